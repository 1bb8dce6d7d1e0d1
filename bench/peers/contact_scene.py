# SPDX-License-Identifier: Apache-2.0
"""Scenes of bodies that touch, the same for all engines, and a judge that reads poses only. y is up; SI units."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

GRAVITY = 9.81
Array = NDArray[np.float64]


@dataclass
class Thing:
    """A box with these sides, a ball with one radius, or a capsule along its x axis with a radius and the length of its cylinder.

    mass: 0: it never moves. turn: columns are its axes.
    """

    sides: tuple[float, ...]
    place: tuple[float, float, float]
    mass: float = 0.0
    turn: Array = field(default_factory=lambda: np.eye(3))
    velocity: tuple[float, float, float] = (0, 0, 0)

    @property
    def is_ball(self) -> bool:
        return len(self.sides) == 1

    @property
    def is_capsule(self) -> bool:
        return len(self.sides) == 2

    @property
    def reach(self) -> float:
        if self.is_capsule:
            return self.sides[0] + self.sides[1] / 2
        return self.sides[0] if self.is_ball else float(np.linalg.norm(self.sides)) / 2


@dataclass
class Scene:
    """pivots: of a moving thing and the place around which it swings. push: a constant force on things, by number, N.

    joints: ball joints of two moving things at a place; the first thing comes before the second, which has no other one before it.
    """

    things: list[Thing]
    friction: float = 0.5
    restitution: float = 0.0
    seconds: float = 10.0
    pivots: list[tuple[int, tuple[float, float, float]]] = field(default_factory=list)
    push: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    joints: list[tuple[int, int, tuple[float, float, float]]] = field(default_factory=list)
    gravity: tuple[float, float, float] = (0, -GRAVITY, 0)

    @property
    def moving(self) -> list[int]:
        return [k for k, thing in enumerate(self.things) if thing.mass > 0]


CUBE, CUBE_MASS = 0.2, 8.0
GROUND = Thing((40, 1, 40), (0, -0.5, 0))


def tower(top: float = 1) -> Scene:
    """Ten cubes; the mass of the uppermost one is `top` times that of the others."""
    return Scene(
        [GROUND] + [Thing((CUBE,) * 3, (0, CUBE * (k + 0.5), 0), CUBE_MASS * (top if k == 9 else 1)) for k in range(10)]
    )


def pyramid(rows: int) -> Scene:
    things = [GROUND]
    for row in range(rows):
        for k in range(rows - row):
            things.append(
                Thing((CUBE,) * 3, (1.02 * CUBE * (k - (rows - row - 1) / 2), CUBE * (row + 0.5), 0), CUBE_MASS)
            )
    return Scene(things, seconds=10 if rows < 20 else 4)


def heap(count: int) -> Scene:
    """Cubes and balls of 5 to 10 cm fall into a box."""
    random, wide = np.random.default_rng(2), 0.8 if count < 500 else 1.4
    walls = [Thing((wide + 1, 0.5, wide + 1), (0, -0.25, 0))]
    for x, z in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        sides = (0.5, 6.0, wide + 1) if x else (wide + 1, 6.0, 0.5)
        walls.append(Thing(sides, (x * (wide + 0.5) / 2, 3.0, z * (wide + 0.5) / 2)))
    things, each = [], int(wide / 0.13)
    for k in range(count):
        size = random.uniform(0.05, 0.1)
        layer, rest = divmod(k, each * each)
        place = (0.13 * (rest % each - (each - 1) / 2), 0.1 + 0.13 * layer, 0.13 * (rest // each - (each - 1) / 2))
        turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
        turn *= np.linalg.det(turn)
        sides = (size / 2,) if k % 2 else (size,) * 3
        things.append(Thing(sides, place, 1000 * (math.pi / 6 if k % 2 else 1) * size**3, turn))
    return Scene(walls + things, seconds=8 if count < 500 else 5)


def slope(share: float) -> Scene:
    """A cube on a plane, by gravity that leans. share: of the angle at which friction gives way."""
    angle = math.atan(0.5) * share
    return Scene(
        [GROUND, Thing((CUBE,) * 3, (0, CUBE / 2, 0), CUBE_MASS)],
        gravity=(GRAVITY * math.sin(angle), -GRAVITY * math.cos(angle), 0), seconds=10 if share < 1 else 5,
    )  # fmt: skip


def grip(times: float) -> Scene:
    """A cube of 1 kg is pressed against a wall by a plate that carries itself. times: the force, of what is needed."""
    force = times * GRAVITY / 0.5
    plate = (0.05, 0.3, 0.3)
    return Scene(
        [GROUND, Thing((0.1, 3, 3), (-0.1, 1.5, 0)), Thing((0.1,) * 3, (0, 1, 0), 1), Thing(plate, (0.075, 1, 0), 1)],
        push={3: (-force, GRAVITY, 0)}, seconds=20,
    )  # fmt: skip


def bounce(restitution: float) -> Scene:
    return Scene([GROUND, Thing((0.1,), (0, 1.1, 0), 4)], restitution=restitution, seconds=5)


def cradle() -> Scene:
    """Five balls that touch, hung 1 m below; the first is lifted by 30 degrees."""
    things = [GROUND]
    pivots = []
    for k in range(5):
        at, angle = (0.2 * k, 2.0, 0.0), -math.pi / 6 if k == 0 else 0.0
        things.append(Thing((0.1,), (at[0] + math.sin(angle), at[1] - math.cos(angle), 0), 4))
        pivots.append((k + 1, at))
    return Scene(things, friction=0.0, restitution=1.0, seconds=0.9, pivots=pivots)


# The capsules of a figure: ends of the axis in the plane of its front, radius, mass; and its joints.
FIGURE = [
    ((-0.08, 0.00), (0.08, 0.00), 0.10, 10.0), ((0.00, 0.25), (0.00, 0.45), 0.12, 20.0), ((0.00, 0.72), (0.00, 0.80), 0.10, 5.0),
    *(
        limb for side in (-1, 1) for limb in (
            ((0.25 * side, 0.45), (0.45 * side, 0.45), 0.05, 2.5), ((0.55 * side, 0.45), (0.75 * side, 0.45), 0.04, 2.0),
            ((0.1 * side, -0.15), (0.1 * side, -0.40), 0.07, 7.0), ((0.1 * side, -0.55), (0.1 * side, -0.80), 0.05, 4.0),
        )
    ),
]  # fmt: skip
FIGURE_JOINTS = [
    (0, 1, (0.0, 0.12)), (1, 2, (0.0, 0.6)),
    *(
        joint for side, k in ((-1, 3), (1, 7)) for joint in (
            (1, k, (0.19 * side, 0.45)), (k, k + 1, (0.5 * side, 0.45)),
            (0, k + 2, (0.1 * side, -0.1)), (k + 2, k + 3, (0.1 * side, -0.475)),
        )
    ),
]  # fmt: skip


def ragdolls(count: int) -> Scene:
    """Figures of eleven capsules with ball joints fall on each other and on the ground, in layers."""
    random = np.random.default_rng(1)
    each = math.ceil(math.sqrt(count / 4))
    scene = Scene([GROUND], seconds=5)
    for k in range(count):
        layer, rest = divmod(k, each * each)
        x, y, z = 1.7 * (rest % each), 1.2 + 2 * layer, 0.5 * (rest // each)
        first = len(scene.things)
        for a, b, radius, mass in FIGURE:
            way = np.subtract(b, a)
            length = float(np.linalg.norm(way))
            c, s = way / length
            turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
            place = (x + (a[0] + b[0]) / 2, y + (a[1] + b[1]) / 2, z)
            speed = tuple(random.normal(size=3) * 0.2)
            scene.things.append(Thing((radius, length), place, mass, turn, speed))
        scene.joints += [(first + i, first + j, (x + u, y + v, z)) for i, j, (u, v) in FIGURE_JOINTS]
    return scene


def rope(ratio: float) -> Scene:
    """Sixty beads with ball joints between them hang over half a turn of a fixed cylinder, friction 0.3, with weights at both ends.

    ratio: of the weights. Friction acts on the lever of the cylinder, tensions on that of the beads' centers: with r the radius of a
    bead and R that of the cylinder it holds up to exp(0.3 pi R / (R + r)) = 2.43, beads' weights aside.
    """
    beads, around, radius = 60, 27, 0.0125  # around: joints along the half turn
    turning = math.pi / around
    line = radius / math.sin(turning / 2)  # the circle of the beads' centers
    middle = (0.0, 2.0)
    places = []
    for k in range(beads):
        before = (beads - 1 - around) // 2  # beads that hang on the first side
        step = min(max(k - before, 0), around)
        down = max(before - k, k - before - around, 0)
        angle = math.pi - step * turning
        places.append((middle[0] + line * math.cos(angle), middle[1] + line * math.sin(angle) - 2 * radius * down))
    scene = Scene([], friction=0.3, seconds=4)
    along_z = np.array([[0, 0, 1.0], [0, 1, 0], [-1, 0, 0]])
    scene.things.append(Thing((line - radius, 0.5), (*middle, 0), 0, along_z))
    weights = {0: 1.0, beads - 1: ratio}
    scene.things += [Thing((radius,), (x, y, 0), weights.get(k, 0.002)) for k, (x, y) in enumerate(places)]
    for k in range(1, beads):
        a, b = places[k - 1], places[k]
        scene.joints.append((k, k + 1, ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2, 0)))
    return scene


SCENES = {
    "tower": tower, "tower, 1000:1": lambda: tower(1000), "pyramid 55": lambda: pyramid(10),
    "pyramid 1035": lambda: pyramid(45), "heap 200": lambda: heap(200), "heap 1000": lambda: heap(1000),
    "slope 0.99": lambda: slope(0.99), "slope 1.2": lambda: slope(1.2), "grip 1.5": lambda: grip(1.5), "grip 20": lambda: grip(20),
    "bounce, e = 1": lambda: bounce(1.0), "bounce, e = 0.5": lambda: bounce(0.5), "cradle": cradle,
    "rope 2.3": lambda: rope(2.3), "rope 2.6": lambda: rope(2.6),
    "ragdolls 20": lambda: ragdolls(20), "ragdolls 100": lambda: ragdolls(100),
}  # fmt: skip


# --- the judge --------------------------------------------------------------------------------------------------------


def overlap(a: Thing, b: Thing, place_a: Array, turn_a: Array, place_b: Array, turn_b: Array) -> float:
    """How deep two things are in each other, m: by separating axes, or by the nearest place of a box to a ball's center."""
    if a.is_capsule or b.is_capsule:
        return overlap_of_capsule(a, b, place_a, turn_a, place_b, turn_b)
    way = place_b - place_a
    if a.is_ball and b.is_ball:
        return a.sides[0] + b.sides[0] - float(np.linalg.norm(way))
    if a.is_ball:
        return overlap(b, a, place_b, turn_b, place_a, turn_a)
    half = np.array(a.sides) / 2
    if b.is_ball:
        local = turn_a.T @ way
        off = local - np.clip(local, -half, half)
        outside = float(np.linalg.norm(off))
        return b.sides[0] - outside if outside > 0 else b.sides[0] + float((half - np.abs(local)).min())
    other = np.array(b.sides) / 2
    axes = [*turn_a.T, *turn_b.T]
    for u, v in itertools.product(turn_a.T, turn_b.T):
        normal = np.cross(u, v)
        if (length := np.linalg.norm(normal)) > 1e-3:
            axes.append(normal / length)
    normals = np.array(axes)
    depth = np.abs(normals @ turn_a) @ half + np.abs(normals @ turn_b) @ other - np.abs(normals @ way)
    return float(depth.min())


