# SPDX-License-Identifier: Apache-2.0
"""Notes about all of a URDF file that is not taken over: a table says what is taken of each element, and all else is noted."""

from __future__ import annotations

from collections import Counter

from iota.shapelib.trees import Element

MOST_NAMED = 5
# Attributes and children that are taken, of each element.
TAKEN: dict[str, tuple[str, str]] = {
    "robot": ("name version", "link joint material"),
    "link": ("name", "inertial visual collision"),
    "inertial": ("", "origin mass inertia"),
    "origin": ("xyz rpy", ""),
    "mass": ("value", ""),
    "inertia": ("ixx ixy ixz iyy iyz izz", ""),
    "visual": ("name", "origin geometry material"),
    "collision": ("name", "origin geometry"),
    "geometry": ("", "box cylinder capsule sphere mesh"),
    "box": ("size", ""),
    "cylinder": ("radius length", ""),
    "capsule": ("radius length", ""),
    "sphere": ("radius", ""),
    "mesh": ("filename scale", ""),
    "material": ("name", "color"),
    "color": ("rgba", ""),
    "joint": ("name type", "origin parent child axis limit dynamics mimic"),
    "parent": ("link", ""),
    "child": ("link", ""),
    "axis": ("xyz", ""),
    "limit": ("lower upper", ""),
    "dynamics": ("damping friction", ""),
    "mimic": ("joint multiplier offset", ""),
}
# Joints of which some children have no place in iota. They mean nothing in those of other types that do not read them.
PARTLY = {"planar": ("limit", "dynamics"), "floating": ("limit", "dynamics")}
USUAL = {("limit", "effort"): "0", ("limit", "velocity"): "0"}


def left_out(robot: Element, taken: set[int]) -> list[str]:
    """One note for each kind of attribute or element that is not taken, with lines. Joints of other namespaces are named, as their links
    hang on nothing. taken: ids of elements that are taken beside the table, and of limits whose effort and speed are."""
    notes = []
    joints = [element for element in robot.children if element.tag.endswith("joint") and element.tag != "joint"]
    if joints:
        named = ", ".join(f"{each.text('name', '')} (<{each.tag}>, line {each.line})" for each in joints[:9])
        more = f" and {len(joints) - 9} more" if len(joints) > 9 else ""
        count = "1 joint is" if len(joints) == 1 else f"{len(joints)} joints are"
        notes.append(f"{count} not of URDF and left out, so that links hang on nothing: {named}{more}")
    known = TAKEN["robot"][1].split()
    others = Counter(
        each.tag for each in robot.children if each.tag not in known and each not in joints and id(each) not in taken
    )
    notes += [f"{number} <{tag}> {'is' if number == 1 else 'are'} left out" for tag, number in others.items()]
    found: dict[str, list[int]] = {}
    for attribute in robot.attributes:
        if attribute not in TAKEN["robot"][0].split() and not attribute.startswith("xmlns"):
            found.setdefault(f"{attribute} of <robot>", []).append(robot.line)
    for child in robot.children:
        if child.tag in known:
            _look(child, found, taken)
        elif child.tag == "gazebo" and id(child) in taken:
            for each in child.children:
                if id(each) not in taken:
                    found.setdefault(f"<{each.tag}> in <gazebo>", []).append(each.line)
    for what, lines in found.items():
        where = ", ".join(map(str, lines[:MOST_NAMED])) + (" ..." if len(lines) > MOST_NAMED else "")
        notes.append(f"{what} is left out ({'line' if len(lines) == 1 else 'lines'} {where})")
    return notes


def _look(element: Element, found: dict[str, list[int]], taken: set[int]) -> None:
    attributes, children = (words.split() for words in TAKEN[element.tag])
    for name, value in element.attributes.items():
        usual = USUAL.get((element.tag, name))
        is_usual = usual is not None and value.strip().rstrip("0").rstrip(".") in ("", usual)
        is_usual = is_usual or (element.tag == "limit" and name in ("effort", "velocity") and id(element) in taken)
        if name not in attributes and not is_usual:
            found.setdefault(f"{name} of <{element.tag}>", []).append(element.line)
    partly = PARTLY.get(element.attributes.get("type", ""), ()) if element.tag == "joint" else ()
    seen: set[str] = set()
    for child in element.children:
        # Only the first is read of elements that may stand there once.
        is_second = child.tag in seen and (element.tag, child.tag) not in (("link", "visual"), ("link", "collision"))
        seen.add(child.tag)
        if child.tag in partly:
            found.setdefault(f"<{child.tag}> of {element.attributes['type']} joints", []).append(child.line)
        elif id(child) in taken and child.tag == "contact":
            for each in child.children:
                if id(each) not in taken:
                    found.setdefault(f"<{each.tag}> in <contact>", []).append(each.line)
        elif child.tag not in children:
            found.setdefault(f"<{child.tag}> in <{element.tag}>", []).append(child.line)
        elif is_second:
            found.setdefault(f"a further <{child.tag}> in <{element.tag}>", []).append(child.line)
        else:
            _look(child, found, taken)
