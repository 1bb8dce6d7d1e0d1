# SPDX-License-Identifier: Apache-2.0
"""One of each kind of drawing in a cell of its own, in eight columns and five rows of the picture, for kept pictures of them."""

from __future__ import annotations

import math
from itertools import count
from pathlib import Path
from tempfile import mkdtemp

import numpy as np

import iota
from iota import looks, shapelib

COLUMNS, ROWS, AWAY = 8, 5, 4.0
HIGH = 2 * AWAY * math.tan(math.radians(21))  # of the picture at the middle of the scene, m
WIDE = 16 / 9 * HIGH
TILT = (0.1305, 0.3827, 0.0537, 0.9130)  # a little from above and beside
RED, GREEN, BLUE, AMBER = "#d0402b", "#4c9a52", "#3f7fd0", "#f2a324"
CLASS = """
const { three } = globalThis.iota;
iota.define("knot", {
  make: ({ color }) => {
    const group = new three.Group();
    for (let part = 0; part < 6; part++) {
      const ball = new three.Mesh(new three.SphereGeometry(0.06), new three.MeshBasicMaterial({ color }));
      ball.position.set(0.14 * Math.cos(part * Math.PI / 3), 0.14 * Math.sin(part * Math.PI / 3), 0);
      group.add(ball);
    }
    return group;
  },
});
"""

cells = count()


def cell() -> tuple[float, float, float]:
    """The middle of the next one, m."""
    row, column = divmod(next(cells), COLUMNS)
    return WIDE * ((column + 0.5) / COLUMNS - 0.5), 1.8 + HIGH * (0.5 - (row + 0.5) / ROWS), 0.0


def beside(
    at: tuple[float, float, float], x: float = 0.0, y: float = 0.0, z: float = 0.0
) -> tuple[float, float, float]:
    return at[0] + x, at[1] + y, at[2] + z


def build() -> iota.World:
    system = iota.System(gravity=(0, 0, 0))
    world = iota.World(system, title="kinds", ground=0.0, dt=0.05)
    world.camera = iota.Camera(position=(0, 1.8, AWAY), target=(0, 1.8, 0))
    draw_shapes(world)
    draw_strokes(world)
    draw_surfaces(world)
    draw_bodies(world)
    return world


def draw_shapes(world: iota.World) -> None:
    for look in (
        looks.sphere(0.17, "brass"),
        looks.box((0.28, 0.22, 0.22), "wood", rounding=0.02),
        looks.cylinder(0.12, "steel", length=0.34),
        looks.cone(0.14, 0.34, color=GREEN),
        looks.capsule(0.09, "rubber", length=0.24),
        looks.torus(0.14, 0.045, "steel"),
        looks.ellipsoid((0.36, 0.2, 0.24), color=BLUE),
        looks.pyramid((0.3, 0.28, 0.28), color=AMBER),
        looks.half_sphere(0.18, color=RED),
        looks.disc(0.18, 0.02, "brass"),
        looks.polygon([(-0.2, -0.15), (0.2, -0.15), (0, 0), (0.15, 0.2), (-0.15, 0.2)], 0.05, color=GREEN),
        looks.chain_link(0.3),
        looks.mesh(
            [(0, 0, 0), (0.3, 0, 0), (0, 0.3, 0), (0, 0, 0.3)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)], color=BLUE
        ),
        looks.box((0.3, 0.3, 0.05), "glass"),
        looks.sphere(0.17, color="#d0402b80"),
    ):
        world.drawings.shape(look, position=cell(), rotation=TILT)
    world.add_static(looks.box((0.1, 0.4, 0.1), "rope"), cell(), TILT)


