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
    """A box with these sides, or a ball with one radius. mass: 0: it never moves. turn: columns are its axes."""

    sides: tuple[float, ...]
    place: tuple[float, float, float]
    mass: float = 0.0
    turn: Array = field(default_factory=lambda: np.eye(3))
    velocity: tuple[float, float, float] = (0, 0, 0)

    @property
    def is_ball(self) -> bool:
        return len(self.sides) == 1

    @property
    def reach(self) -> float:
        return self.sides[0] if self.is_ball else float(np.linalg.norm(self.sides)) / 2


@dataclass
class Scene:
    """pivots: of a moving thing and the place around which it swings. push: a constant force on things, by number, N."""

    things: list[Thing]
    friction: float = 0.5
    restitution: float = 0.0
    seconds: float = 10.0
    pivots: list[tuple[int, tuple[float, float, float]]] = field(default_factory=list)
    push: dict[int, tuple[float, float, float]] = field(default_factory=dict)
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


SCENES = {
    "tower": tower, "tower, 1000:1": lambda: tower(1000), "pyramid 55": lambda: pyramid(10),
    "pyramid 1035": lambda: pyramid(45), "heap 200": lambda: heap(200), "heap 1000": lambda: heap(1000),
    "slope 0.99": lambda: slope(0.99), "slope 1.2": lambda: slope(1.2), "grip 1.5": lambda: grip(1.5), "grip 20": lambda: grip(20),
    "bounce, e = 1": lambda: bounce(1.0), "bounce, e = 0.5": lambda: bounce(0.5), "cradle": cradle,
}  # fmt: skip


# --- the judge --------------------------------------------------------------------------------------------------------


def overlap(a: Thing, b: Thing, place_a: Array, turn_a: Array, place_b: Array, turn_b: Array) -> float:
    """How deep two things are in each other, m: by separating axes, or by the nearest place of a box to a ball's center."""
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


class Judge:
    """Looks at poses (n, 3), (n, 3, 3) of the things that move."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.start = np.array([scene.things[k].place for k in scene.moving])
        self.worst = self.last = 0.0
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
        for i, j in np.argwhere(np.triu(near, 1)):
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
        off = places[-1] - self.start
        if name.startswith("heap"):
            lost = int((places[-1, :, 1] < -0.05).sum())
            return lost == 0 and self.last < 0.01, f"{lost} lost"
        aside = float(np.hypot(off[:, 0], off[:, 2]).max())
        fallen = float(-off[:, 1].min())
        return aside < 0.1 and fallen < 0.3 and self.worst < 0.02, f"drift {1000 * max(aside, fallen):.2g} mm"
