# SPDX-License-Identifier: Apache-2.0
"""A ball of 400 kg on a chain of exact links swings into pillars of bricks; k lets it go, c builds all anew."""

from __future__ import annotations

import math

import iota
from iota import looks

HOOK = iota.Vec3(-0.45, 2.9, 0)  # of the crane, m
LENGTH, LINKS, LINK = 2.2, 11, 1.0  # of the chain, m; kg
RADIUS, BALL = 0.25, 400.0  # m, kg
DRAWN = 0.95  # rad, by which the ball is drawn back
BRICK, GAP = 0.15, 0.09  # m; between pillars
PILLARS, ROWS = 5, 6
CLAY = 1800.0  # kg/m^3
COLORS = ("#b0543c", "#c4684a", "#9c4633")
POST = iota.Vec3(-3.2, 2.0, 0)  # what draws the ball back


def build() -> iota.World:
    """The world of the study."""
    world = make_world()
    Wrecker(world)
    return world


def make_world() -> iota.World:
    """The ground and the crane. What lies still for half a second sleeps, until something touches it."""
    system = iota.System()
    system.rest_after = 0.5
    system.usual_material = iota.Material(friction=0.5)
    world = iota.World(system, title="wrecking ball: it swings into a hall of pillars, each 0.9 m high")
    present(world)
    return world


def present(world: iota.World) -> None:
    """The crane and the post, beside the way of the ball."""
    steel, paint = looks.cylinder(0.03, "steel"), looks.cylinder(0.05, "paint", color="#d99a2b")
    top = HOOK + (0, 0.1, 0)
    crane = [world.add_strut(tuple(HOOK), tuple(top), steel)]
    for z in (-1.5, 1.5):
        crane += [world.add_strut((top.x + x, 0, z), tuple(top), paint) for x in (-0.25, 0.25)]
    for each in crane:
        each.material = iota.Material(touches="nothing")  # the links at the hook are within all of them
    for z in (-0.5, 0.5):
        world.add_strut((POST.x, 0, z), tuple(POST), paint)
    world.draw_ties("rope", looks.cylinder(0.012, "rope"))
    world.stage(ground="#96918a")
    world.camera = iota.Camera(position=(1.9, 1.9, 5.2), target=(-0.8, 1.35, 0))


class Wrecker:
    """The ball on its chain, the pillars, and the rope that holds the ball back."""

    def __init__(self, world: iota.World) -> None:
        self.world, self.system = world, world.system
        self.bricks = self._pillars()
        way = iota.Vec3(-math.sin(DRAWN), -math.cos(DRAWN), 0)
        self.chain = (
            iota.builder.chain(LINKS, LENGTH, top=HOOK, direction=way, mass=LINKS * LINK).realize(self.system).bodies
        )
        world.draw(self.chain, looks.chain_link(LENGTH / LINKS))
        end = self.chain[-1].particles[-1]
        self.ball = self.system.body(
            shape=iota.Sphere(RADIUS), mass=BALL, position=end.position + way * RADIUS, damping=0.02
        )
        world.draw(self.ball, looks.solid("steel", "#3c4046"))
        end.combine(self.ball.attachment(end.position))
        hold = self.ball.attachment(self.ball.center_of_mass + (POST - self.ball.center_of_mass).unit() * RADIUS)
        eye = self.system.body().particle(POST, mass=1.0)
        eye.nail()
        self.rope = self.system.rope(eye, hold)
        world.action("let go", key="k", help="lets the ball go", on="world")(self.let_go)
        world.action("build anew", key="c", help="builds the pillars, and draws the ball back", on="world")(world.reset)
        world.at(1.2)(self.let_go)

    def _pillars(self) -> list[iota.Body]:
        """Across the way of the ball, a little behind its lowest place, so that it hangs free when all is done."""
        made = []
        for place in range(PILLARS):
            z = (place - (PILLARS - 1) / 2) * (BRICK + GAP)
            for row in range(ROWS):
                size = (BRICK, BRICK, BRICK)
                brick = self.system.body(shape=iota.Box(size), density=CLAY, position=(0, BRICK * (row + 0.5), z))
                self.world.draw(brick, looks.box(size, "paint", 0.008, color=COLORS[(row + place) % len(COLORS)]))
                made.append(brick)
        return made

    def let_go(self) -> None:
        if self.rope.active:
            self.rope.active = False


if __name__ == "__main__":
    build().run()
