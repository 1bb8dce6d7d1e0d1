# SPDX-License-Identifier: Apache-2.0
"""Fingertips of people in headsets as small bodies, so that they push what they touch."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from iota._core import Body, Grip, Material, Sphere, System, Vec3
from iota.world.event import Event
from iota.world.events import Events
from iota.world.scene import Scene

RADIUS, MASS = 0.009, 0.25  # m, kg
FREQUENCY, ACCELERATION = 12.0, 200.0  # of the spring to the hand, Hz, and 50 N at most, m/s^2
INDEX_TIP = 9  # joint of a bare hand, in the order of WebXR
FORGOTTEN = 2.0  # s, of real time, after which a hand that tells nothing is gone
CLOSED = 0.3  # of a trigger or pinch, with which a hand holds things instead
HANDS = ("left", "right", "left hand", "right hand")  # controllers, and bare hands
TOUCHING = Material(friction=0.8)
PASSING = Material(touches="nothing")


@dataclass
class Finger:
    """A fingertip. told: when its hand moved last, s."""

    body: Body
    grip: Grip
    told: float


class Fingers:
    """A ball at the tip of each index finger and controller, which a spring draws to the hand: it pushes with at most 50 N, and no
    longer once the hand closes. Pages neither draw nor pick it."""

    def __init__(self, system: System, scene: Scene, events: Events) -> None:
        self._system, self._scene, self._events = system, scene, events
        self._fingers: dict[tuple[int, str], Finger] = {}
        self._group = system.group("fingertips")
        self._version = -1
        events.on_pointer(self._moved)
        events.on_leave(self._left)
        events.on_frame(self._tidy)

    def touching(self, bodies: Iterable[Body]) -> tuple[int, Literal["left", "right"]] | None:
        """The client and the hand, "left" or "right", of a fingertip that touched one of these bodies in the last step."""
        owners = {finger.body: key for key, finger in self._fingers.items()}
        for body in bodies if owners else ():
            for contact in body.contacts:
                if contact.other in owners:
                    client, pointer = owners[contact.other]
                    return client, "left" if pointer.startswith("left") else "right"
        return None

    def destroy(self) -> None:
        """Hands push nothing any more."""
        for function in (self._moved, self._left, self._tidy):
            self._events.forget(function)
        for key in list(self._fingers):
            self._drop(key)

    def _moved(self, event: Event) -> None:
        if event.pointer not in HANDS or event.point is None or event.hand is None:
            return
        joints = event.hand.joints
        tip = Vec3(*joints[INDEX_TIP]) if len(joints) > INDEX_TIP else event.point
        finger = self._fingers.get((event.client, event.pointer))
        if finger is None or not (finger.body.alive and finger.grip.alive):
            finger = self._fingers[event.client, event.pointer] = self._make(tip)
        finger.told = time.monotonic()
        finger.grip.move(tip)
        wanted = PASSING if max(event.hand.trigger, event.hand.grip) > CLOSED else TOUCHING
        if finger.body.material != wanted:
            finger.body.material = wanted

    def _make(self, tip: Vec3) -> Finger:
        body = self._system.body(shape=Sphere(RADIUS), mass=MASS, position=tip, material=TOUCHING)
        body.name = "fingertip"
        self._group.add(body)
        self._scene.draw(body, [])
        grip = self._system.grip(body, (0, 0, 0), tip, frequency=FREQUENCY, max_acceleration=ACCELERATION)
        return Finger(body, grip, 0.0)

    def _left(self, event: Event) -> None:
        for key in [key for key in self._fingers if key[0] == event.client]:
            self._drop(key)

    def _tidy(self) -> None:
        """Hands that are gone, and fingertips that an undo has brought back."""
        now = time.monotonic()
        for key in [key for key, finger in self._fingers.items() if now - finger.told > FORGOTTEN]:
            self._drop(key)
        if self._system.structure_version != self._version:
            mine = {finger.body for finger in self._fingers.values()}
            for body in {particle.body for particle in self._group.particles} - mine if self._group.alive else ():
                body.destroy()
            self._version = self._system.structure_version

    def _drop(self, key: tuple[int, str]) -> None:
        finger = self._fingers.pop(key, None)
        if finger is not None and finger.body.alive:
            finger.body.destroy()
