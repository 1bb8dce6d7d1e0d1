# SPDX-License-Identifier: Apache-2.0
"""Hands as small bodies, so that they push what they touch: fingertips of people in headsets, paddles at the mouse."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from iota import looks
from iota._core import Body, Grip, Group, Material, Sphere, System, Vec3
from iota.world.drawings import Drawings
from iota.world.event import Event
from iota.world.events import Events
from iota.world.scene import Scene

RADIUS, MASS = 0.009, 0.25  # m, kg
FREQUENCY, ACCELERATION = 12.0, 200.0  # of the spring to the hand, Hz, and 50 N at most, m/s^2
INDEX_TIP = 9  # joint of a bare hand, in the order of WebXR
FORGOTTEN = 2.0  # s, of real time, after which a hand that tells nothing is gone
CLOSED = 0.3  # of a trigger or pinch, with which a hand holds things instead
STEEP = 0.1  # cosine of the largest angle between the mouse's ray and its first one
MOUSE = "mouse"
HANDS = ("left", "right", "left hand", "right hand")  # controllers, and bare hands
TOUCHING = Material(friction=0.8)
PASSING = Material(touches="nothing")


@dataclass
class Finger:
    """A fingertip or a paddle. told: when its hand moved last, s; a mouse that rests tells nothing."""

    body: Body
    grip: Grip
    told: float = math.inf


@dataclass
class Paddle:
    """A paddle that a client has taken. anchor, normal: of the plane in which it moves, m, once the mouse has moved. start: where it is made."""

    radius: float
    color: str
    anchor: Vec3 | None = None
    normal: Vec3 | None = None
    start: Vec3 | None = None

    def place(self, event: Event) -> Vec3 | None:
        """On the ray of the mouse, as deep as what it pointed at first; made before that, so that it comes to touch it."""
        if event.point is None or event.origin is None or event.direction is None:
            return None
        if self.anchor is None or self.normal is None:
            self.anchor, self.normal = event.point + event.direction * self.radius, event.direction
            self.start = event.point - event.direction * (1.5 * self.radius)
        steep = max(event.direction.dot(self.normal), STEEP)
        return event.origin + event.direction * ((self.anchor - event.origin).dot(self.normal) / steep)


class Fingers:
    """A ball at the tip of each index finger and controller, and at the mouse of those who have taken a paddle, which a spring draws to
    the hand: it pushes with at most 50 N, and no longer once the hand closes. Pages do not pick it, and draw only paddles."""

    def __init__(self, system: System, scene: Scene, drawings: Drawings, events: Events) -> None:
        self._system, self._scene, self._drawings, self._events = system, scene, drawings, events
        self._fingers: dict[tuple[int, str], Finger] = {}
        self._paddles: dict[int, Paddle] = {}  # by client
        self._group: Group | None = None
        self._version = -1

    def begin(self) -> None:
        """Hands push from now on. Raises TypeError in a World of another Simulator."""
        system: object = self._system
        if not isinstance(system, System):
            raise TypeError("hands push bodies of a System; this world has a simulator of its own")
        if self._group is None:
            self._group = self._system.group("fingertips")
            self._events.on_pointer(self._moved)
            self._events.on_leave(self._left)
            self._events.on_frame(self._tidy)

    def turn_paddle(self, client: int, radius: float, color: str) -> None:
        """Gives a client a paddle, or takes it away."""
        if self._paddles.pop(client, None) is None:
            self._paddles[client] = Paddle(radius, color)
        self._drop((client, MOUSE))

    def touching(self, bodies: Iterable[Body]) -> tuple[int, Literal["left", "right"]] | None:
        """The client and the hand, "left" or "right", of a fingertip that touched one of these bodies in the last step."""
        owners = {finger.body: key for key, finger in self._fingers.items()}
        for body in bodies if owners else ():
            for contact in body.contacts:
                if contact.other in owners:
                    client, pointer = owners[contact.other]
                    return client, "left" if pointer.startswith("left") else "right"
        return None

    def _moved(self, event: Event) -> None:
        tip = self._tip(event)
        if tip is None or event.hand is None:
            return
        finger = self._fingers.get((event.client, event.pointer))
        if finger is None or not (finger.body.alive and finger.grip.alive):
            self._drop((event.client, event.pointer))
            finger = self._fingers[event.client, event.pointer] = self._make(tip, self._paddle_of(event))
        if event.pointer in HANDS:
            finger.told = time.monotonic()
        finger.grip.move(tip)
        wanted = PASSING if max(event.hand.trigger, event.hand.grip) > CLOSED else TOUCHING
        if finger.body.material != wanted:
            finger.body.material = wanted

    def _paddle_of(self, event: Event) -> Paddle | None:
        return self._paddles.get(event.client) if event.pointer == MOUSE else None

    def _tip(self, event: Event) -> Vec3 | None:
        """The place at which the pointer of an event pushes; None if it does not."""
        paddle = self._paddle_of(event)
        if paddle is not None:
            return paddle.place(event)
        if event.pointer not in HANDS or event.hand is None:
            return None
        joints = event.hand.joints
        return Vec3(*joints[INDEX_TIP]) if len(joints) > INDEX_TIP else event.point

    def _make(self, tip: Vec3, paddle: Paddle | None) -> Finger:
        assert self._group is not None
        radius = RADIUS if paddle is None else paddle.radius
        start = tip if paddle is None or paddle.start is None else paddle.start
        body = self._system.body(shape=Sphere(radius), mass=MASS, position=start, material=TOUCHING)
        body.name = "fingertip" if paddle is None else "paddle"
        self._group.add(body)
        self._scene.draw(body, [])
        grip = self._system.grip(body, (0, 0, 0), tip, frequency=FREQUENCY, max_acceleration=ACCELERATION)
        if paddle is not None:
            self._drawings.shape(looks.sphere(radius, "rubber", color=paddle.color), on=body)
        return Finger(body, grip)

    def _left(self, event: Event) -> None:
        self._paddles.pop(event.client, None)
        for key in [key for key in self._fingers if key[0] == event.client]:
            self._drop(key)

    def _tidy(self) -> None:
        """Hands that are gone, and fingertips that an undo has brought back."""
        now = time.monotonic()
        for key in [key for key, finger in self._fingers.items() if now - finger.told > FORGOTTEN]:
            self._drop(key)
        if self._system.structure_version != self._version:
            mine = {finger.body for finger in self._fingers.values()}
            if self._group is not None and self._group.alive:
                for body in {particle.body for particle in self._group.particles} - mine:
                    body.destroy()
            self._version = self._system.structure_version

    def _drop(self, key: tuple[int, str]) -> None:
        finger = self._fingers.pop(key, None)
        if finger is not None and finger.body.alive:
            finger.body.destroy()
