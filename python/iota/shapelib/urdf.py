# SPDX-License-Identifier: Apache-2.0
"""Robots as URDF files: http://wiki.ros.org/urdf/XML. Read by our own code, because an error has to name the line."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np

from iota import looks
from iota._core import Box, Capsule, Cylinder, Shape, Sphere
from iota.builder.parts import JointKind
from iota.shapelib.files import FileError, PathLike
from iota.shapelib.folding import Tree, fold, keep_names, mark
from iota.shapelib.frames import Frame, about, from_rpy, solid_of
from iota.shapelib.mechanism_data import JointCoupling, Link, LinkJoint, Mechanism, color_of, seen_shapes
from iota.shapelib.meshes import mesh_of
from iota.shapelib.surface_files import READERS, read_surface
from iota.shapelib.trees import Element, read_tree
from iota.shapelib.urdf_extras import actuators, frictions
from iota.shapelib.urdf_notes import left_out

JOINTS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
ONE_COORDINATE = ("revolute", "continuous", "prismatic")
MOST_LINKS = 10_000
# The axis of a cylinder is z in URDF, and x in iota.
X_TO_Z = np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]])


def read_urdf(path: PathLike, root: Element | None = None, base: str | None = None) -> Mechanism:
    """base: "fixed" or "free"; None: fixed. Raises FileError."""
    robot = root or read_tree(path)
    if robot.tag != "robot":
        raise robot.wrong(f"a URDF file has <robot> at its top, not <{robot.tag}>")
    links = {}
    for element in robot.all("link"):
        name = element.text("name")
        if name in links:
            raise element.wrong(f"there are two links named {name}")
        links[name] = element
    if not links:
        raise robot.wrong("the robot has no links")
    if len(links) > MOST_LINKS:
        raise robot.wrong(f"has {len(links)} links, more than {MOST_LINKS}")
    for name, element in links.items():
        if "${" in name:
            raise element.wrong("this is a xacro file, a template of URDF: run it through xacro")
    joint_of, order, world = _tree(robot, links)
    mechanism = Mechanism(robot.text("name", "") or Path(path).stem)
    colors = _materials(robot)
    missing: list[str] = []
    mimics, initial = _mimics(joint_of, mechanism.notes)
    mechanism.couplings = mimics
    frames: dict[str, Frame] = {name: Frame() for name in order if name not in joint_of}
    if world:
        frames["world"] = Frame()
    for name in order:
        joint = joint_of.get(name)
        if joint is not None:
            moved = _moved(joint, initial[joint.text("name")])
            frames[name] = frames[joint.need("parent").text("link")] @ _origin(joint) @ moved
        if name != "world":
            mechanism.links.append(_link(links[name], frames[name], colors, path, missing, mechanism.notes))
    taken: set[int] = set()
    frictions_of = frictions(robot, links, taken)
    for link in mechanism.links:
        link.material = {"friction": frictions_of[link.name]} if link.name in frictions_of else None
    roots = [] if base == "free" else [name for name in order if name not in joint_of and name != "world"]
    tree = _tree_of(mechanism, joint_of, roots)
    bare = fold(mechanism, tree)
    if "world" in links and any(each.tag in ("visual", "collision") for each in links["world"].children):
        mechanism.notes.append(f"the shapes of the link world are left out (line {links['world'].line})")
    has_collisions = any(link.touching for link in mechanism.links)
    for link in mechanism.links:
        link.touches = bool(link.touching) or not has_collisions
        link.touching = link.touching or seen_shapes(link)
    for link in bare:
        mark(link)
    moving = 0
    for name in order:
        joint = joint_of.get(name)
        if joint is not None:
            made = _joint(joint, frames[name], initial[joint.text("name")], mechanism.notes)
            moving += joint.text("type") != "fixed"
            if made is not None:
                mechanism.joints.append(made)
        elif name in roots:
            mechanism.joints.append(LinkJoint("weld", f"{name} to the world", name, None, frames[name].place))
    keep_names(mechanism, tree)
    if missing:
        listed = ", ".join(sorted(set(missing))[:3]) + (" ..." if len(set(missing)) > 3 else "")
        what = "1 mesh is missing, and is" if len(missing) == 1 else f"{len(missing)} meshes are missing, and are"
        mechanism.notes.append(f"{what} not drawn: {listed}")
    followers = {coupling.terms[0][0] for coupling in mimics}
    free = {
        each.text("name"): each
        for each in joint_of.values()
        if each.text("type") in ONE_COORDINATE and each.text("name") not in followers
    }
    mechanism.actuators = actuators(robot, free, initial, taken, mechanism.notes)
    mechanism.notes += left_out(robot, taken)
    mechanism.counts = {
        "links": len(links) - ("world" in links), "joints": len(joint_of), "moving joints": moving,
        "independent joints": moving - len(mimics),
        "mass": math.fsum(_mass(element) for element in links.values()), "missing meshes": len(missing),
    }  # fmt: skip
    return mechanism


def _tree(robot: Element, links: dict[str, Element]) -> tuple[dict[str, Element], list[str], bool]:
    """The joint above each link, all links from the roots down, and whether `world` is a parent without a
    declaration."""
    joint_of: dict[str, Element] = {}
    children: dict[str, list[str]] = {}
    names: set[str] = set()
    for joint in robot.all("joint"):
        name, parent, child = joint.text("name"), joint.need("parent").text("link"), joint.need("child").text("link")
        if name in names:
            raise joint.wrong(f"there are two joints named {name}")
        names.add(name)
        if joint.text("type") not in JOINTS:
            raise joint.wrong(f"the joint {name} is of no known type: {joint.text('type')}")
        for link in (parent, child):
            if link not in links and not (link == "world" and link == parent):
                raise joint.wrong(f"the joint {name} names the link {link}, which does not exist")
        if child in joint_of:
            both = f"{joint_of[child].text('name')}, {name}"
            raise joint.wrong(f"{child} has two parents ({both}): URDF must be a tree")
        joint_of[child] = joint
        children.setdefault(parent, []).append(child)
    if "world" in joint_of:
        raise joint_of["world"].wrong("the link world is that which stands still: no joint can have it as its child")
    world = "world" in children and "world" not in links
    order = (["world"] if world else []) + [name for name in links if name not in joint_of]
    for name in order:
        order += children.get(name, [])
        if len(order) > len(links) + 1:
            break
    reached = set(order)
    for name in links:
        if name not in reached:
            raise joint_of[name].wrong(f"the links round {name} form a loop without a root: URDF must be a tree")
    return joint_of, order, world


def _tree_of(mechanism: Mechanism, joint_of: dict[str, Element], roots: list[str]) -> Tree:
    """The links as a tree that can be folded. roots: those that the world holds."""
    kinds = {name: joint.text("type") for name, joint in joint_of.items()}
    above = {name: joint.need("parent").text("link") for name, joint in joint_of.items() if kinds[name] != "floating"}
    parent = {name: None if link == "world" else link for name, link in above.items()}
    return Tree(mechanism.links, parent, {name for name, kind in kinds.items() if kind == "fixed"}, set(roots))


def _origin(element: Element) -> Frame:
    origin = element.first("origin")
    if origin is None:
        return Frame()
    return Frame(np.array(origin.numbers("xyz", 3, "0 0 0")), from_rpy(*origin.numbers("rpy", 3, "0 0 0")))


def _mass(link: Element) -> float:
    inertial = link.first("inertial")
    return inertial.need("mass").number("value") if inertial is not None else 0.0


def _link(
    element: Element, frame: Frame, colors: dict[str, str], path: PathLike, missing: list[str], notes: list[str]
) -> Link:
    name, mass = element.text("name"), _mass(element)
    inertial = element.first("inertial")
    inertia, at = np.zeros((3, 3)), Frame()
    if inertial is not None:
        at = _origin(inertial)
        told = inertial.first("inertia")
        if told is not None:
            xx, xy, xz, yy, yz, zz = (told.number(key, 0.0) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
            inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if mass < 0 or (np.linalg.eigvalsh(inertia) < -1e-9).any():
        raise (inertial or element).wrong(f"the link {name} has a negative mass or inertia")
    try:
        solid = solid_of(mass, inertia, at) if mass > 0 else None
    except ValueError as error:
        raise (inertial or element).wrong(f"the inertia of the link {name} fits no body: {error}") from None
    if solid is not None and solid.is_changed:
        notes.append(f"the inertia of the link {name} is impossible for a rigid body; the nearest possible one is used")
    link = Link(name, frame, solid)
    for visual in element.all("visual"):
        found = _shape(visual.need("geometry"), path, missing, notes)
        if found is not None:
            shape, turn = found
            color = _color(visual, colors)
            where = _origin(visual)
            link.drawn.append((looks.Look(shape, "paint", color), Frame(where.place, where.turn @ turn)))
    for collision in element.all("collision"):
        found = _shape(collision.need("geometry"), path, missing, notes)
        if found is not None:
            where = _origin(collision)
            link.touching.append((found[0], Frame(where.place, where.turn @ found[1])))
    return link


def _shape(geometry: Element, path: PathLike, missing: list[str], notes: list[str]) -> tuple[Shape, np.ndarray] | None:
    """A shape and its rotation; None for a mesh that cannot be read, which is added to `missing`."""
    for child in geometry.children:
        try:
            if child.tag == "box":
                return Box(child.numbers("size", 3)), np.eye(3)
            if child.tag == "cylinder":
                return Cylinder(child.number("radius"), child.number("length")), X_TO_Z
            if child.tag == "capsule":
                return Capsule(child.number("radius"), child.number("length")), X_TO_Z
            if child.tag == "sphere":
                return Sphere(child.number("radius")), np.eye(3)
        except ValueError as error:
            raise error if isinstance(error, FileError) else child.wrong(str(error)) from None
        if child.tag == "mesh":
            name = child.text("filename")
            file = _find(name, Path(path))
            if file is None or file.suffix.lower() not in READERS:
                missing.append(name)
                return None
            surface = read_surface(file)
            surface.weld()
            scale = np.array(child.numbers("scale", 3, "1 1 1"))
            try:
                mesh, is_turned = mesh_of(surface.vertices, surface.triangles()[0], scale)
            except ValueError as error:
                raise child.wrong(f"the mesh {name}: {error}") from None
            if is_turned:
                notes.append(f"the mesh {name} is inside out, and turned round")
            return mesh, np.eye(3)
    raise geometry.wrong("a geometry is a box, cylinder, capsule, sphere or mesh")


def _find(name: str, path: Path) -> Path | None:
    """A mesh file: beside the URDF file, or for package://name/rest in a folder above it that has such a file. Never
    outside of the folder tree of the URDF file."""
    plain = name.removeprefix("file://")
    folders = [path.parent]
    if name.startswith("package://"):
        plain = name.removeprefix("package://")
        folders += list(path.resolve().parent.parents)[:4]
    for folder in folders:
        for part in (plain, plain.partition("/")[2]) if name.startswith("package://") else (plain,):
            if part and not Path(part).is_absolute() and ".." not in Path(part).parts and os.path.isfile(folder / part):
                return folder / part
    return None


def _materials(robot: Element) -> dict[str, str]:
    colors = {}
    for material in robot.all("material"):
        color = material.first("color")
        if color is not None:
            colors[material.text("name", "")] = _hex(color)
    return colors


def _color(visual: Element, colors: dict[str, str]) -> str | None:
    material = visual.first("material")
    if material is None:
        return None
    color = material.first("color")
    if color is None:
        return colors.get(material.text("name", ""))
    found = _hex(color)
    if material.text("name", ""):
        colors.setdefault(material.text("name"), found)
    return found


def _hex(color: Element) -> str:
    return color_of(color.numbers("rgba", 4))


def _mimics(joint_of: dict[str, Element], notes: list[str]) -> tuple[list[JointCoupling], dict[str, float]]:
    """The couplings of joints that mimic others, and where each joint begins, rad or m: where its leader, at 0, puts it.
    Raises FileError for leaders that do not exist or follow in a circle."""
    joints = {joint.text("name"): joint for joint in joint_of.values()}
    follows: dict[str, tuple[Element, str]] = {}
    couplings: list[JointCoupling] = []
    for name, joint in joints.items():
        mimic = joint.first("mimic")
        if mimic is None:
            continue
        leader = mimic.text("joint")
        if leader not in joints or leader == name:
            raise mimic.wrong(f"{name} mimics {leader}, which is not another joint")
        unlike = [each for each in (name, leader) if joints[each].text("type") not in ONE_COORDINATE]
        if unlike:
            notes.append(f"{name} mimics {leader}, but {unlike[0]} is {joints[unlike[0]].text('type')}: left out")
            continue
        follows[name] = (mimic, leader)
        terms = [(name, 1.0), (leader, -_multiplier(mimic))] if _multiplier(mimic) != 0 else [(name, 1.0)]
        length = 0.0 if len(terms) == 1 else None  # locked at its offset
        couplings.append(JointCoupling(f"{name} mimics {leader}", terms, length))
    initial = {name: 0.0 for name in joints if name not in follows}
    for name in follows:
        chain = [name]
        while chain[-1] not in initial:
            mimic, leader = follows[chain[-1]]
            if leader in chain:
                raise mimic.wrong(f"joints mimic each other in a circle: {', '.join([*chain, leader])}")
            chain.append(leader)
        for each in reversed(chain[:-1]):
            mimic, leader = follows[each]
            initial[each] = _multiplier(mimic) * initial[leader] + mimic.number("offset", 0.0)
    return couplings, initial


def _multiplier(mimic: Element) -> float:
    return mimic.number("multiplier", 1.0)


def _axis(joint: Element) -> np.ndarray:
    """In the joint's frame."""
    element = joint.first("axis")
    axis = np.array(element.numbers("xyz", 3)) if element else np.array([1.0, 0, 0])
    if not np.linalg.norm(axis) > 0:
        raise (element or joint).wrong(f"the axis of {joint.text('name')} is zero")
    return axis


