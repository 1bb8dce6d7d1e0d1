# SPDX-License-Identifier: Apache-2.0
"""`net_force` and `net_torque` against the change of momenta of each body, in steps with and without blows."""

from collections.abc import Callable

import numpy as np
import pytest

import iota

H = 1 / 120
G = 9.81
MODES = ["energy_keeping", "robust", "plausible", "accurate"]


def a_floor(mode: str, restitution: float) -> iota.System:
    system = iota.System(mode=mode)
    system.usual_material = iota.Material(friction=0.4, restitution=restitution)
    floor = system.obstacle(iota.HalfSpace((0, 1, 0)))
    floor.material = iota.Material(friction=0.4)
    return system


def thrown(
    system: iota.System, shape: iota.Shape, at: tuple[float, float, float], velocity: tuple[float, float, float]
) -> iota.Body:
    body = system.body(shape=shape, mass=1, position=at)
    body.velocity = velocity
    return body


def a_box(system: iota.System) -> list[iota.Body]:
    return [thrown(system, iota.Box((0.2, 0.3, 0.2)), (0, 0.17, 0), (3, -1, 0.5))]


def a_ball(system: iota.System) -> list[iota.Body]:
    return [thrown(system, iota.Sphere(0.1), (0, 0.12, 0), (3, -1, 0.5))]


def two_boxes_in_a_row(system: iota.System) -> list[iota.Body]:
    cube = iota.Box((0.2, 0.2, 0.2))
    return [thrown(system, cube, (0, 0.1, 0), (3, 0, 0.5)), thrown(system, cube, (0.23, 0.1, 0.03), (0, 0, 0))]


def a_box_that_falls_on_a_plate(system: iota.System) -> list[iota.Body]:
    plate = thrown(system, iota.Box((0.4, 0.2, 0.4)), (0, 0.1, 0), (2, 0, 0))
    return [plate, thrown(system, iota.Box((0.2, 0.2, 0.2)), (0.1, 0.33, 0.03), (2, -1, 0))]


SCENES = [a_box, a_ball, two_boxes_in_a_row, a_box_that_falls_on_a_plate]


def forces_of_momenta(system: iota.System, bodies: list[iota.Body]) -> list[np.ndarray]:
    """Makes a step; the change of the momentum of each body by its length, N."""
    before = [np.array(body.velocity) for body in bodies]
    system.step(H)
    return [body.mass * (np.array(body.velocity) - v) / H for body, v in zip(bodies, before, strict=True)]


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("restitution", [0, 0.5])
def test_the_net_force_is_the_change_of_momentum_in_each_step_also_with_a_blow(
    mode: str, restitution: float, scene: Callable[[iota.System], list[iota.Body]]
) -> None:
    system = a_floor(mode, restitution)
    bodies = scene(system)
    for _ in range(60):
        for body, force in zip(bodies, forces_of_momenta(system, bodies), strict=True):
            assert np.linalg.norm(force - np.array(body.net_force)) < 1e-9 * (np.linalg.norm(force) + body.mass * G)


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
@pytest.mark.parametrize("restitution", [0, 0.5])
def test_the_net_force_of_a_box_is_that_of_its_contacts_and_its_weight(mode: str, restitution: float) -> None:
    system = a_floor(mode, restitution)
    (box,) = a_box(system)
    for _ in range(60):
        (force,) = forces_of_momenta(system, [box])
        told = sum((np.array(contact.force) for contact in box.contacts), np.array((0, -box.mass * G, 0)))
        assert np.linalg.norm(force - told) < 1e-6 * (np.linalg.norm(force) + box.mass * G)


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
def test_the_load_from_outside_of_a_combined_body_has_the_blow_of_both_parts(mode: str) -> None:
    system = a_floor(mode, 0.5)
    cube = iota.Box((0.2, 0.2, 0.2))
    left = system.body(shape=cube, mass=1, position=(0, 0.13, 0))
    right = system.body(shape=cube, mass=2, position=(0.2, 0.13, 0))
    left.combine(right)
    left.velocity = (2, -1, 0)
    for _ in range(30):
        force = forces_of_momenta(system, [left])[0]
        for told in (
            sum((np.array(part.net_force) for part in left.parts), np.zeros(3)),
            sum((np.array(part.outside_force) for part in left.parts), np.zeros(3)),
        ):
            assert np.linalg.norm(force - told) < 1e-6 * (np.linalg.norm(force) + left.mass * G)


@pytest.mark.parametrize("restitution", [0, 0.5])
def test_the_net_torque_is_the_change_of_angular_momentum_about_the_center_of_mass(restitution: float) -> None:
    system = a_floor("energy_keeping", restitution)
    box = thrown(system, iota.Box((0.2, 0.3, 0.2)), (0, 0.19, 0), (1, -1, 0.5))
    box.angular_velocity = (0, 1, 2)
    for _ in range(60):
        before = np.array(box.angular_momentum)
        system.step(H)
        torque = (np.array(box.angular_momentum) - before) / H
        assert np.linalg.norm(torque - np.array(box.net_torque)) < 1e-5 * (np.linalg.norm(torque) + G * 0.1)
