# SPDX-License-Identifier: Apache-2.0
"""Joints as lines: their axes, stops and present values."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import pairwise

from iota._core import Body, Constraint, JointCoordinate, System, Vec3
from iota.frames import into_frame
from iota.world.drawings import Drawings
from iota.world.events import Events
from iota.world.many import Segments

AXIS, STOPS, POINTER = "#3f7fd0", "#d0402b", "#f2a324"
CHORD = math.radians(10)  # the longest of an arc
FULL_TURN = 2 * math.pi
REACHES = 1.6  # in an axis
NOT_DRAWN = ("rod", "rope", "coupling")  # drawn as ties, or without a place of its own

Line = tuple[Vec3, Vec3]


class JointMarks:
    """For each joint its axis (blue), its stops as an arc or a track (red) and its present value as a pointer (amber). Marks
    are fixed to the bodies; they are made again when joints or stops have changed."""

    def __init__(
        self,
        system: System,
        drawings: Drawings,
        events: Events,
        joints: Iterable[Constraint] | None,
        length: float | None,
    ) -> None:
        """length: of an axis, m; None: by the size of the joint's first body."""
        self._system, self._drawings, self._events = system, drawings, events
        self._joints = None if joints is None else list(joints)
        self._length = length
        self._marks: list[Segments] = []
        self._drawn: object = None
        self._follow = events.on_frame(self._write)

    def destroy(self) -> None:
        """Removes them from the page."""
        self._events.forget(self._follow)
        self._clear()

    def _clear(self) -> None:
        for mark in self._marks:
            mark.destroy()
        self._marks.clear()

    def _write(self) -> None:
        joints = self._system.constraints if self._joints is None else self._joints
        shown = [j for j in joints if j.alive and j.active and j.kind not in NOT_DRAWN]
        state = (self._system.structure_version, [(j, _limits(j, "angle"), _limits(j, "slide")) for j in shown])
        if state == self._drawn:
            return
        self._drawn = state
        self._clear()
        for joint in shown:
            self._draw(joint)

    def _draw(self, joint: Constraint) -> None:
        place, axis = joint.position, joint.axis
        length = _reach(joint) * REACHES if self._length is None else self._length
        if not abs(axis):
            arms = [Vec3(length / 4, 0, 0), Vec3(0, length / 4, 0), Vec3(0, 0, length / 4)]
            self._add(joint.a, [(place - arm, place + arm) for arm in arms], AXIS, length)
            return
        self._add(joint.a, [(place - axis * (length / 2), place + axis * (length / 2))], AXIS, length)
        across = _across(axis, joint.a.center_of_mass - place) * (length / 2)
        if limits := _limits(joint, "angle"):
            low, high = (limit - joint.angle.value for limit in limits)
            self._add(joint.a, [(place, place + across)], POINTER, length)
            self._add(joint.b, _sector(place, axis, across, low, high), STOPS, length)
        if limits := _limits(joint, "slide"):
            low, high = (limit - joint.slide.value for limit in limits)
            self._add(joint.a, [(place - across / 2, place + across / 2)], POINTER, length)
            ends = [place + axis * low, place + axis * high]
            ticks = [(end - across / 2, end + across / 2) for end in ends]
            self._add(joint.b, [(ends[0], ends[1]), *ticks], STOPS, length)

    def _add(self, body: Body | None, lines: list[Line], color: str, length: float) -> None:
        """Fixes lines, given in the world, to a body; None: to the world. length: of an axis, m."""
        if body is not None:
            center, turn = body.center_of_mass, body.orientation
            lines = [(into_frame(start, center, turn), into_frame(end, center, turn)) for start, end in lines]
        starts, ends = [tuple(start) for start, _ in lines], [tuple(end) for _, end in lines]
        mark = self._drawings.segments(starts, ends, radius=length / 80, color=color, at=body)
        self._marks.append(mark)


def _reach(joint: Constraint) -> float:
    """The distance of the farthest particle of the first body from the joint, m."""
    return max((abs(p.position - joint.position) for p in joint.a.particles), default=0.0) or 1.0


def _limits(joint: Constraint, name: str) -> tuple[float, float] | None:
    """The limits of a coordinate, rad or m. None: it has none, or the kind of joint has no such coordinate."""
    coordinate: JointCoordinate | None = getattr(joint, name, None)
    return None if coordinate is None else coordinate.limits


def _across(axis: Vec3, arm: Vec3) -> Vec3:
    """The unit vector at right angles to a unit vector that is nearest to an arm; any if the arm lies along it."""
    across = arm - axis * arm.dot(axis)
    if abs(across) <= 1e-6 * abs(arm):
        across = axis.cross(Vec3(1, 0, 0) if abs(axis.x) < 0.6 else Vec3(0, 1, 0))
    return across / abs(across)


def _sector(place: Vec3, axis: Vec3, arm: Vec3, low: float, high: float) -> list[Line]:
    """An arc from an arm turned by `low` to the arm turned by `high`, rad, with both radii. A range beyond a full turn is a circle."""
    high = min(high, low + FULL_TURN)
    count = max(1, math.ceil((high - low) / CHORD))
    side = axis.cross(arm)
    angles = [low + (high - low) * i / count for i in range(count + 1)]
    rim = [place + arm * math.cos(angle) + side * math.sin(angle) for angle in angles]
    return [*pairwise(rim), (place, rim[0]), (place, rim[-1])]
