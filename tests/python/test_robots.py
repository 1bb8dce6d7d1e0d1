# SPDX-License-Identifier: Apache-2.0
"""Robots from files move as MuJoCo moves them: friction, actuators, rotors, loops."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import iota
import iota.shapelib as shapelib
from iota.builder import Actuator, Realized, Structure

mujoco = pytest.importorskip("mujoco")

Write = Callable[[str, str], Path]
STIFF = 'solref="0.0004 1" solimp="0.9999 0.9999 0.001"'
OPTION = '<option timestep="0.0002" integrator="implicitfast" cone="elliptic"/>'
TWO_ARMS = """<mujoco><worldbody><body name="arm" pos="0 0 1"><joint name="j" axis="0 1 0" damping="0.1" {joint}/>
  <geom type="capsule" fromto="0 0 0 0.5 0 0" size="0.03" density="800"/>
  <body name="lower" pos="0.5 0 0"><joint name="k" axis="0 1 0" damping="0.1"/>
    <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.03" density="800"/></body></body></worldbody>
  <actuator>{actuators}</actuator></mujoco>"""
BLOCK = """<mujoco><worldbody><geom type="box" size="5 1 0.1" pos="0 0 -0.1" friction="{floor}" {more}/>
  <body name="body" pos="0 0 0.1"><freejoint/><geom type="{shape}" size="0.1 0.1 0.1" friction="{own}" {more}/></body></worldbody></mujoco>"""


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def write_file(name: str, text: str) -> Path:
        path = tmp_path / name
        path.write_text(text)
        return path

    return write_file


class Twins:
    """A model in MuJoCo and here."""

    def __init__(self, path: Path, text: str) -> None:
        self.model = mujoco.MjModel.from_xml_string(text.replace("<mujoco>", f"<mujoco>{OPTION}"))
        self.state = mujoco.MjData(self.model)
        path.write_text(text)
        self.found = shapelib.mechanism(path)
        self.system = iota.System()
        self.made: Realized = self.found.realize(self.system)

    def control(self, **values: float) -> Twins:
        for name, value in values.items():
            self.state.ctrl[self.model.actuator(name).id] = value
            self.made[name].control = value
        return self

    def run(self, seconds: float, rate: int = 240) -> Twins:
        for _ in range(round(seconds * rate)):
            report = self.system.step(1 / rate)
            assert report.worst_gap < 1e-7
        mujoco.mj_step(self.model, self.state, round(seconds / self.model.opt.timestep))
        return self

    def apart(self, *bodies: str) -> float:
        """Largest distance of the centers of mass, m."""
        worst = 0.0
        for name in bodies:
            x, y, z = self.state.xipos[self.model.body(name).id]
            worst = max(worst, (self.made[name].center_of_mass - (x, z, -y)).length)
        return worst


def twins(tmp_path: Path, text: str) -> Twins:
    return Twins(tmp_path / "robot.xml", text)


# --- joints -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("joint", "near"),
    [
        ('damping="0.3"', 5e-4),
        ('frictionloss="0.8" solreffriction="0.0004 1" solimpfriction="0.9999 0.9999 0.001"', 2e-3),
        ('armature="0.2"', 5e-4),
        ('stiffness="4" springref="40" damping="0.2"', 5e-4),
    ],
)
def test_a_hinge_has_the_damping_friction_rotor_and_spring_of_its_file(tmp_path: Path, joint: str, near: float) -> None:
    text = TWO_ARMS.format(joint=joint, actuators="").replace('damping="0.1" ', "", 1)
    pair = twins(tmp_path, text).run(0.5)
    assert pair.apart("arm", "lower") < near
    assert pair.state.xipos[1][2] < 0.95  # it fell


def test_the_rotor_of_a_slide_is_heavy_but_has_no_weight(tmp_path: Path) -> None:
    text = '<mujoco><worldbody><body name="b"><joint name="s" type="slide" axis="0 0 1" armature="3"/><geom size="0.1" mass="1"/></body></worldbody></mujoco>'
    pair = twins(tmp_path, text).run(0.5)
    assert pair.made["s"].slide.value == pytest.approx(-0.5 * 9.81 / 4 * 0.25, rel=1e-4)
    larger = shapelib.mechanism(tmp_path / "robot.xml", scale=2.0)
    system = iota.System(gravity=(0, -2 * 9.81, 0))
    made = larger.realize(system)
    for _ in range(120):
        system.step(1 / 240)
    assert made["s"].slide.value == pytest.approx(2 * pair.made["s"].slide.value, rel=1e-6)


def test_gravcomp_takes_a_share_of_the_weight_off(tmp_path: Path) -> None:
    text = TWO_ARMS.format(joint="", actuators="").replace('<body name="lower"', '<body name="lower" gravcomp="0.75"')
    pair = twins(tmp_path, text).run(0.5)
    assert pair.apart("arm", "lower") < 3e-4
    other = iota.System()
    pair.found.realize(other)
    pair.found.realize(other)
    assert len(other.fields) == 2 * len(pair.system.fields)


# --- actuators ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("actuators", "joint", "near"),
    [
        ('<motor name="m" joint="j" gear="5" ctrlrange="-2 2"/><motor name="n" joint="k" gear="-2" forcerange="-1 1"/>', "", 4e-3),
        ('<position name="m" joint="j" kp="60" kv="6"/><position name="n" joint="k" kp="30" kv="2" gear="2"/>', "", 2e-4),
        ('<velocity name="m" joint="j" kv="20"/><velocity name="n" joint="k" kv="8"/>', "", 2e-4),
        ('<position name="m" joint="j" kp="60" kv="6"/><motor name="n" joint="j" gear="3"/>', "", 2e-4),
        ('<general name="m" joint="j" gainprm="50" biastype="affine" biasprm="2 -50 -5"/><motor name="n" tendon="t" gear="0.5"/>', 'ref="20"', 3e-4),
    ],
)  # fmt: skip
def test_actuators_drive_two_arms_as_in_mujoco(tmp_path: Path, actuators: str, joint: str, near: float) -> None:
    text = TWO_ARMS.format(joint=joint, actuators=actuators)
    tendon = '<tendon><fixed name="t"><joint joint="j" coef="1"/><joint joint="k" coef="-2"/></fixed></tendon></mujoco>'
    pair = twins(tmp_path, text.replace("</mujoco>", tendon)).control(m=-0.8, n=1.0).run(0.5)
    assert pair.apart("arm", "lower") < near
    assert not any("actuator" in note for note in pair.found.notes)


def test_a_force_stays_within_its_range_in_a_world(tmp_path: Path) -> None:
    actuators = '<position name="m" joint="j" kp="60" kv="6" forcerange="-20 20"/><velocity name="n" joint="k" kv="8" forcerange="-4 4"/>'
    pair = twins(tmp_path, TWO_ARMS.format(joint="", actuators=actuators))
    pair.system = iota.System()
    world = iota.World(pair.system, dt=1 / 240, ground=None)
    pair.made = pair.found.realize(pair.system, world)
    pair.control(m=-0.8, n=1.0)
    assert pair.made["m"].force == -20
    for _ in range(120):
        world.step()
    mujoco.mj_step(pair.model, pair.state, 2500)
    assert pair.apart("arm", "lower") < 0.01


def test_a_servo_with_a_range_of_force_reaches_its_target_without_a_world(tmp_path: Path) -> None:
    pair = twins(
        tmp_path,
        TWO_ARMS.format(joint="", actuators='<position name="m" joint="j" kp="60" kv="6" forcerange="-20 20"/>'),
    )
    servo = pair.made["m"]
    servo.control = -0.8
    assert servo.force == -20
    for _ in range(240):
        pair.system.step(1 / 240)
        assert abs(pair.made["j"].angle.efforts["motor"]) <= 20 * (1 + 1e-9)
    assert pair.made["j"].angle.value == pytest.approx(-0.8, abs=0.02)


def test_an_intvelocity_actuator_moves_at_its_control_up_to_its_range(tmp_path: Path) -> None:
    pair = twins(
        tmp_path,
        TWO_ARMS.format(
            joint="",
            actuators='<intvelocity name="m" joint="j" kp="900" kv="40" forcerange="-90 90" actrange="-0.3 1"/>',
        ),
    )
    pair.control(m=-1.0).run(0.25)
    assert pair.made["j"].angle.value == pytest.approx(-0.25, abs=0.02)
    assert float(pair.state.qpos[0]) == pytest.approx(-0.25, abs=0.08)  # it gives way
    pair.run(0.5)
    assert pair.made["j"].angle.value == pytest.approx(-0.3, abs=0.02)


def test_controls_are_clipped_and_must_be_numbers(tmp_path: Path) -> None:
    pair = twins(tmp_path, TWO_ARMS.format(joint="", actuators='<motor name="j" joint="j" ctrlrange="-2 3"/>'))
    motor = pair.made["j actuator"]  # the joint has the name
    assert motor.joints == [pair.made["j"]] and motor.control_range == (-2, 3) and motor.control == 0
    motor.control = 7
    assert motor.control == 3 and motor.force == 3 and "j actuator" in repr(motor)
    with pytest.raises(ValueError, match=r'the control of the actuator "j actuator" must be finite, not nan'):
        motor.control = math.nan
    with pytest.raises((TypeError, ValueError)):
        motor.control = "fast"
    assert motor.control == 3
    motor.control = 0
    assert pair.made["j"].angle.motor is None


def test_actuators_that_have_no_counterpart_are_noted(write: Write) -> None:
    actuators = """<muscle name="muscle" joint="j" lengthrange="0 1"/><damper name="damper" joint="j" kv="1" ctrlrange="0 1"/>
      <position name="lagging" joint="j" kp="3" timeconst="0.1"/><motor name="thruster" site="s"/><motor name="cable" tendon="t"/>
      <position name="sum" tendon="u" kp="3"/><intvelocity name="speed" joint="j" kp="3"/><motor name="ball" joint="b"/><motor name="none" joint="j" gear="0"/>"""
    more = """<body name="c" pos="0 3 0"><joint name="b" type="ball"/><geom size="0.1"/><site name="s"/></body><site name="p"/></worldbody>
      <tendon><spatial name="t"><site site="s"/><site site="p"/></spatial><fixed name="u"><joint joint="j" coef="1"/><joint joint="k" coef="1"/></fixed></tendon>"""
    text = TWO_ARMS.format(joint="", actuators=actuators).replace("</worldbody>", more)
    found = shapelib.mechanism(write("rest.xml", text))
    state = "is a muscle, a damper or of another kind with a state or a gain of its own: left out"
    for note in (
        f"the actuator muscle {state}", f"the actuator damper {state}", "the lag of the actuator lagging is left out",
        "the actuator thruster drives no joint: left out", "the actuator cable drives a tendon in space: left out",
        "the actuator sum holds a sum of joints: left out", "the actuator ball drives a ball or free joint: left out",
        "the actuator speed sets a speed of j, which has other actuators: left out", "the actuator none has a gear of 0: left out",
    ):  # fmt: skip
        assert note in found.notes, found.notes
    assert [actuator.name for actuator in found.actuators] == ["lagging"]
    assert found.problems() == []
    off = shapelib.mechanism(
        write("off.xml", text.replace("<mujoco>", '<mujoco><option><flag actuation="disable"/></option>'))
    )
    assert off.actuators == []


def test_an_actuator_of_a_joint_that_does_not_exist_is_refused_with_its_line(write: Write) -> None:
    with pytest.raises(shapelib.FileError, match="line 5"):
        shapelib.mechanism(write("missing.xml", TWO_ARMS.format(joint="", actuators='<motor joint="nowhere"/>')))


@pytest.mark.parametrize(
    ("joint", "actuators", "error"),
    [
        ('armature="-1"', "", "the armature of joint j must be finite and not negative"),
        ('armature="nan"', "", "the armature of joint j must be finite and not negative"),
        ("", '<motor name="m" joint="j" gear="nan"/>', "the gear of actuator m must be finite"),
        ("", '<position joint="k" kp="inf"/>', "the gainprm of actuator 0 must be finite"),
        ('/><geom size="0.1" friction="-1 0 0"', "", "the friction of geom 0 must be finite and not negative"),
    ],
)
def test_numbers_that_no_robot_can_have_are_refused(write: Write, joint: str, actuators: str, error: str) -> None:
    with pytest.raises(shapelib.FileError, match=error):
        shapelib.mechanism(write("rubbish.xml", TWO_ARMS.format(joint=joint, actuators=actuators)))


def test_the_range_of_a_joint_limits_what_its_actuator_gives(write: Write) -> None:
    motor = '<motor name="m" joint="j" gear="-2" forcerange="1 2"/>'
    for joint, ends in (("", (1, 2)), ('actuatorfrcrange="-3 3"', (1, 1.5)), ('actuatorfrcrange="0 0.5"', (0, 0))):
        found = shapelib.mechanism(write("limited.xml", TWO_ARMS.format(joint=joint, actuators=motor)))
        assert found.actuators[0].force_range == pytest.approx(ends) and found.notes == []


def test_structures_with_actuators_are_saved_copied_merged_and_checked(system: iota.System) -> None:
    arm = Structure()
    body = arm.body(shape=iota.Box((1, 0.1, 0.1)), mass=1, position=(0.5, 0, 0), material={"friction": 0.3}, lift=0.5)
    arm.joint("revolute", body, at=(0, 0, 0), axis=(0, 0, 1), name="hinge")
    arm.actuator(
        (0, "angle", 1.0), gain=20.0, stiffness=20.0, damping=1.0, control_range=(-2, 2), control=0.5, name="servo"
    )
    both = Structure()
    both.merge(arm.copy(), "left ")
    both.merge(arm + (0, 2, 0), "right ")
    again = Structure.from_json(both.to_json())
    assert again.actuators[1].terms[0][0] == 1 and again.actuators[1].name == "right servo"
    made = again.realize(system)
    assert made.bodies[1].material == iota.Material(friction=0.3)
    assert made["right hinge"].angle.spring == (20, 1, 0.5) and made.actuators[0] is made["left servo"]
    for wrong, text in (
        ({"gain": math.nan}, "gain must be finite, not nan"),
        ({"stiffness": -1.0}, "stiffness must be finite and at least 0, not -1"),
        ({"control_range": (1.0, -1.0)}, "control_range must be two numbers, the lower one first"),
        ({"force_range": (math.nan, 1.0)}, "force_range must be two numbers"),
        ({"law": "wish"}, "law must be one of force, speed, target, not 'wish'"),
        ({"law": "speed"}, "needs a finite force_range"),
        ({"terms": [(7, "angle", 1.0)]}, "there is no joint 7, only 1 joints"),
        ({"terms": [(0, "twist", 1.0)]}, "a coordinate must be one of"),
        ({"terms": [(0, "angle", 0.0)]}, "a ratio must be finite and not 0"),
        ({"terms": []}, "drives no joint"),
    ):
        arm.actuators = [Actuator(**({"terms": [(0, "angle", 1.0)], "name": "servo"} | wrong))]
        assert text in " ".join(arm.problems()), wrong
    arm.actuators = [Actuator([(0, "angle", 1.0)], law="target", force_range=(-1, 1)), Actuator([(0, "angle", 1.0)])]
    assert "has no other actuator" in " ".join(arm.problems())


@pytest.mark.parametrize(("low", "high"), [(1, 4), (-8, -2), (0, 3)])
def test_a_range_of_force_without_0_pushes_against_the_spring_of_its_law(
    tmp_path: Path, low: float, high: float
) -> None:
    servo = f'<position name="m" joint="j" kp="40" kv="3" forcerange="{low} {high}"/>'
    pair = Twins(tmp_path / "robot.xml", TWO_ARMS.format(joint="", actuators=servo))
    pair.system = iota.System()
    world = iota.World(pair.system)
    pair.made = pair.found.realize(pair.system, world=world)
    pair.control(m=0.8)
    for _ in range(60):
        world.step()
    mujoco.mj_step(pair.model, pair.state, round(pair.system.time / pair.model.opt.timestep))
    assert pair.apart("arm", "lower") < 3e-3


def test_a_range_of_a_joint_that_its_actuators_share_is_noted(write: Write) -> None:
    motors = '<motor name="m" joint="j"/><motor name="n" joint="j"/>'
    found = shapelib.mechanism(write("two.xml", TWO_ARMS.format(joint='actuatorfrcrange="-2 6"', actuators=motors)))
    note = "the actuatorfrcrange of j is that of each of its 2 actuators, and not of their sum"
    assert found.notes == [note]


@pytest.mark.parametrize(
    ("before", "after", "what"),
    [
        ('pos="0 0 1"', 'pos="nan 0 1"', "pos of body arm"),
        ('pos="0 0 1"', 'gravcomp="nan"', "gravcomp of body arm"),
        ('axis="0 1 0"', 'axis="nan 1 0"', "axis of joint j"),
        ('damping="0.1"', 'range="nan 1" limited="true"', "range of joint j"),
        ('damping="0.1"', 'ref="nan"', "ref of joint j"),
        ('damping="0.1"', 'stiffness="1" springref="inf"', "springref of joint j"),
        ('damping="0.1"', 'frictionloss="nan"', "frictionloss of joint j"),
        ('damping="0.1"', 'damping="-1"', "damping of joint j"),
    ],
)
def test_numbers_that_mujoco_takes_and_nothing_can_have_are_refused(
    write: Write, before: str, after: str, what: str
) -> None:
    text = TWO_ARMS.format(joint="", actuators="").replace(before, after, 1)
    with pytest.raises(shapelib.FileError, match=f"the {what} must be finite"):
        shapelib.mechanism(write("wrong.xml", text))


def test_a_sum_of_no_joints_holds_nothing(write: Write) -> None:
    tendon = '<tendon><fixed name="t" range="-1 1"><joint joint="j" coef="0"/></fixed></tendon>'
    equality = '<equality><tendon tendon1="t"/></equality></mujoco>'
    text = TWO_ARMS.format(joint="", actuators="").replace("</mujoco>", tendon + equality)
    system = iota.System()
    shapelib.mechanism(write("none.xml", text)).realize(system)
    assert [joint.kind for joint in system.constraints] == ["revolute", "revolute"]


# --- friction -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("floor", "own", "more"), [(0.3, 0.3, ""), (0.2, 0.5, ""), (0.9, 0.4, ""), (0.3, 0.3, 'condim="1"')]
)
def test_a_block_slides_as_far_as_in_mujoco(tmp_path: Path, floor: float, own: float, more: str) -> None:
    pair = twins(tmp_path, BLOCK.format(floor=floor, own=own, more=more, shape="box"))
    pair.state.qvel[0] = 2
    pair.made["body"].velocity = (2, 0, 0)
    assert pair.run(0.5, 120).apart("body") < 2e-3


def test_the_friction_of_a_geom_with_priority_counts_alone(write: Write) -> None:
    text = BLOCK.format(floor=0.9, own=0.4, more="", shape="box").replace(
        "<freejoint/><geom", '<freejoint/><geom priority="1"'
    )
    found = shapelib.mechanism(write("priority.xml", text))
    by_name = {body.name: body.material for body in found.bodies}
    assert by_name["body"]["friction"] * by_name["world"]["friction"] == pytest.approx(0.4**2)


def test_a_ball_rolls_to_a_stop_and_stops_spinning(tmp_path: Path) -> None:
    """Torques in MuJoCo: N times 1 mm against rolling, 4 mm against spinning."""
    text = BLOCK.format(floor="0.8 0.004 0.001", own="0.8 0.004 0.001", more='condim="6"', shape="sphere")
    pair = twins(tmp_path, text)
    pair.state.qvel[0], pair.state.qvel[4] = 1, 10
    pair.made["body"].velocity, pair.made["body"].angular_velocity = (1, 0, 0), (0, 0, -10)
    assert pair.run(0.5, 120).apart("body") < 2e-3
    assert pair.made["body"].velocity.x == pytest.approx(1 - 5 / 7 * 0.01 * 9.81 * 0.5, abs=1e-3)
    pair.made["body"].velocity, pair.made["body"].angular_velocity = (0, 0, 0), (0, 10, 0)
    for _ in range(60):
        pair.system.step(1 / 120)
    assert pair.made["body"].angular_velocity.y == pytest.approx(10 - 2.5 * 0.04 * 9.81 / 0.1 * 0.5, rel=0.01)


def test_geoms_of_different_friction_are_noted(write: Write) -> None:
    text = BLOCK.format(floor=1, own=0.4, more="", shape="box").replace(
        "</worldbody>",
        '<body><freejoint/><geom size="0.1" friction="2"/><geom size="0.2" friction="0.1"/></body><geom type="plane" size="1 1 1" friction="0.7"/></worldbody>',
    )
    notes = " ".join(shapelib.mechanism(write("mixed.xml", text)).notes)
    assert "the geoms of body 2 differ in friction: all have the largest, 4" in notes
    assert "moving bodies have frictions of 1 to 4: between two of them the geometric mean acts" in notes
    assert "world.scene.ground_body.material = iota.Material(friction=0.7)" in notes


# --- loops and ropes ----------------------------------------------------------------------------------------------------

LOOSE = """<mujoco><worldbody>
  <body name="a" pos="0 0 1"><joint name="ja" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0.5 0 0" size="0.03"/></body>
  <body name="b" pos="0 1 1"><joint name="jb" axis="0 1 0" damping="0.2"/><geom type="capsule" fromto="0 0 0 0.3 0 0.2" size="0.03"/></body>
  <body name="c" pos="0.5 0.2 1"><freejoint/><geom type="box" size="0.1 0.05 0.07"/></body></worldbody>
  <tendon><fixed name="t"><joint joint="ja" coef="1"/><joint joint="jb" coef="2"/></fixed></tendon><equality>{}</equality></mujoco>"""


@pytest.mark.parametrize(
    "equality",
    [
        f'<connect body1="a" body2="c" anchor="0.5 0 0" {STIFF}/>',
        f'<weld body1="a" body2="c" {STIFF}/>',
        f'<joint joint1="ja" joint2="jb" polycoef="0 0.5 0 0 0" {STIFF}/>',
        f'<joint joint1="ja" {STIFF}/>',
        f'<tendon tendon1="t" {STIFF}/>',
    ],
)
def test_equalities_hold_as_in_mujoco(tmp_path: Path, equality: str) -> None:
    assert twins(tmp_path, LOOSE.format(equality)).run(0.5, 240).apart("a", "b", "c") < 6e-4


def stewart() -> str:
    legs, closings, servos = "", "", ""
    for leg in range(6):
        t, u = (math.radians(120 * (leg // 2) + (by if leg % 2 else -by)) for by in (20, 50))
        foot = np.array((0.5 * math.cos(t), 0.5 * math.sin(t), 0.1))
        half = (np.array((0.3 * math.cos(u), 0.3 * math.sin(u), 0.7)) - foot) / 2
        at, along = (" ".join(map(str, v)) for v in (foot, half))
        legs += f"""<body name="lower{leg}" pos="{at}"><joint type="ball"/><geom type="capsule" fromto="0 0 0 {along}" size="0.015"/>
          <body name="upper{leg}" pos="{along}"><joint name="slide{leg}" type="slide" axis="{along}" damping="20"/>
          <geom type="capsule" fromto="0 0 0 {along}" size="0.01"/></body></body>"""
        closings += f'<connect body1="upper{leg}" body2="plate" anchor="{along}" {STIFF}/>'
        servos += f'<position name="leg{leg}" joint="slide{leg}" kp="4000" kv="200"/>'
    return f"""<mujoco><default><geom contype="0" conaffinity="0"/></default><worldbody><body name="plate" pos="0 0 0.7"><freejoint/>
      <geom type="cylinder" size="0.3 0.02" density="600"/></body>{legs}</worldbody><equality>{closings}</equality><actuator>{servos}</actuator></mujoco>"""


def test_a_stewart_platform_is_moved_by_its_six_servos_as_in_mujoco(tmp_path: Path) -> None:
    pair = twins(tmp_path, stewart()).control(**{f"leg{leg}": 0.05 * (leg % 3) - 0.03 for leg in range(6)})
    pair.run(0.25, 120)
    assert pair.apart("plate", *(f"upper{leg}" for leg in range(6))) < 1e-3
    assert abs(pair.made["slide2"].slide.value) > 0.02


def test_a_tendon_over_three_sites_is_a_rope_on_which_a_load_swings(tmp_path: Path) -> None:
    text = """<mujoco><worldbody><site name="p" pos="-0.3 0 2"/><site name="q" pos="0.3 0 2"/>
      <body name="load" pos="0 0 1"><freejoint/><geom size="0.05" density="2000"/><site name="l" pos="0 0 0.05"/></body></worldbody>
      <tendon><spatial name="rope" limited="true" range="0 2.2" solreflimit="0.0004 1" solimplimit="0.9999 0.9999 0.001">
      <site site="p"/><site site="l"/><site site="q"/></spatial></tendon></mujoco>"""
    pair = twins(tmp_path, text)
    assert len(pair.found.ties) == 1 and len(pair.found.ties[0].over) == 1
    pair.state.qvel[0] = 0.8
    pair.made["load"].velocity = (0.8, 0, 0)
    assert pair.run(0.5).apart("load") < 2e-3


# --- URDF ---------------------------------------------------------------------------------------------------------------

INERTIA = '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial>'
DRIVEN = """<robot name="r"><link name="base"/>
  <link name="arm"><contact><lateral_friction value="0.3"/><stiffness value="5"/></contact>{inertia}<collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="rail">{inertia}<collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="j" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="10" velocity="2"/></joint>
  <joint name="k" type="prismatic"><parent link="base"/><child link="rail"/><origin xyz="0 1 0"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="{effort}" velocity="0.5"/></joint>
  <gazebo reference="rail"><mu1>{mu}</mu1><mu2>0.9</mu2></gazebo>
  <transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="j"><hardwareInterface>hardware_interface/PositionJointInterface</hardwareInterface></joint>
    <actuator name="servo"><mechanicalReduction>50</mechanicalReduction></actuator></transmission>
  <transmission name="u"><joint name="{joint}"><hardwareInterface>EffortJointInterface</hardwareInterface></joint></transmission></robot>"""


def driven(**changes: Any) -> str:
    return DRIVEN.format(**({"inertia": INERTIA, "effort": 20, "mu": 0.7, "joint": "k"} | changes))


def test_friction_and_transmissions_of_a_urdf_are_taken(write: Write) -> None:
    found = shapelib.mechanism(write("driven.urdf", driven()))
    assert {body.name: body.material for body in found.bodies if body.material} == {
        "arm": {"friction": 0.3},
        "rail": {"friction": 0.7},
    }
    assert found.notes == ["<stiffness> in <contact> is left out (line 2)", "<mu2> in <gazebo> is left out (line 6)"]
    system = iota.System()
    made = found.realize(system)
    made["servo"].control = 0.5
    made["u"].control = 99  # at most 20 N
    system.step(1 / 240)
    assert made["rail"].velocity.x == pytest.approx(20 / 240, rel=1e-6)
    assert abs(made["arm"].angular_velocity.y) < 2  # the largest speed of the servo
    for _ in range(240):
        system.step(1 / 240)
    assert made["j"].angle.value == pytest.approx(0.5, abs=1e-3) and made["k"].slide.value == pytest.approx(1)


@pytest.mark.parametrize(
    ("changes", "note"),
    [
        ({"joint": "nowhere"}, "1 <transmission> is left out: u drives nowhere, which is no joint with a coordinate of its own (line 9)"),
        ({"joint": "j"}, "1 <transmission> is left out: u drives j, which another one drives (line 9)"),
    ],
)  # fmt: skip
def test_a_transmission_that_fits_no_joint_is_noted(write: Write, changes: dict[str, Any], note: str) -> None:
    found = shapelib.mechanism(write("wrong.urdf", driven(**changes)))
    assert note in found.notes and [each.name for each in found.actuators] == ["servo"]


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"mu": -1}, "line 6: the friction of the link rail must not be negative, not -1"),
        ({"mu": "nan"}, "line 6: mu1 must be finite"),
        ({"mu": "much"}, "line 6: mu1 must be a number"),
        ({"effort": -3}, "line 5: the largest effort and speed of k must not be negative"),
    ],
)
def test_frictions_and_efforts_that_cannot_be_are_refused_with_their_line(
    write: Write, changes: dict[str, Any], error: str
) -> None:
    with pytest.raises(shapelib.FileError) as refused:
        shapelib.mechanism(write("wrong.urdf", driven(**changes)))
    assert error in str(refused.value)


def test_a_joint_that_mimics_another_0_times_stays_at_its_offset(write: Write) -> None:
    mimic = '<mimic joint="j" multiplier="0" offset="0.25"/></joint>\n  <gazebo'
    text = driven(joint="j").replace("</joint>\n  <gazebo", mimic)
    system = iota.System()
    made = shapelib.mechanism(write("still.urdf", text)).realize(system)
    start = made["rail"].position.x
    made["rail"].velocity = (3, 0, 0)
    for _ in range(60):
        system.step(1 / 240)
    assert made["rail"].position.x == pytest.approx(start, abs=1e-6)


def test_a_negative_damping_of_a_urdf_is_refused(write: Write) -> None:
    text = driven().replace("</joint>\n  <gazebo", '<dynamics damping="-1"/></joint>\n  <gazebo')
    with pytest.raises(shapelib.FileError, match="line 5: the damping and the friction of k must not be negative"):
        shapelib.mechanism(write("wrong.urdf", text))