def draw_strokes(world: iota.World) -> None:
    at = cell()
    world.drawings.line(beside(at, -0.2, -0.2), beside(at, 0, 0.2), beside(at, 0.2, -0.2), color=BLUE, closed=True)
    at = cell()
    world.drawings.line(beside(at, -0.2, -0.1), beside(at, 0, 0.15), beside(at, 0.2, -0.1), radius=0.03, color=RED)
    at = cell()
    world.drawings.tube(
        beside(at, -0.25, -0.1), beside(at, 0, 0.2), beside(at, 0.25, -0.1), radius=0.05, color=GREEN, material="paint"
    )
    world.drawings.arrow(beside(cell(), -0.15, -0.2), vector=(0.3, 0.4, 0), radius=0.03, color=AMBER)
    at = cell()
    for place in range(4):
        world.drawings.axes(at=beside(at, 0.09 * place - 0.2, 0.05 * place - 0.2), length=0.25)
    world.label("label", at=cell())
    world.label("10 cm", at=cell(), height=0.1, color=RED)
    at = cell()
    turns = np.linspace(0, 4 * math.pi, 60)
    world.points(
        np.column_stack([0.2 * np.cos(turns), 0.2 * np.sin(turns), 0 * turns]) + at,
        radius=0.025,
        color=[RED, BLUE] * 30,
    )
    at = cell()
    grid = [(0.12 * x, 0.12 * y, 0.0) for x in (-1, 0, 1) for y in (-1, 0, 1)]
    world.drawings.shapes(
        looks.box((0.07, 0.07, 0.07)), np.array(grid) + at, rotations=[TILT] * 9, color=[GREEN, AMBER, BLUE] * 3
    )
    at = cell()
    world.drawings.strut(beside(at, -0.2, -0.2), beside(at, 0.2, 0.2), looks.cylinder(0.04, "paint"), color=RED)
    spot = cell()
    world.drawings.shape(looks.box((0.4, 0.4, 0.02), "paint", color="#606060"), position=spot)
    world.drawings.light("spot", at=beside(spot, z=0.8), to=spot, color=RED, intensity=3, reach=0.8, angle=0.2)
    frame = world.drawings.frame(beside(cell(), -0.1), (0, 0, math.sqrt(0.5), math.sqrt(0.5)))
    world.drawings.shape(looks.cone(0.1, 0.2, color=AMBER), on=frame, position=(0.1, 0, 0))


def draw_surfaces(world: iota.World) -> None:
    four = np.array([[(0.3, 0.6, 0.32), (0.8, 0, 0)], [(0, 0, 0.8), (0.8, 0.7, 0)]])
    at = cell()
    square = [beside(at, x, y) for x, y in ((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))]
    world.surface(square, [(0, 1, 2), (0, 2, 3)], texture=four, repeat=2)
    world.drawings.shape(looks.box((0.3, 0.3, 0.3), texture=four), position=cell(), rotation=TILT)
    at = cell()
    world.drawings.skin(lambda: [beside(at, -0.1), beside(at, 0.1)], 0.14, color=GREEN)
    file = Path(mkdtemp()) / "tent.obj"
    file.write_text("v -0.2 -0.2 0\nv 0.2 -0.2 0\nv 0 0.2 0\nv 0 -0.1 0.3\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 3 2\n")
    world.surface(shapelib.read_surface(str(file)), at=cell(), color=BLUE)
    module = file.with_name("knot.js")
    module.write_text(CLASS)
    world.pages.client_module(module)
    world.drawings.custom("knot", at=cell(), values={"color": RED})


def draw_bodies(world: iota.World) -> None:
    system = world.system
    at = cell()
    painted = system.body(shape=iota.Box((0.25, 0.25, 0.25)), mass=1.0, position=at, orientation=TILT)
    world.draw(painted, looks.solid("wood"))
    world.drawings.paint(painted, "#8a4fb0")

    def between(make: str) -> None:
        at = cell()
        first, second = (system.body().particle(beside(at, x, x)) for x in (-0.2, 0.2))
        first.nail()
        second.nail()
        if make == "spring":
            system.bond(first, second, "spring", stiffness=1.0, length=0.5)
        elif make == "rope":
            system.rope(first, second, length=0.7)
        elif make == "rod":
            system.rod(first, second)

    at = cell()
    places = [0.06 * k for k in range(-3, 4)]
    for row in places:
        for column in places:
            nailed = system.body().particle(beside(at, row, column))
            nailed.nail()
            world.draw(nailed.body, looks.sphere(0.001))
    between("spring")
    between("rope")
    between("rod")
    at = cell()
    system.emitter(
        rate=400, position=at, source=iota.Sphere(0.2), velocity=(0, 0, 0), lifetime=1e6, max_count=60,
        curve=[(0, 0.03, (1, 0.6, 0.1)), (1, 0.03, (1, 0.6, 0.1))],
    )  # fmt: skip
    runner = system.body(shape=iota.Sphere(0.03), mass=1.0, position=beside(cell(), 0.2))
    world.drawings.trace(runner, radius=0.02, color=AMBER)

    @world.on_step
    def run() -> None:
        turn = 4 * system.time
        runner.velocity = (-0.8 * math.sin(turn), 0.8 * math.cos(turn), 0)

    @world.at(0.6)
    def stay() -> None:
        world.clock.paused = True

    assert next(cells) <= COLUMNS * ROWS
