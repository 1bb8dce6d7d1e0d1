# SPDX-License-Identifier: Apache-2.0
"""MuJoCo models (MJCF): MuJoCo itself reads them, with defaults, classes and includes, and gives masses, frames and
joints."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from iota import looks
from iota._core import Box, Capsule, Cylinder, Ellipsoid, Mesh, Shape, Sphere
from iota.extras import how_to_get
from iota.shapelib.files import FileError, PathLike, whole
from iota.shapelib.folding import Tree, fold, keep_names, mark
from iota.shapelib.frames import Frame, from_quaternion, solid_of
from iota.shapelib.mechanism_data import (
    JointActuator,
    JointCoupling,
    Link,
    LinkJoint,
    LinkSpring,
    Mechanism,
    color_of,
    seen_shapes,
)
from iota.shapelib.meshes import mesh_of
from iota.shapelib.mjcf_notes import MOST_NAMED, gravity_note, left_out
from iota.shapelib.trees import Element, read_tree
from iota.shapelib.urdf import X_TO_Z

FREE, BALL, SLIDE, HINGE = range(4)  # mjtJoint
CONNECT, WELD, EQUAL_JOINTS, EQUAL_TENDONS = range(4)  # mjtEq
SITE = 6  # mjtObj
WRAPPED_JOINT, WRAPPED_SITE = 1, 3  # mjtWrap
PLANE, ROUND = 0, (2, 3, 5)  # mjtGeom; sphere, capsule, cylinder
DRIVES_JOINT, DRIVES_TENDON = (0, 1), 3  # mjtTrn
INSTANT, INTEGRATES, FILTERS = (0,), 1, (2, 3)  # mjtDyn
ACTUATION_OFF = 1 << 11  # mjDSBL_ACTUATION
FOLDERS = ("meshdir", "texturedir", "assetdir")
MOST_COPIES, MOST_CELLS = 10_000, 1 << 24
MOST_MASKED = 1000  # bodies, pairs of which are compared
POSITIVE = ("friction", "armature", "damping", "frictionloss")
SAID = {
    "0": "ref",
    "_spring": "springref",
    "data": "number",
    "prm": "coef",
    "ipos": "inertial pos",
    "iquat": "inertial quat",
}  # arrays
Y_TO_Z = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # of land, whose heights are along y
LIGHTEST = 1e-6  # kg: for movable bodies without mass
CARDAN = 1e-3  # share of a link's mass in each light ring between two joints of one link


def read_mjcf(path: PathLike) -> Mechanism:
    """Raises FileError, and ImportError without MuJoCo."""
    root = read_tree(path)
    if root.tag != "mujoco":
        raise root.wrong(f"an MJCF file has <mujoco> at its top, not <{root.tag}>")
    included: list[Element] = []
    check(root, Path(path).parent, frozenset([Path(path)]), included)
    try:
        import mujoco
    except ImportError:
        raise ImportError(f"MJCF files need MuJoCo. {how_to_get('shapelib')}") from None
    warnings: list[str] = []
    # Without this it writes them into MUJOCO_LOG.TXT, in the folder where the script was started.
    mujoco.set_mju_user_warning(lambda text: warnings.append(" ".join(str(text).split())))
    try:
        model = compiled(mujoco, path)
        notes: list[str] = []
        spec = said(mujoco, path, included, notes)
        state = mujoco.MjData(model)
        mujoco.mj_kinematics(model, state)
    except ValueError as error:
        raise wrong(path, str(error), included) from None
    finally:
        mujoco.set_mju_user_warning(None)
    require_numbers(path, model)
    reader = _Reader(model, state, root.text("model", "") or Path(path).name.split(".")[0])
    try:
        reader.read()
    except FileError:
        raise
    except ValueError as error:
        raise FileError(path, f"has a size or an inertia that no body can have: {error}") from None
    reader.mechanism.notes += notes
    if spec is not None:
        roots = [root, *included]
        reader.mechanism.notes += [
            *gravity_note(mujoco, spec),
            *left_out(mujoco, spec, roots, reader.is_taken),
        ]
    reader.mechanism.notes += [f"MuJoCo warns: {text}" for text in warnings]
    return reader.mechanism


def compiled(mujoco: Any, path: PathLike) -> Any:
    """The model. Muscles are not read, so that one whose range of lengths MuJoCo cannot find is no reason to refuse a model."""
    try:
        return mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        if "lengthrange" not in str(error).lower():
            raise
    spec = mujoco.MjSpec.from_file(str(path))
    spec.compiler.LRopt.mode = int(mujoco.mjtLRMode.mjLRMODE_NONE)
    return spec.compile()


def require_numbers(path: PathLike, model: Any) -> None:
    """Raises FileError for numbers that MuJoCo takes and no body, joint or actuator can have."""
    joint_of_q = [int(np.searchsorted(model.jnt_qposadr, q, "right")) - 1 for q in range(model.nq)]
    tendon_of_wrap = [int(np.searchsorted(model.tendon_adr, wrap, "right")) - 1 for wrap in range(model.nwrap)]
    for array, kind, names, owner_of in (
        ("body", "body", "pos quat gravcomp mass inertia ipos iquat", None),
        ("geom", "geom", "pos quat size friction", None),
        ("site", "site", "pos quat", None),
        ("jnt", "joint", "pos axis range stiffness", None),
        ("qpos", "joint", "0 _spring", joint_of_q),
        ("dof", "joint", "armature damping frictionloss", model.dof_jntid),
        ("actuator", "actuator", "gear gainprm biasprm ctrlrange forcerange actrange", None),
        ("eq", "equality", "data", None),
        ("tendon", "tendon", "range stiffness damping lengthspring", None),
        ("wrap", "tendon", "prm", tendon_of_wrap),
    ):
        for name in names.split():
            values = getattr(model, f"{array}_{name}" if array != "qpos" else f"qpos{name}")
            rows = values.reshape(len(values), int(np.prod(values.shape[1:])))
            is_positive = name in POSITIVE
            is_wrong = np.isnan(rows) if name == "range" else ~np.isfinite(rows)  # a joint may have one limit
            for number in np.flatnonzero((is_wrong | (is_positive & (rows < 0))).any(axis=1)):
                owner = number if owner_of is None else owner_of[number]
                called = getattr(model, kind)(int(owner)).name or owner
                raise FileError(
                    path,
                    f"the {SAID.get(name, name)} of {kind} {called} must be finite{' and not negative' if is_positive else ''}",
                )


def said(mujoco: Any, path: PathLike, included: list[Element], notes: list[str]) -> Any:
    """The elements of the file as MuJoCo reads them, with defaults and lines; None, and a note, where it cannot."""
    try:
        if Path(path).suffix == ".xml":
            return mujoco.MjSpec.from_file(str(path))
        # MuJoCo 4 opens files of other endings as models only, not as elements.
        folder = Path(path).parent
        files = {str(Path(each.path).relative_to(folder)): Path(each.path).read_bytes() for each in included}
        return mujoco.MjSpec.from_string(Path(path).read_text(), include=files)
    except ValueError as error:
        notes.append(
            f"what is left out is not listed in full, as MuJoCo cannot read the elements: {error}".split("\n")[0]
        )
        return None


def wrong(path: PathLike, text: str, included: list[Element]) -> FileError:
    """Converts an error of MuJoCo. MuJoCo reports line 0 for an element of an included file; the element is then found by
    the tag and the attribute that the error names."""
    reason = f"MuJoCo cannot read it: {text.split(chr(10))[0].rstrip(': ')}"
    line = re.search(r"line(?: number=)? ?(\d+)", text)
    if line is None or line.group(1) != "0":
        return FileError(path, reason, line and int(line.group(1)))
    tag, name = (re.search(rf"{word}:? '(\w+)'", text) for word in ("Element", "attribute"))
    for root in included:
        for element in root.walk():
            if tag and element.tag == tag.group(1) and (name is None or name.group(1) in element.attributes):
                return FileError(element.path, reason, element.line)
    return FileError(path, f"{reason}, in a file that it includes")


def check(element: Element, folder: Path, seen: frozenset[Path], included: list[Element], copies: int = 1) -> None:
    """Raises FileError for what MuJoCo would take minutes or all memory to build, as it cannot be interrupted, and for files
    outside of the model's folder; also in the files that it includes, whose roots are added to `included`. folder: that of the
    model; seen: the files around the element."""
    if element.tag in ("replicate", "flexcomp", "composite"):
        for word in element.text("count", "1").split():
            copies *= max(1, whole(word, element.path, element.line, "count"))
        if copies > MOST_COPIES:
            raise element.wrong(f"makes {copies} copies, more than {MOST_COPIES}")
    for tag, (rows, columns) in {"hfield": ("nrow", "ncol"), "texture": ("width", "height")}.items():
        if element.tag == tag:
            size = element.number(rows, 0.0) * element.number(columns, 0.0)
            if size > MOST_CELLS:
                raise element.wrong(f"<{tag}> has {size:.3g} cells, more than {MOST_CELLS}")
    for name, value in element.attributes.items():
        if name.startswith("file") or name in FOLDERS:
            if Path(value).is_absolute() or ".." in Path(value).parts:
                raise element.wrong(f"{name} {value!r} leads out of the model's folder: copy what it needs into it")
    if element.tag in ("include", "model"):
        # MuJoCo takes a file of any ending, from the model's folder or from that of the file that includes it.
        places = [at / element.text("file") for at in (folder, Path(element.path).parent)]
        for file in dict.fromkeys(filter(Path.exists, places)) or places[:1]:
            if file in seen:
                raise element.wrong(f"{file.name} includes itself")
            if not file.exists():
                raise element.wrong(f"<{element.tag}> names {element.attributes.get('file')!r}, which does not exist")
            included.append(read_tree(file))
            check(included[-1], folder, seen | {file}, included, copies)
    for child in element.children:
        check(child, folder, seen, included, copies)


class _Reader:
    """A model in its initial configuration."""

    def __init__(self, model: Any, state: Any, title: str) -> None:
        self.model, self.state = model, state
        self.mechanism = Mechanism(title)
        self.springs: set[int] = set()  # tendons whose springs are taken
        self.driven: set[int] = set()  # joints of which the largest force of an actuator is taken
        self.names = [model.body(number).name or f"body {number}" for number in range(model.nbody)]

    def read(self) -> None:
        m, mechanism = self.model, self.mechanism
        moves = np.zeros(m.nbody, bool)
        for body in range(1, m.nbody):
            moves[body] = m.body_jntnum[body] > 0 or moves[m.body_parentid[body]]
        self.moves = moves
        for body in range(m.nbody):
            link = self.link(body)
            joints = range(m.body_jntadr[body], m.body_jntadr[body] + m.body_jntnum[body])
            kinds = [int(m.jnt_type[joint]) for joint in joints]
            if moves[body] and FREE not in kinds:
                self.join(link, list(joints))
            mechanism.links.append(link)
        self.pass_by()
        for number in range(m.neq):
            self.equality(number)
        for number in range(m.ntendon):
            self.tendon(number)
        planes = int((m.geom_type == 0).sum())
        self.materials()
        self.fold()
        self.actuators()
        for count, what in (
            (planes, "planes, which are drawn by the world"), (m.nflex, "deformable bodies"),
        ):  # fmt: skip
            if count:
                mechanism.notes.append(f"{count} {what} are left out")
        mechanism.counts = {
            "bodies": m.nbody - 1, "joints": m.njnt, "degrees of freedom": m.nv, "geoms": m.ngeom, "equalities": m.neq,
            "tendons": m.ntendon, "actuators": m.nu, "mass": float(m.body_mass.sum()),
            "height of the center of mass": float(m.body_mass @ self.state.xipos[:, 2] / max(m.body_mass.sum(), 1e-300)),
        }  # fmt: skip

    def fold(self) -> None:
        """Makes bodies without mass parts of those that they are fixed to."""
        m = self.model
        number = {name: body for body, name in enumerate(self.names)}
        links = [link for link in self.mechanism.links if self.moves[number.get(link.is_of or link.name, 0)]]
        parent: dict[str, str | None] = {}
        for link in links:
            body = number[link.is_of or link.name]
            parent[link.name] = self.name_of(int(m.body_parentid[body]))
        fixed = {link.name for link in links if not link.is_of and m.body_jntnum[number[link.name]] == 0}
        tree = Tree(links, parent, fixed, set())
        for link in fold(self.mechanism, tree):
            mark(link)
        keep_names(self.mechanism, tree)

    def is_taken(self, kind: str, number: int, attribute: str) -> bool:
        """Whether it is of a spring of a tendon that became one of ours, or of the force of an actuator."""
        if kind == "Joint":
            return attribute in ("actfrclimited", "actfrcrange") and number in self.driven
        return kind == "Tendon" and attribute in ("stiffness", "damping", "springlength") and number in self.springs

    def frame(self, body: int) -> Frame:
        return Frame(self.state.xpos[body].copy(), self.state.xmat[body].reshape(3, 3).copy())

    def link(self, body: int) -> Link:
        m = self.model
        link = Link(self.names[body], self.frame(body), None)
        if self.moves[body]:
            mass, inertia = float(m.body_mass[body]), np.diag(m.body_inertia[body])
            if mass <= 0 and m.body_jntnum[body] == 0:
                mass = 0.0  # part of what it is fixed to
            elif mass <= 0:
                self.mechanism.notes.append(f"the body {link.name} has no mass; it is given {LIGHTEST} kg")
                mass, inertia = LIGHTEST, LIGHTEST * 1e-2 * np.eye(3)
            x, y, z, w = np.roll(m.body_iquat[body], -1)
            at = Frame(m.body_ipos[body].copy(), from_quaternion(x, y, z, w))
            link.solid = solid_of(mass, inertia, at) if mass > 0 else None
            link.lift = float(m.body_gravcomp[body])
        for geom in range(m.body_geomadr[body], m.body_geomadr[body] + m.body_geomnum[body]):
            shape = self.shape(geom)
            if shape is not None:
                w, x, y, z = m.geom_quat[geom]
                material = int(m.geom_matid[geom])
                rgba = m.mat_rgba[material] if material >= 0 else m.geom_rgba[geom]
                look = looks.Look(shape[0], "paint", color_of(rgba))
                where = Frame(m.geom_pos[geom].copy(), from_quaternion(x, y, z, w) @ shape[1])
                link.drawn.append((look, where))
                if m.geom_contype[geom] or m.geom_conaffinity[geom]:
                    link.touching.append((shape[0], where))
        link.touches = bool(link.touching or not link.drawn)
        link.touching = link.touching or seen_shapes(link)
        if link.drawn and not self.moves[body]:
            link.kind, link.solid = "static", solid_of(1.0, np.eye(3), Frame())
        return link

    def shape(self, geom: int) -> tuple[Shape, Any] | None:
        """By the numbers of mjtGeom; None for planes and geometries without a closed surface."""
        m = self.model
        size, kind = [float(v) for v in m.geom_size[geom]], int(m.geom_type[geom])
        if kind == 1:
            field = int(m.geom_dataid[geom])
            rows, columns, first = m.hfield_nrow[field], m.hfield_ncol[field], m.hfield_adr[field]
            x, y, height, _ = (float(v) for v in m.hfield_size[field])
            # Its rows go along y and its columns along x. Below its lowest place it is a block, which nothing comes to.
            heights = height * m.hfield_data[first : first + rows * columns].reshape(rows, columns).astype(float)
            return Mesh.height_field(heights[::-1].T, (2 * x, 2 * y)), Y_TO_Z
        if kind == 2:
            return Sphere(size[0]), np.eye(3)
        if kind == 3:
            return Capsule(size[0], 2 * size[1]), X_TO_Z
        if kind == 4:
            return Ellipsoid([2 * v for v in size]), np.eye(3)
        if kind == 5:
            return Cylinder(size[0], 2 * size[1]), X_TO_Z
        if kind == 6:
            return Box([2 * v for v in size]), np.eye(3)
        if kind == 7:
            mesh = int(m.geom_dataid[geom])
            vertices = m.mesh_vert[m.mesh_vertadr[mesh] : m.mesh_vertadr[mesh] + m.mesh_vertnum[mesh]]
            faces = m.mesh_face[m.mesh_faceadr[mesh] : m.mesh_faceadr[mesh] + m.mesh_facenum[mesh]]
            try:
                return mesh_of(vertices, faces)[0], np.eye(3)
            except ValueError as error:
                self.mechanism.notes.append(f"the mesh {m.mesh(mesh).name} is not drawn: {error}")
        return None

    def materials(self) -> None:
        """Gives each link the friction of its geoms, as far as they touch. MuJoCo takes the larger friction of two geoms, or that of the one
        with a higher priority, and iota the geometric mean of two bodies: what moves gets the friction with which that is right on
        what is fixed."""
        m = self.model
        touching = [int(geom) for geom in np.flatnonzero((m.geom_contype != 0) | (m.geom_conaffinity != 0))]
        fixed = [geom for geom in touching if not self.moves[m.geom_bodyid[geom]]]
        floor = max(fixed, key=lambda geom: m.geom_friction[geom][0], default=None)
        number = {name: body for body, name in enumerate(self.names)}
        rubs: dict[int, list[dict[str, float]]] = {}
        for geom in touching:
            if m.geom_type[geom] != PLANE:
                rubs.setdefault(int(m.geom_bodyid[geom]), []).append(self.rub(geom, None if geom in fixed else floor))
        materials = {body: {name: max(rub[name] for rub in each) for name in each[0]} for body, each in rubs.items()}
        for link in self.mechanism.links:
            found = materials.get(number.get(link.is_of or link.name, 0))
            if found is not None:
                link.material = {name: value for name, value in found.items() if name == "friction" or value > 0}
        for body, each in rubs.items():
            if len({rub["friction"] for rub in each}) > 1:
                of = f"of {self.names[body]}" if self.moves[body] else "that are fixed"
                self.mechanism.notes.append(
                    f"the geoms {of} differ in friction: all have the largest, {materials[body]['friction']:g}"
                )
        moving = {material["friction"] for body, material in materials.items() if self.moves[body]}
        if len(moving) > 1:
            self.mechanism.notes.append(
                f"moving bodies have frictions of {min(moving):g} to {max(moving):g}: between two of them the geometric mean acts, where MuJoCo "
                "has the larger one"
            )
        planes = [float(m.geom_friction[geom][0]) for geom in fixed if m.geom_type[geom] == PLANE]
        if planes:
            self.mechanism.notes.append(
                f"the plane has a friction of {max(planes):g}, which the world's ground has where a script says so: "
                f"world.scene.ground_body.material = iota.Material(friction={max(planes):g})"
            )

    def rub(self, geom: int, floor: int | None) -> dict[str, float]:
        """Keywords of `iota.Material` for a geom that meets `floor`, which has its own friction; None: others like itself."""
        m = self.model
        sliding, spinning, rolling = (float(v) for v in m.geom_friction[geom])
        dimensions, others = int(m.geom_condim[geom]), 0.0
        if floor is not None:
            ahead = int(m.geom_priority[geom]) - int(m.geom_priority[floor])
            others = float(m.geom_friction[floor][0])
            if ahead <= 0:
                mine = [0.0, 0.0, 0.0] if ahead < 0 else [sliding, spinning, rolling]
                sliding, spinning, rolling = (
                    max(a, float(b)) for a, b in zip(mine, m.geom_friction[floor], strict=True)
                )
                dimensions = max(dimensions if ahead == 0 else 1, int(m.geom_condim[floor]))
        is_fixed = not self.moves[m.geom_bodyid[geom]]
        is_round = int(m.geom_type[geom]) in ROUND
        if dimensions > 3 and not is_round and not is_fixed:
            name = m.geom(geom).name or geom
            self.mechanism.notes.append(
                f"the friction of geom {name} against spinning and rolling is left out: it is not round"
            )
        radius = float(m.geom_size[geom][0]) if is_round and not is_fixed else np.inf
        if dimensions == 1 and not is_fixed:
            sliding = 0.0
        return {
            "friction": sliding**2 / others if others > 0 else sliding,
            "spinning": spinning / radius if dimensions > 3 else 0.0,
            "rolling": rolling / radius if dimensions > 4 else 0.0,
        }

    def pass_by(self) -> None:
        """Links do not touch that MuJoCo excludes: those of `exclude`, and those whose masks say so."""
        m, pairs = self.model, set()
        for signature in (int(v) for v in m.exclude_signature):
            pairs.add((signature >> 16, signature & 0xFFFF))
        types, affinities = np.zeros(m.nbody, int), np.zeros(m.nbody, int)
        np.bitwise_or.at(types, m.geom_bodyid, m.geom_contype)
        np.bitwise_or.at(affinities, m.geom_bodyid, m.geom_conaffinity)
        masked = [body for body in range(1, m.nbody) if types[body] or affinities[body]]
        has_masks = any(types[body] != 1 or affinities[body] != 1 for body in masked)
        if has_masks and len(masked) > MOST_MASKED:
            self.mechanism.notes.append(f"masks of contacts are left out, as more than {MOST_MASKED} bodies have them")
        elif has_masks:
            for a in masked:
                free = (types[a] & affinities) | (types & affinities[a])
                pairs |= {(a, b) for b in masked if a < b and not free[b]}
        self.mechanism.passing += [(self.names[a], self.names[b]) for a, b in pairs]

    # --- joints ---------------------------------------------------------------------------------------------------

    def join(self, link: Link, joints: list[int]) -> None:
        """One joint of iota for each of a body's; between two of them there is a light ring."""
        parent = int(self.model.body_parentid[self.names.index(link.name)])
        above = self.name_of(parent)
        if not joints:
            self.mechanism.joints.append(
                LinkJoint("weld", f"{link.name} to {self.names[parent]}", link.name, above, link.frame.place)
            )
            return
        assert link.solid is not None
        rings = len(joints) - 1
        solid = link.solid
        if rings:
            inertia = solid.inertia
            share = CARDAN
            own = 1 - rings * share
            link.solid = solid_of(own * solid.mass, own * inertia, solid.frame)
            for number in range(rings):
                ring = Link(
                    f"{link.name} ring {number + 1}",
                    link.frame,
                    solid_of(share * solid.mass, share * inertia, solid.frame),
                )
                ring.drawn = [(looks.sphere(1e-3), Frame(solid.frame.place))]
                ring.touching = [(Sphere(1e-3), Frame(solid.frame.place))]
                ring.touches, ring.is_of = link.touches, link.name
                self.mechanism.links.append(ring)
        for number, joint in enumerate(joints):
            a = link.name if number == rings else f"{link.name} ring {number + 1}"
            self.joint(joint, a, above)
            above = a

    def name_of(self, body: int) -> str | None:
        return self.names[body] if self.moves[body] else None

    def joint(self, joint: int, a: str, b: str | None) -> None:
        m = self.model
        name, kind = self.joint_name(joint), int(m.jnt_type[joint])
        at, axis = self.state.xanchor[joint].copy(), self.state.xaxis[joint].copy()
        if kind == BALL:
            if m.jnt_limited[joint]:
                self.mechanism.notes.append(f"the limit of the ball joint {name} is left out")
            self.mechanism.joints.append(LinkJoint("ball", name, a, b, at))
            return
        dof, first = int(m.jnt_dofadr[joint]), float(m.qpos0[m.jnt_qposadr[joint]])
        options: dict[str, Any] = {}
        stiffness, damping = float(np.ravel(m.jnt_stiffness[joint])[0]), float(np.ravel(m.dof_damping[dof])[0])
        if stiffness < 0:
            self.mechanism.notes.append(f"the stiffness of {name} is negative: left out")
        if stiffness > 0 or damping > 0:
            rest = float(m.qpos_spring[m.jnt_qposadr[joint]]) - first if stiffness > 0 else 0.0
            options["spring"] = (stiffness, damping, rest)
        if m.dof_frictionloss[dof] > 0:
            options["friction"] = float(m.dof_frictionloss[dof])
        rotor = float(m.dof_armature[dof])
        if m.jnt_limited[joint]:
            low, high = (float(v) - first for v in m.jnt_range[joint])
            if low <= 0 <= high and low < high:
                options["limits"] = (low, high)
            else:
                self.mechanism.notes.append(f"the limits of {name} exclude its initial pose: left out")
        self.mechanism.joints.append(
            LinkJoint("prismatic" if kind == SLIDE else "revolute", name, a, b, at, axis, options, rotor)
        )

    # --- actuators ------------------------------------------------------------------------------------------------

    def actuators(self) -> None:
        m = self.model
        made = {joint.name for joint in self.mechanism.joints}
        used: dict[int, int] = {}
        left: dict[str, list[str]] = {}
        for number in range(m.nu):
            name = str(m.actuator(number).name or f"actuator {number}")
            terms = self.terms_of_actuator(number)
            law: dict[str, Any] | str = terms if isinstance(terms, str) else self.law(number, name, terms)
            if isinstance(law, dict) and not isinstance(terms, str):
                named = self.terms(terms)
                if all(joint in made for joint, _ in named):
                    self.mechanism.actuators.append(JointActuator(name, named, law))
                    for joint in terms:
                        used[joint] = used.get(joint, 0) + 1
                    continue
                law = "drives a joint that is left out"
            left.setdefault(str(law), []).append(name)
        for why, names in left.items():
            self.mechanism.notes += [f"the actuator {name} {why}: left out" for name in names[:MOST_NAMED]]
            if len(names) > MOST_NAMED:
                self.mechanism.notes.append(f"{len(names) - MOST_NAMED} more actuators are left out for that reason")
        # A joint has one motor, so that two of its actuators cannot both move it at a speed.
        shared = {joint for joint, count in used.items() if count > 1}
        self.mechanism.notes += [
            f"the actuatorfrcrange of {self.joint_name(joint)} is that of each of its {used[joint]} actuators, and not of their sum"
            for joint in sorted(shared & self.driven)
        ]
        kept = []
        for actuator in self.mechanism.actuators:
            crowded = [joint for joint in shared if self.joint_name(joint) in dict(actuator.terms)]
            if crowded and actuator.law.get("law", "force") != "force":
                self.mechanism.notes.append(
                    f"the actuator {actuator.name} sets a speed of {self.joint_name(crowded[0])}, which has other actuators: left out"
                )
                continue
            kept.append(actuator)
        self.mechanism.actuators = kept

    def terms_of_actuator(self, number: int) -> dict[int, float] | str:
        """The ratios by joint; a reason for what has none."""
        m = self.model
        if int(m.opt.disableflags) & ACTUATION_OFF:
            return "is switched off by a flag"
        kind, gear = int(m.actuator_trntype[number]), float(m.actuator_gear[number][0])
        target = int(m.actuator_trnid[number][0])
        if kind in DRIVES_JOINT and int(m.jnt_type[target]) in (SLIDE, HINGE):
            terms: dict[int, float] | None = {target: 1.0}
        elif kind in DRIVES_JOINT:
            return "drives a ball or free joint"
        elif kind == DRIVES_TENDON:
            terms = self.sum_of_tendon(target)
        else:
            return "drives no joint"
        if terms is None:
            return "drives a tendon in space"
        terms = {joint: gear * ratio for joint, ratio in terms.items() if ratio != 0}
        return terms if terms and gear != 0 else "has a gear of 0"

    def law(self, number: int, name: str, terms: dict[int, float]) -> dict[str, Any] | str:
        """The fields of an `iota.builder.Actuator`; a reason for one that is of no such kind."""
        m, notes = self.model, self.mechanism.notes
        dynamics = int(m.actuator_dyntype[number])
        gain = float(m.actuator_gainprm[number][0])
        has_bias = int(m.actuator_biastype[number]) != 0
        bias = [float(v) for v in m.actuator_biasprm[number][:3]] if has_bias else [0.0, 0.0, 0.0]
        if (
            int(m.actuator_gaintype[number]) != 0
            or int(m.actuator_biastype[number]) > 1
            or dynamics not in (*INSTANT, INTEGRATES, *FILTERS)
        ):
            return "is a muscle, a damper or of another kind with a state or a gain of its own"
        if bias[1] > 0 or bias[2] > 0:
            return "has a spring or damper that drives its joint"
        initial = sum(ratio * float(m.qpos0[m.jnt_qposadr[joint]]) for joint, ratio in terms.items())
        law: dict[str, Any] = {
            "gain": gain,
            "constant": bias[0] + bias[1] * initial,
            "stiffness": abs(bias[1]),
            "damping": abs(bias[2]),
        }
        if m.actuator_ctrllimited[number]:
            law["control_range"] = tuple(float(v) for v in m.actuator_ctrlrange[number])
        forces = self.largest_force(number, terms)
        if forces is not None:
            law["force_range"] = forces
        if dynamics in FILTERS:
            notes.append(f"the lag of the actuator {name} is left out")
        if dynamics == INTEGRATES:
            if len(terms) > 1 or gain <= 0 or bias[1] != -gain or bias[0] != 0:
                return "integrates its control, but sets no speed"
            if forces is None:
                notes.append(
                    f"the actuator {name} has no range of force: its largest one is {gain:g}, that of an error of 1"
                )
            law = {"law": "speed", "force_range": forces or (-gain, gain), "control_range": law.get("control_range")}
            if m.actuator_actlimited[number]:
                law["travel"] = tuple(float(v) - initial for v in m.actuator_actrange[number])
        elif len(terms) > 1 and (law["stiffness"] > 0 or law["damping"] > 0):
            return "holds a sum of joints"
        return law

    def largest_force(self, number: int, terms: dict[int, float]) -> tuple[float, float] | None:
        """Returns the range of the actuator and of its joint, along the actuator."""
        m = self.model
        low, high = (
            (float(v) for v in m.actuator_forcerange[number]) if m.actuator_forcelimited[number] else (-np.inf, np.inf)
        )
        if len(terms) == 1:
            ((joint, ratio),) = terms.items()
            if m.jnt_actfrclimited[joint]:
                ends = sorted(float(v) / ratio for v in m.jnt_actfrcrange[joint])
                low, high = (min(max(end, ends[0]), ends[1]) for end in (low, high))
                self.driven.add(joint)
        return (low, high) if np.isfinite((low, high)).any() else None

    # --- loops and ropes ------------------------------------------------------------------------------------------

    def equality(self, number: int) -> None:
        m = self.model
        kind, name = int(m.eq_type[number]), m.equality(number).name or f"equality {number}"
        if not m.eq_active0[number]:
            self.mechanism.notes.append(f"the equality {name} is switched off, and left out")
            return
        if kind in (EQUAL_JOINTS, EQUAL_TENDONS):
            self.coupling(number, name)
            return
        if kind not in (CONNECT, WELD):
            self.mechanism.notes.append(f"the equality {name} is of deformable bodies: left out")
            return
        ends = [int(m.eq_obj1id[number]), int(m.eq_obj2id[number])]
        data = m.eq_data[number]
        is_site = int(m.eq_objtype[number]) == SITE
        bodies = [int(m.site_bodyid[end]) for end in ends] if is_site else ends
        if is_site:
            places = [self.state.site_xpos[end].copy() for end in ends]
            turns = [self.state.site_xmat[end].reshape(3, 3) for end in ends]
        else:
            frames = [self.frame(body) for body in bodies]
            # connect: a place in each body. weld: one in the second, and the pose of the second relative to the first.
            local = [data[0:3], data[3:6]] if kind == CONNECT else [data[0:3], data[0:3]]
            places = [frame.place + frame.turn @ place for frame, place in zip(frames, local, strict=True)]
            turns = [frame.turn for frame in frames]
            if kind == WELD:
                w, x, y, z = data[6:10]
                relative = Frame(data[3:6].copy(), from_quaternion(x, y, z, w))
                meant = frames[0] @ relative
                places[0] = meant.place + meant.turn @ data[0:3]
                turns = [meant.turn, frames[1].turn]
        a, b = (self.name_of(body) for body in bodies)
        at = places[1] if a is None or b is not None else places[0]
        if a is None and b is None:
            self.mechanism.notes.append(f"the equality {name} is between fixed bodies: left out")
            return
        gap = float(np.linalg.norm(places[0] - places[1]))
        turn = float(np.linalg.norm(turns[0] - turns[1])) if kind == WELD else 0.0
        if gap > 1e-6 or turn > 1e-6:
            self.mechanism.notes.append(
                f"the equality {name} is violated initially: it keeps the initial poses of its bodies"
            )
        first, second = (a, b) if a is not None else (b, a)
        assert first is not None
        self.mechanism.joints.append(LinkJoint("ball" if kind == CONNECT else "weld", name, first, second, at))

    def coupling(self, number: int, name: str) -> None:
        """An equality of two joints or of two fixed tendons, or of one and a constant: y - y0 = a + b (x - x0) + ..."""
        m = self.model
        a, b, *higher = (float(v) for v in m.eq_data[number][:5])
        first, second = int(m.eq_obj1id[number]), int(m.eq_obj2id[number])
        if any(higher) and second >= 0:
            self.mechanism.notes.append(f"the equality {name} is not linear: left out")
            return
        of = self.sum_of_tendon if int(m.eq_type[number]) == EQUAL_TENDONS else lambda joint: {joint: 1.0}
        total, other = of(first), of(second) if second >= 0 else {}
        if total is None or other is None:
            self.mechanism.notes.append(f"the equality {name} is of tendons that are not sums of joints: left out")
            return
        for joint, ratio in other.items():
            total[joint] = total.get(joint, 0.0) - b * ratio
        if a != 0:
            self.mechanism.notes.append(
                f"the equality {name} is violated initially: it keeps the initial poses of its bodies"
            )
        terms = self.terms(total)
        length = 0.0 if len(terms) == 1 else None  # one joint, which is locked where it is
        if terms:
            self.mechanism.couplings.append(JointCoupling(name, terms, length))

    def sum_of_tendon(self, number: int) -> dict[int, float] | None:
        """The ratios by joint of a fixed tendon; None for a tendon in space."""
        m = self.model
        wraps = range(m.tendon_adr[number], m.tendon_adr[number] + m.tendon_num[number])
        if any(int(m.wrap_type[wrap]) != WRAPPED_JOINT for wrap in wraps):
            return None
        total: dict[int, float] = {}
        for wrap in wraps:
            joint = int(m.wrap_objid[wrap])
            total[joint] = total.get(joint, 0.0) + float(m.wrap_prm[wrap])
        return total

    def terms(self, total: dict[int, float], side: float = 1.0) -> list[tuple[str, float]]:
        return [(self.joint_name(joint), side * ratio) for joint, ratio in total.items() if ratio != 0]

    def joint_name(self, joint: int) -> str:
        return str(self.model.joint(joint).name or f"joint {joint}")

    def tendon(self, number: int) -> None:
        """A tendon over sites, without pulleys, with a largest length, becomes a rope, one between two sites with stiffness or damping a
        spring; the limits of a sum of joints become a coupling for each."""
        m = self.model
        called = str(m.tendon(number).name or number)
        name = f"the tendon {called}"
        wraps = range(m.tendon_adr[number], m.tendon_adr[number] + m.tendon_num[number])
        total = self.sum_of_tendon(number)
        if total is not None:
            if m.tendon_limited[number] and any(total.values()):
                # Coordinates are 0 in the initial pose, where the tendon has a length of its own.
                low, high = (float(v) - float(m.tendon_length0[number]) for v in m.tendon_range[number])
                if not low <= 0 <= high:
                    self.mechanism.notes.append(f"the limits of {name} exclude the initial pose: left out")
                    return
                for side, end, limit in ((1, "longest", high), (-1, "shortest", -low)):
                    coupling = JointCoupling(f"{called} {end}", self.terms(total, side), limit, one_sided=True)
                    self.mechanism.couplings.append(coupling)
            return
        is_plain = all(int(m.wrap_type[wrap]) == WRAPPED_SITE for wrap in wraps)
        stiffness, damping = (np.ravel(of[number]) for of in (m.tendon_stiffness, m.tendon_damping))
        has_spring = stiffness[0] > 0 or damping[0] > 0
        has_spring = has_spring and is_plain and len(wraps) == 2 and not any((*stiffness[1:], *damping[1:]))
        if not (has_spring or (is_plain and m.tendon_limited[number])):
            what = "has no largest length" if is_plain else "runs over pulleys or round geoms"
            self.mechanism.notes.append(f"{name} {what}: left out")
            return
        ends = []
        for wrap in wraps:
            site = int(m.wrap_objid[wrap])
            body = int(m.site_bodyid[site])
            ends.append((self.names[body], self.state.site_xpos[site].copy()))
        if has_spring:
            shortest, longest = (float(v) for v in m.tendon_lengthspring[number])
            rates = float(stiffness[0]), float(damping[0])
            self.springs.add(number)
            self.mechanism.springs.append(LinkSpring(f"{name} spring", (ends[0], ends[1]), *rates, (shortest, longest)))
        if m.tendon_limited[number]:
            if m.tendon_range[number][0] > 0:
                self.mechanism.notes.append(f"the least length of {name} is left out")
            self.mechanism.ropes.append((name, ends, float(m.tendon_range[number][1])))
