# SPDX-License-Identifier: Apache-2.0
"""What complexity management gains, and the error that is seen: the figures of docs/complexity.md.

    python bench/complexity.py [gain | budget | walk | tour | control | pace | play]

Times are processor times. The error is the angle at which a viewer 10 m away sees a point beside its place in the full
simulation from the same state, over 0.5 s.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from unittest import mock

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "python"))
from page_client import PageClient

import iota
from iota.levels import arrivals, catching_up, choice
from iota.studies import cradle_contact, crowd, museum, shoal, weather
from iota.types import StepReport
from iota.world import levels

DT = 1 / 120
DISTANCE = 10.0  # m
PICTURE = Path(__file__).parent.parent / "docs" / "pictures" / "complexity.svg"
WARM = 60  # steps, in full
STEADY = 80  # chains
LEARNING = 700  # frames of a walk until the headroom is learnt
MOST = 1.25  # budgets that a step may take
STRIDES = {"full": 1, "1/2": 2, "1/4": 4, "1/8": 8, "frozen": 0}
LEVELS = ("full", "1/2", "1/4", "1/8", "stiff", "frozen")


def kind(name: str, count: int) -> iota.World:
    """Many things of one kind of the studies."""
    world = iota.World(
        iota.System(gravity=(0, 0, 0), mode="robust") if name == "shoals" else iota.System(damping=0.02), ground=None
    )
    made = crowd.Crowd(world, 0)
    made.is_tinted = False
    for number in range(count):
        before = set(world.system.bodies)
        at = iota.Vec3(crowd.APART * (number % 20), crowd.HEIGHT, crowd.APART * (number // 20))
        HANGS[name](world, at, number)
        made.things.append(
            world.levels.manage([body for body in world.system.bodies if body not in before and body.kind == "dynamic"])
        )
    return world


def hang_cradle(world: iota.World, at: iota.Vec3, number: int) -> None:
    cradle_contact.Row(world, "steel", at=at, label=False).lift(1 + number % 2, 0)


def swim(world: iota.World, at: iota.Vec3, number: int) -> None:
    shoal.School(world, 300, lambda time: np.array(at) + shoal.leader_at(time))


HANGS: dict[str, Callable[[iota.World, iota.Vec3, int], object]] = {
    "acrobats": lambda world, at, number: crowd.acrobat(world, at, "#888888", number),
    "rope ladders": lambda world, at, number: crowd.ladder(world, at, "#888888", number),
    "chains": lambda world, at, number: crowd.chain(world, at, "#888888", number),
    "cradles": hang_cradle,
    "cloths": lambda world, at, number: weather.flag(world, at),
    "shoals": swim,
    "paper fish": lambda world, at, number: crowd.shoal(world, at, "#888888", number),
}
COUNTS = {"cradles": 20, "cloths": 8, "shoals": 2}
STIFFENS = ("acrobats", "rope ladders", "chains")


def set_level(world: iota.World, name: str) -> None:
    for thing in world.levels.things:
        if name == "stiff":
            thing._set_stiff(True, world.scene._visuals)
        else:
            thing._set_stride(STRIDES[name])


def cost(world: iota.World, steps: int = 60) -> float:
    """Mean processor time of a step, ms."""
    taken = []
    for _ in range(steps):
        began = time.process_time()
        world.system.step(DT)
        taken.append(1e3 * (time.process_time() - began))
    return float(np.mean(taken))


@dataclass
class Row:
    """gain: how many times less a step costs. p50, p99: error, degrees. lost, gained: energy in 0.5 s that the full simulation
    does not lose or gain, of the kinetic energy."""

    name: str
    level: str
    gain: float
    p50: float
    p99: float
    lost: float
    gained: float


def gain_and_error() -> list[Row]:
    rows: list[Row] = []
    print("| things | level | gain | error p50, degrees | p99 | energy lost | gained |\n|---|---|---|---|---|---|---|")
    for name in HANGS:
        full = 0.0
        for level in LEVELS:
            if level == "stiff" and name not in STIFFENS:
                continue
            world, twin = kind(name, COUNTS.get(name, 40)), kind(name, COUNTS.get(name, 40))
            for each in (world, twin):
                for _ in range(WARM):
                    each.system.step(DT)
            before = world.system.energy
            points = dict(zip(world.system.particles, twin.system.particles, strict=True))
            set_level(world, level)
            errors: list[float] = []
            gained = 0.0
            for _ in range(60):
                world.system.step(DT)
                twin.system.step(DT)
                gap = np.array([list(p.position - q.position) for p, q in points.items() if p.alive])
                errors.extend(np.degrees(np.arctan(np.linalg.norm(gap, axis=1) / DISTANCE)))
                gained = max(gained, own_energy(world) - before.total + before.external_work)
            lost = (own_energy(twin) - own_energy(world)) / before.kinetic
            ms = cost(world)
            full = full or ms
            p50, p99 = np.percentile(errors, [50, 99])
            rows.append(Row(name, level, full / max(ms, 1e-9), float(p50), float(p99), lost, gained / before.kinetic))
            tell(rows[-1])
    for count, factor in ((1200, 3.0), (1200, 10.0), (1200, 30.0), (240, 10.0)):
        rows.append(together(factor, count))
        tell(rows[-1])
    return rows


def own_energy(world: iota.World) -> float:
    """Without the work of wind and of fish that swim, J."""
    energy = world.system.energy
    return energy.total - energy.external_work


def tell(row: Row) -> None:
    print(
        f"| {row.name} | {row.level} | {row.gain:.2g} | {row.p50:.1e} | {row.p99:.1e} | {row.lost:.1e} | {row.gained:.1e} |",
        flush=True,
    )


def together(factor: float, count: int, steps: int = 1500) -> Row:
    """All levels, as management chooses them for a viewer who stands in the crowd and offers `factor` budgets. The error is the angle at
    which this viewer sees points within 10 m beside their places in the full simulation from the same state."""
    world, offered, _, taken = loaded(count, factor)
    eye = iota.Vec3(0.5 * crowd.APART * count / crowd.ROWS, 1.6, 0.5 * crowd.APART)
    world.levels.viewers = lambda: [eye]
    for _ in range(steps):
        world.step()
    twin = crowd.build(count, None)
    twin.system.restore(world.system.snapshot())
    for body in twin.system.bodies:
        body.stride = 1
    before = world.system.energy
    ms = np.median(taken[-400:])
    errors: list[float] = []
    gained = 0.0
    mine, others = (np.array([list(p.position) for p in each.system.particles]) for each in (world, twin))
    near = np.linalg.norm(mine - np.array(eye), axis=1) < DISTANCE
    for _ in range(60):
        world.step()
        twin.system.step(DT)
        mine, others = (np.array([list(p.position) for p in each.system.particles]) for each in (world, twin))
        distance = np.linalg.norm(others[near] - np.array(eye), axis=1)
        errors.extend(np.degrees(np.arctan(np.linalg.norm(mine[near] - others[near], axis=1) / distance)))
        gained = max(gained, own_energy(world) - before.total + before.external_work)
    p50, p99 = np.percentile(errors, [50, 99])
    lost = (own_energy(twin) - own_energy(world)) / before.kinetic
    name = f"{count} together, {factor:.0f} budgets"
    return Row(
        name, str(world.levels).split(": ")[1], offered / ms, float(p50), float(p99), lost, gained / before.kinetic
    )


def draw(rows: list[Row]) -> None:
    """Gain against error, both logarithmic."""
    colors = {
        "acrobats": "#b5462f",
        "rope ladders": "#2f6c80",
        "chains": "#5b7f4b",
        "cradles": "#8a5a83",
        "cloths": "#b8860b",
        "shoals": "#4a7fb5",
        "paper fish": "#c06c84",
        "together": "#222222",
    }

    def at(row: Row) -> tuple[float, float]:
        x = 70 + 110 * (math.log10(max(row.p99, 1e-3)) + 3)
        return x, 300 - 80 * math.log10(max(row.gain, 0.5))

    parts = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 640 360" font-family="sans-serif" font-size="12">']
    parts.append('<rect width="640" height="360" fill="white"/>')
    for power in range(-3, 2):
        x = 70 + 110 * (power + 3)
        parts.append(f'<path d="M{x} 40V320" stroke="#ddd"/><text x="{x - 14}" y="336">{10.0**power:g}</text>')
    for power in range(4):
        y = 300 - 80 * power
        parts.append(f'<path d="M70 {y}H610" stroke="#ddd"/><text x="36" y="{y + 4}">{10**power}</text>')
    parts.append('<path d="M290 40V320" stroke="#888" stroke-dasharray="4"/>')
    parts.append('<text x="200" y="354">error at 10 m after up to 0.5 s, p99, degrees</text>')
    parts.append('<text x="6" y="14">times cheaper than full</text>')
    for i, (name, color) in enumerate(colors.items()):
        mine = [row for row in rows if name in row.name and row.level != "full"]
        parts.append(f'<text x="{70 + 71 * i}" y="32" fill="{color}">{name}</text>')
        for row in mine:
            x, y = at(row)
            label = row.name.split(", ")[1].split()[0] + "x" if name == "together" else row.level
            parts.append(f'<circle cx="{x:.0f}" cy="{y:.0f}" r="4" fill="{color}"/>')
            if row.gain > 1.2 and not (row.p99 > 1 and row.gain < 3):  # others lie on each other
                parts.append(f'<text x="{x + 6:.0f}" y="{y - 4:.0f}" fill="{color}">{label}</text>')
    PICTURE.write_text("\n".join([*parts, "</svg>"]) + "\n")


def loaded(count: int, factor: float, offered: float | None = None) -> tuple[iota.World, float, float, list[float]]:
    """A crowd that offers `factor` budgets: the world, what it offers (measured unless it is given) and its budget, ms, and a list
    that gets the time of each step with its management."""
    world = crowd.build(count, None)
    for _ in range(20):
        world.step()
    measured = min(cost(world, 20) for _ in range(3))
    offered = offered or measured
    limit = offered / factor
    world.levels.budget_ms = limit
    return world, offered, limit, noting(world)


def noting(world: iota.World) -> list[float]:
    """A list that gets the time of each step with its management, ms."""
    taken: list[float] = []
    step = world.levels._step

    def timed(dt: float) -> StepReport:
        began = time.process_time()
        report = step(dt)
        taken.append(1e3 * (time.process_time() - began))
        return report

    object.__setattr__(world.levels, "_step", timed)
    return taken


def budget(count: int = 600, factor: float = 10.0, steps: int = 1500) -> None:
    """A load of `factor` budgets: percentiles of a step, and how long it takes until all is full after the load falls."""
    world, offered, limit, taken = loaded(count, factor)
    for _ in range(steps):
        world.step()
    after = np.array(taken[240:])
    print(f"{count} things, {len(world.system.bodies)} bodies: offered {offered:.2f} ms, budget {limit:.2f} ms")
    print(
        "step: p50 {:.2f} p90 {:.2f} p99 {:.2f} p99.9 {:.2f} most {:.2f} of the budget".format(
            *(np.percentile(after, [50, 90, 99, 99.9, 100]) / limit)
        ),
        f"management {world.levels.own_ms:.3f} ms",
    )
    print(world.levels)
    world.levels.budget_ms = 20 * offered
    steps_back = 0
    while world.levels.counts().get("full", 0) < count and steps_back < 1000:
        world.step()
        steps_back += 1
    print(f"all full after {steps_back * DT:.2f} s")


class Tape:
    """The clock that decides about levels: a first walk notes what it says, and further ones hear the same and so do the same, with
    the same bits. The time of a frame is then the least of all of them: what other programs do to a frame is not the same
    twice."""

    def __init__(self) -> None:
        self._seconds: list[float] = []
        self._at: int | None = None  # None: it notes

    def rewind(self) -> None:
        self._at = 0

    def process_time(self) -> float:
        if self._at is None:
            self._seconds.append(time.process_time())
            return self._seconds[-1]
        self._at += 1
        return self._seconds[self._at - 1]

    def perf_counter(self) -> float:
        return time.perf_counter()


def walk(count: int = 600, frames: int = 100_000, factor: float = 10.0, walks: int = 6) -> None:
    """The lamp's way through the valley, again and again, with a load of `factor` budgets: percentiles of all frames but the first
    700, in which the headroom is learnt, or the first half of a short walk."""
    offered: float | None = None

    def make() -> tuple[iota.World, float, list[float]]:
        nonlocal offered
        world, offered, limit, taken = loaded(count, factor, offered)
        return world, limit, taken

    compare(make, f"{count} things", frames, walks)


def tour(frames: int = 30_000, walks: int = 3) -> None:
    """The same of the way through the museum, with its own budget."""

    def make() -> tuple[iota.World, float, list[float]]:
        world = museum.build()
        assert world.levels.budget_ms is not None
        return world, world.levels.budget_ms, noting(world)

    compare(make, "museum", frames, walks)


def compare(make: Callable[[], tuple[iota.World, float, list[float]]], name: str, frames: int, walks: int) -> None:
    """Takes the same walk `walks` times. Beside it chains that nobody manages, whose work is the same in each step, so that their
    percentiles tell what other programs do to processor times. make: the world, its budget and its times, ms."""
    tape = Tape()
    learning = min(LEARNING, frames // 2)
    taken = np.full(frames, np.inf)
    others = np.full(frames, np.inf)
    end = b""
    with ExitStack() as patches:
        for module in (levels, choice, arrivals, catching_up):
            patches.enter_context(mock.patch.object(module, "time", tape))
        for number in range(walks):
            world, limit, times = make()
            steady = kind("chains", STEADY)
            for frame in range(frames):
                world.step()
                others[frame] = min(others[frame], cost(steady, 1))
            taken = np.minimum(taken, times)
            tape.rewind()
            places = np.array([list(each.position) for each in world.system.particles]).tobytes()
            if end not in (b"", places):
                raise SystemExit("a walk that hears the same clock did not end at the same places")
            end = places
            print(f"{name}, budget {limit:.2f} ms, {frames} frames, {number + 1} walks: p50 p90 p99 p99.9 most")
            print("  ", spread(taken[learning:] / limit), "of the budget, with management")
            beyond = learning + np.nonzero(taken[learning:] > MOST * limit)[0]
            print(f"   beyond {MOST} budgets: {len(beyond)} frames", *beyond[:10])
            print("  ", spread(others[learning:] / np.median(others)), "of the usual, chains in full")
            print(f"   a usual step may take {world.levels._time.full:.2f} of the budget; {world.levels}", flush=True)


def spread(values: np.ndarray) -> str:
    """Percentiles."""
    return " ".join(f"{np.percentile(values, p):.2f}" for p in (50, 90, 99, 99.9, 100))


def control(count: int = 10_000) -> None:
    """What management takes of a step."""
    system = iota.System()
    world = iota.World(system, ground=None)
    for number in range(count):
        rod = system.body()
        at = iota.Vec3(number % 100, 0, number // 100)
        rod.particle(at).nail()
        rod.particle(at + (0.5, 0, 0))
    world.levels.viewers = lambda: [(50.0, 0.0, 50.0)]
    world.levels.budget_ms = 8.0
    for _ in range(100):
        world.step()
    planned: list[float] = []
    plan = world.levels._plan

    def timed() -> None:
        began = time.process_time()
        plan()
        planned.append(1e3 * (time.process_time() - began))

    object.__setattr__(world.levels, "_plan", timed)
    for _ in range(600):
        world.step()
    planned = planned[300:]
    print(
        f"{count} articulates: {np.median(planned):.3f} ms, p90 {np.percentile(planned, 90):.3f} ms of 8 ms; {world.levels}"
    )


def pace(count: int = 1500, seconds: int = 12) -> None:
    """How near a served world without a budget comes to real time, as a page shows it, with and without a budget of its own."""
    for may_give in (False, True):
        world = iota.World(iota.System(), ground=None)
        world.camera = iota.Camera(position=(0, 1, 4), target=(0, 0, 0))
        for number in range(count):
            at = iota.Vec3(5.5 * (number % 20 - 9.5), 0.01 * (number % 7), -3.0 * (number // 20))
            iota.builder.chain(links=8, length=2.4, top=at, direction=(1.0, -0.1 * (number % 9), 0.0)).realize(
                world.system
            )
        if not may_give:
            world.levels.off()
        reached: list[float] = []
        with PageClient(world.start(port=0)):
            for _ in range(2 * seconds):
                began, at_first = time.perf_counter(), world.call(lambda world=world: world.system.time)
                time.sleep(0.5)
                simulated = world.call(lambda world=world: world.system.time) - at_first
                reached.append(simulated / (time.perf_counter() - began))
            told = world.call(lambda world=world: str(world.levels))
        world.stop()
        print(f"of real time, each half second: {' '.join(f'{share:.2f}' for share in reached)}; {told}", flush=True)


def toys(mode: str) -> tuple[iota.World, iota.Body]:
    """288 things that touch: towers, a wall, a heap and dominoes; and a ball to play with."""
    system = iota.System(mode=mode)
    system.rest_after = 0.5
    world = iota.World(system)
    random = np.random.default_rng(0)
    for tower in range(6):
        for floor in range(8):
            system.body(shape=iota.Box((0.4, 0.2, 0.4)), mass=32, position=(tower - 3, 0.1 + 0.2 * floor, -2))
    for row in range(10):
        for column in range(10):
            at = (0.4 * column - 2 + 0.2 * (row % 2), 0.1 + 0.2 * row, 0)
            system.body(shape=iota.Box((0.39, 0.2, 0.2)), mass=10, position=at)
    shapes = [iota.Box((0.2, 0.15, 0.25)), iota.Sphere(0.12), iota.Capsule(0.08, 0.2), iota.Cylinder(0.1, 0.2)]
    for number in range(100):
        place = tuple(random.uniform((-1, 0.3, 1.5), (1, 2.5, 3.5)))
        turn = ("x", float(random.uniform(0, 360)))
        system.body(shape=shapes[number % 4], mass=5, position=place, orientation=turn)
    for number in range(40):
        system.body(shape=iota.Box((0.06, 0.5, 0.25)), mass=3, position=(0.2 * number - 4, 0.25, -3.2))
    return world, system.body(shape=iota.Sphere(0.25), mass=30, position=(-3.5, 0.3, 4.5))


def play() -> None:
    """A hand pulls a ball of 30 kg through three hundred things that touch, at 2 m/s; with and without a budget of the time that a step
    has."""
    way = [(-3.5, 0.5, 4.5), (0, 0.4, 2.5), (1, 0.6, 1.5), (0.3, 0.5, 0.5), (0, 0.7, -0.6), (-2, 0.8, -1), (-3, 0.6, -2),
           (1, 0.7, -2), (3, 0.3, -3.2), (-4, 0.3, -3.2)]  # fmt: skip
    for mode in ("energy_keeping", "robust"):
        for has_budget in (False, True):
            world, ball = toys(mode)
            if has_budget:
                world.levels.viewers, world.levels.reach = lambda: [(0, 1, 0)], 20.0  # all is in reach
                world.levels.budget_ms = 1e3 * world.dt
            for _ in range(240):
                world.step()
            grip, taken, overlap, shares = world.system.grip(ball, (0, 0, 0)), list[float](), 0.0, list[float]()
            for begin, end in pairwise(way):
                steps = round(math.dist(begin, end) / (2 * world.dt))
                for part in np.linspace(0, 1, steps)[1:]:
                    grip.move(tuple((1 - part) * np.array(begin) + part * np.array(end)))
                    began = time.process_time()
                    report = world.step()
                    taken.append((time.process_time() - began) / world.dt)
                    overlap = max(overlap, report.worst_gap)
                    shares.append(world.system.contacts_share)
            print(
                f"{mode}, {'a' if has_budget else 'no'} budget: {spread(np.array(taken))} of a step's time, overlaps up to"
                f" {1e3 * overlap:.1f} mm, exact up to {np.mean(shares):.2f} of the usual on average",
                flush=True,
            )


def main() -> None:
    wanted = sys.argv[1] if len(sys.argv) > 1 else "gain"
    if wanted == "gain":
        draw(gain_and_error())
    elif wanted == "budget":
        budget(*map(int, sys.argv[2:3]))
    elif wanted == "walk":
        walk(*map(int, sys.argv[2:6]))
    elif wanted == "tour":
        tour(*map(int, sys.argv[2:4]))
    elif wanted == "control":
        control()
    elif wanted == "pace":
        pace(*map(int, sys.argv[2:4]))
    elif wanted == "play":
        play()


if __name__ == "__main__":
    main()
