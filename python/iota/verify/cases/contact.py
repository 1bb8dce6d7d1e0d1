# SPDX-License-Identifier: Apache-2.0
"""Rest, sliding and rolling on obstacles against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import iota
from iota.verify.run import Run

G = 9.81  # m/s2


def _on_a_slope(angle: float, friction: float) -> iota.System:
    """Level ground, and gravity turned instead."""
    system = iota.System(gravity=(G * math.sin(angle), -G * math.cos(angle), 0))
    material = iota.Material(friction=friction)
    system.obstacle(iota.HalfSpace((0, 1, 0)), material=material)
    system.usual_material = material
    return system


def _step(system: iota.System, seconds: float, dt: float) -> None:
    for _ in range(round(seconds / dt)):
        report = system.step(dt)
        assert report.unconverged == 0


def contact(run: Run) -> None:
    """Contact with the ground and with each other.

    Boxes, balls and cylinders on a plane and on each other with Coulomb friction, by rows of the same solve as joints.
    Expected values are closed forms: the way of a sliding box, the speed at which a sliding ball begins to roll, the angles
    at which a box slides and a tower tips, the weight on four corners, the overhang of a stack of blocks, the speeds of a
    ball and of the plank on which it begins to roll, the heights and the time of a bouncing ball, the speeds of balls after
    an impact, the way of a ball against rolling resistance.
    """
    dt = run.size(1 / 240, 1 / 120)
    _sliding(run, dt)
    _rolling(run, dt)
    _slopes(run, dt)
    _resting(run, dt)
    _towers(run, dt)
    _overhang(run, dt)
    _plank(run, dt)
    _bounces(run, dt)
    _impacts(run, dt)
    _rolling_resistance(run, dt)


def _sliding(run: Run, dt: float) -> None:
    for friction in (0.1, 0.5, 1.0):
        system = _on_a_slope(0, friction)
        box = system.body(shape=iota.Box((0.4, 0.1, 0.4)), position=(0, 0.05, 0), velocity=(2, 0, 0))
        _step(system, 2.5, dt)
        way = 2**2 / (2 * friction * G)
        run.near(f"way of a box at 2 m/s, friction {friction}, m", box.center_of_mass.x, way, 1e-3)
        run.at_most(f"its speed afterwards, friction {friction}, m/s", abs(box.velocity), 1e-6)


def _rolling(run: Run, dt: float) -> None:
    speeds: dict[str, list[float]] = {}
    shapes: dict[str, tuple[iota.Shape, float]] = {
        "ball": (iota.Sphere(0.1), 2 / 5),
        "cylinder": (iota.Cylinder(0.1, 0.2), 1 / 2),
    }
    across = (0, math.sqrt(0.5), 0, math.sqrt(0.5))  # the axis along z
    for name, (shape, inertia) in shapes.items():
        system = _on_a_slope(0, 0.3)
        body = system.body(shape=shape, position=(0, 0.1, 0), orientation=across, velocity=(2, 0, 0))
        for _ in range(round(1.5 / dt)):
            system.step(dt)
            speeds.setdefault(name, []).append(body.velocity.x)
        run.near(f"speed of a {name} that slid at 2 m/s and rolls, m/s", speeds[name][-1], 2 / (1 + inertia), 1e-4)
        before = body.velocity.x
        _step(system, run.size(10, 2), dt)
        run.near(f"the {name}'s speed later, of that", body.velocity.x / before, 1, 1e-5)
        run.near(f"height of the {name}'s center, m", body.center_of_mass.y, 0.1, 1e-6)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        for name, (_, inertia) in shapes.items():
            (line,) = axes.plot(dt * np.arange(len(speeds[name])), speeds[name], label=name)
            axes.axhline(2 / (1 + inertia), color=line.get_color(), ls=":", lw=1)
        axes.set(xlabel="time, s", ylabel="speed, m/s")
        axes.legend()

    run.picture("contact", "What slides begins to roll; dotted: the speed by its inertia.", draw, size=(5, 3))


def _slopes(run: Run, dt: float) -> None:
    limit = math.atan(0.6)
    for share, name in ((0.999, "below"), (1.01, "above")):
        angle = share * limit
        system = _on_a_slope(angle, 0.6)
        box = system.body(shape=iota.Box((0.4, 0.1, 0.4)), position=(0, 0.05, 0))
        _step(system, 2, dt)
        way = max(0.0, 2 * G * (math.sin(angle) - 0.6 * math.cos(angle)))
        run.near(f"way on a slope {name} the angle of friction in 2 s, m", box.center_of_mass.x, way, 2e-3)
    tips = math.atan(0.1 / 0.4)
    for share, stands in ((0.995, True), (1.005, False)):
        system = _on_a_slope(share * tips, 0.6)
        tower = system.body(shape=iota.Box((0.1, 0.4, 0.1)), position=(0, 0.2, 0))
        _step(system, 5, dt)
        name = f"height of a tower at {share} of the angle at which it tips, m"
        run.near(name, tower.center_of_mass.y, 0.2 if stands else 0.05, 1e-5)


def _resting(run: Run, dt: float) -> None:
    for size in (0.01, 1.0, 30.0):
        system = _on_a_slope(0, 0.5)
        box = system.body(shape=iota.Box((size, size, size)), position=(0, size / 2, 0))
        _step(system, 3, dt)
        run.at_most(f"a cube of {size} m sinks, of its size", abs(box.center_of_mass.y / size - 0.5), 1e-8)
        forces = [point.force.y / (box.mass * G) for point in box.contacts]
        run.near(f"least share of its weight on a corner, {size} m", min(forces, default=0), 0.25, 1e-3)
        run.near(f"largest share, {size} m", max(forces, default=0), 0.25, 1e-3)


def _towers(run: Run, dt: float) -> None:
    for ratio in (1, 1000):
        system = _on_a_slope(0, 0.5)
        edge = 0.2
        tower = [
            system.body(
                shape=iota.Box((edge, edge, edge)),
                position=(0, (k + 0.5) * edge, 0),
                density=1000 * (ratio if k == 9 else 1),
            )
            for k in range(10)
        ]
        _step(system, 3, dt)
        way = max(abs(body.center_of_mass - (0, (k + 0.5) * edge, 0)) for k, body in enumerate(tower))
        run.at_most(f"ten cubes of 0.2 m, the last {ratio} times as heavy: farthest way in 3 s, m", way, 1e-8 * ratio)
        force = sum(point.force.y for point in tower[-1].contacts)
        run.near("force below the last one, of its weight", force / (tower[-1].mass * G), 1, 1e-6)


def _overhang(run: Run, dt: float) -> None:
    """The k-th of blocks on each other, from above, reaches 1/(2 k) of its length beyond the next at most."""
    for share, stands in ((0.99, True), (1.01, False)):
        system = _on_a_slope(0, 0.5)
        reach, blocks = 0.0, []
        for k in range(5):  # from above
            blocks.append(system.body(shape=iota.Box((1, 0.1, 0.4)), position=(-reach, 0.45 - 0.1 * k, 0)))
            reach += share / (2 * (k + 1))
        lowest = blocks[-1]
        lowest.kind = "static"
        lowest.material = iota.Material(friction=0.5)
        _step(system, 2, dt)
        name = f"height of the highest of four blocks at {share} of the farthest overhang, m"
        if stands:
            run.near(name, blocks[0].center_of_mass.y, 0.45, 1e-6)
        else:
            run.at_most(name, blocks[0].center_of_mass.y, 0.4)


def _plank(run: Run, dt: float) -> None:
    """The impulse of friction that ends the slip: v - J/m - J/M = J R^2/I, I = 2/5 m R^2."""
    system = _on_a_slope(0, 0)
    plank = system.body(shape=iota.Box((4, 0.1, 1)), position=(0, 0.05, 0), density=100)
    ball = system.body(shape=iota.Sphere(0.1), position=(-1, 0.2, 0), velocity=(1, 0, 0), density=2000)
    plank.material = ball.material = iota.Material(friction=0.5)
    _step(system, 1.5, dt)
    impulse = 1 / (1 / ball.mass + 1 / plank.mass + 2.5 / ball.mass)
    run.near(
        "speed of a ball that begins to roll on a plank on ice, m/s", ball.velocity.x, 1 - impulse / ball.mass, 2e-3
    )
    run.near("speed of the plank, m/s", plank.velocity.x, impulse / plank.mass, 2e-3)


def _bounces(run: Run, dt: float) -> None:
    height = 0.9
    for restitution in (0.5, 0.9, 1.0):
        system = _on_a_slope(0, 0.5)
        ball = system.body(shape=iota.Sphere(0.1), position=(0, 0.1 + height, 0))
        ball.material = iota.Material(restitution=restitution)
        start = system.energy.kinetic + system.energy.potential
        whole = math.sqrt(2 * height / G) * (1 + restitution) / (1 - restitution) if restitution < 1 else math.inf
        falls, worst, last, gain = 0, 0.0, 0.0, -math.inf
        for k in range(round(min(whole + 0.5, run.size(20, 8)) / dt)):
            before = ball.velocity.y
            system.step(dt)
            gain = max(gain, system.energy.kinetic + system.energy.potential - start)
            if before < 0 < ball.velocity.y and falls < 4:
                falls += 1
                apex = ball.center_of_mass.y - 0.1 + ball.velocity.y**2 / (2 * G)
                worst = max(worst, abs(apex / (height * restitution ** (2 * falls)) - 1))
            if abs(ball.velocity) > 1e-6:
                last = (k + 1) * dt
        run.at_most(f"heights of four bounces, restitution {restitution}, relative", worst, 1e-6)
        run.at_most(f"energy gained, restitution {restitution}, of m g h", gain / (ball.mass * G * height), 1e-12)
        if whole < run.size(20, 8):
            name = f"time until the ball rests, restitution {restitution}, s"
            run.near(name, last, whole, 4 * dt / (1 - restitution))


def _impacts(run: Run, dt: float) -> None:
    """Newton's law: J = (1 + e) m M/(m + M) of the relative speed."""
    for ratio in (1e-3, 1.0, 1e3):
        for restitution in (0.0, 0.5, 1.0):
            system = iota.System(gravity=(0, 0, 0))
            system.usual_material = iota.Material(restitution=restitution)
            ball = system.body(shape=iota.Sphere(0.1), position=(-0.5, 0, 0), velocity=(2, 0, 0))
            other = system.body(shape=iota.Sphere(0.1), position=(0.5, 0, 0), velocity=(-1, 0, 0), density=1000 * ratio)
            _step(system, 0.5, dt)
            impulse = 3 * (1 + restitution) / (1 / ball.mass + 1 / other.mass)
            name = f"of a ball after one of {ratio:g} times its mass, restitution {restitution}, m/s"
            run.at_most("error of the speed " + name, abs(ball.velocity - (2 - impulse / ball.mass, 0, 0)), 1e-6)


def _rolling_resistance(run: Run, dt: float) -> None:
    """a = C g/(1 + I/(m R^2))."""
    for coefficient in (0.02, 0.1):
        system = _on_a_slope(0, 0.6)
        ball = system.body(shape=iota.Sphere(0.1), position=(0, 0.1, 0), velocity=(1, 0, 0), spin=(0, 0, -10))
        ball.material = iota.Material(friction=0.6, rolling=coefficient)
        slowing = coefficient * G / (1 + 2 / 5)
        _step(system, 1 / slowing + 0.2, dt)
        name = f"way of a ball at 1 m/s, rolling resistance {coefficient}, m"
        run.near(name, ball.center_of_mass.x, 1 / (2 * slowing), 1e-4)
        run.at_most(f"its speed afterwards, rolling resistance {coefficient}, m/s", abs(ball.velocity), 1e-9)
