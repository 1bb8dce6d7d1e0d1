# SPDX-License-Identifier: Apache-2.0
"""Two hundred people leave a building through its doors. Click a door, or pull it shut: they take another way. k begins, c anew."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

import iota
from iota import looks

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

MASS, RADIUS = 75.0, 0.3  # kg, m
SPEED, SPREAD, PATIENCE = 1.34, 0.2, 0.5  # m/s, Weidmann's mean and its spread; s until one walks as one wants
# Between people, and between people and walls: Helbing, Farkas, Vicsek 2000. Who touches is pushed by a spring, and held back by friction.
FEAR, REACH, BODY, RUB = 2000.0, 0.08, 6e4, 6e4  # N, m, N/m, kg/(m s)
FAR = 1.4  # m, beyond which people do not mind each other
HEIGHT = 0.9  # m, of a person's center
WALL, LOW = 0.2, 1.1  # m: thickness of a wall, and how much of it is drawn
CLEAR = 2.5  # m, beyond an exit, where people are gone
WIDE, SHUT = 2.95, 0.6  # rad: of an open door; one that stands open by less lets nobody through
BEGIN, END = 1.0, 6.0  # s: before they leave, and after the last one has, until all are back
STRENGTH = 120.0  # N m, of what moves a door
WINDOW = 5.0  # s, over which a flow is shown
COATS = ("#b5462f", "#2f6c80", "#d9a441", "#5b7f4b", "#8a4f6d", "#e8e2d4", "#3c4a63")


@dataclass
class Room:
    """A rectangle on the ground, m. Outside is a room, too."""

    low: tuple[float, float]
    high: tuple[float, float]

    def has(self, places: Array) -> Flags:
        """Whether places (n, 2) are in it."""
        return np.asarray(((places >= self.low) & (places <= self.high)).all(axis=1))


@dataclass
class Gate:
    """A door between two rooms, by number. middle: m. along: of its wall, "x" or "z". passed: when people went through, s."""

    middle: tuple[float, float]
    width: float
    along: str
    rooms: tuple[int, int]
    name: str = ""
    hinge: iota.Constraint | None = None
    passed: list[float] = field(default_factory=list)

    @property
    def is_open(self) -> bool:
        return self.hinge is None or abs(self.hinge.angle.value) > SHUT

    @property
    def ends(self) -> Array:
        """Its posts, (2, 2)."""
        way = np.array((0.5, 0.0) if self.along == "x" else (0.0, 0.5)) * self.width
        return np.array([self.middle - way, self.middle + way])

    @property
    def leaf(self) -> Array:
        """The ends of its leaf, (2, 2), m."""
        assert self.hinge is not None
        post, other = self.ends
        turn = self.hinge.angle.value * self.hinge.axis.y
        c, s = math.cos(turn), math.sin(turn)
        x, z = other - post
        return np.array([post, post + (c * x + s * z, c * z - s * x)])

    def flow(self, now: float, window: float = WINDOW) -> float:
        """People a second over the last `window` s."""
        return sum(now - window < time <= now for time in self.passed) / window


@dataclass
class Plan:
    """Rooms, gates between them, and which of the rooms are outside."""

    rooms: list[Room]
    gates: list[Gate]
    outside: set[int]
    people: dict[int, int]  # how many there are in which room


def build(people: int = 50) -> iota.World:
    """The world of the study. people: in each of the four rooms."""
    plan = house(people)
    world = iota.World(
        iota.System(gravity=(0, 0, 0)), title="evacuation: people leave a house of 20 m", dt=1 / 60, ground=0.0
    )
    world.stage(ground="#9c9f9b")
    world.camera = iota.Camera(position=(1.2, 16.0, 15.0), target=(1.2, 0, 0.3))
    for gate in plan.gates:
        hang(world, plan, gate)
    made = Evacuation(world, plan)
    draw(world, plan, made.walls)
    for gate in plan.gates:
        sign(world, made, gate)
    wanted = world.controls.slider("wanted speed", 0.6, 3.0, SPEED, step=0.02, unit="m/s", help="of those who hurry")
    wanted.on_change(lambda: made.hurry(wanted.value))
    world.controls.plot("people inside", lambda: len(made.people) - made.gone, seconds=60)
    flows = {gate.name: partial(flow, world, gate) for gate in plan.gates if gate.name}
    world.controls.plot("people a second", flows, seconds=60)

    @world.action("shut", key="k", help="shuts or opens the held or selected door")
    def shut(event: iota.Event) -> None:
        if not made.turn(event.body):
            event.notice("Nothing to shut", "Hold or select a door.")

    @world.action("anew", key="c", help="brings everybody back", on="world")
    def anew() -> None:
        made.anew()

    @world.on_reset
    def again() -> None:
        wanted.value = SPEED
        made.forget()

    return world


def house(people: int = 50) -> Plan:
    """Four rooms at a corridor with an exit at each end. people: in each of them."""
    rooms = [Room((x, z), (x + 10, end)) for x, (z, end) in product((-10, 0), ((-6, -1.4), (1.4, 6)))]
    rooms += [Room((-10, -1.4), (10, 1.4)), Room((-20, -8), (-10, 8)), Room((10, -8), (20, 8))]
    gates = [Gate((x, z), 1.0, "x", (number, 4)) for number, (x, z) in enumerate(product((-3, 3), (-1.4, 1.4)))]
    gates += [Gate((-10, 0), 1.2, "z", (4, 5), "exit west"), Gate((10, 0), 1.2, "z", (4, 6), "exit east")]
    return Plan(rooms, gates, {5, 6}, dict.fromkeys(range(4), people))


def hall(width: float, people: int) -> Plan:
    """A hall with one exit, whose flow is compared with published figures."""
    rooms = [Room((-10, -5), (0, 5)), Room((0, -8), (10, 8))]
    return Plan(rooms, [Gate((0, 0), width, "z", (0, 1), "exit")], {1}, {0: people})


class Evacuation:
    """The people, their ways and the forces on them. gone: how many have left. walls: (n, 2, 2), m."""

    def __init__(self, world: iota.World, plan: Plan, seed: int = 1) -> None:
        self.world, self.system, self.plan = world, world.system, plan
        self.random = np.random.default_rng(seed)
        self.begins = BEGIN
        self.walls = walls_of(plan)
        self.everyone = self.system.group("people")
        self.people = [self.person(*place) for place in self.places()]
        self.wishes = np.clip(self.random.normal(SPEED, SPREAD, len(self.people)), 0.8, 1.9)
        self.number = {body.particles[0]: index for index, body in enumerate(self.people)}
        self.points = self.system.array([body.particles[0] for body in self.people])
        self.start = self.points.positions
        self.before = self.where()
        self.system.pair_force(
            "gap = 2*radius - r; energy = fear*reach*exp(gap/reach) + 0.5*body*max(gap, 0)^2; drag = rub*max(gap, 0)",
            cutoff=FAR, group=self.everyone, shifted=True,
            radius=RADIUS, fear=FEAR, reach=REACH, body=BODY, rub=RUB,
        )  # fmt: skip
        self.system.field(self.force, group=self.everyone)
        self.wanted, self.open, self.left = SPEED, list[bool](), list[float]()
        self.empty_since: float | None = None
        world.on_step(self.count)

    def person(self, x: float, z: float) -> iota.Body:
        body = self.system.body()
        self.everyone.add(body.particle((x, HEIGHT, z), mass=MASS))
        body.material = iota.Material(touches="nothing")
        coat = COATS[self.random.integers(len(COATS))]
        tall = (0.94, 1.0, 1.06)[self.random.integers(3)]  # few looks are drawn fast
        self.world.draw(body, person(coat, tall))
        body.name = "a person"
        return body

    def places(self) -> list[tuple[float, float]]:
        """Places in the rooms, apart from each other."""
        found: list[tuple[float, float]] = []
        for number, count in self.plan.people.items():
            room, here = self.plan.rooms[number], np.empty((0, 2))
            while len(here) < count:
                place = self.random.uniform(np.add(room.low, 0.5), np.subtract(room.high, 0.5))
                free = not len(here) or np.linalg.norm(here - place, axis=1).min() > 2.3 * RADIUS
                if free and np.linalg.norm(away_from(self.leaves(), place[None]), axis=2).min(initial=1) > 0.5:
                    here = np.vstack([here, place])
            found += [(float(x), float(z)) for x, z in here]
        return found

    def where(self) -> Array:
        """The places of all people on the ground, (n, 2), m."""
        places: Array = np.asarray(self.points.positions, float)[:, ::2]
        return places

    # --- what drives them ---------------------------------------------------------------------------------------------

    def force(self, batch: Any) -> Array:
        """On those who are still there: they want to walk their way, and mind walls."""
        places, speeds = batch.position[:, ::2], batch.velocity[:, ::2]
        forces: Array = np.zeros_like(batch.position)
        wishes = self.wanted / SPEED * self.wishes[[self.number[particle] for particle in batch.particles]]
        way = self.ways(places) if batch.time >= self.begins else np.zeros_like(places)
        forces[:, ::2] = MASS * (wishes[:, None] * way - speeds) / PATIENCE + self.wall_forces(places, speeds)
        forces[:, 1] = -400.0 * (batch.position[:, 1] - HEIGHT) * 2 - 250.0 * batch.velocity[:, 1]
        return forces

    def ways(self, places: Array) -> Array:
        """Unit vectors towards the gate that is the next on the shortest way out; zero where there is none."""
        gates, left = self.plan.gates, self.left
        ends = np.array([gate.ends for gate in gates])
        out = np.zeros_like(places)
        for number, room in enumerate(self.plan.rooms):
            here = np.flatnonzero(room.has(places))
            if number in self.plan.outside:
                out[here] = np.sign(np.add(room.low, room.high)[0]) * np.array((1.0, 0.0))
                continue
            mine = [
                g for g, gate in enumerate(gates) if number in gate.rooms and self.open[g] and math.isfinite(left[g])
            ]
            if not mine or not len(here):
                continue
            aims = np.array([nearest(ends[g], places[here], 0.8 * RADIUS) for g in mine])
            far = np.linalg.norm(aims - places[here], axis=2)
            best = (far + np.array([left[g] for g in mine])[:, None]).argmin(axis=0)
            aim = aims[best, np.arange(len(here))]
            through = np.array([normal(gates[g], self.plan, number) for g in mine])[best]
            way = aim - places[here] + 0.5 * through  # not to stop on the sill
            out[here] = way / np.maximum(np.linalg.norm(way, axis=1), 1e-9)[:, None]
        return out

    def look(self) -> None:
        """Which gates are open, and the way from each to the nearest exit through open ones, m (Bellman and Ford)."""
        now = [gate.is_open for gate in self.plan.gates]
        if now == self.open:
            return
        self.open, outside = now, self.plan.outside
        gates = list(enumerate(self.plan.gates))
        far = [0.0 if now[g] and outside & set(gate.rooms) else math.inf for g, gate in gates]
        for _ in gates:
            for (g, gate), (h, other) in product(gates, gates):
                if now[g] and now[h] and set(gate.rooms) & set(other.rooms):
                    far[g] = min(far[g], far[h] + math.dist(gate.middle, other.middle))
        self.left = far

    def leaves(self) -> Array:
        """The leaves of the doors that do not lie at their walls, (n, 2, 2), m."""
        hinged = [gate for gate in self.plan.gates if gate.hinge is not None and gate.hinge.angle.value < WIDE - 0.3]
        return np.array([gate.leaf for gate in hinged]).reshape(-1, 2, 2)

    def wall_forces(self, places: Array, speeds: Array) -> Array:
        """Forces of walls, posts and doors, as of people who stand there."""
        away = away_from(np.concatenate([self.walls, self.leaves()]), places)
        far = np.maximum(np.linalg.norm(away, axis=2), 1e-6)
        gap = RADIUS + WALL / 2 - far
        touching = np.maximum(gap, 0)
        push = FEAR * np.exp(np.minimum(gap, 0.3) / REACH) + BODY * touching
        push[far > FAR] = 0
        normals = away / far[:, :, None]
        slip = speeds[:, None] - (speeds[:, None] * normals).sum(axis=2)[:, :, None] * normals
        total: Array = (push[:, :, None] * normals - RUB * touching[:, :, None] * slip).sum(axis=1)
        return total

    # --- what happens -------------------------------------------------------------------------------------------------

    @property
    def gone(self) -> int:
        return sum(body.kind == "inactive" for body in self.people)

    def count(self) -> None:
        """Notes who has passed a gate, and takes away who is far outside."""
        now, places = self.system.time, self.where()
        self.look()
        for gate in self.plan.gates:
            along = 1 if gate.along == "z" else 0
            beside = np.abs(places[:, along] - gate.middle[along]) < gate.width
            before, after = (spots[:, 1 - along] - gate.middle[1 - along] for spots in (self.before, places))
            crossed = (before * after < 0) & beside
            gate.passed += [now] * int(crossed.sum())
        self.before = places
        out = np.zeros(len(places), bool)
        for number in self.plan.outside:
            room = self.plan.rooms[number]
            edge = room.low[0] if room.low[0] >= 0 else room.high[0]
            out |= room.has(places) & (np.abs(places[:, 0] - edge) > CLEAR)
        for index in np.flatnonzero(out):
            if self.people[index].kind != "inactive":
                self.people[index].kind = "inactive"
        if self.gone < len(self.people):
            self.empty_since = None
        elif self.empty_since is None:
            self.empty_since = now
        elif now > self.empty_since + END:
            self.anew()

    def hurry(self, speed: float) -> None:
        """speed: that they want on the average, m/s."""
        self.wanted = speed

    def turn(self, leaf: iota.Body) -> bool:
        """Shuts or opens a door; False for another body."""
        for gate in self.plan.gates:
            if gate.hinge is not None and gate.hinge.a == leaf:
                servo = gate.hinge.angle.servo
                gate.hinge.angle.servo = (WIDE if servo is not None and servo[0] == 0 else 0.0, STRENGTH, 2.5)
                return True
        return False

    def anew(self) -> None:
        """Everybody is back in place."""
        with self.system.edit():
            for body in self.people:
                body.kind = "dynamic"
            self.points.positions = self.start
            self.points.velocities = np.zeros_like(self.start)
        self.forget()
        self.begins = self.system.time + BEGIN

    def forget(self) -> None:
        """Counts anew. After a reset the time is 0."""
        for gate in self.plan.gates:
            gate.passed.clear()
        self.before, self.empty_since, self.begins = self.where(), None, BEGIN


def walls_of(plan: Plan) -> Array:
    """The sides of all rooms but those outside, each once, without the gates in them: (n, 2, 2), m."""
    lines: dict[tuple[str, float], list[tuple[float, float]]] = {}
    for number, room in enumerate(plan.rooms):
        if number not in plan.outside:
            (x, z), (x_end, z_end) = room.low, room.high
            for at in (z, z_end):
                lines.setdefault(("x", at), []).append((x, x_end))
            for at in (x, x_end):
                lines.setdefault(("z", at), []).append((z, z_end))
    walls = []
    for (along, at), spans in lines.items():
        holes = [gate for gate in plan.gates if gate.along == along and gate.middle[along == "x"] == at]
        # The ends of walls are round, so that they begin half of the thickness beside a gate.
        halves = [(gate.middle[along == "z"], (gate.width + WALL) / 2) for gate in holes]
        cuts = sorted((middle - half, middle + half) for middle, half in halves)
        for low, high in joined(spans):
            for begin, end in [*cuts, (high, high)]:
                if low < begin:
                    walls.append([(low, at), (begin, at)] if along == "x" else [(at, low), (at, begin)])
                low = max(low, end)
    return np.array(walls)


def joined(spans: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The union of intervals."""
    found: list[tuple[float, float]] = []
    for low, high in sorted(spans):
        if found and low <= found[-1][1]:
            found[-1] = (found[-1][0], max(found[-1][1], high))
        else:
            found.append((low, high))
    return found


