# SPDX-License-Identifier: Apache-2.0
"""Two cradles by contact alone: steel lets as many balls go as arrive, lead swings as one. l and k lift one more ball, left and right."""

from __future__ import annotations

import math

import iota
from iota import looks

from .cradle import HEIGHT, LIFT, RADIUS, STRING, present

BALLS = 5
METALS = {  # density, kg/m^3; restitution; material and color
    "steel": (7800.0, 0.99, "steel", None),
    "lead": (11300.0, 0.1, "paint", "#474c55"),
}
PLACES = {"steel": -0.15, "lead": 0.15}  # m


def build(left: int = 1, right: int = 0) -> iota.World:
    """The world of the study. left, right: how many of the balls are lifted at first."""
    world = make_world()
    cradles = [Row(world, name) for name in METALS]
    counts = [left, right]

    def lift() -> None:
        for cradle in cradles:
            cradle.lift(*counts)

    def lift_more(side: int) -> None:
        counts[side] = (counts[side] + 1) % BALLS
        counts[1 - side] = min(counts[1 - side], BALLS - counts[side])
        lift()

    @world.action("lift left", key="l", button="a", help="lifts one more ball of each on the left", on="world")
    def lift_left() -> None:
        lift_more(0)

    @world.action("lift right", key="k", button="b", help="lifts one more ball of each on the right", on="world")
    def lift_right() -> None:
        lift_more(1)

    @world.on_reset
    def begin_anew() -> None:
        counts[:] = left, right
        lift()

    lift()
    return world


def make_world() -> iota.World:
    """A table without a cradle."""
    world = iota.World(
        iota.System(), title="cradles by contact: impacts run through 24 mm balls", dt=1 / 240, ground=0.0
    )
    world.stage("room")
    world.camera = iota.Camera(position=(0.1, 0.22, 0.56), target=(0, 0.09, 0))
    return world


class Row:
    """Balls of a metal on strings. They do nothing but swing and touch."""

    def __init__(
        self,
        world: iota.World,
        metal: str,
        count: int = BALLS,
        at: iota.Vec3 | None = None,
        label: bool = True,
        size: float = 1.0,
    ) -> None:
        """at: where it stands, m; None: at the place of its metal. size: times the usual one."""
        density, restitution, material, color = METALS[metal]
        at = iota.Vec3(PLACES[metal], 0, 0) if at is None else at
        radius, height, self.string = size * RADIUS, size * HEIGHT, size * STRING
        frame = world.system.body("static", shape=iota.Box((size * 0.01,) * 3), position=at)
        frame.name = f"frame of {metal}"
        self.balls, self.tops = [], []
        for number in range(count):
            top = at + (2 * radius * (number - (count - 1) / 2), height, 0)
            ball = world.system.body(shape=iota.Sphere(radius), density=density, position=top - (0, self.string, 0))
            ball.name = f"ball of {metal}"
            ball.material = iota.Material(friction=0.05, restitution=restitution)
            world.system.revolute(ball, frame, at=top, axis=(0, 0, 1))
            self.balls.append(ball)
            self.tops.append(top)
        present(world, self.balls, frame, looks.sphere(radius, material, color=color), size)
        if label:
            world.label(metal, at + (0, height + size * 0.02, 0))

    def lift(self, left: int, right: int) -> None:
        """Balls on both sides are held up and let go."""
        for number, (ball, top) in enumerate(zip(self.balls, self.tops, strict=True)):
            angle = -LIFT if number < left else LIFT if number >= len(self.balls) - right else 0.0
            ball.set_pose(
                top + (self.string * math.sin(angle), -self.string * math.cos(angle), 0),
                (0, 0, math.sin(angle / 2), math.cos(angle / 2)),
            )
            ball.velocity = ball.angular_velocity = (0, 0, 0)

    def angles(self) -> list[float]:
        """From the plumb line, rad."""
        return [
            math.atan2(ball.position.x - top.x, top.y - ball.position.y)
            for ball, top in zip(self.balls, self.tops, strict=True)
        ]


if __name__ == "__main__":
    build().run()
