# SPDX-License-Identifier: Apache-2.0
"""Fifty exhibits that work: those that visitors see are simulated in full, the others less; 1 goes along with a visitor, t tints."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

import iota
from iota import looks, studies
from iota.levels.level import Level
from iota.levels.managed import Managed
from iota.studies import (
    bucky,
    cradle_contact,
    crowd,
    evacuation,
    ladder,
    mechanisms,
    molecule,
    soft_molecule,
    undersea,
    weather,
)
from iota.studies._stands import arm, tripod
from iota.world.shown import Paint
from iota.world.things import Frame

BUDGET = 1.5  # ms of processor time a step
HALL, DEPTH, HEIGHT, WALL = 8.0, 6.4, 3.2, 0.16  # of a hall along x, and z; of its walls; m
BACK, FRONT = -2.1, 0.6  # z of the two rows of exhibits, m
DOOR = (1.7, 1.6, 2.4)  # z of its middle, width, height, m
TOP = 0.8  # of a plinth, m
PACE, EYE = 0.9, 1.55  # m/s and m, of the visitor
AISLES = ((BACK + FRONT) / 2, DOOR[0])  # z of the ways, m
HIDDEN = 0.05  # of its significance: an exhibit behind a wall
CALM = 12.0  # s, after which a visitor sets an exhibit going once more
COATS = ("#b5462f", "#d9a441", "#5b7f4b", "#2f6c80", "#8a5a83")
LEVELS = ("full", "1/2", "1/4", "1/8", "frozen")  # a stiff one would be drawn otherwise
# Its script parts and joins blocks by the forces of each step.
LEVELS_OF = {"Jacob's ladder": ("full", "frozen")}
TINTS = {name: crowd.TINTS[name] for name in LEVELS}
Maker = Callable[[iota.World, iota.Vec3, int], Callable[[], None] | None]


@dataclass
class Exhibit:
    """at: on the floor, m. again: what a visitor does to it."""

    name: str
    hall: int
    at: iota.Vec3
    bodies: list[iota.Body]
    again: Callable[[], None] | None = None
    thing: Managed = field(init=False)
    touched: float = -math.inf


def build(budget_ms: float | None = BUDGET) -> iota.World:
    """The world of the study. budget_ms: None simulates all in full."""
    system = iota.System(damping=0.04)
    system.usual_material = iota.Material(friction=0.6, touches="obstacles")
    world = iota.World(system, title=f"museum: {len(HALLS) * HALL:.0f} m of halls", ground=0.0)
    world.scene.shows_edits = False
    world.stage(sky="#7d93a8", horizon="#c3ccd2", ground="#6f6a62", light=0.8)
    museum = Museum(world)
    world.levels.viewers = museum.eyes
    world.levels.reach = 2.5
    world.levels.budget_ms = budget_ms
    return world


class Museum:
    """The building, its exhibits, and a visitor who walks through all halls and back."""

    def __init__(self, world: iota.World) -> None:
        self.world, self.system = world, world.system
        self.exhibits: list[Exhibit] = []
        self.is_tinted = False
        self.walls: list[iota.Body] = []
        world.draw_ties("spring", looks.box((0.1, 0.006, 0.006), "rope"))  # a thousand of them
        world.draw_ties("rope", looks.cylinder(0.004, "rope"))
        self.fields()
        for number, (title, rows) in enumerate(HALLS.items()):
            self.hall(number, title)
            for z, row in zip((BACK, FRONT), rows, strict=True):
                self.row(number, z, row)
        for each in self.exhibits:
            each.thing = world.levels.manage(
                each.bodies,
                levels=next((own for kind, own in LEVELS_OF.items() if each.name.startswith(kind)), LEVELS),
                significance=partial(self.significance, each),
                on_level=lambda thing, level: self.tint(thing, level),
                name=each.name,
            )
        self.colors = [TINTS["full"]] * len(self.exhibits)
        self.lamps = world.drawings.points(np.array(self.signs), 0.022, self.colors)
        self.way = self.calc_way()
        self.lengths = np.r_[0, np.cumsum(np.linalg.norm(np.diff(self.way, axis=0), axis=1))]
        self.visitor = self.draw_visitor()
        world.every(1 / 30)(self.walk)
        world.every(0.5)(self.set_going)
        world.action("tint", key="t", help="colors exhibits by their levels, or as they are", on="world")(self.toggle)
        world.camera = view_of(0)
        world.drawings.viewpoint("go along", self.seat, self.ahead)
        for number, title in enumerate(HALLS):
            world.drawings.viewpoint(title, view_of(number).position, view_of(number).target)
        world.drawings.viewpoint("the whole museum", WHOLE.position, WHOLE.target)

    # --- who looks ----------------------------------------------------------------------------------------------------

    def eyes(self) -> list[iota.Vec3]:
        """The visitor's, and those of users."""
        return [self.eye(), *(iota.Vec3(*eye) for eye in self.world.levels.eyes())]

    def eye(self) -> iota.Vec3:
        x, z = self.place(self.system.time)
        return iota.Vec3(x, EYE, z)

    def place(self, time: float) -> tuple[float, float]:
        """The visitor walks there and back: x and z on the floor, m."""
        way = (PACE * time + 2.0) % self.lengths[-1]
        x, z = (float(np.interp(way, self.lengths, axis)) for axis in self.way.T)
        return x, z

    @staticmethod
    def calc_way() -> np.ndarray:
        """Through each hall between its rows, and back along the doors."""
        back, doors = AISLES
        points = []
        for number in range(len(HALLS)):
            left, right = HALL * number + 0.7, HALL * (number + 1) - 0.7
            points += [(left, doors), (left, back), (right, back), (right, doors)]
        points += [(0.7, doors)]
        return np.array(points)

    def significance(self, exhibit: Exhibit, thing: Managed) -> float:
        """Visual angle times speed, as usual, but less for what a wall hides."""
        speed = max((abs(body.velocity) for body in exhibit.bodies[:4] if body.alive), default=0.0)
        best = 0.0
        middle = exhibit.at + (0, 1.2, 0)
        for eye in self.eyes():
            distance = max(abs(middle - eye), 0.5)
            seen = min(thing.size / distance, math.pi) * (speed / distance + 0.02)
            best = max(best, seen if self.sees(eye, middle) else HIDDEN * seen)
        return best

    @staticmethod
    def sees(eye: iota.Vec3, place: iota.Vec3) -> bool:
        """Whether no wall between two halls is between them; doors are open, and so is the front."""
        for number in range(1, len(HALLS)):
            x = HALL * number
            if (eye.x - x) * (place.x - x) < 0:
                z = eye.z + (place.z - eye.z) * (x - eye.x) / (place.x - eye.x)
                if -DEPTH / 2 < z < DEPTH / 2 and abs(z - DOOR[0]) > DOOR[1] / 2:
                    return False
        return True

    def walk(self) -> None:
        x, z = self.place(self.system.time)
        ahead = self.place(self.system.time + 1.2)
        way = np.array([ahead[0] - x, ahead[1] - z])
        way = way / max(float(np.linalg.norm(way)), 1e-9)
        self.visitor.at = (x, 0.86, z)
        self.seat.at = (x - 2.2 * way[0], 2.1, z - 2.2 * way[1] + 0.6)
        self.ahead.at = (x + 2.0 * way[0], 0.95, z + 2.0 * way[1] - 0.7)

    def set_going(self) -> None:
        """A visitor sets going what is near and has come to rest."""
        eye = self.eye()
        for each in self.exhibits:
            near = abs(each.at + (0, EYE, 0) - eye) < self.world.levels.reach + 0.3
            if each.again is not None and near and self.system.time - each.touched > CALM:
                each.touched = self.system.time
                each.again()

    def draw_visitor(self) -> Frame:
        frame = self.world.drawings.frame((0, 0.86, 0))
        for look in evacuation.person("#2f6c80", 1.0):
            self.world.drawings.shape(look, on=frame, position=look.offset, rotation=look.rotation)
        self.world.drawings.shape(looks.sphere(0.05, "brass", color="#ffe3a0"), on=frame, position=(0.24, 0.0, 0.12))
        self.world.drawings.light("point", at=frame, color="#ffd9a0", reach=1.2, intensity=0.3)
        self.seat = self.world.drawings.frame((0, EYE, 0))
        self.ahead = self.world.drawings.frame((1, EYE, 0))
        return frame

    # --- levels -------------------------------------------------------------------------------------------------------

    def toggle(self) -> None:
        self.is_tinted = not self.is_tinted
        for each in self.exhibits:
            self.tint(each.thing, each.thing.level)

    def tint(self, thing: Managed, level: Level) -> None:
        """Colors an exhibit, and the lamp under its label."""
        exhibit = next(each for each in self.exhibits if each.thing is thing)
        self.colors[self.exhibits.index(exhibit)] = TINTS[level.name]
        self.lamps.color = self.colors
        if exhibit.name in self.paints:
            self.paints.pop(exhibit.name).destroy()
        if self.is_tinted:
            self.paints[exhibit.name] = self.world.drawings.paint(exhibit.bodies, TINTS[level.name])

    # --- the building -------------------------------------------------------------------------------------------------

    def hall(self, number: int, title: str) -> None:
        """Floor, walls, a lamp and its name."""
        left, middle, add = HALL * number, HALL * (number + 0.5), self.world.add_static
        paint = HUES[number % len(HUES)]
        floor = looks.box((HALL, 0.012, DEPTH), "paint", color="#8d8476" if number % 2 else "#80776a")
        self.world.drawings.shape(floor, position=(middle, 0.0, 0))
        add(looks.box((HALL, HEIGHT, WALL), "paint", color=paint), (middle, HEIGHT / 2, -DEPTH / 2 - WALL / 2))
        add(looks.box((HALL, 0.12, 0.03), "paint", color="#f4f1ea"), (middle, 0.06, -DEPTH / 2 + 0.015))
        self.divide(left, paint)
        if number == len(HALLS) - 1:
            self.divide(left + HALL, paint)
        self.world.label(title, at=(middle, HEIGHT + 0.25, -DEPTH / 2), height=0.16)
        for place, name in enumerate(PAINTINGS[title]):
            x = left + HALL * (2 * place + 1) / (2 * len(PAINTINGS[title]))
            frame = looks.box((1.02, 0.62, 0.03), "wood", color="#6b4a2e")
            self.world.drawings.shape(frame, position=(x, 2.3, -DEPTH / 2 + 0.015))
            picture = looks.box((0.96, 0.54, 0.01), "paint", texture=str(studies.PICTURES / f"{name}.jpg"))
            self.world.drawings.shape(picture, position=(x, 2.3, -DEPTH / 2 + 0.032))
        lamp = (middle, HEIGHT + 1.0, 2.6)
        self.world.drawings.light(
            "spot", at=lamp, to=(middle, 0.6, -1.0), color="#fff0d8", reach=5.0, angle=0.75, intensity=0.7
        )

    def divide(self, x: float, paint: str) -> None:
        """A wall with a door across the building."""
        middle, width, high = DOOR
        low, end = middle - width / 2, DEPTH / 2
        for begin, finish, bottom in ((-end, low, 0.0), (low + width, end, 0.0), (low, low + width, high)):
            size = (WALL, HEIGHT - bottom, finish - begin)
            place = (x, (HEIGHT + bottom) / 2, (begin + finish) / 2)
            self.world.add_static(looks.box(size, "paint", color=paint), place)
        for z in (low, low + width):
            jamb = looks.box((WALL + 0.06, high, 0.06), "wood", color="#8a5f3c")
            self.world.drawings.shape(jamb, position=(x, high / 2, z))

    def row(self, number: int, z: float, kinds: tuple[str, ...]) -> None:
        """Exhibits side by side."""
        widths = [KINDS[kind][1] for kind in kinds]
        gap = (HALL - WALL - sum(widths)) / (len(kinds) + 1)
        x = HALL * number + WALL / 2 + gap
        for kind, width in zip(kinds, widths, strict=True):
            self.add(kind, number, iota.Vec3(x + width / 2, 0, z))
            x += width + gap

    def add(self, kind: str, hall: int, at: iota.Vec3) -> None:
        maker, width, plinth = KINDS[kind]
        count = 1 + sum(each.name.startswith(kind) for each in self.exhibits)
        if plinth:
            wood = looks.box((width, TOP, 0.5), "wood", color="#8d7458")
            self.world.add_static(wood, (at.x, TOP / 2, at.z))
        before = set(self.system.bodies)
        again = maker(self.world, at, count)
        made = [body for body in self.system.bodies if body not in before and body.kind in ("dynamic", "resting")]
        name = f"{kind} {count}"
        self.exhibits.append(Exhibit(name, hall, at, made, again))
        sign = at + (0, TOP - 0.16 if plinth else 0.2, 0.42 if plinth else 0.66)
        self.world.label(kind, at=tuple(sign), height=0.036)
        self.signs.append(tuple(sign - (0, 0.075, 0)))

    def fields(self) -> None:
        """Water around weed, one wind on all flags, and forces that carry cages of carbon."""
        system = self.system
        weed, _, cages, cloth = (system.group(name) for name in ("weed", "soft", "cages", "cloth"))
        lift = system.gravity * -1.0
        system.field("uniform", group=weed, acceleration=lift + (0, undersea.BUOYANCY, 0))
        system.field("current", group=weed, velocity=(0.1, 0, 0), drag=0.02, speed=0.5, size=1.2, evolution=0.4)
        system.field("uniform", group=cages, acceleration=lift)
        system.field(
            "current",
            group=cloth,
            velocity=weather.WIND,
            drag=weather.DRAG,
            speed=1.6,
            size=0.5,
            octaves=3,
            evolution=1.5,
        )
        self.signs: list[tuple[float, ...]] = []
        self.paints: dict[str, Paint] = {}