def away_from(walls: Array, places: Array) -> Array:
    """The ways from the nearest places of walls (w, 2, 2) to others (n, 2), (n, w, 2), m."""
    start, along = walls[:, 0], walls[:, 1] - walls[:, 0]
    share = ((places[:, None] - start) * along).sum(axis=2) / (along**2).sum(axis=1)
    ways: Array = places[:, None] - (start + np.clip(share, 0, 1)[:, :, None] * along)
    return ways


def nearest(ends: Array, places: Array, margin: float) -> Array:
    """The places between two posts, at a margin from them, that are nearest to others, (n, 2), m."""
    along = ends[1] - ends[0]
    length = float(np.linalg.norm(along))
    inside = min(margin / length, 0.5)
    share = np.clip((places - ends[0]) @ along / length**2, inside, 1 - inside)
    found: Array = ends[0] + share[:, None] * along
    return found


def normal(gate: Gate, plan: Plan, room: int) -> Array:
    """The direction from a room through a gate."""
    axis = 1 if gate.along == "x" else 0
    middle = (plan.rooms[room].low[axis] + plan.rooms[room].high[axis]) / 2
    way = np.zeros(2)
    way[axis] = np.sign(gate.middle[axis] - middle)
    return way


def person(coat: str, tall: float) -> list[looks.Look]:
    """Somebody who stands, 1.7 m tall, around the middle of the body."""
    up = (0.0, 0.0, 0.5**0.5, 0.5**0.5)
    return [
        looks.capsule(0.17, "paint", 0.42 * tall, color=coat, offset=(0, 0.1 * tall, 0), rotation=up),
        looks.capsule(
            0.13, "paint", 0.5 * tall, color="#3b3f46", offset=(0, 0.5 * tall - HEIGHT - 0.02, 0), rotation=up
        ),
        looks.sphere(0.115, "paint", color="#d9ae8c", offset=(0, 0.64 * tall, 0)),
    ]


