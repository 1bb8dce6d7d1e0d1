# SPDX-License-Identifier: Apache-2.0
"""One of each thing that scripts draw, each at a place of its own, and a panel with one of each control, for browser tests; prints what
it hears as JSON lines."""

from __future__ import annotations

import base64
import json
import math
import struct

import numpy as np

import iota
from iota import looks

UPRIGHT = (0, 0, math.sqrt(0.5), math.sqrt(0.5))  # from +x to +y


def tell(**what: object) -> None:
    print(json.dumps(what), flush=True)


def build() -> iota.World:
    system = iota.System(gravity=(0, 0, 0))
    world = iota.World(system, title="entities", ground=0.0)
    world.camera = iota.Camera(position=(0, 1.3, 3.6), target=(0, 0.7, 0))
    ball = system.body(shape=iota.Sphere(0.12), mass=1.0, position=(0, 0.2, 0.9))
    world.draw(ball, looks.solid("brass"))
    draw(world)
    draw_more(world)
    follow(world)
    colored = world.system.body(shape=iota.Box((0.2, 0.2, 0.2)), position=(-1.3, 0.2, 0.9), color="seagreen")
    colored.particles[0].nail()
    ask(world)
    listen(world, ball)
    night = world.drawings.stage(sky="#05070d", horizon="#101a2e", ground="#20242c", light=0.4)
    night.visible = False

    @world.on_key("n")
    def dusk() -> None:
        night.visible = not night.visible

    lamp = world.drawings.light(
        "spot", at=(-0.4, 1.5, 1.2), color="#ff4020", intensity=3, reach=1.5, angle=0.3, shadow=True
    )
    lamp.visible = False

    @world.on_key("l")
    def light() -> None:
        lamp.visible = not lamp.visible

    return world


def draw(world: iota.World) -> None:
    """What stays where it is."""
    world.drawings.line((-1.6, 0.2, 0), (-1.35, 0.6, 0), (-1.2, 0.2, 0), radius=0.03, color="#d0402b")
    world.drawings.line((-1.6, 0.8, 0), (-1.35, 1.2, 0), (-1.2, 0.8, 0), color="#3f7fd0", closed=True)
    world.drawings.line((0.35, 0.35, 0.9), (0.65, 0.35, 0.9), radius=0.03, color="#d0402b")
    world.drawings.arrow((-0.9, 0.2, 0), vector=(0.3, 0.6, 0), color="#2f9d92")
    world.drawings.arrow((-0.9, 1.0, 0), vector=(0.3, 0.2, 0), radius=0.03, color="#8a4fb0")
    world.drawings.axes(at=(-0.2, 0.3, 0), length=0.5)
    grid = [(i, j) for i in range(8) for j in range(8)]
    world.points(
        np.array([[0.5 + 0.04 * i, 0.3 + 0.06 * j, 0] for i, j in grid]),
        radius=0.02,
        color=np.array([[i / 7, 0.4, j / 7] for i, j in grid]),
    )
    world.label("a label", at=(0, 1.25, 0))
    world.label("of 10 cm", at=(0.65, 1.1, 0), height=0.1, color="#d0402b")
    world.drawings.shape(looks.box((0.25, 0.25, 0.25), "wood"), position=(1.1, 0.3, 0))
    world.drawings.shape(looks.sphere(0.12, "glass"), position=(1.45, 0.3, 0))
    world.drawings.shape(looks.torus(0.12, 0.04, "steel"), position=(1.1, 0.8, 0))
    world.drawings.shape(
        looks.Look(iota.Cone(0.12, 0.3), "paint", "#4c9a52"), position=(1.45, 0.8, 0), rotation=UPRIGHT
    )


