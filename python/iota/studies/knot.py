# SPDX-License-Identifier: Apache-2.0
"""Two hands tie a rope of a hundred rods into an overhand knot, which then holds a ring of steel; k ties, c begins anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import iota
from iota import looks
from iota.world.things import Frame

from ._story import Story

RODS, ROD, ROPE = 100, 0.024, 0.008  # number, length and radius, m
MASS, FRICTION = 0.004, 0.4  # of a rod, kg
START = -1.5  # of the rope on the table, m
RING, WIRE, STEEL = 0.03, 0.01, 7800.0  # radii, m; kg/m^3
SKIN = "#dba67e"
THREADED = 0.2  # of the rope in the ring, m
DAMPING = 1.0  # of the rods, 1/s
STEP = 1 / 360  # s: rods that are this light under tension turn fast
Way = list[tuple[float, Sequence[float]]]  # s, m

# The free end makes a loop over the rope, dives under it where the other hand lifts it, and leaves over the loop.
END: Way = [
    (0.5, (0.9, 0.06, 0.0)), (1.2, (0.72, 0.06, 0.28)), (2.4, (0.16, 0.06, 0.34)), (3.2, (-0.2, 0.07, 0.16)),
    (3.8, (-0.24, 0.07, -0.04)), (4.3, (-0.2, 0.06, -0.16)), (4.8, (0.0, 0.012, -0.22)), (5.3, (0.1, 0.012, -0.15)),
    (6.0, (0.11, 0.012, 0.0)), (6.5, (0.12, 0.02, 0.1)), (7.0, (0.14, 0.09, 0.18)), (7.8, (0.24, 0.09, 0.4)),
    (8.2, (0.32, 0.05, 0.52)), (10.5, (0.8, 0.05, 0.4)), (11.5, (0.9, 0.05, 0.2)),
]  # fmt: skip
LIFT, LIFTED = (4.2, 4.6, 7.0), (0.11, 0.12)  # s: it begins, is up, ends; m along the rope, and up
HOLD, HANG, TOP = 7.6, (11.6, 15.0), 1.85  # s: takes the other end, lifts it; m
TIED = 15.5  # s


def build() -> iota.World:
    """The world of the study."""
    world = make_world()
    Knot(world)
    return world


def make_world() -> iota.World:
    world = iota.World(iota.System(), title="knot: two hands tie a rope of 2.4 m", dt=STEP, ground=0.0)
    world.stage("room")
    world.camera = iota.Camera(position=(-0.3, 1.25, 1.75), target=(-0.3, 0.36, 0))
    return world


@dataclass
class Hand:
    """A grip on an end or a rod, where it goes, and where it is, m."""

    grip: iota.Grip
    way: Way
    at: Sequence[float]

    def follow(self, time: float) -> None:
        """time: since the tying began, s."""
        times, places = zip(*self.way, strict=True)
        self.at = [float(np.interp(time, times, along)) for along in zip(*places, strict=True)]
        self.grip.move(self.at)


class Knot:
    """A rope on a table, with a ring on it."""

    def __init__(self, world: iota.World, friction: float = FRICTION) -> None:
        self.world, self.system = world, world.system
        along = START + ROD * np.arange(RODS + 1)
        # Over the ring's lower side.
        middle = START + THREADED
        over = np.clip(2.5 - 0.4 * np.abs(along - middle) / ROD, 0, 1)
        places = evened(np.column_stack([along, ROPE + 2.1 * WIRE * over, np.zeros(RODS + 1)]))
        made = self.system.rod_array(places[:-1], places[1:], masses=MASS, damping=DAMPING)
        made.particles[1:-1:2].combine(made.particles[2::2])
        self.rods = list(made)
        for rod in self.rods:
            rod.radius, rod.material, rod.name = ROPE, iota.Material(friction=friction), "rope"
        world.draw(self.rods, looks.capsule(ROPE, "rope", color="#b8322a"))
        self.ring = self.system.body(
            shape=iota.Torus(RING, WIRE),
            density=STEEL,
            position=(middle, RING + WIRE, 0),
            orientation=(0, 0.5**0.5, 0, 0.5**0.5),
        )
        self.ring.material = iota.Material(friction=0.3)
        world.draw(self.ring, looks.solid("steel", "#dfe3e8"))
        self.hands: dict[str, Hand] = {}
        self.seen = {name: glove(world) for name in ("free", "other")}
        self.begun = 0.0  # s
        self.story = Story(world, wait=6.0, first=1.0, on_stop=self.release)
        self.story.at(0.0)(self.tie)
        self.story.at(TIED + 6)(world.reset)
        self.story.action("tie", key="k", help="two hands tie the knot")(self.tie)
        world.action("begin anew", key="c", help="the rope lies as at the start", on="world")(world.reset)
        world.on_step(self.follow)
        world.on_step(self.show)
        world.on_reset(self.hands.clear)
        world.on_reset(self.show)

    def tie(self) -> None:
        """Begins."""
        self.release()
        self.begun = self.system.time
        self._take("free", self.rods[-1], 1, END)

    def follow(self) -> None:
        """The hands do what is due."""
        if not self.hands:
            return
        now = self.system.time - self.begun
        if LIFT[0] <= now < LIFT[2] and "other" not in self.hands:
            rod = min(self.rods[: RODS * 4 // 5], key=lambda r: abs(r.position.x - LIFTED[0]) + abs(r.position.z))
            self._take("other", rod, 0, [(LIFT[1], tuple(rod.position + (0, LIFTED[1], 0)))])
        if LIFT[2] <= now < HOLD:
            self._drop("other")
        if now >= HOLD and "other" not in self.hands:
            at = self.rods[0].particles[0].position
            self._take("other", self.rods[0], -1, [(HANG[0], tuple(at)), (HANG[1], (at.x + 1.2, TOP, at.z))])
        if now >= HANG[0]:
            self._drop("free")
        if not all(hand.grip.alive for hand in self.hands.values()):
            return self.release()
        for hand in self.hands.values():
            hand.follow(now)

    def show(self) -> None:
        """Hands that hold are seen where they are."""
        for name, frame in self.seen.items():
            hand = self.hands.get(name)
            frame.visible = hand is not None and hand.grip.alive
            if hand is not None and hand.grip.alive:
                frame.at = hand.at

    def _take(self, name: str, rod: iota.Body, end: int, way: Way) -> None:
        """end: -1, 0, 1: the first one, the middle, the last one."""
        at = rod.position if end == 0 else rod.particles[max(end, 0)].position
        grip = self.system.grip(rod, (end * ROD / 2, 0, 0), target=at, frequency=6, max_acceleration=4000)
        self.hands[name] = Hand(grip, [(self.system.time - self.begun, tuple(at)), *way], tuple(at))

    def _drop(self, name: str) -> None:
        hand = self.hands.pop(name, None)
        if hand and hand.grip.alive:
            hand.grip.destroy()

    def release(self) -> None:
        """Both hands let go."""
        for name in list(self.hands):
            self._drop(name)


def glove(world: iota.World) -> Frame:
    """A palm above two fingers that meet at the frame's origin; hidden."""
    frame = world.drawings.frame()
    frame.visible = False
    world.drawings.shape(looks.Look(iota.Ellipsoid((0.07, 0.055, 0.05)), "rubber", SKIN), (0, 0.075, 0), on=frame)
    for side in (-1, 1):
        finger = looks.capsule(0.011, "rubber", length=0.05, color=SKIN)
        world.drawings.shape(finger, (0.014 * side, 0.036, 0), ("z", 90 - 22 * side), on=frame)
    return frame


def evened(places: np.ndarray) -> np.ndarray:
    """The same way along x with rods of one length, m."""
    fine = np.linspace(places[0, 0], places[-1, 0], 20 * len(places))
    height = np.interp(fine, places[:, 0], places[:, 1])
    length = np.r_[0, np.cumsum(np.hypot(np.diff(fine), np.diff(height)))]
    at = np.interp(np.linspace(0, length[-1], len(places)), length, fine)
    return np.column_stack([at, np.interp(at, fine, height), np.zeros(len(places))])


if __name__ == "__main__":
    build().run()
