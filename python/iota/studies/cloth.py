# SPDX-License-Identifier: Apache-2.0
"""A cloth on a bar; pull, and a rip runs through it. n lets the wind blow, b tears a knot out, c makes a new cloth."""

from __future__ import annotations

import numpy as np

import iota
from iota import looks

CORNER = iota.Vec3(-0.6, 2.0, 0)
COLUMNS, ROWS, SPACING = 17, 13, 0.075  # m
TEAR = 1.0  # N, what a thread across carries
UPRIGHT = 1.8  # times as much: an upright one. So rips run up and down.
TIP = 0.5  # share of its strength at the tip of a rip, which is sharper than the cells of the cloth
FIRM = 2.5  # cells around a hand that the fingers keep together
POST, CLEAR = (
    0.02,
    0.075,
)  # m: radius of a post; how near a knot comes, so that no thread between two knots cuts through it


NEAR, PUSH = 0.07, 60.0  # m: knots that are nearer push each other away, so that layers do not pass each other; N/m


class Weave:
    """The threads of a cloth, and what a rip and a hand do to them. Threads are numbered as the bonds of the cloth."""

    def __init__(self, world: iota.World, made: iota.builder.Realized) -> None:
        self._world, self._bonds = world, list(made.bonds)
        number = {point: index for index, point in enumerate(made.points)}
        places = np.array([tuple(point.position) for point in made.points])
        p, q = (
            places[np.array([[number[end] for end in bond.ends] for bond in self._bonds])].transpose(1, 0, 2) / SPACING
        )
        self._middles = (p + q) / 2  # cells
        self._number = {bond: index for index, bond in enumerate(self._bonds)}
        self._start = {point.body: place / SPACING for point, place in zip(made.points, places, strict=True)}
        across, down, _ = np.abs(q - p).T
        # By the axis along which a rip through them runs: across threads and upright ones. The others only keep cells in form.
        self._threads = {0: (down < 0.1) & (across < 1.5), 1: (across < 0.1) & (down < 1.5)}
        strength = np.where(self._threads[0], TEAR, np.where(self._threads[1], UPRIGHT * TEAR, np.inf))
        self._strength = strength
        for bond, newtons in zip(self._bonds, strength, strict=True):
            bond.break_force = float(newtons)
        self._left = strength.copy()  # of it, N
        self._held: iota.Body | None = None
        world.on_step(self._hand_on)
        world.on_reset(self._mend)

    def _mend(self) -> None:
        self._left[:], self._held = self._strength, None

    def _hand_on(self) -> None:
        """The neighbors of what has torn carry its load, and are weaker at the tip of the rip; a hand keeps what it holds together."""
        changed: set[int] = set()
        for broken in self._world.system.broken:
            index = None if broken.bond is None else self._number.get(broken.bond)
            if index is not None:
                changed |= self._tear(index)
        held = self._world.users.held()
        if held != self._held:
            changed |= self._near(self._held) | self._near(held)
            self._held = held
        firm = self._near(held)
        for index in changed:
            bond = self._bonds[index]
            if bond.alive:
                bond.break_force = np.inf if index in firm else float(self._left[index])

    def _tear(self, index: int) -> set[int]:
        """Weakens the next threads of the same direction, on both sides of a torn one, and what crossed it."""
        for along, threads in self._threads.items():
            if threads[index]:
                away = np.abs(self._middles - self._middles[index])
                beside = threads & (away[:, along] < 0.1) & (away[:, 1 - along] < 1.1)
                crosses = ~self._threads[0] & ~self._threads[1] & (np.hypot(away[:, 0], away[:, 1]) < 0.6)
                self._left[beside] = TIP * self._strength[beside]
                self._left[crosses] = 1e-3
                return set(np.flatnonzero(beside | crosses))
        return set()

    def _near(self, body: iota.Body | None) -> set[int]:
        """The part that is between the fingers."""
        if body not in self._start:
            return set()
        return set(np.flatnonzero(np.linalg.norm(self._middles - self._start[body], axis=1) < FIRM))


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(mode="robust", damping=0.2)
    world = iota.World(system, title="cloth: it hangs in the wind, and rips where it is pulled; 1.2 m wide")
    cloth = iota.builder.cloth(COLUMNS, ROWS, SPACING, CORNER, mass=0.45, stiffness=120, damping=0.05, tear=TEAR)
    cloth.points.radius[:] = 0.003
    made = cloth.realize(system)
    wind = system.field(
        "current", group=made.groups["cloth"], velocity=(0.3, 0, 1.2), drag=0.0035, speed=1.0, size=0.6, evolution=1.0
    )
    system.pair_force("soft_repulsion", cutoff=NEAR, group=made.groups["cloth"], stiffness=PUSH, length=NEAR)
    Weave(world, made)
    present(world, made)

    @world.action("wind", key="n", help="the wind drops, or comes back", on="world")
    def blow() -> None:
        wind.active = not wind.active

    @world.action("tear", key="b", button="b", help="tears what you hold out of its threads")
    def tear(event: iota.Event) -> None:
        for bond in system.bonds:
            if event.body in (end.body for end in bond.ends):
                bond.destroy()

    @world.action("mend", key="c", button="a", help="a new cloth", on="world")
    def mend() -> None:
        world.reset()

    return world