def _moved(joint: Element, by: float) -> Frame:
    """The pose of a joint whose coordinate is `by`, rad or m."""
    if by == 0:
        return Frame()
    axis = _axis(joint)
    if joint.text("type") == "prismatic":
        return Frame(by * axis / np.linalg.norm(axis))
    return Frame(turn=about(axis, by))


def _joint(joint: Element, frame: Frame, initial: float, notes: list[str]) -> LinkJoint | None:
    """frame: of its child, at the joint. initial: the joint's coordinate there. None for a free joint."""
    name, kind = joint.text("name"), joint.text("type")
    parent, child = joint.need("parent").text("link"), joint.need("child").text("link")
    b = None if parent == "world" else parent
    if kind == "fixed":
        return LinkJoint("weld", name, child, b, frame.place)
    if kind == "floating":
        return None
    axis = _axis(joint)
    if kind == "planar":
        return LinkJoint("planar", name, child, b, frame.place, frame.turn @ axis)
    options: dict[str, object] = {}
    limit = joint.first("limit")
    if limit is not None and kind != "continuous" and {"lower", "upper"} & limit.attributes.keys():
        lower, upper = limit.number("lower", 0.0), limit.number("upper", 0.0)
        if lower > upper:
            raise limit.wrong(f"the lower limit of {name}, {lower}, is above the upper one, {upper}")
        if lower <= initial <= upper and lower < upper:
            options["limits"] = (lower - initial, upper - initial)
        else:
            notes.append(
                f"the limits of {name}, {lower} to {upper}, exclude its initial pose or leave no range: left out"
            )
    elif kind in ("revolute", "prismatic") and joint.first("mimic") is None:
        notes.append(f"the joint {name} has no limits, which its type {kind} needs: it moves freely")
    dynamics = joint.first("dynamics")
    if dynamics is not None:
        damping, friction = dynamics.number("damping", 0.0), dynamics.number("friction", 0.0)
        if min(damping, friction) < 0:
            raise dynamics.wrong(f"the damping and the friction of {name} must not be negative")
        if damping > 0:
            options["spring"] = (0.0, damping, 0.0)
        if friction > 0:
            options["friction"] = friction
    ours: JointKind = "prismatic" if kind == "prismatic" else "revolute"
    return LinkJoint(ours, name, child, b, frame.place, frame.turn @ axis, options)