def view_of(hall: int) -> iota.Camera:
    """From in front of a hall."""
    x = HALL * (hall + 0.5)
    return iota.Camera(position=(x + 1.2, 2.1, 4.7), target=(x - 0.1, 1.15, -0.6))


# --- exhibits: each at a place on the floor -------------------------------------------------------------------------------


def group(world: iota.World, name: str) -> iota.Group:
    return next(each for each in world.system.groups if each.name == name)


def engine(world: iota.World, at: iota.Vec3, number: int) -> None:
    mechanisms.engine(world, at + (-0.175, TOP + 0.24, 0), TOP, speed=2.0 + number)


def shaft(world: iota.World, at: iota.Vec3, number: int) -> None:
    mechanisms.shaft(world, at + (-0.29, TOP + 0.24, 0), TOP)


def scales(world: iota.World, at: iota.Vec3, number: int) -> Callable[[], None]:
    before = set(world.system.bodies)
    mechanisms.scales(world, at + (0, TOP + 0.62, 0), TOP)
    weight = next(body for body in world.system.bodies if body not in before and isinstance_cylinder(body))
    return lambda: push(weight, (0, 0.15, 0))


def isinstance_cylinder(body: iota.Body) -> bool:
    return bool(body.solids) and isinstance(body.solids[0].shape, iota.Cylinder)


