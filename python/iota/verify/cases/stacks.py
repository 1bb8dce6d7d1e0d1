# SPDX-License-Identifier: Apache-2.0
"""Stacks that stand or fall by friction and geometry alone."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
from scipy.optimize import linprog

import iota
from iota.verify.reference import GRAVITY as G
from iota.verify.run import Run


def stacks(run: Run) -> None:
    """Stacks: cards, arches, overhangs, a heavy block on a tower.

    Two cards that lean on each other by an angle p from the vertical stand if the friction of the floor is at least tan(p)/2,
    less t/(2 l) for their thickness. A semicircular arch of n voussoirs stands above a thickness at which its line of thrust
    no longer fits: by linear programming (limit analysis, hinges at the edges). Blocks reach beyond each other by 1/(2 k) of
    their length. Ten cubes carry a thousand times their weight, and a chain of tori that hold each other by contact alone has the
    pitch 2 R - 2 r under a thousand times theirs. A rod that is thrown with its lower end in front jams where
    friction exceeds 4/3 (Painleve): its motion stays finite, and no step gains energy.
    """
    _cards(run)
    _arches(run)
    run.progress(0.6)
    _overhang(run)
    _tower(run)
    _links(run)
    _painleve(run)


def _on_ground(friction: float) -> iota.System:
    system = iota.System()
    system.obstacle(iota.HalfSpace((0, 1, 0)), material=iota.Material(friction=friction))
    return system


def _cards(run: Run) -> None:
    length, thick = 0.09, 0.002
    for degrees in run.size((10, 15, 20), (15,)):
        p = math.radians(degrees)
        needed = math.tan(p) / 2 - thick / (2 * length)
        for share in (1 - 1e-4, 1 + 1e-4):
            system = _on_ground((share * needed) ** 2)  # the geometric mean with the cards' 1
            foot = -(thick * math.sin(p) + length * math.cos(p)) / 2
            top = (thick * math.cos(p) + length * math.sin(p)) / 2
            cards = [
                system.body(
                    shape=iota.Box((thick, length, 0.06)),
                    position=(-side * top, -foot, 0),
                    orientation=("z", -side * degrees),
                    material=iota.Material(friction=1),
                )
                for side in (1, -1)
            ]
            for _ in range(round(1.5 * 240)):
                assert system.step(1 / 240).unconverged == 0
            sunk = -foot - cards[0].center_of_mass.y
            name = f"cards at {degrees} degrees, {share:.4f} of the friction needed: they sink by, of their length"
            if share > 1:
                run.at_most(name, sunk / length, 1e-4)
            else:
                run.at_least(name, sunk / length, 0.3)


def least_thickness(count: int) -> float:
    """The least thickness of a semicircular arch, of its mean radius, by limit analysis.

    Each joint has a force on its inner and one on its outer edge, not negative, and any shear; each voussoir is at rest.
    """

    def stands(thickness: float) -> bool:
        edges = (1 - thickness / 2, 1 + thickness / 2)
        joints = np.linspace(0, math.pi, count + 1)
        equations, weights = [], []
        for k in range(count):
            half = (joints[k + 1] - joints[k]) / 2
            weight = (edges[1] ** 2 - edges[0] ** 2) * math.sin(2 * half) / 2
            reach = 2 / 3 * (edges[1] ** 3 - edges[0] ** 3) / (edges[1] ** 2 - edges[0] ** 2) * math.cos(half)
            rows = np.zeros((3, 3 * (count + 1)))
            for joint, sign in ((k, 1), (k + 1, -1)):
                a = joints[joint]
                out = np.array([math.cos(a), math.sin(a)])
                across = np.array([-math.sin(a), math.cos(a)])
                for i, (at, along) in enumerate(((edges[0], across), (edges[1], across), (1.0, out))):
                    force = sign * along
                    rows[:, 3 * joint + i] += [*force, at * (out[0] * force[1] - out[1] * force[0])]
            equations.append(rows)
            weights.append([0, weight, reach * math.cos(joints[k] + half) * weight])
        bounds = [(0, None), (0, None), (None, None)] * (count + 1)
        found = linprog(np.zeros(len(bounds)), A_eq=np.vstack(equations), b_eq=np.concatenate(weights), bounds=bounds)
        return bool(found.status == 0)

    low, high = 0.02, 0.3
    for _ in range(20):
        middle = (low + high) / 2
        low, high = (low, middle) if stands(middle) else (middle, high)
    return high


def _arch(count: int, thickness: float) -> float:
    """How far the keystone of an arch of 1 m sinks in 2 s, m."""
    inner, outer, width = 1 - thickness / 2, 1 + thickness / 2, 0.3
    system = _on_ground(2)
    system.usual_material = iota.Material(friction=2)
    joints = np.linspace(0, math.pi, count + 1)
    ring = [0, 1, 2, 3]
    sides = [[a, b, b + 4, a, b + 4, a + 4] for a, b in zip(ring, [*ring[1:], 0], strict=True)]
    triangles = np.array([0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, *np.ravel(sides)]).reshape(-1, 3)
    stones = []
    for a, b in itertools.pairwise(joints):
        corners = np.array(
            [[r * math.cos(t), r * math.sin(t)] for r, t in ((inner, a), (outer, a), (outer, b), (inner, b))]
        )
        middle = corners.mean(0)
        vertices = [[x, y, z] for z in (-width / 2, width / 2) for x, y in corners - middle]
        stones.append(system.body(shape=iota.Mesh(vertices, triangles), position=(*middle, 0), density=2000))
    keystone = stones[count // 2]
    height = keystone.center_of_mass.y
    for _ in range(240):
        assert system.step(1 / 120).unconverged == 0
    return height - keystone.center_of_mass.y


def _arches(run: Run) -> None:
    counts = run.size((5, 7, 9, 11), (5,))
    least = {count: least_thickness(count) for count in (*range(4, 16), 25)} if run.scale != "quick" else {}
    sunk = {}
    for count in counts:
        limit = least.get(count) or least_thickness(count)
        for share in (0.99, 1.01):
            sunk[count, share] = _arch(count, share * limit)
            name = f"arch of {count} voussoirs at {share} of its least thickness {limit:.4f}: its keystone sinks by, m"
            if share > 1:
                run.at_most(name, sunk[count, share], 1e-3)
            else:
                run.at_least(name, sunk[count, share], 0.3)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        axes.plot(list(least), list(least.values()), "-", lw=1, label="limit analysis")
        axes.axhline(0.1075, color="k", ls=":", lw=1, label="Milankovitch, many voussoirs")
        for share, mark, word in ((1.01, "^", "stands"), (0.99, "v", "falls")):
            axes.plot(counts, [share * least_thickness(n) for n in counts], mark, ms=5, label=word)
        axes.set(xlabel="voussoirs", ylabel="thickness / radius")
        axes.legend(fontsize=7)

    run.picture("stacks", "Semicircular arches 1 % above and below the least thickness.", draw, size=(5, 3))


def _overhang(run: Run) -> None:
    for share in (1 - 1e-4, 1 + 1e-4):
        system = iota.System()
        material = iota.Material(friction=0.5)
        system.usual_material = material
        reach, blocks = 0.0, []
        for k in range(5):  # from above
            blocks.append(system.body(shape=iota.Box((1, 0.1, 0.4)), position=(-reach, 0.45 - 0.1 * k, 0)))
            reach += share / (2 * (k + 1))
        blocks[-1].kind, blocks[-1].material = "static", material
        for _ in range(5 * 120):
            assert system.step(1 / 120).unconverged == 0
        fallen = 0.45 - blocks[0].center_of_mass.y
        name = f"four blocks at {share:.4f} of the farthest overhang: the highest falls by, m"
        if share < 1:
            run.at_most(name, fallen, 1e-8)
        else:
            run.at_least(name, fallen, 0.2)


def _tower(run: Run) -> None:
    """Ten cubes of 0.2 m with a thousand times their weight on top, without sleep."""
    system = _on_ground(0.5)
    system.usual_material = iota.Material(friction=0.5)
    tower = [
        system.body(shape=iota.Box((0.2,) * 3), position=(0, 0.2 * k + 0.1, 0), density=1000 * (1000 if k == 10 else 1))
        for k in range(11)
    ]
    seconds, places, worst = run.size(60.0, 3.0), [], 0.0
    for k in range(round(seconds * 60)):
        report = system.step(1 / 60)
        assert report.unconverged == 0
        worst = max(worst, report.worst_gap)
        if k >= 60:
            places.append([body.center_of_mass for body in tower])
    run.at_most("a thousand times their weight on ten cubes: overlap, m", worst, 1e-6)
    run.at_most(
        f"their drift from 1 s to {seconds:g} s, m", float(np.ptp(np.array(places), axis=0).max()), run.size(1e-7, 1e-8)
    )
    weight = tower[-1].mass * G
    for below in (0, 5):
        force = sum(point.force.y for point in tower[below].contacts if point.position.y < 0.2 * below + 0.1)
        above = weight + sum(body.mass for body in tower[below:-1]) * G
        run.near(f"force below cube {below}, of the weight above it", force / above, 1, 1e-6)


def _links(run: Run) -> None:
    count, radius, tube = run.size(64, 8), 0.04, 0.005
    pitch = 2 * (radius - tube)
    system = iota.System()
    system.usual_material = iota.Material(friction=0.3)
    links = [
        system.body(
            shape=iota.Torus(radius, tube), density=7800, position=(0, -pitch * k, 0), orientation=("y", 90 * (k % 2))
        )
        for k in range(count)
    ]
    links[0].kind, links[0].material = "static", system.usual_material
    links[-1].particle(links[-1].position, mass=999 * links[-1].mass)
    heights = []
    for _ in range(2 * 60):
        assert system.step(1 / 60).unconverged == 0
        heights.append([link.position.y for link in links])
    track = np.array(heights)
    name = f"{count} torus links under a thousand times the mass of one, 60 Hz:"
    run.at_most(f"{name} largest error of the pitch, m", float(np.abs(np.diff(track[-1]) + pitch).max()), 1e-6)
    run.at_most(f"{name} motion in the last second, m", float(np.ptp(track[60:], axis=0).max()), 1e-9)


def _painleve(run: Run) -> None:
    gain, places = 0.0, []
    for friction in run.size((1.0, 1.5, 2.5), (2.5,)):
        for degrees in run.size((30, 55, 63.4, 70, 80), (55, 70)):
            system = _on_ground(friction)
            system.usual_material = iota.Material(friction=friction)
            lean = math.radians(degrees)
            rod = system.body(
                shape=iota.Capsule(0.005, 1),
                mass=1,
                position=(0, math.sin(lean) / 2 + 0.005, 0),
                orientation=("z", degrees),
                velocity=(-3, 0, 0),
            )
            moment, middle, before = float(np.max(np.linalg.eigvalsh(rod.inertia))), rod.center_of_mass, [math.inf]
            ends = [
                rod.particle(middle + side * iota.Vec3(math.cos(lean), math.sin(lean), 0), mass=0) for side in (1, -1)
            ]
            at, angle = np.array(middle), lean
            for _ in range(2 * 500):
                assert system.step(1 / 500).unconverged == 0
                along = ends[0].position - ends[1].position
                now, angle_now = np.array(rod.center_of_mass), math.atan2(along.y, along.x)
                turned = math.remainder(angle_now - angle, 2 * math.pi)
                speed, spin = (now - at) * 500, turned * 500
                # By mean velocities and the height in the middle of the step: less than before and after an impact.
                energy = speed @ speed / 2 + moment * spin**2 / 2 + G * (now[1] + at[1]) / 2
                gain = max(gain, energy - max(before[-3:]))
                at, angle = now, angle_now
                before.append(energy)
            places.append(tuple(rod.center_of_mass))
    run.at_most("rods that jam: largest gain of energy in a step, by places, J", gain, 5e-3)
    run.at_least("rods that end within 3 m", sum(math.dist(at, (0, 0, 0)) < 3 for at in places), len(places))
