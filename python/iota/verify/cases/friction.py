# SPDX-License-Identifier: Apache-2.0
"""Sticking, sliding and rolling against closed forms, judged from positions."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

import iota
from iota.verify.reference import GRAVITY as G
from iota.verify.reference import Array
from iota.verify.run import Run


def on_a_slope(angle: float, material: iota.Material) -> iota.System:
    """Level ground, and gravity turned instead."""
    system = iota.System(gravity=(G * math.sin(angle), -G * math.cos(angle), 0))
    system.obstacle(iota.HalfSpace((0, 1, 0)), material=material)
    system.usual_material = material
    return system


def steps(system: iota.System, body: iota.Body, seconds: float, dt: float) -> Array:
    """The places of a body's center after each step, m: shape (steps, 3)."""
    places = []
    for _ in range(round(seconds / dt)):
        assert system.step(dt).unconverged == 0
        places.append(body.center_of_mass)
    return np.array(places)


def acceleration(places: Array, dt: float) -> Array:
    """The acceleration of a uniform motion, by the places after one, two and three thirds of the time, m/s^2."""
    n = len(places) // 3
    return np.asarray((places[3 * n - 1] - 2 * places[2 * n - 1] + places[n - 1]) / (n * dt) ** 2)


def friction(run: Run) -> None:
    """Friction: what sticks, slides, rolls and spins.

    A block on a slope about the angle of friction, and pulled along the floor with a static friction that differs from the kinetic
    one; a ball that rolls down a slope, on a turntable (a circle at 2/7 of its rate) and against friction on the spot; SimBenchmark's box
    with 25 balls on it, drawn in three directions; a block that two jaws hold (2 mu N = m g); a bolt in the unrolled thread of
    a screw, which holds up to tan(lead) = mu/cos(30 degrees); a sleeve on a post, which jams where the load is further out than
    h/(2 mu); a rope of n nodes around a cylinder, whose forces differ by ((1 + mu tan(d/2))/(1 - mu tan(d/2)))^n at most.
    """
    dt = run.size(1 / 240, 1 / 120)
    _slope(run, dt)
    _static(run, dt)
    _spinning(run, dt)
    _turntable(run)
    run.progress(0.4)
    _box_with_balls(run)
    _grasp(run)
    run.progress(0.7)
    _thread(run, dt)
    _sleeve(run)
    _capstan(run)


