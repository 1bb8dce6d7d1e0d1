# SPDX-License-Identifier: Apache-2.0
"""A mouse or finger on the screen leads what can only move one way: its hand goes to the place on that way which is nearest to the ray."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from iota._core import Body, Constraint, System, Vec3
from iota.frames import into_frame
from iota.world.clients import Clients
from iota.world.event import Event
from iota.world.events import Events

SCREEN = ("mouse", "touch")  # names of pointers without depth
SAMPLES = 48  # of a way, before it is refined
NEAR = 0.08  # of the distance: how far a hand may be from its pointer's ray, since a near miss holds too


@dataclass
class Ray:
    """origin: m. direction: a unit vector. is_down: its button is pressed."""

    origin: Vec3
    direction: Vec3
    is_down: bool

    def distance(self, place: Vec3) -> float:
        """The distance of a place, m."""
        arm = place - self.origin
        along = max(arm.dot(self.direction), 0.0)
        return abs(arm - self.direction * along)


@dataclass
class Way:
    """The way of a held point of a jointed body. start: the point, m, at the value `began` of the coordinate. hand: where the
    pointer alone would put the point, m."""

    joint: Constraint
    start: Vec3
    began: float
    hand: Vec3

    @property
    def coordinate(self) -> float:
        return self.joint.angle.value if self.joint.kind == "revolute" else self.joint.slide.value

    def place(self, value: float) -> Vec3:
        """The point at a value of the coordinate."""
        axis = self.joint.axis
        if self.joint.kind == "prismatic":
            return self.start + axis * (value - self.began)
        center, turn = self.joint.position, value - self.began
        arm = self.start - center
        along = axis * arm.dot(axis)
        across = arm - along
        return center + along + across * math.cos(turn) + axis.cross(across) * math.sin(turn)

    def nearest(self, ray: Ray) -> Vec3:
        """The place nearest to a ray; of two that are as near, the one nearer to the present one."""
        coordinate = self.joint.angle if self.joint.kind == "revolute" else self.joint.slide
        now, size = coordinate.value, abs(self.start - self.joint.position) or 1.0
        reach = math.pi if self.joint.kind == "revolute" else 10 * size
        low, high = coordinate.limits or (now - reach, now + reach)
        if not (math.isfinite(low) and math.isfinite(high)):
            low, high = now - reach, now + reach

        def cost(value: float) -> float:
            return ray.distance(self.place(value)) + 1e-3 * size * abs(value - now) / (high - low)

        step = (high - low) / SAMPLES
        best = min((low + step * k for k in range(SAMPLES + 1)), key=cost)
        while step > 1e-5 * (high - low):  # halves the interval around the best
            step /= 2
            best = min((best, max(best - step, low), min(best + step, high)), key=cost)
        return self.place(best)


class Guiding:
    """guide_of: the joint whose way a hand on a body follows, with the range that a hand may lead it through; None without one."""

    def __init__(
        self, system: System, events: Events, clients: Clients, guide_of: Callable[[Body], Constraint | None]
    ) -> None:
        self._system, self._events, self._clients, self._guide_of = system, events, clients, guide_of
        self._rays: dict[tuple[int, str], Ray] = {}
        self._ways: dict[tuple[int, int], Way] = {}
        events.on_pointer(self._pointed)
        events.on_leave(self._left)

    def listen(self, bodies: Iterable[Body]) -> None:
        """Leads hands on these bodies."""
        self._events.on_drag(list(bodies))(self._dragged)

    def _pointed(self, event: Event) -> None:
        if event.pointer.startswith(SCREEN) and event.origin is not None and event.direction is not None:
            is_down = event.hand is not None and event.hand.trigger > 0
            self._rays[event.client, event.pointer] = Ray(event.origin, event.direction.unit(), is_down)
            # The move of a hold may arrive before that of its pointer.
            for key in self._ways:
                if key[0] == event.client:
                    self._lead(key)

    def _left(self, event: Event) -> None:
        self._rays = {key: ray for key, ray in self._rays.items() if key[0] != event.client}
        self._ways = {key: way for key, way in self._ways.items() if key[0] != event.client}

    def _dragged(self, event: Event) -> None:
        key = (event.client, event.hold)
        if event.phase == "end" or event.target is None or event.point is None:
            self._ways.pop(key, None)
            return
        if event.phase == "start":
            joint = self._guide_of(event.target)
            if joint is not None and joint.alive:
                if joint.a != event.target:
                    self._take(key, joint.a, event.point)
                way = Way(joint, event.point, 0.0, event.point)
                way.began = way.coordinate
                self._ways[key] = way
            return
        if (led := self._ways.get(key)) is not None:
            led.hand = event.point
            self._lead(key)

    def _lead(self, key: tuple[int, int]) -> None:
        """Moves a hold to the place on its way that is nearest to the ray of its pointer."""
        client, number = key
        way, found = self._ways[key], self._clients.by_id.get(client)
        hold = None if found is None else found.holds.get(number)
        ray = self._ray(client, way.hand)
        if way.joint.alive and hold is not None and ray is not None:
            hold.move(way.nearest(ray))

    def _take(self, key: tuple[int, int], body: Body, hand: Vec3) -> None:
        """Moves a hold to the body that goes the way: a handle turns in the hand that pulls its door."""
        client, number = key
        hold = self._clients.by_id[client].holds[number]
        hold.let_go()
        hold.last = body
        self._clients.grip(hold, body, into_frame(hand, body.center_of_mass, list(body.orientation)), hand)

    def _ray(self, client: int, hand: Vec3) -> Ray | None:
        """The ray of the pointer that leads a hand; None for a hand in space, which has a depth of its own."""
        rays = [ray for (of, _), ray in self._rays.items() if of == client and ray.is_down]
        near = [ray for ray in rays if ray.distance(hand) < NEAR * abs(hand - ray.origin)]
        return min(near, key=lambda ray: ray.distance(hand), default=None)