def crane(world: iota.World, at: iota.Vec3, number: int) -> Callable[[], None]:
    weight, _ = mechanisms.crane(world, at + (-0.16, TOP, 0))
    return lambda: push(weight, (0.3, 0, 0.5))


def pendulum(world: iota.World, at: iota.Vec3, number: int) -> Callable[[], None]:
    bar = mechanisms.pendulum(world, at + (0, TOP + 0.2, 0), TOP, stiffness=10.0 * number)

    def again() -> None:
        if bar.alive:
            bar.angular_velocity = (0, 0, 6)

    return again


def cradle(metal: str, world: iota.World, at: iota.Vec3, number: int) -> Callable[[], None]:
    row = cradle_contact.Row(world, metal, 3 + number, at + (0, TOP, 0), label=False)
    row.lift(number, 0)
    return lambda: row.lift(number, 0)


def blocks(world: iota.World, at: iota.Vec3, number: int) -> Callable[[], None]:
    top = at + (0, TOP + 0.55, 0)
    ladder.stand(world, top, TOP)
    return ladder.Ladder(world, 5 + 2 * number, top).tip


def hung_chain(world: iota.World, at: iota.Vec3, number: int) -> Callable[[], None]:
    top, links = at + (0, 1.85, 0), 12 * number
    tripod(world, top)
    made = iota.builder.chain(links, 1.5, top=top, direction=(-0.2, -0.9, 0.3)).realize(world.system).bodies
    world.draw(made, looks.chain_link(1.5 / links))
    return lambda: push(made[-1], (1.5, 0, 1.0))


