# SPDX-License-Identifier: Apache-2.0
"""Mode accurate on solids, closed loops and springs, against an independent solver."""

from __future__ import annotations

import numpy as np
import pytest
from amount import TRIES_ALL
from rigid_reference import Array, Point, RigidReference, Solid, place_of

import iota
from iota.shapelib.frames import from_quaternion, to_quaternion

SECONDS, HZ = 1.0, 60


def random_solid(rng: np.random.Generator, hinge: Array, at: Array) -> tuple[Solid, Array]:
    """A box with the place `hinge` of its unit cube at `at`; its edges, too."""
    size, mass = rng.uniform(0.3, 1.0, 3), rng.uniform(0.5, 2.0)
    q = rng.normal(size=4)
    q /= np.linalg.norm(q)
    inertia = mass / 12 * (np.sum(size**2) - size**2)
    position = at - from_quaternion(*q) @ (hinge * size)
    return Solid(mass, inertia, position, q, rng.normal(size=3), rng.normal(size=3)), size


def tree_of_boxes(seed: int) -> tuple[RigidReference, list[Array]]:
    """Two to four boxes hinged at corners, half of them on a nail, with a spring; edges of each."""
    rng = np.random.default_rng(seed)
    scene, corner = RigidReference(), np.array([0.5, 0.5, 0.5])
    sizes: list[Array] = []
    for i in range(rng.integers(2, 5)):
        near = int(rng.integers(i)) if i else 0
        place = -corner * rng.choice([-1, 1], 3)
        at = np.zeros(3)
        if i:
            other = scene.solids[near]
            at = other.position + from_quaternion(*other.orientation) @ (place * sizes[near])
        solid, size = random_solid(rng, corner, at)
        scene.solids.append(solid)
        sizes.append(size)
        if i:
            scene.hinges.append(((near, place * sizes[near]), (i, corner * size)))
    if seed % 2:
        scene.nails.append((0, corner * sizes[0]))
    ends = (0, -corner * sizes[0]), (len(sizes) - 1, -corner * sizes[-1])
    first, last = (place_of(scene.start().reshape(-1, 13), end) for end in ends)
    scene.springs.append((*ends, rng.uniform(5, 50), float(np.linalg.norm(first - last))))
    scene.meet_hinges()
    return scene, sizes


def ring_of_boxes(seed: int) -> tuple[RigidReference, list[Array]]:
    """Four boxes that are hinged in a closed ring, in empty space but for gravity."""
    rng = np.random.default_rng(seed)
    scene = RigidReference()
    sizes: list[Array] = []
    corners = [np.array([np.cos(a), np.sin(a), rng.uniform(-0.3, 0.3)]) for a in np.pi / 2 * np.arange(4)]
    for i in range(4):
        start, end = corners[i], corners[(i + 1) % 4]
        size = np.array([np.linalg.norm(end - start), *rng.uniform(0.2, 0.5, 2)])
        x = (end - start) / size[0]
        y = np.cross([0, 0, 1], x) / np.linalg.norm(np.cross([0, 0, 1], x))
        orientation = np.array(to_quaternion(np.stack([x, y, np.cross(x, y)], axis=1)))
        mass = rng.uniform(0.5, 2.0)
        inertia = mass / 12 * (np.sum(size**2) - size**2)
        scene.solids.append(
            Solid(mass, inertia, (start + end) / 2, orientation, 5 * rng.normal(size=3), 5 * rng.normal(size=3))
        )
        sizes.append(size)
    ahead = [np.array([0.5 * size[0], 0, 0]) for size in sizes]
    for i in range(4):
        scene.hinges.append(((i, ahead[i]), ((i + 1) % 4, -ahead[(i + 1) % 4])))
    scene.meet_hinges()
    return scene, sizes


def points_of(scene: RigidReference) -> list[Point]:
    return [p for pair in scene.hinges for p in pair] + scene.nails + [p for s in scene.springs for p in s[:2]]


def play(scene: RigidReference, sizes: list[Array], tolerance: float) -> tuple[Array, float]:
    """Places of all points, and the sum of the estimated errors, m."""
    system = iota.System(mode="accurate")
    system.tolerance = tolerance
    points = points_of(scene)
    handles: dict[int, iota.Particle] = {}
    for i, (solid, size) in enumerate(zip(scene.solids, sizes, strict=True)):
        own = [k for k, point in enumerate(points) if point[0] == i]
        body = system.body(
            shape=iota.Box(size.tolist()),
            mass=solid.mass,
            position=solid.position.tolist(),
            orientation=solid.orientation.tolist(),
            velocity=solid.velocity.tolist(),
            spin=solid.spin.tolist(),
            attachments=[points[k][1].tolist() for k in own],
        )
        handles |= dict(zip(own, body.attachments, strict=True))
    count = 2 * len(scene.hinges)
    for k in range(0, count, 2):
        handles[k].combine(handles[k + 1])
    for k in range(count, count + len(scene.nails)):
        handles[k].nail()
    for k, (_, _, stiffness, length) in enumerate(scene.springs):
        p = count + len(scene.nails) + 2 * k
        system.bond(handles[p], handles[p + 1], "spring", stiffness=stiffness, length=length)
    estimate = 0.0
    for _ in range(round(SECONDS * HZ)):
        estimate += system.step(1 / HZ).error / HZ
    return np.array([handles[k].position for k in range(len(points))]), estimate


SCENES = {f"tree {seed}": (tree_of_boxes, seed) for seed in range(4 if TRIES_ALL else 2)} | {"ring": (ring_of_boxes, 0)}


@pytest.mark.parametrize("name", SCENES)
def test_accurate_meets_its_tolerance_on_solids(name: str) -> None:
    make, seed = SCENES[name]
    scene, sizes = make(seed)
    state = scene.after(SECONDS)
    truth = np.array([place_of(state, point) for point in points_of(scene)])
    for tolerance in (1e-3, 1e-5, 1e-7):
        found, estimate = play(scene, sizes, tolerance)
        assert np.abs(found - truth).max() < 2 * tolerance
        assert estimate < 2 * tolerance
