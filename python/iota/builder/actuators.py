# SPDX-License-Identifier: Apache-2.0
"""Actuators of a realized structure: controls that set springs, motors and servos of joints, which act in the engine's steps."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from iota import _core
from iota.builder.parts import Actuator

if TYPE_CHECKING:
    from iota.world import World

# A motor that never reaches this speed, rad/s or m/s, pushes with its largest force.
UNREACHED = 1e4


@dataclass
class _Acts:
    """A share of one actuator in the spring, the constant force, and the motor or servo of a coordinate."""

    stiffness: float = 0.0
    damping: float = 0.0
    pull: float = 0.0  # of the spring, at 0
    push: float = 0.0
    motor: tuple[float, float] | None = None
    servo: tuple[float, ...] | None = None


@dataclass(eq=False)
class DrivenCoordinate:
    """A coordinate of a joint with its actuators. passive: its spring without them. is_followed: whether `follow` is called before
    each step."""

    coordinate: _core.JointCoordinate
    passive: tuple[float, float, float] = (0.0, 0.0, 0.0)
    actuators: list[tuple[ActuatorOnJoint, float]] = field(default_factory=list)
    is_followed: bool = False
    _is_pushed: bool = False
    _sides: list[int] = field(default_factory=list)

    def follow(self) -> None:
        """Updates it where a force is at the end of its range, or is within it again."""
        if self.coordinate.joint.alive and (any(self._sides) or any(each._side() for each, _ in self.actuators)):
            self.update()

    def update(self) -> None:
        self._sides = [each._side() for each, _ in self.actuators]
        stiffness, damping, rest = self.passive
        pull, push, motor, servo = stiffness * rest, 0.0, None, None
        has_spring = False
        for actuator, ratio in self.actuators:
            acts = actuator._acts_on(self, ratio)
            stiffness, damping = stiffness + acts.stiffness, damping + acts.damping
            pull, push = pull + acts.pull, push + acts.push
            motor, servo = acts.motor or motor, acts.servo or servo
            has_spring = has_spring or actuator._data.stiffness > 0 or actuator._data.damping > 0
        if has_spring:
            self.coordinate.spring = (stiffness, damping, pull / stiffness if stiffness > 0 else 0.0)
        if push != 0:
            motor = (math.copysign(UNREACHED, push), abs(push))
        if servo is not None:
            self.coordinate.servo = servo  # type: ignore[assignment]
        elif motor is not None or self._is_pushed:
            self.coordinate.motor = motor
        self._is_pushed = servo is not None or motor is not None


class ActuatorOnJoint:
    """An actuator of a joint, or of a sum of them. Its control acts until it is set again, in the steps of the engine, by the spring
    and the motor of the joint's coordinate, which a script then leaves alone.

    A world that it was realized with keeps its force within its range before each step. Otherwise that is looked at when the control is
    set: where the force is beyond its range, a servo with the largest force acts until the control is set again. Snapshots, rewinding and
    recordings have what it does to the joint, not `control`.

        arm["elbow servo"].control = 0.5
    """

    def __init__(self, data: Actuator, driven: list[tuple[DrivenCoordinate, float]]) -> None:
        self._data, self._driven = data, driven
        self._control = self._clipped(data.control)
        for coordinate, ratio in driven:
            coordinate.actuators.append((self, ratio))

    @property
    def name(self) -> str:
        """Its name in the structure."""
        return self._data.name

    @property
    def joints(self) -> list[_core.Constraint]:
        """The joints that it drives."""
        return [driven.coordinate.joint for driven, _ in self._driven]

    @property
    def control(self) -> float:
        """In the unit of its source: a force, or a target in rad or m, or a speed. Clipped to its range. ValueError for what is not finite."""
        return self._control

    @control.setter
    def control(self, control: float) -> None:
        value = float(control)
        if not math.isfinite(value):
            raise ValueError(f'the control of the actuator "{self.name}" must be finite, not {value}')
        self._control = self._clipped(value)
        for driven, _ in self._driven:
            driven.update()

    @property
    def control_range(self) -> tuple[float, float] | None:
        """Lowest and highest control; None for any."""
        return self._data.control_range

    @property
    def force(self) -> float:
        """At present, along its length, N m or N."""
        if self._data.law != "force":
            driven, ratio = self._driven[0]
            return driven.coordinate.efforts.get("motor", 0.0) / ratio
        force = self._force()
        low, high = self._data.force_range or (force, force)
        return min(max(force, low), high)

    def __repr__(self) -> str:
        return f'<actuator "{self.name}", control {self.control:g}>'

    def _clipped(self, control: float) -> float:
        low, high = self._data.control_range or (control, control)
        return min(max(control, low), high)

    def _offset(self) -> float:
        """Its force where its length and speed are 0."""
        return self._data.gain * self._control + self._data.constant

    def _force(self) -> float:
        """By its law, beyond its range too."""
        length = sum(ratio * driven.coordinate.value for driven, ratio in self._driven)
        speed = sum(ratio * driven.coordinate.speed for driven, ratio in self._driven)
        return self._offset() - self._data.stiffness * length - self._data.damping * speed

    def _may_be_beyond(self) -> bool:
        """Whether its force has a range and changes with the motion."""
        data = self._data
        return data.law == "force" and data.force_range is not None and data.stiffness + data.damping > 0

    def _side(self) -> int:
        """-1 or 1 where its force is held by the lower or upper end of its range, 0 within it."""
        if not self._may_be_beyond() or self._data.force_range is None:
            return 0
        force, (low, high) = self._force(), self._data.force_range
        return int(force > high) - int(force < low)

    def _acts_on(self, driven: DrivenCoordinate, ratio: float) -> _Acts:
        data = self._data
        if data.law != "force":
            return self._moves(ratio)
        force, offset = self._force(), self._offset()
        low, high = data.force_range or (-math.inf, math.inf)
        limit = min(max(force, low), high)
        is_alone = len(driven.actuators) == 1  # a coordinate has one motor, which the forces of others may need
        if data.stiffness == 0 and data.damping == 0:
            return _Acts(push=ratio * limit)
        if limit != force and driven.is_followed:
            if data.damping == 0 or not is_alone or limit * force <= 0:
                return _Acts(push=ratio * limit)
            # It does not go beyond the speed at which its force is 0, as a constant force would in a step.
            still = force + data.damping * ratio * driven.coordinate.speed
            return _Acts(motor=(still / (data.damping * ratio), abs(ratio * limit)))
        if limit != force and is_alone and limit * force <= 0:
            return _Acts(push=ratio * limit)  # against its law, for a range without 0
        if limit != force and is_alone:
            if data.stiffness > 0:
                return _Acts(servo=(offset / (data.stiffness * ratio), abs(ratio * limit)))
            return _Acts(motor=(offset / (data.damping * ratio), abs(ratio * limit)))
        spring = _Acts(ratio * ratio * data.stiffness, ratio * ratio * data.damping)
        if data.stiffness > 0:
            spring.pull = ratio * offset
        else:
            spring.push = ratio * offset
        return spring

    def _moves(self, ratio: float) -> _Acts:
        """By a servo or a motor of its largest force."""
        data = self._data
        assert data.force_range is not None  # as `problems` says
        most = abs(ratio) * max(map(abs, data.force_range))
        top = () if data.top_speed is None else (data.top_speed / abs(ratio),)
        if data.law == "target":
            return _Acts(servo=(self._offset() / ratio, most, *top))
        if data.travel is None or self._control == 0:
            return _Acts(motor=(self._control / ratio, most))
        end = data.travel[1] if self._control > 0 else data.travel[0]
        return _Acts(servo=(end / ratio, most, abs(self._control / ratio)))


def actuate(parts: list[Actuator], joints: list[_core.Constraint], world: World | None) -> list[ActuatorOnJoint]:
    """Makes the actuators of a structure, whose joints are `joints`, and lets them act. world: looks at the ranges of their forces."""
    driven: dict[tuple[int, str], DrivenCoordinate] = {}
    made = []
    for part in parts:
        terms = []
        for joint, name, ratio in part.terms:
            if (joint, name) not in driven:
                coordinate = getattr(joints[joint], name)
                driven[joint, name] = DrivenCoordinate(coordinate, coordinate.spring or (0.0, 0.0, 0.0))
            terms.append((driven[joint, name], ratio))
        made.append(ActuatorOnJoint(part, terms))
    limited = [each for each in driven.values() if any(actuator._may_be_beyond() for actuator, _ in each.actuators)]
    if world is not None and limited:
        for each in limited:
            each.is_followed = True

        def follow() -> None:
            for each in limited:
                each.follow()

        world.on_step(follow)
    for each in driven.values():
        each.update()
    return made