def hung(
    maker: Callable[..., iota.Body], kick: float, world: iota.World, at: iota.Vec3, number: int
) -> Callable[[], None]:
    """An acrobat, a rope ladder or a chain of the crowd, at gallows."""
    top = at + (0, 2.45, 0)
    crowd.gallows(world, top)
    root = maker(world, top, COATS[number % len(COATS)], number)
    return lambda: push(root.articulate.bodies[-1 if maker is not crowd.acrobat else 0], (0, 0, kick))


def ring(world: iota.World, at: iota.Vec3, number: int) -> Callable[[], None]:
    nail = at + (0, 1.35, 0)
    made = molecule.hang(world, "rigid", nail)
    arm(world, nail)
    return lambda: push(made.points[1].body, (0.6, 0, 0.3))


def soft_ring(world: iota.World, at: iota.Vec3, number: int) -> Callable[[], None]:
    nail = at + (0, 1.45, 0)
    made = soft_molecule.hang_softly(world, nail)
    arm(world, nail)
    return lambda: push(made.points[5].body, (1.5, 0, 1.0))


def cage(world: iota.World, at: iota.Vec3, number: int) -> Callable[[], None]:
    center = at + (0, 1.3, 0)
    made = bucky.make(world.system, center)
    bucky.stand(world, center)
    group(world, "cages").add(*made.points)
    atoms = world.system.array(made.points[:60])
    bucky.breathe(atoms, 0.2, center)
    return lambda: bucky.breathe(atoms, 0.2, center)


