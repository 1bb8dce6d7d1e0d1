# SPDX-License-Identifier: Apache-2.0
"""The derrick: forces in its ropes against statics, and what winch, sheets and brake do."""

from __future__ import annotations

import math

import pytest

import iota
from iota.studies import rigging


class Rig:
    """A derrick that a test drives."""

    def __init__(self) -> None:
        self.world = rigging.make_world()
        self.derrick = rigging.Derrick(self.world)
        self.winch, self.peak, self.swing = 0.0, rigging.PEAK, rigging.SWING

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / self.world.dt)):
            self.derrick.drive(self.winch, self.peak, self.swing)
            self.world.step()

    def mean(self, name: str, seconds: float = 1.0) -> float:
        """The mean force in a rope, N."""
        forces = []
        for _ in range(round(seconds / self.world.dt)):
            self.run(self.world.dt)
            forces.append(self.derrick.tension(name))
        return sum(forces) / len(forces)


@pytest.fixture
def rig() -> Rig:
    return Rig()


@pytest.mark.parametrize("parts", rigging.PARTS)
def test_the_force_at_the_winch_is_the_weight_by_the_parts_of_the_tackle(rig: Rig, parts: int) -> None:
    rig.derrick.reeve(parts)
    rig.run(3.0)
    weight = (rigging.CRATE + rigging.BLOCK) * 9.81
    assert rig.mean("tackle") == pytest.approx(weight / parts, rel=5e-3)
    drum = rig.derrick.drum.angle.effort / rigging.DRUM
    assert abs(drum) == pytest.approx(weight / parts, rel=0.02)


@pytest.mark.parametrize("parts", [1, 4])
def test_the_load_rises_by_the_rope_of_the_winch_divided_by_the_parts(rig: Rig, parts: int) -> None:
    rig.derrick.reeve(parts)
    rig.run(1.0)
    height, angle = rig.derrick.crate.position.y, rig.derrick.drum.angle.value
    rig.winch = 0.5
    rig.run(2.0)
    turned = rig.derrick.drum.angle.value - angle
    assert turned == pytest.approx(0.8 * 2.0 - 0.16, rel=0.01)  # it needs 0.4 s to be so fast
    assert rig.derrick.crate.position.y - height == pytest.approx(turned * rigging.DRUM / parts, rel=0.03)


def test_the_lift_carries_what_the_moments_about_the_heel_of_the_boom_say(rig: Rig) -> None:
    rig.run(4.0)
    d = rig.derrick
    tip, head = d.tip.position - rigging.HEEL, d.head.position - rigging.HEEL
    weight = (rigging.CRATE + rigging.BLOCK) * 9.81
    # The rope of the tackle runs along the boom to its heel: only weights and the lift have moments.
    moment = tip.x * weight + 0.5 * tip.x * d.boom.mass * 9.81
    way = (head - tip) * (1 / abs(head - tip))
    expected = moment / abs(tip.x * way.y - tip.y * way.x)
    assert rig.mean("lift") == pytest.approx(expected, rel=0.02)


def test_the_sheet_of_a_side_pulls_the_boom_there(rig: Rig) -> None:
    rig.run(1.0)
    rig.swing = 30
    rig.run(0.5)
    assert rig.mean("starboard") > 1.2 * rig.mean("port")
    rig.run(5.0)
    tip = rig.derrick.tip.position - rigging.HEEL
    assert math.degrees(math.atan2(tip.z, tip.x)) == pytest.approx(30, abs=2)


def test_without_the_brake_the_load_runs_down_and_a_hand_at_the_crank_holds_it(rig: Rig) -> None:
    rig.run(1.0)
    crank = rig.derrick.drum.a
    rig.derrick.is_braked = False
    height = rig.derrick.crate.position.y
    needed = (rigging.CRATE + rigging.BLOCK) * 9.81 / 4 * rigging.DRUM
    for _ in range(240):
        crank.apply_torque(rig.derrick.drum.axis * needed)
        rig.run(rig.world.dt)
    assert rig.derrick.crate.position.y == pytest.approx(height, abs=0.02)
    rig.run(2.0)
    assert rig.derrick.crate.position.y < height - 0.1
    rig.derrick.is_braked = True
    rig.run(1.0)
    low = rig.derrick.crate.position.y
    rig.run(1.0)
    assert rig.derrick.crate.position.y == pytest.approx(low, abs=0.01)


def test_the_story_hoists_swings_and_lowers_and_warns_of_nothing() -> None:
    world = rigging.build()
    crate = next(body for body in world.system.bodies if body.name == "crate")
    heights, sides = [], []
    for _ in range(round(31 / world.dt)):
        report = world.step()
        assert report is not None and not report.warnings
        heights.append(crate.position.y)
        sides.append(crate.position.z)
    assert max(heights) - heights[0] > 0.3 and max(sides) > 0.8 and min(sides) < -0.8
    assert heights[-1] < max(heights) - 0.2


def test_a_reset_and_a_key_begin_anew_with_four_parts() -> None:
    world = rigging.build()
    crate = next(body for body in world.system.bodies if body.name == "crate")
    world.step()
    height = crate.position.y
    for _ in range(700):
        world.step()
    assert crate.position.y > height + 0.02
    world.controls.act("anew")
    world.step()
    assert crate.position.y == pytest.approx(height, abs=1e-3)


def test_a_reset_and_an_undo_bring_back_the_tackle_that_is_read_and_can_be_led_anew() -> None:
    world = rigging.build()
    parts = next(thing for thing in world.drawings.things if getattr(thing, "label", "") == "parts of the tackle")

    def choose(number: int) -> None:
        parts.take(number - 1.0, "", iota.Event(world.system, "change"), world._guard)
        world.step()

    def assert_led(number: int) -> None:
        """There is one tackle, of so many parts, and its label tells its force."""
        for _ in range(480):
            world.step()
        assert [len(each.terms) - 1 for each in world.system.constraints if each.kind == "tackle"] == [number]
        (text,) = (thing.text for thing in world.drawings.things if getattr(thing, "text", "").startswith("tackle "))
        weight = (rigging.CRATE + rigging.BLOCK) * 9.81
        assert float(text.split()[1]) == pytest.approx(weight / number, rel=0.1)

    world.step()
    for number in (3, 1):  # both are gone after the reset
        choose(number)
    world.reset()
    assert_led(4)
    assert parts.value == "4"
    choose(2)
    assert_led(2)
    choose(3)
    world.undo()
    assert_led(2)
