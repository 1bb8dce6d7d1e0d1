# SPDX-License-Identifier: Apache-2.0
"""The clients, their selections and their holds."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, Protocol

from iota._core import Body, Grip, System, Vec3
from iota.saving import replacing
from iota.simulator import SimulatedGrip
from iota.world.clock import Clock
from iota.world.listeners import Listener
from iota.world.scene import Camera, camera_or_none

TakePicture = Callable[[int, float], bytes]  # client, time limit in s
SendPulse = Callable[[int, str, float, float], None]  # client, hand, strength, s
SendCamera = Callable[[int, Camera | None], None]
LONGEST_PULSE = 5.0  # s
FREQUENCY, ACCELERATION = 2.5, 60.0  # of the spring of a hand on a large body, Hz, m/s^2
SAG = 0.1  # of the size of what is held: how far the spring gives way under its weight


class Fleeting(Protocol):
    """Something in the simulator that is there only while a hand holds a body."""

    @property
    def alive(self) -> bool: ...

    def destroy(self) -> None: ...


@dataclass
class Hold:
    """One grab of a client while it lasts. number: the page's own. taken: the body at its start. last: the body that the
    hand holds now or held last, which an edit may have made another one. listeners: its functions of drags. grip: None
    if one of these replaces it. pointer: the name of the hand."""

    client: int
    number: int
    taken: Body
    last: Body
    listeners: list[Listener] = field(default_factory=list, repr=False, compare=False)
    grip: Grip | SimulatedGrip | None = None
    pointer: str = ""

    @property
    def body(self) -> Body | None:
        """The body at the grip; None without one, or if it has ended."""
        if self.grip is None or not self.grip.alive:
            return None
        return self.grip.body if isinstance(self.grip, Grip) else alive(self.taken)

    def move(self, target: Vec3) -> None:
        if self.grip is not None and self.grip.alive:
            self.grip.move(target)

    def let_go(self) -> None:
        if self.grip is not None and self.grip.alive:
            self.grip.destroy()


@dataclass
class Client:
    """One open page. role: host, guest or viewer, see `Pages.link`. selected: its selection. is_profiling: it shows what the parts of a step cost. eye: the place of
    the user's eyes, world, m; None until the page has told it, which it does while there are several pages or a step has a
    budget. holds: by the page's own number of the grab."""

    id: int
    name: str = ""
    role: str = "host"
    selected: Body | None = None
    is_profiling: bool = False
    eye: Vec3 | None = None
    holds: dict[int, Hold] = field(default_factory=dict)
    take_picture: TakePicture | None = field(default=None, repr=False, compare=False)
    send_pulse: SendPulse | None = field(default=None, repr=False, compare=False)
    send_camera: SendCamera | None = field(default=None, repr=False, compare=False)
    _camera: Camera | None = field(default=None, init=False, repr=False, compare=False)

    @property
    def camera(self) -> Camera | None:
        """The view of this page alone, which moves there when another one is assigned; None: that of the world, see
        `World.camera`. A reset of the world does not change it."""
        return self._camera

    @camera.setter
    def camera(self, camera: Camera | None) -> None:
        self._camera = camera_or_none(camera)
        if self.send_camera is not None:
            self.send_camera(self.id, camera)

    def pulse(
        self, hand: Literal["left", "right", "both"] = "both", strength: float = 0.5, seconds: float = 0.05
    ) -> None:
        """A haptic pulse in the user's hands, for this client alone; a phone vibrates on "both". strength: from 0 to 1.
        seconds: at most 5.

            @world.on_stop(hammer)
            def struck(event):
                for client in world.users.clients:
                    if world.users.held(client.id) == hammer:
                        client.pulse("right", 0.8)
        """
        if hand not in ("left", "right", "both"):
            raise ValueError(f"hand must be left, right or both, not {hand!r}")
        if not (0 <= strength <= 1 and 0 <= seconds <= LONGEST_PULSE):
            raise ValueError(
                f"a pulse has a strength from 0 to 1 and lasts up to {LONGEST_PULSE:g} s, not {strength}, {seconds}"
            )
        if self.send_pulse is not None:
            self.send_pulse(self.id, "" if hand == "both" else hand, strength, seconds)

    def screenshot(self, file: str | Path | None = None, seconds: float = 20.0) -> bytes:
        """The page's current picture, as a PNG file; also written to `file`. The world waits for it, at most `seconds`.
        Raises TimeoutError if it does not arrive (the page is in the background), RuntimeError if the world is not
        served, OSError if the file cannot be written; an older one is then unchanged."""
        if self.take_picture is None:
            raise RuntimeError("this client is on no page")
        picture = self.take_picture(self.id, seconds)
        if file is not None:
            with replacing(Path(file)) as fresh:
                fresh.write_bytes(picture)
        return picture