def draw_more(world: iota.World) -> None:
    """Above and before the others."""
    world.drawings.tube((-1.6, 1.4, 0), (-1.3, 1.6, 0), (-1.0, 1.4, 0), radius=0.04, material="paint", color="#4c9a52")
    world.drawings.strut((-0.8, 1.4, 0), (-0.6, 1.8, 0), looks.cylinder(0.03, "paint"), color="#d0402b")
    world.surface([(-0.4, 1.4, 0), (0, 1.4, 0), (-0.2, 1.8, 0)], [(0, 2, 1)], color="#3f7fd0")
    cubes = world.drawings.shapes(
        looks.box((0.1, 0.1, 0.1), "paint"),
        [(0.2, 1.45, 0), (0.35, 1.45, 0)],
        sizes=[1, 1.2],
        color=["#8a4fb0", "#f2a324"],
    )
    frame = world.drawings.frame((9, 9, 9))
    # So steep that its face does not mirror the lamp above it, which is white.
    world.drawings.shape(
        looks.pyramid((0.4, 0.2, 0.2), color="#2f9d92"), on=frame, position=(0, 0.2, 0), rotation=UPRIGHT
    )
    # Green and red above, blue and yellow below.
    four = np.array([[(0.3, 0.6, 0.32), (0.8, 0, 0)], [(0, 0, 0.8), (0.8, 0.7, 0)]])
    world.drawings.shape(looks.box((0.3, 0.3, 0.3), texture=four), position=(1.1, 1.5, 0))
    world.surface(
        [(1.4, 1.35, 0), (1.7, 1.35, 0), (1.7, 1.65, 0), (1.4, 1.65, 0)], [(0, 1, 2), (0, 2, 3)], texture=four, repeat=2
    )
    # Two balls that have merged: between them is surface.
    world.drawings.skin(lambda: [(0.9, 0.2, 0.9), (1.06, 0.2, 0.9)], 0.1, color="#4c9a52")
    painted = world.system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1.0, position=(-1.0, 0.2, 0.9))
    world.draw(painted, looks.solid("wood"))
    world.drawings.paint(painted, "#8a4fb0")

    @world.after(0.2)
    def move() -> None:
        frame.at = (0.6, 1.4, 0)
        cubes.positions = np.array([(0.2, 1.65, 0), (0.35, 1.65, 0)])


def follow(world: iota.World) -> None:
    """A ball that runs to and fro, and its path."""
    system = world.system
    runner = system.body(shape=iota.Sphere(0.03), mass=1.0, position=(-0.3, 0.2, 0.7))
    world.drawings.trace(runner, radius=0.01, color="#f2a324")

    @world.on_step
    def run() -> None:
        runner.velocity = (-0.6 * math.sin(2 * system.time), 0.3 * math.cos(6 * system.time), 0)


def ask(world: iota.World) -> None:
    """One of each control."""
    system = world.system
    gravity = world.controls.slider("gravity", 0, 20, 9.81, unit="m/s²")
    gravity.on_change(lambda: tell(slider=gravity.value))
    wind = world.controls.checkbox("wind", True)
    wind.on_change(lambda: tell(checkbox=wind.value))
    material = world.controls.choice("material", ["steel", "wood", "glass"])
    material.on_change(lambda: tell(choice=material.value))
    name = world.controls.text("name", "ball")
    name.on_change(lambda: tell(text=name.value))
    world.controls.button("throw")(lambda: tell(button=True))
    waves = {"sine": lambda: math.sin(3 * system.time), "cosine": lambda: math.cos(3 * system.time)}
    world.controls.plot("wave", waves, unit="m")


def listen(world: iota.World, ball: iota.Body) -> None:
    """Clicks, a key, and a picture on demand."""
    world.on_click(ball)(lambda event: tell(click=[round(x, 3) for x in event.point]))
    world.on_click("nothing")(lambda event: tell(missed=[round(x, 3) for x in event.direction]))
    world.on_key("k")(lambda event: tell(key=event.key))

    @world.on_key("i")
    def picture(event: iota.Event) -> None:
        curtain = world.drawings.shape(looks.Look(iota.Box((4, 4, 0.02)), "paint", "#d0402b"), position=(0, 0.9, 2.4))
        png = next(client for client in world.users.clients if client.id == event.client).screenshot()
        curtain.visible = False
        tell(curtain=base64.b64encode(png).decode())
        tell(screenshot=struct.unpack(">II", png[16:24]))
