# SPDX-License-Identifier: Apache-2.0
"""Which contacts welded bodies have with what joints hold at them, judged from motion and told forces."""

import itertools
from collections.abc import Iterable

import numpy as np
import pytest

import iota

H = 1 / 120


def a_system(mode: str = "energy_keeping") -> iota.System:
    system = iota.System(mode=mode)
    system.usual_material = iota.Material(friction=0.5)
    return system


def box(system: iota.System, x: float, y: float = 1.0, size: Iterable[float] = (0.2, 0.2, 0.2)) -> iota.Body:
    return system.body(shape=iota.Box(tuple(size)), mass=1, position=(x, y, 0))


def an_arm(
    system: iota.System, overlap: float, at: float = 0.25
) -> tuple[iota.Body, iota.Body, iota.Body, iota.Constraint]:
    """A plate in the world, a bracket welded to it, and an arm that is hinged to the bracket and overlaps the plate."""
    plate, bracket = box(system, 0, size=(0.4, 0.2, 0.2)), box(system, 0.3)
    arm = box(system, 0.45 - overlap, size=(0.5, 0.1, 0.1))
    system.weld(plate), system.weld(bracket)
    system.revolute(bracket, arm, at=(at, 1, 0), axis=(0, 0, 1))
    return plate, bracket, arm, system.weld(plate, bracket)


def strongest(system: iota.System, steps: int) -> float:
    most = 0.0
    for _ in range(steps):
        system.step(H)
        if len(system.contacts):
            most = max(most, float(np.linalg.norm(system.contacts.forces, axis=1).max()))
    return most


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
@pytest.mark.parametrize("overlap", [1e-4, 3e-3, 0.05])
@pytest.mark.parametrize("at", [0.18, 0.25, 0.3])
def test_a_link_does_not_touch_what_is_welded_to_the_one_that_it_is_hinged_to(
    mode: str, overlap: float, at: float
) -> None:
    system = a_system(mode)
    plate, _, arm, _ = an_arm(system, overlap, at)
    assert strongest(system, 30) == 0
    assert not list(plate.contacts)
    assert arm.angular_velocity.z < -5, "it swings down"


def test_a_weld_that_is_switched_off_or_undone_counts_no_longer() -> None:
    system = a_system()
    *_, arm, weld = an_arm(system, 1e-3)
    with system.edit():
        weld.active = False
    assert strongest(system, 10) > 5, "the plate carries the arm"
    assert arm.angular_velocity.length < 1e-6
    system.undo()
    saved = system.snapshot()
    assert strongest(system, 10) == 0
    system.restore(saved)
    assert strongest(system, 10) == 0
    assert arm.angular_velocity.z < -1


def test_bodies_in_a_chain_of_welds_do_not_touch_each_other_or_what_hangs_on_the_chain() -> None:
    system = a_system()
    chain = [box(system, 0.05 * i, size=(0.12, 0.2, 0.2)) for i in range(6)]
    for a, b in itertools.pairwise(chain):
        system.weld(a, b)
    system.weld(chain[0])
    hook = box(system, 0.1, 0.86, size=(0.1, 0.1, 0.1))
    system.revolute(chain[5], hook, at=(0.25, 0.9, 0), axis=(0, 0, 1))
    assert strongest(system, 30) == 0


def test_a_weld_that_yields_does_not_make_one_body_of_two() -> None:
    system = a_system()
    *_, arm, weld = an_arm(system, 1e-3)
    weld.compliance = 1e-9
    assert strongest(system, 10) > 5
    assert arm.angular_velocity.length < 1e-6


def test_the_world_and_static_bodies_make_no_chain() -> None:
    system = a_system()
    shelf = system.obstacle(iota.Box((4, 0.2, 1)), position=(0, 0.9, 0))
    shelf.material = iota.Material(friction=0.5)
    post, block = box(system, 0.0, 1.15, size=(0.2, 0.3, 0.2)), box(system, 0.3, 1.1)
    system.weld(post, at=(0, 1.0, 0))
    system.revolute(block, None, at=(0.3, 1.1, 0), axis=(0, 0, 1))
    block.angular_velocity = (0, 0, 1)
    for _ in range(120):
        system.step(H)
    assert abs(block.angular_velocity.z) < 0.1, "it lies on the shelf and leans at the post"


def test_two_bodies_that_welds_hold_in_the_world_do_not_press_each_other() -> None:
    system = a_system()
    left, right = box(system, 0), box(system, 0.19)
    system.weld(left), system.weld(right)
    assert strongest(system, 10) == 0


def test_what_is_welded_to_a_wheel_on_its_axle_may_overlap_the_stand() -> None:
    system = a_system()
    stand = system.obstacle(iota.Box((0.2, 1, 0.2)), position=(0, 0.5, 0))
    stand.material = iota.Material(friction=0.5)
    wheel = system.body(shape=iota.Cylinder(0.3, 0.05), mass=1, position=(0, 0.9, 0.12))
    hub = system.body(shape=iota.Sphere(0.05), mass=0.1, position=(0.1, 0.9, 0.12))
    system.revolute(wheel, None, at=(0, 0.9, 0.1), axis=(0, 0, 1))
    system.weld(wheel, hub)
    assert strongest(system, 10) == 0


def test_a_sensor_that_is_welded_to_a_frame_feels_the_door_of_the_frame() -> None:
    system = a_system()
    frame, door = box(system, 0), box(system, 0.35, size=(0.4, 0.2, 0.02))
    system.weld(frame)
    system.revolute(frame, door, at=(0.12, 1, 0), axis=(0, 1, 0))
    gate = box(system, 0.5, size=(0.1, 0.1, 0.1))
    gate.material = iota.Material(touches="sensor")
    system.weld(frame, gate)
    watch = system.watch_contacts()
    system.step(H)
    assert [{event.body, event.other} for event in watch.events] == [{gate, door}]
