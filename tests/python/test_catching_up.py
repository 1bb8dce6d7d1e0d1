# SPDX-License-Identifier: Apache-2.0
"""What was frozen out of sight has happened when it comes into sight (completeness), and what was seen stays so (consistency)."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

import iota
from iota.studies import crowd
from iota.world import catching_up
from iota.world.catching_up import catch_up

PLENTY, LITTLE = 1e4, 1e-6  # ms
DT = 1 / 120


class Place:
    """A ground, and something 200 m from its viewer, who may come."""

    def __init__(self, make: Callable[[iota.World], iota.Body], material: iota.Material | None = None) -> None:
        self.system = iota.System(damping=0.02)
        self.system.usual_material = material or iota.Material(touches="obstacles")
        self.world = iota.World(self.system, ground=0.0)
        self.root = make(self.world)
        self.eye = [0.0, 2.0, 200.0]
        self.world.levels.viewers = lambda: [self.eye]
        self.thing = self.world.levels.manage(self.root.articulate, levels=["full", "frozen"])

    def freeze(self) -> None:
        self.world.levels.budget_ms = LITTLE
        for _ in range(100):
            self.world.step()
            if self.thing.level.name == "frozen":
                return
        raise AssertionError("it is not frozen")

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / DT)):
            self.world.step()

    def places(self) -> np.ndarray:
        return np.array([list(p.position) for body in self.thing.bodies for p in body.particles])


def box(world: iota.World) -> iota.Body:
    made = world.system.body(shape=iota.Box((0.3, 0.2, 0.4)), mass=2, position=(0, 9, 0))
    made.angular_velocity = (1, 0, 2)
    return made


def hung(maker: Callable[..., iota.Body]) -> Callable[[iota.World], iota.Body]:
    return lambda world: maker(world, iota.Vec3(0, 3.4, 0), "#888888", 1)


def test_what_was_falling_lies_on_the_ground_when_somebody_comes() -> None:
    place = Place(box)
    place.freeze()
    assert place.root.position.y > 5
    place.run(3.0)
    assert place.root.position.y > 5, "nobody sees it"
    place.eye[2] = 20.0
    place.run(0.1)
    assert place.root.position.y == pytest.approx(0.1, abs=2e-3) and abs(place.root.velocity) < 1e-3
    assert place.system.validate() == [] and place.system.energy.made == 0
    assert len(place.root.solids) == 1


@pytest.mark.parametrize("maker", [crowd.chain, crowd.ladder, crowd.acrobat])
@pytest.mark.parametrize("seconds", [0.5, 1.5])
def test_what_swung_has_swung_on_with_its_energy(maker: Callable[..., iota.Body], seconds: float) -> None:
    place, twin = Place(hung(maker)), Place(hung(maker))
    for each in (place, twin):
        each.run(0.5)
    before = place.system.energy
    assert catch_up(place.system, place.thing.bodies, seconds)
    twin.run(seconds)
    energy, wanted = place.system.energy, twin.system.energy
    assert energy.total <= before.total + 1e-3 * before.kinetic
    assert energy.total == pytest.approx(wanted.total, abs=0.1 * before.kinetic)
    # Of 2 m, and of several rods that swing: its phase.
    assert np.abs(place.places() - twin.places()).max() < 0.15
    assert place.system.validate() == []


def test_what_is_seen_frozen_stays_where_it_is_seen() -> None:
    place = Place(box)
    place.eye[2] = 20.0
    place.freeze()
    start = place.places()
    for distance in (18.0, 12.0, 6.0):
        place.eye[2] = distance
        place.run(0.5)
        if place.thing.level.name == "frozen":
            assert np.array_equal(place.places(), start)
    place.eye[2] = 200.0
    place.run(0.2)
    place.eye[2] = 20.0
    place.run(0.1)
    assert np.abs(place.places() - start).max() < 0.9, "of the time out of sight alone"


def test_a_jump_beside_it_finds_what_has_happened() -> None:
    place = Place(box)
    place.freeze()
    place.run(3.0)
    place.eye[:] = [0.0, 1.0, 1.0]
    place.run(DT)
    assert place.thing.level.name == "full"
    assert place.root.position.y < 0.2


def test_what_lies_still_is_within_a_millimeter() -> None:
    place = Place(box, iota.Material(friction=0.5))
    place.root.set_pose((0, 0.1, 0))
    place.root.velocity = place.root.angular_velocity = (0, 0, 0)
    place.run(1.0)
    place.freeze()
    start = place.places()
    place.run(2.0)
    place.eye[2] = 20.0
    place.run(0.2)
    assert np.abs(place.places() - start).max() < 1e-3


def test_what_cannot_be_copied_goes_on_from_where_it_was() -> None:
    place = Place(box)
    lower = place.system.body(shape=iota.Box((1, 1, 1)), mass=5, position=(0, 30, 0))
    assert catch_up(place.system, [place.root], 0.1)
    place.system.field("wind", velocity=(1, 0, 0), drag=0.1)
    start = place.places()
    assert not catch_up(place.system, [place.root], 1.0)
    assert np.array_equal(place.places(), start) and lower.position.y == 30
    hinge = Place(box)
    hinge.system.revolute(hinge.root, at=(0, 9, 0), axis=(0, 0, 1), motor=(1, 5))
    other = hinge.world.levels.manage(hinge.system.body(shape=iota.Sphere(0.1), mass=1, position=(9, 9, 9)))
    assert other.can_catch_up


def test_its_work_is_bounded() -> None:
    place = Place(hung(crowd.ladder))
    place.run(0.2)
    steps: list[float] = []
    step = iota.System.step

    class Counted:
        def __call__(self, system: iota.System, dt: float) -> iota.types.StepReport:
            steps.append(dt)
            return step(system, dt)

    copy = catching_up._Copy(place.system, place.thing.bodies, 1e6)
    counted = Counted()
    for _ in range(3):
        counted(copy.system, catching_up.LONGEST)
    assert len(steps) == 3
    assert catch_up(place.system, place.thing.bodies, 1e6), "as after a few seconds"
    assert math.isfinite(place.system.energy.total) and place.system.validate() == []


def test_what_is_replayed_has_the_same_bits() -> None:
    place = Place(box)
    place.system.start_recording()
    place.freeze()
    place.run(1.0)
    place.eye[2] = 20.0
    place.run(0.1)
    recording = place.system.stop_recording()
    assert iota.System().replay(recording) is None


@pytest.mark.parametrize("value", [-1, float("nan"), float("inf")])
def test_a_sight_is_a_length(value: float) -> None:
    with pytest.raises(ValueError, match="sight must be a length"):
        iota.World(iota.System()).levels.sight = value
