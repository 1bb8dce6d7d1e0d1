#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Worst frames of difficult scenes, as multiples of the median frame of the same scene.

    python bench/worst_frames.py                # all scenes, both modes
    python bench/worst_frames.py --scene taut   # those whose name contains it

Frames of 1/60 s on one thread, processor time, without the first one, which analyzes the structure (its own column).
`iterations` is a frame's largest number of Newton iterations in one island, of all its sub-steps: it does not depend
on the machine. A frame that is slow only in time was slow for other reasons; `--runs` takes the least of several.
"""

from __future__ import annotations

import argparse
import itertools
import math
import random
import statistics
import time
from collections.abc import Callable, Iterator

import iota

HERTZ = 60
Scene = Iterator[None]
"""Makes a world at the first `next`; each later one may change it before a frame."""


def links(
    system: iota.System, lengths: list[float], masses: list[float], heading: Callable[[int], iota.Vec3]
) -> list[iota.Body]:
    """A chain from (0, 2, 0); each link has a particle with half of its mass at both ends."""
    at = iota.Vec3(0, 2, 0)
    made: list[iota.Body] = []
    for i, (length, mass) in enumerate(zip(lengths, masses, strict=True)):
        body = system.body()
        start = body.particle(at, mass=mass / 2)
        at = at + length * heading(i)
        body.particle(at, mass=mass / 2)
        if made:
            made[-1].particles[-1].combine(start)
        else:
            start.nail()
        made.append(body)
    return made


def along(*vectors: tuple[float, float, float]) -> Callable[[int], iota.Vec3]:
    units = [iota.Vec3(*v) * (1 / math.hypot(*v)) for v in vectors]
    return lambda i: units[i % len(units)]


def unchanged() -> Scene:
    while True:
        yield


def zigzag(system: iota.System) -> Scene:
    links(system, [0.05] * 60, [0.01] * 60, along((1, 1, 0), (1, -1, 0.2)))
    yield from unchanged()


def folded(system: iota.System) -> Scene:
    """Back by exactly 180 degrees."""
    links(system, [0.05] * 40, [0.01] * 40, lambda i: iota.Vec3(1 if i < 20 else -1, 0, 0))
    yield from unchanged()


def upside_down(system: iota.System) -> Scene:
    links(system, [0.05] * 20, [0.01] * 20, along((1e-9, 1, 0)))
    yield from unchanged()


def tiny_link(system: iota.System) -> Scene:
    links(system, [1e-6 if i == 10 else 0.1 for i in range(20)], [0.01] * 20, along((1, 0, 0)))
    yield from unchanged()


def lengths_of_six_decades(system: iota.System) -> Scene:
    links(system, [10 ** (-3 + 6 * i / 19) for i in range(20)], [0.1] * 20, along((1, 0, 0)))
    yield from unchanged()


def masses_of_ten_decades(system: iota.System) -> Scene:
    links(system, [0.1] * 20, [10 ** (-5 + 10 * i / 19) for i in range(20)], along((1, 0, 0)))
    yield from unchanged()


def star(system: iota.System) -> Scene:
    hub = system.body().particle((0, 2, 0), mass=0.01)
    hub.nail()
    for i in range(200):
        angle = 2 * math.pi * i / 200
        heading = (math.cos(angle), 0, math.sin(angle))
        arm = iota.builder.chain(links=10, length=0.5, top=(0, 2, 0), direction=heading).realize(system)
        hub.combine(arm.points[0])
    yield from unchanged()


def conflict(count: int) -> Callable[[iota.System], Scene]:
    """A chain of 1 m nailed 1.5 m apart."""

    def make(system: iota.System) -> Scene:
        chain = links(system, [1 / count] * count, [0.1 / count] * count, along((1, 0, 0)))
        chain[-1].particles[1].nail((1.5, 2, 0))
        yield from unchanged()

    return make


def pulled_nail(system: iota.System) -> Scene:
    """An arm of 1 m whose end is nailed to a place that goes to 1.5 m and comes back."""
    chain = links(system, [0.05] * 20, [0.01] * 20, along((1, -1, 0)))
    end = chain[-1].particles[1]
    yield
    for frame in range(10**9):
        end.nail((0.7 + 0.8 * math.sin(0.05 * frame) ** 2, 2 - 0.5 * math.cos(0.05 * frame), 0))
        yield


def bars(system: iota.System, counts: tuple[int, int, int]) -> dict[tuple[int, ...], iota.Particle]:
    """Knots in so many columns, layers downwards, and rows, 0.1 m apart, with a bar between neighbors; by their numbers."""
    knots: dict[tuple[int, ...], iota.Particle] = {}
    with system.edit():
        for start in itertools.product(*map(range, counts)):
            for axis in range(3):
                end = tuple(number + (k == axis) for k, number in enumerate(start))
                if end[axis] == counts[axis]:
                    continue
                body = system.body()
                for at in (start, end):
                    p = body.particle((0.1 * at[0], 2 - 0.1 * at[1], 0.1 * at[2]), mass=0.005)
                    if at in knots:
                        knots[at].combine(p)
                    else:
                        knots[at] = p
    return knots


def taut_net(load: float, count: int = 32) -> Callable[[iota.System], Scene]:
    """Of bars, nailed at its corners exactly taut, with a load in its middle."""

    def make(system: iota.System) -> Scene:
        knots = bars(system, (count, 1, count))
        for corner in itertools.product((0, count - 1), (0,), (0, count - 1)):
            knots[corner].nail()
        if load > 0:
            middle = knots[count // 2, 0, count // 2]
            middle.combine(system.body().particle(middle.position, mass=load))
        yield from unchanged()

    return make


def lattice(system: iota.System) -> Scene:
    """Nailed at its roof."""
    for (_, layer, _), knot in bars(system, (6, 6, 6)).items():
        if layer == 0:
            knot.nail()
    yield from unchanged()


def springs(count: int, tears: bool) -> Callable[[iota.System], Scene]:
    """A cloth of particles and springs hung by two corners; with a load and a limit, it tears."""

    def make(system: iota.System) -> Scene:
        p = [[system.body().particle((i / count, 2, j / count), mass=1e-3) for j in range(count)] for i in range(count)]
        for i in range(count):
            for j in range(count):
                for x, y in ((i + 1, j), (i, j + 1), (i + 1, j + 1)):
                    if x < count and y < count:
                        bond = system.bond(p[i][j], p[x][y], "spring", stiffness=1e4)
                        if tears:
                            bond.break_force = 30
        p[0][0].nail()
        p[-1][0].nail()
        if tears:
            p[-1][-1].combine(system.body().particle(p[-1][-1].position, mass=3))
        yield from unchanged()

    return make


def random_edits(system: iota.System) -> Scene:
    """300 links in empty space; each frame combines or separates two of them."""
    dice = random.Random(7)
    bodies = []
    for _ in range(300):
        body = system.body()
        at = iota.Vec3(*(dice.uniform(0, 3) for _ in range(3)))
        for k in range(2):
            body.particle(at + iota.Vec3(0.2 * k, 0, 0), mass=0.1)
        bodies.append(body)
    joined: list[tuple[iota.Particle, iota.Particle]] = []
    yield
    while True:
        if joined and dice.random() < 0.4:
            first, second = joined.pop(dice.randrange(len(joined)))
            first.separate(second)
        else:
            a, b = dice.sample(bodies, 2)
            pair = a.particles[dice.randrange(2)], b.particles[dice.randrange(2)]
            try:
                pair[0].combine(pair[1], over=0.5)
                joined.append(pair)
            except (ValueError, RuntimeError):
                pass
        yield


def box_on_plane(system: iota.System) -> Scene:
    """The touching face has no single nearest point: this waits for contacts."""
    size = iota.Box((0.2, 0.2, 0.2))
    box = system.body(shape=size, mass=1, position=(0, 0.11, 0))
    system.surface_to_surface(box, size, None, iota.HalfSpace())
    yield from unchanged()


SCENES: dict[str, Callable[[iota.System], Scene]] = {
    "zigzag chain, 60 links": zigzag,
    "chain folded back": folded,
    "chain upside down, 1e-9 off": upside_down,
    "a link of 1e-6 m among 0.1 m": tiny_link,
    "links of 1e-3 to 1e3 m": lengths_of_six_decades,
    "masses of 1e-5 to 1e5 kg": masses_of_ten_decades,
    "star, 200 arms of 10": star,
    "conflict, 20 links": conflict(20),
    "conflict, 100 links": conflict(100),
    "nail pulled beyond reach and back": pulled_nail,
    "taut net 32 x 32": taut_net(0),
    "taut net 32 x 32, 100 kg": taut_net(100),
    "taut net 10 x 10, 100 kg": taut_net(100, 10),
    "lattice 6 x 6 x 6, roof nailed": lattice,
    "cloth of springs 24 x 24": springs(24, False),
    "cloth 16 x 16, torn by 3 kg": springs(16, True),
    "300 links, an edit a frame": random_edits,
    "box on a plane": box_on_plane,
}


def measure(make: Callable[[iota.System], Scene], mode: str, frames: int) -> tuple[list[float], list[int], int]:
    """Processor time of each frame, s, its iterations, and the number of islands given up."""
    system = iota.System(mode=mode)
    system.threads = 1
    scene = make(system)
    times, iterations, given_up = [], [], 0
    for _ in range(frames):
        next(scene)
        start = time.process_time()
        report = system.step(1 / HERTZ)
        times.append(time.process_time() - start)
        iterations.append(max((island.iterations for island in system.islands()), default=0))
        given_up += report.unconverged
    return times, iterations, given_up


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", default="", help="only scenes whose name contains this")
    parser.add_argument("--frames", type=int, default=240, help="of 1/60 s (default: %(default)s)")
    parser.add_argument("--runs", type=int, default=1, help="each frame's time is the least of so many runs")
    arguments = parser.parse_args()
    print("| scene | mode | first ms | median ms | worst ms | worst / median | iterations median | worst | given up |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, make in SCENES.items():
        if arguments.scene not in name:
            continue
        for mode in ("robust", "energy_keeping"):
            runs = [measure(make, mode, arguments.frames) for _ in range(arguments.runs)]
            times = [1e3 * min(frame) for frame in zip(*(run[0] for run in runs), strict=True)]
            iterations, given_up = runs[0][1], runs[0][2]
            median, worst = statistics.median(times[1:]), max(times[1:])
            print(
                f"| {name} | {mode} | {times[0]:.2f} | {median:.3f} | {worst:.2f} | {worst / median:.1f} "
                f"| {statistics.median(iterations[1:]):.0f} | {max(iterations[1:])} | {given_up} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
