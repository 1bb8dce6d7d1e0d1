# SPDX-License-Identifier: Apache-2.0
"""The scenes of all engines: rigid bodies and ball joints, the same as in scenes/*.h. y is up.

No collisions, damping or sleep; everything starts at rest.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

GRAVITY = 9.81  # m/s^2, down
LENGTH, MASS, RADIUS = 0.1, 0.1, 0.005  # of a link: m, kg, m
WORLD = -1
"""The first body of a joint with the world."""

Array = NDArray[np.float64]


@dataclass
class Scene:
    """n bodies and their joints. A body's frame has its origin at the center of mass and the principal axes for axes."""

    mass: Array  # (n,) kg
    inertia: Array  # (n, 3) kg m^2, about the body's axes
    center: Array  # (n, 3) m
    rotation: Array  # (n, 3, 3), columns: the body's axes
    joints: list[tuple[int, int]]  # (WORLD or a body, a body); a tree's joints lead away from the world
    joint_at: Array  # (number of joints, 3) m

    def anchors(self) -> tuple[Array, Array]:
        """Places of each joint in the frames of its two bodies, (number of joints, 3) m; in the world's for WORLD."""
        first, second = np.array(self.joints, dtype=np.intp).T
        local = [
            np.einsum("nji,nj->ni", self.rotation[body], self.joint_at - self.center[body]) for body in (first, second)
        ]
        local[0][first == WORLD] = self.joint_at[first == WORLD]
        return local[0], local[1]

    def available(self) -> float:
        """Largest energy that gravity can release, J: each body hangs straight below the support on its shortest path
        of joints."""
        ways: dict[int, list[int]] = {}
        for k, pair in enumerate(self.joints):
            for body in pair:
                ways.setdefault(body, []).append(k)
        lowest = np.full(len(self.mass), math.inf)
        heap = [(0.0, float(self.joint_at[k, 1]), k) for k in ways[WORLD]]
        reached: set[int] = set()
        while heap:
            reach, height, k = heapq.heappop(heap)
            if k in reached:
                continue
            reached.add(k)
            for body in self.joints[k]:
                if body == WORLD:
                    continue
                arm = float(np.linalg.norm(self.center[body] - self.joint_at[k]))
                lowest[body] = min(lowest[body], height - reach - arm)
                for other in ways[body]:
                    if other not in reached:
                        step = float(np.linalg.norm(self.joint_at[other] - self.joint_at[k]))
                        heapq.heappush(heap, (reach + step, height, other))
        return float(np.sum(self.mass * GRAVITY * (self.center[:, 1] - lowest)))


class Builder:
    """Collects bodies and joints."""

    def __init__(self) -> None:
        self.bodies: list[tuple[float, Array, Array, Array]] = []
        self.joints: list[tuple[int, int]] = []
        self.joint_at: list[Array] = []

    def rod(self, begin: Array, end: Array, mass: float, radius: float) -> int:
        """A solid cylinder, its first axis along it."""
        along = end - begin
        length = float(np.linalg.norm(along))
        x = along / length
        y = np.cross(np.eye(3)[np.argmin(np.abs(x))], x)
        y /= np.linalg.norm(y)
        across = mass * (3 * radius**2 + length**2) / 12
        inertia = np.array([mass * radius**2 / 2, across, across])
        return self.body(mass, inertia, (begin + end) / 2, np.stack([x, y, np.cross(x, y)], axis=1))

    def points(self, places: Array, mass: float) -> int:
        """Equal masses at places (n, 3)."""
        arm = places - places.mean(axis=0)
        moments, axes = np.linalg.eigh(mass / len(places) * (np.sum(arm**2) * np.eye(3) - arm.T @ arm))
        if np.linalg.det(axes) < 0:
            axes = -axes
        # MuJoCo refuses a plate without thickness: by round-off its largest moment exceeds the sum of the others.
        moments = moments + [1e-9 * moments[2], 0, 0]
        return self.body(mass, moments, places.mean(axis=0), axes)

    def body(self, mass: float, inertia: Array, center: Array, rotation: Array) -> int:
        self.bodies.append((mass, inertia, center, rotation))
        return len(self.bodies) - 1

    def join(self, first: int, second: int, at: Array) -> None:
        self.joints.append((first, second))
        self.joint_at.append(at)

    def scene(self) -> Scene:
        mass, inertia, center, rotation = map(np.array, zip(*self.bodies, strict=True))
        return Scene(mass, inertia, center, rotation, self.joints, np.array(self.joint_at))