def alive(body: Body | None) -> Body | None:
    """The body, or the one that absorbed it; None if it was destroyed."""
    return None if body is None else body.survivor


def hand_frequency(body: Body, dt: float) -> float:
    """The frequency of a hand's spring, Hz: under the weight of a small body it gives way by a small part of its size. dt: of a step, s,
    which resolves no shorter times."""
    center, part = body.center_of_mass, body.articulate
    # A grip pulls with at least half of the mass of what hangs on its body, see `Grips::build`.
    sag = abs(body.system.gravity) * (1 if len(part) == 1 else 2) / (2 * math.pi * FREQUENCY) ** 2
    size = 2 * body.radius
    for particle in (particle for each in part for particle in each.particles):
        size = max(size, 2 * abs(particle.position - center))
        if sag <= SAG * size:
            break
    if sag <= SAG * size or size == 0:
        return FREQUENCY
    stiffest = 1 / (2 * math.pi * dt)
    return max(FREQUENCY, min(FREQUENCY * math.sqrt(sag / (SAG * size)), stiffest))


class Clients:
    """The open pages, and their grips. Each holder has a grip of its own, so their forces are added."""

    def __init__(self, system: System, clock: Clock) -> None:
        self._system, self._clock = system, clock
        self.by_id: dict[int, Client] = {}
        self.take_picture: TakePicture | None = None
        self.send_pulse: SendPulse | None = None
        self.send_camera: SendCamera | None = None
        self.send_away: Callable[[int], None] | None = None
        self.taken_away: list[tuple[Hold, str]] = []  # with the reason; their functions wait to be told
        # All that hands have made since the last reset, for a state that is restored may have it again.
        self.fleeting: set[Fleeting] = set()

    def join(self, id: int, name: str, role: str = "host") -> None:
        self.by_id[id] = Client(
            id, name, role, take_picture=self.take_picture, send_pulse=self.send_pulse, send_camera=self.send_camera
        )

    def leave(self, client: Client) -> None:
        del self.by_id[client.id]
        self.let_go(client)

    def holds(self) -> list[Hold]:
        """The holds of all clients."""
        return [hold for client in self.by_id.values() for hold in client.holds.values()]

    def grip(self, hold: Hold, body: Body, local_point: Vec3, target: Vec3) -> None:
        """Grips a point of a body (body frame). Raises what the system raises if that is not possible."""
        whose = {"client": hold.client, "hold": hold.number}
        held: object = body
        if not isinstance(held, Body):  # of another simulator, whose hands are its own
            hold.grip = self._system.grip(body, local_point, target, **whose)
            return
        frequency = hand_frequency(body, self._clock.dt)
        # In proportion, so that a stiffer hand is as fast: it pulls against a damping of its own.
        limit = ACCELERATION * frequency / FREQUENCY
        hold.grip = self._system.grip(body, local_point, target, **whose, frequency=frequency, max_acceleration=limit)
        self.fleeting.add(hold.grip)

    def let_go(self, client: Client) -> None:
        for hold in client.holds.values():
            hold.let_go()
        client.holds.clear()

    def follow_grips(self) -> None:
        """After an edit a grip may be on another body, which exists beside the one that was taken. Holds without a grip
        stay with theirs."""
        for hold in self.holds():
            hold.last = hold.body or hold.last

    def take_away(self, reason: str, holds: Iterable[Hold] | None = None) -> None:
        """Ends these holds, or all, without their users."""
        for hold in self.holds() if holds is None else holds:
            del self.by_id[hold.client].holds[hold.number]
            self.taken_away.append((hold, reason))

    def end_restored(self) -> None:
        """After the system was restored: no hold goes on, and what hands did at that time ends, since nobody could let go of it."""
        self.take_away("reset")
        for made in self.fleeting:
            if made.alive:
                made.destroy()

    @property
    def is_profiled(self) -> bool:
        """Whether a client shows what the parts of a step cost."""
        return any(client.is_profiling for client in self.by_id.values())

    def held(self, client: int | None = None) -> Body | None:
        """The body held last by a client, or by anyone."""
        clients = self.by_id.values() if client is None else [c for c in self.by_id.values() if c.id == client]
        bodies = [hold.body for c in clients for hold in c.holds.values()]
        return next((body for body in reversed(bodies) if body is not None), None)

    def selected(self, client: int) -> Body | None:
        """The body selected by a client."""
        found = self.by_id.get(client)
        return None if found is None else alive(found.selected)