def draw(world: iota.World, plan: Plan, walls: Array) -> None:
    """Walls that are cut low, so that one sees into the rooms, and floors."""
    for (x, z), (x_end, z_end) in walls:
        size = (abs(x_end - x) + WALL, LOW, abs(z_end - z) + WALL)
        world.add_static(looks.box(size, "paint", color="#ece8df"), ((x + x_end) / 2, LOW / 2, (z + z_end) / 2))
    for number, room in enumerate(plan.rooms):
        if number not in plan.outside:
            (x, z), (x_end, z_end) = room.low, room.high
            color = "#b9c2c4" if x_end - x > 15 else "#c7b59a"
            look = looks.box((x_end - x, 0.02, z_end - z), "paint", color=color)
            world.drawings.shape(look, position=((x + x_end) / 2, 0.005, (z + z_end) / 2))


def hang(world: iota.World, plan: Plan, gate: Gate) -> None:
    """A door, open, on hinges at one of its posts."""
    system, (post, _) = world.system, gate.ends
    outside = plan.outside & set(gate.rooms)
    way = normal(gate, plan, gate.rooms[0]) * (
        1 if outside else -1
    )  # exits open outwards, rooms inwards, and lie at the wall
    x, z = gate.middle
    size = (gate.width - 0.04, LOW - 0.06, 0.06) if gate.along == "x" else (0.06, LOW - 0.06, gate.width - 0.04)
    leaf = system.body(
        shape=iota.Box(size, 0.01), mass=25, position=(x, LOW / 2, z), material=iota.Material(touches="nothing")
    )
    leaf.name = gate.name or "door"
    world.draw(leaf, looks.solid("paint", "#c8322b" if outside else "#2f6c80"))
    turn = math.copysign(1.0, iota.Vec3(x - post[0], 0, z - post[1]).cross((way[0], 0, way[1])).y)
    gate.hinge = system.revolute(leaf, at=(post[0], LOW / 2, post[1]), axis=(0, turn, 0), limits=(0, WIDE + 0.02))
    gate.hinge.angle.value = WIDE
    gate.hinge.angle.servo = (WIDE, STRENGTH, 2.5)


def sign(world: iota.World, made: Evacuation, gate: Gate) -> None:
    """Its flow is written above it, and a click shuts or opens it."""
    assert gate.hinge is not None
    label = world.label("", at=(gate.middle[0], LOW + 1.1, gate.middle[1]), height=0.26)

    @world.every(0.25)
    def tell() -> None:
        label.text = f"{flow(world, gate):.1f} /s" if gate.is_open else "shut"

    def click(event: iota.Event) -> None:
        made.turn(event.body)

    world.on_click(gate.hinge.a)(click)


def flow(world: iota.World, gate: Gate) -> float:
    """People a second over the last seconds."""
    return gate.flow(world.system.time)


if __name__ == "__main__":
    build().run()
