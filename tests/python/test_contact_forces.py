# SPDX-License-Identifier: Apache-2.0
"""How piles of balls begin to move, by an independent solver of Coulomb's law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import iota

Array = np.ndarray[Any, np.dtype[np.float64]]
DENSITY = 1000.0


@dataclass
class Pile:
    """Balls that touch each other and the ground. pairs: (upper, lower, normal to the upper one); lower -1 is the ground."""

    radii: Array
    places: Array
    pairs: list[tuple[int, int, Array]]
    friction: float
    gravity: Array


def make_pile(seed: int) -> Pile:
    """Three balls on the ground, a fourth on these, and a fifth on the ground and the first; gravity leans."""
    random = np.random.default_rng(seed)
    radii = random.uniform(0.05, 0.15, 5)
    up = np.array([0, 1.0, 0])

    def beside(i: int, j: int, yaw: float) -> Array:
        """The place of ball j on the ground at ball i."""
        away = 2 * np.sqrt(radii[i] * radii[j])
        return np.array([places[i][0] + away * np.cos(yaw), radii[j], places[i][2] + away * np.sin(yaw)])

    places = [np.array([0, radii[0], 0])]
    yaw = random.uniform(0, 2 * np.pi)
    places.append(beside(0, 1, yaw))
    # The third one touches both: its place above the ground by two distances.
    first, second = 2 * np.sqrt(radii[0] * radii[2]), 2 * np.sqrt(radii[1] * radii[2])
    between = 2 * np.sqrt(radii[0] * radii[1])
    turn = np.arccos((first**2 + between**2 - second**2) / (2 * first * between))
    places.append(beside(0, 2, yaw + turn))
    # The fourth one lies on these: it is at known distances from three centers.
    centers, reach = np.array(places), radii[:3] + radii[3]
    ex = (centers[1] - centers[0]) / np.linalg.norm(centers[1] - centers[0])
    i = ex @ (centers[2] - centers[0])
    ey = centers[2] - centers[0] - i * ex
    ey /= np.linalg.norm(ey)
    ez = np.cross(ex, ey)
    ez *= np.sign(ez[1])
    d, j = np.linalg.norm(centers[1] - centers[0]), ey @ (centers[2] - centers[0])
    x = (reach[0] ** 2 - reach[1] ** 2 + d**2) / (2 * d)
    y = (reach[0] ** 2 - reach[2] ** 2 + i**2 + j**2 - 2 * i * x) / (2 * j)
    places.append(centers[0] + x * ex + y * ey + np.sqrt(reach[0] ** 2 - x**2 - y**2) * ez)
    places.append(beside(0, 4, yaw + turn + np.pi))
    ends = [(0, -1), (1, -1), (2, -1), (4, -1), (1, 0), (2, 0), (2, 1), (3, 0), (3, 1), (3, 2), (4, 0)]
    pairs = [(p, q, up if q < 0 else (places[p] - places[q]) / (radii[p] + radii[q])) for p, q in ends]
    lean = random.uniform(-0.3, 0.3, 2)
    return Pile(radii, np.array(places), pairs, random.uniform(0, 0.6), 9.81 * np.array([lean[0], -1, lean[1]]))


def accelerations(pile: Pile) -> Array:
    """(5, 6): of centers and spins from rest. Each place has a force in Coulomb's cone, none that pulls, and friction against the
    way that it begins to go: by sweeps over the places until no force changes by more than 1e-13 of the weight."""
    masses = DENSITY * 4 / 3 * np.pi * pile.radii**3
    inverse = np.concatenate(
        [np.repeat(1 / masses, 3).reshape(-1, 3), np.repeat(2.5 / (masses * pile.radii**2), 3).reshape(-1, 3)], 1
    )
    motion = np.concatenate([np.tile(pile.gravity, (len(masses), 1)), np.zeros((len(masses), 3))], 1)
    rows = []
    for p, q, normal in pile.pairs:
        first = np.cross(normal, [0.36, 0.48, 0.8])
        first /= np.linalg.norm(first)
        frame = np.array([normal, first, np.cross(normal, first)])
        jacobian = np.zeros((3, *motion.shape))
        jacobian[:, p, :3] = frame
        jacobian[:, p, 3:] = np.cross(-pile.radii[p] * normal, frame)
        if q >= 0:
            jacobian[:, q, :3] = -frame
            jacobian[:, q, 3:] = -np.cross(pile.radii[q] * normal, frame)
        flat = jacobian.reshape(3, -1)
        moved = (inverse.reshape(-1) * flat).T
        rows.append((flat, moved, np.diag(flat @ moved)))
    forces, state = np.zeros((len(rows), 3)), motion.reshape(-1)
    for _ in range(20000):
        change = 0.0
        for force, (flat, moved, own) in zip(forces, rows, strict=True):
            before = force.copy()
            force[0] = max(0.0, force[0] - flat[0] @ state / own[0])
            state = state + moved[:, 0] * (force[0] - before[0])
            force[1:] -= flat[1:] @ state / own[1:].max()
            size, most = float(np.linalg.norm(force[1:])), pile.friction * force[0]
            if size > most:
                force[1:] *= most / size
            state = state + moved[:, 1:] @ (force[1:] - before[1:])
            change = max(change, float(np.abs(force - before).max()))
        if change < 1e-13 * masses.sum() * 9.81:
            return np.asarray(state.reshape(-1, 6))
    raise ArithmeticError("the sweeps did not end")


@pytest.mark.parametrize("seed", range(8))
def test_a_pile_begins_to_move_as_an_independent_solver_of_its_contacts_says(seed: int) -> None:
    pile = make_pile(seed)
    system = iota.System()
    system.gravity = pile.gravity
    system.usual_material = iota.Material(friction=pile.friction)
    system.obstacle(iota.HalfSpace((0, 1, 0)), material=system.usual_material)
    balls = [
        system.body(shape=iota.Sphere(radius), density=DENSITY, position=place)
        for radius, place in zip(pile.radii, pile.places, strict=True)
    ]
    dt, steps, motions = 2e-5, 40, []
    for _ in range(2):  # in the first steps places that stick yield by their compliance
        for _ in range(steps):
            assert system.step(dt).unconverged == 0
        motions.append(np.array([[*ball.velocity, *ball.angular_velocity] for ball in balls]))
    found, known = (motions[1] - motions[0]) / (steps * dt), accelerations(pile)
    found[:, 3:] *= pile.radii[:, None]
    known[:, 3:] *= pile.radii[:, None]
    assert np.abs(known).max() > 0.5, "m/s^2: it moves"
    assert np.abs(found - known).max() < 1e-3


@pytest.mark.parametrize("mode", [None, "robust", "accurate"])
@pytest.mark.parametrize("rate", [60, 120, 480])
def test_a_brake_is_pressed_with_the_same_force_however_fast_its_disc_is(mode: Any, rate: int) -> None:
    """In a step that is taken in parts a held force acted in the first one alone: a twelfth of it was left."""
    system = iota.System(gravity=(0, 0, 0)) if mode is None else iota.System(gravity=(0, 0, 0), mode=mode)
    material = iota.Material(friction=0.3)
    disc = system.body(shape=iota.Cylinder(0.3, 0.02), mass=400, position=(-0.01, 1, 0), material=material)
    disc.angular_velocity = (30, 0, 0)
    system.revolute(disc, at=(0, 1, 0), axis=(1, 0, 0))
    shoe = system.body(shape=iota.Box((0.02, 0.02, 0.02)), mass=0.05, position=(0.01, 1.15, 0), material=material)
    system.prismatic(shoe, at=shoe.position, axis=(1, 0, 0))
    pressed = 0.0
    for _ in range(20):
        shoe.apply_force((-50, 0, 0))
        system.step(1 / rate)
        pressed -= disc.force_from(shoe).x / 20
    assert pressed == pytest.approx(50, rel=1e-3)