def chain(links: int, heavy_end: float = 1) -> Scene:
    """Links along x, fixed at the first end; the last one has `heavy_end` times their mass."""
    build = Builder()
    for i in range(links):
        at = np.array([i * LENGTH, 0, 0])
        mass = MASS * (heavy_end if i + 1 == links else 1)
        link = build.rod(at, at + [LENGTH, 0, 0], mass, RADIUS)
        build.join(link - 1 if i else WORLD, link, at)
    return build.scene()


def net(side: int) -> Scene:
    """A square net of side x side knots in the x-z plane, held at two neighboring corners; all loops are closed."""
    build = Builder()
    knots: dict[tuple[int, int], int] = {(0, 0): WORLD, (0, side - 1): WORLD}
    for row in range(side):
        for column in range(side):
            for to in ((row, column + 1), (row + 1, column)):
                if max(to) >= side:
                    continue
                ends = [LENGTH * np.array([knot[1], 0.0, knot[0]]) for knot in ((row, column), to)]
                link = build.rod(ends[0], ends[1], MASS, RADIUS)
                for knot, at in zip(((row, column), to), ends, strict=True):
                    if knot in knots:
                        build.join(knots[knot], link, at)
                    else:
                        knots[knot] = link
    return build.scene()


def ragdolls(count: int) -> Scene:
    """Figures of 20 bodies and 19 joints, each hanging by a shoulder."""
    build = Builder()
    for i in range(count):
        figure(build, np.array([2.0 * (i % 32), 3, 2.0 * (i // 32)]))
    return build.scene()


def figure(build: Builder, at: Array) -> None:
    """One of them; its joints are in order from the shoulder outwards, as needed for a tree."""
    found: list[tuple[int, int, Array]] = []

    def plate(corners: list[tuple[float, float, float]], mass: float) -> tuple[int, Array]:
        places = at + np.array(corners)
        return build.points(places, mass), places

    def rod(inner: int, begin: Array, end: tuple[float, float, float], mass: float) -> tuple[int, Array]:
        far = at + np.array(end)
        body = build.rod(begin, far, mass, 0.05)
        found.append((inner, body, begin))
        return body, far

    pelvis, hips = plate([(0, 0.1, 0), (-0.1, -0.05, 0), (0.1, -0.05, 0)], 11)
    waist = rod(pelvis, hips[0], (0, 0.25, 0.02), 8)
    ribs, breast = rod(*waist, (0, 0.38, 0), 8)
    chest, shoulders = plate([(0, 0.38, 0), (-0.18, 0.5, 0), (0.18, 0.5, 0)], 14)
    found.append((ribs, chest, breast))
    neck = rod(chest, shoulders[0], (0, 0.6, 0), 2)
    rod(*neck, (0, 0.8, 0), 5)
    for side in (-1, 1):
        x, hip, index = 0.18 * side, 0.1 * side, 1 if side < 0 else 2
        elbow = rod(chest, shoulders[index], (x + 0.28 * side, 0.5, 0), 2.2)
        wrist = rod(*elbow, (x + 0.53 * side, 0.5, 0.02), 1.4)
        rod(*wrist, (x + 0.7 * side, 0.5, 0), 0.5)
        knee = rod(pelvis, hips[index], (hip, -0.45, 0.02), 6)
        ankle = rod(*knee, (hip, -0.85, 0), 3)
        ball = rod(*ankle, (hip, -0.9, 0.15), 0.8)
        rod(*ball, (hip, -0.9, 0.22), 0.2)
    build.join(WORLD, chest, shoulders[1])
    held = {chest}
    while found:
        k = next(k for k, (a, b, _) in enumerate(found) if a in held or b in held)
        a, b, place = found.pop(k)
        build.join(*((a, b) if a in held else (b, a)), place)
        held |= {a, b}


SCENES: dict[str, Callable[[int], Scene]] = {
    "chain": chain,
    "heavy_end": lambda links: chain(links, heavy_end=1000),
    "net": net,
    "ragdolls": ragdolls,
}
"""Name -> scene of a size: links, links, knots along an edge, figures."""

TREES = ("chain", "heavy_end", "ragdolls")
"""Those without loops."""