def overlap_of_capsule(a: Thing, b: Thing, place_a: Array, turn_a: Array, place_b: Array, turn_b: Array) -> float:
    """Of two capsules by their axes; of a capsule and another thing by nine balls along its axis."""
    if not a.is_capsule:
        return overlap_of_capsule(b, a, place_b, turn_b, place_a, turn_a)
    half_a = turn_a[:, 0] * a.sides[1] / 2
    if not b.is_capsule:
        ball = Thing((a.sides[0],), (0, 0, 0))
        return max(
            overlap(ball, b, place_a + share * half_a, turn_a, place_b, turn_b) for share in np.linspace(-1, 1, 9)
        )
    half_b = turn_b[:, 0] * b.sides[1] / 2
    # The nearest places of both axes, each in turn: it converges, as the distance of two segments is convex.
    at_a, at_b = place_a, place_b
    for _ in range(30):
        at_b = place_b + np.clip((at_a - place_b) @ half_b / (half_b @ half_b), -1, 1) * half_b
        at_a = place_a + np.clip((at_b - place_a) @ half_a / (half_a @ half_a), -1, 1) * half_a
    return a.sides[0] + b.sides[0] - float(np.linalg.norm(at_a - at_b))


class Judge:
    """Looks at poses (n, 3), (n, 3, 3) of the things that move."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.start = np.array([scene.things[k].place for k in scene.moving])
        self.worst = self.last = self.gap = 0.0
        self.highest: list[float] = []
        self.heights: list[float] = []
        self.places: list[Array] = []

    def look(self, places: Array, turns: Array, deep: bool) -> None:
        """deep: overlaps, too."""
        self.places.append(places.copy())
        self.heights.append(float(places[0, 1]))
        if not deep or not np.isfinite(places).all():
            return
        scene, moving = self.scene, self.scene.moving
        reach = np.array([scene.things[k].reach for k in moving])
        near = np.linalg.norm(places[:, None] - places[None], axis=2) < reach[:, None] + reach[None]
        self.last = 0.0
        joined = {(moving.index(i), moving.index(j)) for i, j, _ in scene.joints}
        for i, j, at in scene.joints:
            ends = [
                places[k] + turns[k] @ (scene.things[n].turn.T @ np.subtract(at, scene.things[n].place))
                for n, k in ((i, moving.index(i)), (j, moving.index(j)))
            ]
            self.gap = max(self.gap, float(np.linalg.norm(ends[1] - ends[0])))
        for i, j in np.argwhere(np.triu(near, 1)):
            if (i, j) in joined:
                continue
            self._note(scene.things[moving[i]], scene.things[moving[j]], places[i], turns[i], places[j], turns[j])
        for fixed in (thing for thing in scene.things if thing.mass == 0):
            for i, k in enumerate(moving):
                self._note(fixed, scene.things[k], np.array(fixed.place), fixed.turn, places[i], turns[i])

    def _note(self, a: Thing, b: Thing, pa: Array, ta: Array, pb: Array, tb: Array) -> None:
        deep = overlap(a, b, pa, ta, pb, tb)
        self.last, self.worst = max(self.last, deep), max(self.worst, deep)

    def verdict(self, name: str, hz: int) -> tuple[bool, str]:
        """Whether it passes, and its figure."""
        places = np.array(self.places)
        if not np.isfinite(places).all():
            return False, "not a number"
        if name.startswith("slope"):
            way = places[:, 0, 0]
            if "0.99" in name:
                creep = (way[-1] - way[hz]) / (len(way) - 1 - hz) * hz
                return bool(abs(creep) < 1e-3 / 60), f"creeps {1e6 * creep:.2g} um/s"
            leaned = np.array(self.scene.gravity)
            wanted = leaned[0] + 0.5 * leaned[1]
            found = 2 * (way[-1] - way[0]) / ((len(way) - 1) / hz) ** 2
            return bool(abs(found / wanted - 1) < 0.05), f"acceleration {found / wanted:.4f}"
        if name.startswith("grip"):
            fall = (places[2 * hz, 0, 1] - places[-1, 0, 1]) / ((len(places) - 1 - 2 * hz) / hz)
            return bool(abs(fall) < 1e-3 / 60), f"creeps {1e6 * fall:.2g} um/s"
        if name.startswith("bounce"):
            h = np.array(self.heights) - 0.1
            peaks = [h[k] for k in range(1, len(h) - 1) if h[k - 1] < h[k] >= h[k + 1]][:3]
            e = self.scene.restitution
            wanted = [(e * e) ** (k + 1) for k in range(len(peaks))]
            return (
                bool(peaks) and all(abs(p / w - 1) < 0.05 for p, w in zip(peaks, wanted, strict=True)),
                "peaks " + " ".join(f"{p:.3f}" for p in peaks),
            )
        if name == "cradle":
            speeds = np.diff(places[:, :, 0], axis=0) * hz
            after = int(np.argmax(speeds[:, -1]))
            shares = speeds[after] / speeds[:, 0].max()
            return bool(abs(shares[-1] - 1) < 0.07 and (abs(shares[:-1]) < 0.07).all()), "speeds " + " ".join(
                f"{s:.2f}" for s in shares
            )
        if name.startswith("rope"):
            fallen = float(places[hz, -1, 1] - places[-1, -1, 1])
            holds = abs(fallen) < 0.01
            passes = holds if "2.3" in name else fallen > 0.1
            return passes and self.gap < 0.005, f"falls {1000 * fallen:.2g} mm, gaps of joints {1000 * self.gap:.2g} mm"
        if name.startswith("ragdolls"):
            return self.gap < 0.02 and self.worst < 0.05, f"gaps of joints {1000 * self.gap:.2g} mm"
        off = places[-1] - self.start
        if name.startswith("heap"):
            lost = int((places[-1, :, 1] < -0.05).sum())
            return lost == 0 and self.last < 0.01, f"{lost} lost"
        aside = float(np.hypot(off[:, 0], off[:, 2]).max())
        fallen = float(-off[:, 1].min())
        return aside < 0.1 and fallen < 0.3 and self.worst < 0.02, f"drift {1000 * max(aside, fallen):.2g} mm"
