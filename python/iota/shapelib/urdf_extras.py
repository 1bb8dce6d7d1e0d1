# SPDX-License-Identifier: Apache-2.0
"""Conventions beside URDF itself: friction, as Gazebo and Bullet read it, and transmissions of ROS."""

from __future__ import annotations

from typing import Any

from iota.shapelib.files import number
from iota.shapelib.mechanism_data import JointActuator
from iota.shapelib.trees import Element

INTERFACES = {"effort": "force", "position": "target", "velocity": "speed"}


def frictions(robot: Element, links: dict[str, Element], taken: set[int]) -> dict[str, float]:
    """By link: `lateral_friction` of its `contact` (Bullet), else `mu1` of `gazebo` that refers to it, which counts for both directions.
    Raises FileError for one that is negative. taken: gets the ids of the elements."""
    found: dict[str, float] = {}
    for element in robot.all("gazebo"):
        mu = element.first("mu1")
        link = element.text("reference", "")
        if mu is not None and link in links:
            found[link] = _friction(mu, mu.attributes.get("value", mu.content), link)
            taken |= {id(element), id(mu)}
    for link, element in links.items():
        contact = element.first("contact")
        lateral = contact.first("lateral_friction") if contact is not None else None
        if lateral is not None:
            found[link] = _friction(lateral, lateral.text("value"), link)
            taken |= {id(contact), id(lateral)}
    return found


def _friction(element: Element, text: str, link: str) -> float:
    value = number(text.strip(), element.path, element.line, element.tag)
    if value < 0:
        raise element.wrong(f"the friction of the link {link} must not be negative, not {value:g}")
    return value


def actuators(
    robot: Element, joints: dict[str, Element], initial: dict[str, float], taken: set[int], notes: list[str]
) -> list[JointActuator]:
    """Reads transmissions with one joint: its effort, position or speed is set, as hardware interfaces of ROS do. joints: those with one
    coordinate that mimic no other. initial: their coordinates in the structure."""
    made: list[JointActuator] = []
    driven: set[str] = set()
    for element in robot.all("transmission"):
        name = element.text("name", f"transmission, line {element.line}")
        taken.add(id(element))
        reason, joint = _target(element, joints)
        if joint is not None and joint in driven:
            reason = f"drives {joint}, which another one drives"
        law: dict[str, Any] = {}
        if not reason and joint is not None:
            reason, law = _law(element, joints[joint], initial.get(joint, 0.0))
        if reason or joint is None:
            notes.append(f"1 <transmission> is left out: {name} {reason} (line {element.line})")
            continue
        driven.add(joint)
        limit = joints[joint].first("limit")
        taken |= set() if limit is None else {id(limit)}
        actuator = element.first("actuator")
        made.append(JointActuator(actuator.text("name", name) if actuator else name, [(joint, 1.0)], law))
    return made


def _target(element: Element, joints: dict[str, Element]) -> tuple[str, str | None]:
    """A reason to leave it out, and the joint."""
    named = list(element.all("joint"))
    if len(named) != 1:
        return f"has {len(named)} joints", None
    joint = named[0].text("name")
    if joint not in joints:
        return f"drives {joint}, which is no joint with a coordinate of its own", None
    return "", joint


def _law(element: Element, joint: Element, initial: float) -> tuple[str, dict[str, Any]]:
    """A reason to leave it out, and the fields of an `iota.builder.Actuator`."""
    spoken = [each for each in element.walk() if each.tag == "hardwareInterface"]
    said = spoken[0].content.strip().rpartition("/")[2].lower() if spoken else "effort"
    kind = next((law for word, law in INTERFACES.items() if said.startswith(word)), None)
    if kind is None:
        return f"has the interface {said!r}, none of effort, position and velocity", {}
    limit = joint.first("limit")
    effort = limit.number("effort", 0.0) if limit is not None else 0.0
    speed = limit.number("velocity", 0.0) if limit is not None else 0.0
    if effort < 0 or speed < 0:
        assert limit is not None
        raise limit.wrong(f"the largest effort and speed of {joint.text('name')} must not be negative")
    if kind == "force":
        return "", {"force_range": (-effort, effort), "control_range": (-effort, effort)} if effort > 0 else {}
    if effort == 0:
        return "moves its joint with a largest effort that no limit says", {}
    law: dict[str, Any] = {"law": kind, "force_range": (-effort, effort)}
    if kind == "speed":
        return "", law | ({"control_range": (-speed, speed)} if speed > 0 else {})
    law |= {"constant": -initial, "control": initial}
    if limit is not None and joint.text("type") != "continuous" and {"lower", "upper"} <= limit.attributes.keys():
        ends = limit.number("lower"), limit.number("upper")
        law |= {"control_range": ends} if ends[0] <= initial <= ends[1] else {}
    return "", law | ({"top_speed": speed} if speed > 0 else {})