def gingham() -> np.ndarray:
    """Red and white stripes across each other, of single threads: an image of 14 x 14 pixels for a cell."""
    rows, columns = np.indices((14 * (ROWS - 1), 14 * (COLUMNS - 1)))
    share = (columns // 14 % 2 + rows // 14 % 2)[..., None] / 2
    grain = 10 * ((rows + columns) % 2)[..., None] - 5 + np.random.default_rng(0).normal(0, 4, (*rows.shape, 1))
    return np.clip((1 - share) * (226, 216, 202) + share * (158, 32, 40) + grain, 0, 255).astype(np.uint8)


def present(world: iota.World, made: iota.builder.Realized) -> None:
    """The cloth between its threads, pegs on the bar that holds its upper edge, its frame on a lawn, and a basket."""
    world.draw_ties("spring", [])
    corners = [(row * COLUMNS + column, COLUMNS) for row in range(ROWS - 1) for column in range(COLUMNS - 1)]
    triangles = [t for k, below in corners for t in ((k, k + below, k + 1), (k + 1, k + below, k + below + 1))]
    spots = [(column / (COLUMNS - 1), 1 - row / (ROWS - 1)) for row in range(ROWS) for column in range(COLUMNS)]
    world.surface(
        list(made.points), triangles, threads=made.bonds, material="rubber", texture=gingham(), coordinates=spots
    )
    for point in made.points:
        point.body.name = "cloth"
    world.drawings.paint([point.body for point in made.points], "#c8a09a")  # they are in the shadow of their cloth
    left, right, y = CORNER.x - 0.3, CORNER.x + (COLUMNS - 1) * SPACING + 0.3, CORNER.y
    world.add_strut((left, y, 0), (right, y, 0), looks.cylinder(0.014, "wood"))
    for column in range(0, COLUMNS, 4):
        world.add_static(
            looks.box((0.012, 0.075, 0.03), "wood", 0.003, color="#e9c58a"), (CORNER.x + column * SPACING, y - 0.01, 0)
        )
    for x in (left, right):
        post = world.add_strut((x, 0, 0), (x, y + 0.03, 0), looks.cylinder(CLEAR, "wood"))
        world.draw(post, looks.cylinder(POST, "wood", abs(y + 0.03)))
        world.add_static(looks.box((0.06, 0.04, 0.5), "wood"), (x, 0.02, 0))
    basket = looks.Look(iota.Cylinder(0.24, 0.26), "rope", rotation=("z", 90))
    world.add_static(basket, (-1.35, 0.13, -0.5))
    world.add_static(looks.Look(iota.Torus(0.24, 0.016), "rope", rotation=("x", 90)), (-1.35, 0.26, -0.5))
    world.add_static(looks.Look(iota.Ellipsoid((0.42, 0.16, 0.42)), "rubber", "#e8e2d6"), (-1.35, 0.27, -0.5))
    world.drawings.stage(ground="#8a9670")
    world.camera = iota.Camera(position=(0.9, 1.45, 3.3), target=(-0.1, 1.08, 0))