def _slope(run: Run, dt: float) -> None:
    box, mu = iota.Box((0.4, 0.1, 0.4)), 0.6
    for share in (1e-6, 1e-3):
        angle = math.atan(mu * (1 + share))
        system = on_a_slope(angle, iota.Material(friction=mu))
        slides = acceleration(steps(system, system.body(shape=box, position=(0, 0.05, 0)), 3, dt), dt)[0]
        name = f"block on a slope {share:g} above the friction of {mu}: acceleration, m/s^2"
        run.near(name, slides, G * (math.sin(angle) - mu * math.cos(angle)), 1e-6)
    system = on_a_slope(math.atan(mu * (1 - 1e-6)), iota.Material(friction=mu))
    holds = steps(system, system.body(shape=box, position=(0, 0.05, 0)), 3, dt)
    run.at_most("the same 1e-6 below: way in the last two seconds, m", float(np.ptp(holds[len(holds) // 3 :, 0])), 1e-7)
    system = on_a_slope(math.atan(0.999 * mu), iota.Material(friction=mu))
    seconds = run.size(60.0, 10.0)
    places = steps(system, system.body(shape=box, position=(0, 0.05, 0)), seconds, 1 / 60)
    run.at_most(f"creep of a block that holds, from 1 s to {seconds:g} s, m", float(np.ptp(places[60:, 0])), 1e-9)
    for angle in (0.2, 0.4):
        system = on_a_slope(angle, iota.Material(friction=0.5))
        ball = system.body(shape=iota.Sphere(0.1), position=(0, 0.1, 0))
        rolls = acceleration(steps(system, ball, 2, dt), dt)[0]
        run.near(f"ball down a slope of {angle} rad: acceleration, m/s^2", rolls, 5 / 7 * G * math.sin(angle), 1e-6)


def _static(run: Run, dt: float) -> None:
    """A force at the height of the floor, which loads all four corners alike."""
    kinetic, static = 0.3, 0.5
    material = iota.Material(friction=kinetic, static_friction=static)
    for share in (1 - 1e-4, 1 + 1e-4):
        system = on_a_slope(0, material)
        box = system.body(shape=iota.Box((0.4, 0.1, 0.4)), position=(0, 0.05, 0), mass=2)
        force, places = share * static * 2 * G, []
        for _ in range(round(1.5 / dt)):
            box.apply_force((force, 0, 0), box.center_of_mass - (0, 0.05, 0))
            assert system.step(dt).unconverged == 0
            places.append(box.center_of_mass)
        name = f"block drawn with {share:.4f} of its static friction: acceleration, m/s^2"
        run.near(name, acceleration(np.array(places), dt)[0], 0 if share < 1 else force / 2 - kinetic * G, 1e-6)
    angle = math.atan(0.4)
    for speed in (0.02, -2.0):
        system = on_a_slope(angle, material)
        box = system.body(shape=iota.Box((0.4, 0.1, 0.4)), position=(0, 0.05, 0), velocity=(speed, 0, 0))
        way = steps(system, box, 2, dt)[-1, 0]
        down = 2 * speed + 2 * G * (math.sin(angle) - kinetic * math.cos(angle))
        up = -(speed**2) / (2 * G * (math.sin(angle) + kinetic * math.cos(angle)))
        name = "down: it slides on" if speed > 0 else "up: it stops and sticks"
        run.near(f"block between both frictions, thrown {name}; way in 2 s, m", way, down if speed > 0 else up, 5e-5)


def _spinning(run: Run, dt: float) -> None:
    """A ball of radius R on a disk of radius r: 2/3 mu N r is `spinning` N R; it slows by 5/2 `spinning` g/R."""
    radius, patch, mu = 0.1, 0.015, 0.6
    coefficient = 2 / 3 * mu * patch / radius
    system = on_a_slope(0, iota.Material(friction=mu, spinning=coefficient))
    ball = system.body(shape=iota.Sphere(radius), position=(0, radius, 0), spin=(0, 10, 0))
    mark = ball.particle((radius, radius, 0), mass=0)
    slowing = 2.5 * coefficient * G / radius
    angles = [0.0]
    for _ in range(round((10 / slowing + 0.2) / dt)):
        assert system.step(dt).unconverged == 0
        angles.append(math.atan2(-mark.position.z, mark.position.x))
    turned = np.unwrap(angles)
    run.near("ball that spins on the spot at 10 rad/s: angle until it rests, rad", turned[-1], 50 / slowing, 2e-3)
    run.at_most("its angle in the last 0.1 s, rad", float(np.ptp(turned[-round(0.1 / dt) :])), 1e-9)


def _turntable(run: Run) -> None:
    rate, radius, at, speed = 2.0, 0.1, 0.4, 0.3
    tracks: list[Array] = []
    for dt in run.size([1 / 120, 1 / 240], [1 / 120]):
        system = iota.System()
        system.usual_material = iota.Material(friction=0.8)
        table = system.body("scripted", shape=iota.Box((6, 0.1, 6)), position=(0, -0.05, 0))
        table.material = iota.Material(friction=0.8)
        slip = np.array([0, 0, -rate * at - speed])  # of the table against the ball's center
        ball = system.body(shape=iota.Sphere(radius), position=(at, radius, 0), velocity=(0, 0, speed))
        ball.angular_velocity = (-slip[2] / radius, 0, slip[0] / radius)
        places = []
        for k in range(round(1.2 * 2 * math.pi / (2 / 7 * rate) / dt)):
            table.orientation = (0, math.sin(rate * dt * (k + 1) / 2), 0, math.cos(rate * dt * (k + 1) / 2))
            assert system.step(dt).unconverged == 0
            places.append(ball.center_of_mass)
        track = np.array(places)[:, [0, 2]]
        middle, size = circle(track)
        turn = np.unwrap(np.arctan2(*(track - middle).T[::-1]))
        measured = abs(float(np.polyfit(dt * np.arange(len(turn)), turn, 1)[0])) / rate
        run.near(f"ball on a turntable, 1/{1 / dt:.0f} s: its rate, of the table's", measured, 2 / 7, 1e-4 * 2 / 7)
        run.near("radius of its circle, m", size, speed / (2 / 7 * rate), 1e-4)
        tracks.append(track)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        axes.plot(*tracks[-1].T, label="ball")
        axes.plot(0, 0, "k+", label="axis of the table")
        axes.set(xlabel="x, m", ylabel="z, m", aspect="equal")
        axes.legend(fontsize=7)

    run.picture("friction", "A ball on a turntable rolls in a circle beside the axis.", draw, size=(4, 3.4))


def circle(points: Array) -> tuple[Array, float]:
    """Middle and radius of the circle through points of a plane, by least squares."""
    solution = np.linalg.lstsq(np.c_[2 * points, np.ones(len(points))], (points**2).sum(1), rcond=None)[0]
    return solution[:2], math.sqrt(solution[2] + solution[:2] @ solution[:2])


def _box_with_balls(run: Run) -> None:
    """a = (F - mu (M + n m) g)/(M + 2/7 n m) of the box, and 2/7 of it of the balls."""
    force, below, radius, g, dt = 150.0, 0.4, 0.1, 9.8, 1 / 120
    expected = (force - below * 35 * g) / (10 + 25 * 2 / 7)
    results = []
    for degrees in (0, 20, 45):
        along = np.array([math.cos(math.radians(degrees)), 0, math.sin(math.radians(degrees))])
        system = iota.System(gravity=(0, -g, 0))
        system.usual_material = iota.Material(friction=0.8)
        system.obstacle(iota.HalfSpace((0, 1, 0)), material=iota.Material(friction=below**2 / 0.8))
        box = system.body(shape=iota.Box((20, 0.2, 20)), mass=10, position=(0, 0.1, 0))
        grid = [((i - 2) * 0.4, 0.2 + radius, (j - 2) * 0.4) for i in range(5) for j in range(5)]
        balls = [system.body(shape=iota.Sphere(radius), mass=1, position=at) for at in grid]
        places = []
        for _ in range(round(run.size(1.0, 0.5) / dt)):
            box.apply_force(force * along, box.center_of_mass - (0, 0.1, 0))
            assert system.step(dt).unconverged == 0
            places.append([body.center_of_mass for body in (box, *balls)])
        results.append(acceleration(np.array(places), dt) @ along)
    run.near("box with 25 balls at 150 N, acceleration of the box, m/s^2", results[0][0], expected, 1e-4)
    run.at_most("balls, largest error, m/s^2", float(np.abs(results[0][1:] - 2 / 7 * expected).max()), 1e-4)
    spread = float(np.ptp([[a[0] for a in results], [a[1:].mean() + a[0] - results[0][1:].mean() for a in results]]))
    run.at_most("difference between forces at 0, 20 and 45 degrees, m/s^2", spread, 1e-8)


def _grasp(run: Run) -> None:
    """Held while 2 mu N is at least the weight."""
    dt, mu, mass = 1 / 60, 0.5, 0.5
    for share in (1 + 1e-4, 1 - 1e-4):
        system = iota.System()
        system.usual_material = iota.Material(friction=mu)
        box = system.body(shape=iota.Box((0.06, 0.06, 0.06)), mass=mass, position=(0, 1, 0))
        jaws = [
            system.body(shape=iota.Box((0.02, 0.06, 0.06)), mass=0.1, position=(side * 0.04, 1, 0)) for side in (-1, 1)
        ]
        for jaw in jaws:
            system.prismatic(jaw, at=jaw.position, axis=(1, 0, 0))
        heights = []
        for _ in range(round((run.size(60.0, 5.0) if share > 1 else 3) / dt)):
            for side, jaw in zip((1, -1), jaws, strict=True):
                jaw.apply_force((side * share * mass * G / (2 * mu), 0, 0), jaw.center_of_mass)
            assert system.step(dt).unconverged == 0
            heights.append(box.center_of_mass.y)
        if share > 1:
            run.at_most("block in jaws with 1.0001 of the force: creep after 1 s, m", float(np.ptp(heights[60:])), 1e-9)
        else:
            falls = heights[-121] - 2 * heights[-61] + heights[-1]
            run.near("with 0.9999 of it: acceleration, m/s^2", -falls, 1e-4 * G, 1e-6)


def _thread(run: Run, dt: float) -> None:
    mu, flank = 0.2, math.radians(30)
    for share in (0.99, 1.01):
        lead = math.atan(share * mu / math.cos(flank))
        system = iota.System(gravity=(G * math.sin(lead), -G * math.cos(lead), 0))
        system.usual_material = iota.Material(friction=mu)
        for side in (-1, 1):
            system.obstacle(
                iota.HalfSpace((0, math.cos(flank), side * math.sin(flank))), material=system.usual_material
            )
        bolt = system.body(shape=iota.Cylinder(0.05, 0.2), position=(0, 0.05 / math.cos(flank), 0))
        slides = acceleration(steps(system, bolt, 1.5, dt), dt)[0]
        expected = max(0.0, G * (math.sin(lead) - mu / math.cos(flank) * math.cos(lead)))
        run.near(f"thread at {share} of the lead that holds: acceleration, m/s^2", slides, expected, 1e-5)


def _sleeve(run: Run) -> None:
    height, width, mu, dt = 0.2, 0.05, 0.3, 1 / 240
    for share in (0.99, 1.01):
        system = iota.System(gravity=(0, 0, 0))
        system.usual_material = iota.Material(friction=mu)
        system.obstacle(iota.Box((width, 3, 0.3)), material=system.usual_material)
        pins = [
            system.body(
                shape=iota.Cylinder(0.02, 0.1),
                density=5000,
                position=(side * (width / 2 + 0.02), -side * height / 2, 0),
                orientation=("y", 90),
            )
            for side in (-1, 1)
        ]
        pins[0].combine(pins[1])
        load = pins[0].particle((share * height / (2 * mu), 0, 0), mass=0)
        heights = []
        for _ in range(round(2 / dt)):
            pins[0].apply_force((0, -10, 0), load.position)
            assert system.step(dt).unconverged == 0
            heights.append(pins[0].center_of_mass.y)
        way = abs(heights[-1] - heights[60])
        name = f"sleeve on a post, load at {share} of the distance at which it jams: way in 1.75 s, m"
        if share > 1:
            run.at_most(name, way, 1e-6)
        else:
            run.at_least(name, way, 0.05)


def _capstan(run: Run) -> None:
    nodes, angle, mu, radius, dt = 12, math.radians(15), 0.3, 0.105, 1 / 240
    ratio = ((1 + mu * math.tan(angle / 2)) / (1 - mu * math.tan(angle / 2))) ** nodes
    run.note("capstan: ratio of the forces, and exp(mu theta)", f"{ratio:.6f}, {math.exp(mu * nodes * angle):.6f}")
    for share in (1 - 1e-4, 1 + 1e-4):
        for end in (0, -1):  # which one is pulled
            system = iota.System(gravity=(0, 0, 0))
            material = iota.Material(friction=mu)
            system.obstacle(iota.Cylinder(0.1, 0.4), orientation=("y", 90), material=material)
            rope = []
            for k in range(nodes):
                body = system.body()
                at = (radius * math.cos(k * angle), radius * math.sin(k * angle), 0)
                rope.append(body.particle(at, mass=0.05))
                body.radius, body.material = radius - 0.1, material
            for p, q in itertools.pairwise(rope):
                system.rope(p, q)
            pulls = [10.0, 10.0]
            pulls[end] *= share * ratio
            angles: list[float] = []
            for _ in range(round(run.size(2, 1) / dt)):
                for k, force, sign in ((0, pulls[0], -1), (-1, pulls[1], 1)):
                    turn = (0 if k == 0 else (nodes - 1) * angle) + sign * angle / 2
                    rope[k].body.apply_force(
                        (-sign * force * math.sin(turn), sign * force * math.cos(turn), 0), rope[k].position
                    )
                assert system.step(dt).unconverged == 0
                middle = rope[nodes // 2].position
                angles.append(math.atan2(middle.y, middle.x))
            way = radius * abs(angles[-1] - angles[len(angles) // 2])
            name = f"rope around a cylinder, {'first' if end == 0 else 'last'} end at {share:.4f} of the ratio: way, m"
            if share < 1:
                run.at_most(name, way, 1e-9)
            else:
                run.at_least(name, way, 1e-2)