def flag(world: iota.World, at: iota.Vec3, number: int) -> None:
    before = set(world.system.bodies)
    weather.flag(world, at + (-0.38, 1.95, 0), COATS[number % len(COATS)])
    world.draw([body for body in world.system.bodies if body not in before], [])  # its knots


def bed(world: iota.World, at: iota.Vec3) -> None:
    """The bottom of the sea."""
    world.drawings.shape(looks.box((1.0, 0.03, 1.0), "paint", color="#3f6a74"), position=tuple(at))


def kelp(world: iota.World, at: iota.Vec3, number: int) -> None:
    bed(world, at)
    undersea.kelp(world, group(world, "weed"), at.x, at.z, 2.3)


def bush(world: iota.World, at: iota.Vec3, number: int) -> None:
    bed(world, at)
    undersea.bush(world, group(world, "weed"), (at.x, at.y, at.z))


def ribbon(world: iota.World, at: iota.Vec3, number: int) -> None:
    bed(world, at)
    undersea.ribbon(world, group(world, "weed"), (at.x, at.y, at.z))


def push(body: iota.Body, velocity: tuple[float, float, float]) -> None:
    if body.alive:
        body.velocity += velocity


KINDS: dict[str, tuple[Maker, float, bool]] = {  # maker, width, m, and whether it stands on a plinth
    "steam engine": (engine, 0.95, True),
    "two crosses": (shaft, 0.85, True),
    "scales": (scales, 0.55, True),
    "crane": (crane, 0.65, True),
    "torsion pendulum": (pendulum, 0.55, True),
    "cradle of steel": (partial(cradle, "steel"), 0.5, True),
    "cradle of lead": (partial(cradle, "lead"), 0.5, True),
    "Jacob's ladder": (blocks, 0.5, True),
    "chain": (hung_chain, 1.6, False),
    "acrobat": (partial(hung, crowd.acrobat, 0.8), 1.1, False),
    "rope ladder": (partial(hung, crowd.ladder, 1.0), 0.9, False),
    "swinging chain": (partial(hung, crowd.chain, 1.2), 0.8, False),
    "rigid ring": (ring, 1.1, False),
    "soft ring": (soft_ring, 1.1, False),
    "cage of carbon": (cage, 1.5, False),
    "flag": (flag, 0.95, False),
    "kelp": (kelp, 1.0, False),
    "bush": (bush, 1.0, False),
    "ribbon": (ribbon, 1.0, False),
}
PAINTINGS = {
    "Machines": ("mechanisms", "rigging", "grasp"),
    "Balls and blocks": ("cradle-contact", "ladder", "chain"),
    "Circus": ("crowd", "wrecking-ball", "playground"),
    "Molecules": ("bucky", "molecule", "soft-molecule"),
    "Wind and water": ("weather", "undersea", "shoal"),
}
HUES = ("#7d8f86", "#9a7f6b", "#8c5a50", "#5f7488", "#6d8a8f")
HALLS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {  # its name; exhibits at the wall, and in front of these
    "Machines": (
        ("steam engine", "scales", "two crosses", "crane", "steam engine"),
        ("torsion pendulum", "steam engine", "torsion pendulum", "two crosses", "torsion pendulum"),
    ),
    "Balls and blocks": (
        ("chain", "cradle of steel", "Jacob's ladder", "cradle of lead", "chain"),
        ("cradle of steel", "Jacob's ladder", "cradle of steel", "scales", "cradle of lead"),
    ),
    "Circus": (
        ("acrobat", "rope ladder", "acrobat", "rope ladder", "acrobat"),
        ("swinging chain", "rope ladder", "swinging chain", "acrobat", "swinging chain"),
    ),
    "Molecules": (
        ("cage of carbon", "rigid ring", "cage of carbon", "rigid ring", "cage of carbon"),
        ("soft ring", "rigid ring", "soft ring", "rigid ring", "soft ring"),
    ),
    "Wind and water": (
        ("flag", "kelp", "flag", "bush", "flag"),
        ("ribbon", "kelp", "ribbon", "bush", "ribbon"),
    ),
}
WHOLE = iota.Camera(position=(-3.5, 6.5, 12.5), target=(0.33 * HALL * len(HALLS), 0.5, -1.5))


if __name__ == "__main__":
    build().run()
