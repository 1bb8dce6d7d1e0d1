# SPDX-License-Identifier: Apache-2.0
"""Jacob's ladder: the top block is turned over, and blocks tumble down its length. t turns it; any block can be taken hold of."""

from __future__ import annotations

import math
from itertools import pairwise

import iota
from iota import looks
from iota.studies._story import Story
from iota.world.shown import Marker

LENGTH, THICKNESS, WIDTH = 0.06, 0.01, 0.04  # of a block, m
WOOD = 650.0  # kg/m^3
TOP = iota.Vec3(0, 0.55, 0)  # the axle through the top block
TORQUE, SPEED = 0.25, 6.0  # N m, rad/s: with which the top block is turned
# N m: a smaller moment does not part two faces; rad, from folded: the ribbons between two faces are seen.
STICK, OPENED = 1e-6, 0.2
PATIENCE = 8.0  # s without a touch until the story begins
# Ribbons are elastic: their pull keeps a pair straight. It grows from 0 over a few mm, and is a little more than what balances the
# weight below, which hangs from a face and so a block's thickness away from the hinge.
PULL, SPARE = "force = -pull*r/(r + 0.002)", 1.25
RIBBONS = {"outer": (-0.013, 0.013), "inner": (0.0,)}  # places along z, m
COLORS = {"outer": "#c8343c", "inner": "#2b6a9b"}
BLOCK = looks.solid("wood", "#fff1dc")


def build(blocks: int = 7) -> iota.World:
    """The world of the study. blocks: how many; five to nine is usual."""
    world = iota.World(iota.System(damping=0.25), title="ladder: blocks of 6 cm that seem to tumble", dt=1 / 240)
    add_actions(world, Ladder(world, blocks))
    present(world)
    return world


def add_actions(world: iota.World, ladder: Ladder) -> Story:
    """A key that tips it; it tips once at first, and by itself while nobody touches anything. Returns that story."""
    story = Story(world, wait=PATIENCE)
    for number in range(10):
        story.at(4.0 * number)(ladder.tip)
    story.action("tip", key="t", button="a", help="turns the top block over; twice, and two ripples run")(ladder.tip)
    world.at(0.6)(ladder.tip)
    return story


class Block:
    """A flat block that cannot leave its plane. Its corners are numbered (thesis, Fig. 5.7): bit 0 says which end, bit 1 which
    face. `ends` are the middles of its ends, `beyond` where the middles of straight neighbors are, `strips` the ribbons on its
    faces."""

    def __init__(self, world: iota.World, number: int, middle: iota.Vec3) -> None:
        system, down = world.system, 1 if number % 2 else -1  # neighbors begin with the same ends together
        self.body = system.body(shape=iota.Box((THICKNESS, LENGTH, WIDTH), 0.0008), density=WOOD, position=middle)
        self.body.material = iota.Material(touches="nothing")  # blocks lie on each other
        self.ends = [self.body.particle(middle + (0, y * down * LENGTH / 2, 0), mass=0) for y in (1, -1)]
        self.middle = self.body.particle(middle, mass=0)
        self.beyond = [self.body.particle(end.position * 2 - middle, mass=0) for end in self.ends]
        self.corners = [
            self.body.attachment(self.ends[corner & 1].position + ((corner >> 1) * THICKNESS - THICKNESS / 2, 0, 0))
            for corner in range(4)
        ]
        self.strips = [
            {kind: [self._strip(world, middle + (x, 0, z), COLORS[kind]) for z in zs] for kind, zs in RIBBONS.items()}
            for x in (-THICKNESS / 2, THICKNESS / 2)
        ]
        world.draw(self.body, BLOCK)

    def _strip(self, world: iota.World, place: iota.Vec3, color: str) -> Marker:
        look = looks.box((0.0008, LENGTH - 0.001, 0.008), "paint", color=color)
        strip = world.drawings.shape(look, on=self.body.particle(place, mass=0))
        strip.visible = False
        return strip

    @property
    def way(self) -> iota.Vec3:
        """From end 0 to end 1, m."""
        return self.ends[1].position - self.ends[0].position


class Pair:
    """Two neighbors, hinged at corners of one number: 0 or 1, or, in every other pair, 2 or 3. They open from straight (0) over
    one face to folded (pi). pull: of the ribbons, N, on points that meet when it is straight: a bond for a hinge at either end."""

    def __init__(self, system: iota.System, upper: Block, lower: Block, hinge: int, pull: float) -> None:
        self.upper, self.lower, self.hinge, self.locked = upper, lower, hinge, False
        self.bands = [system.bond(point, lower.middle, PULL, pull=pull) for point in upper.beyond]
        self._join(hinge)
        self.move_ribbons()

    @property
    def sense(self) -> int:
        """The sense of rotation about z with which the lower block opens: -1 at ends 0, 1 at ends 1."""
        return 2 * (self.hinge & 1) - 1

    @property
    def angle(self) -> float:
        """0 straight, pi folded, below 0 beyond either: -pi is a little more than folded."""
        upper, lower = self.upper.way, self.lower.way
        return math.atan2(-self.sense * upper.cross(lower).z, -upper.dot(lower))

    def flip(self) -> None:
        """Thesis, Algorithm 5. The other corners meet before the hinge opens, so that the faces lie flat on each other."""
        self._join(self.hinge ^ 1)
        self.upper.corners[self.hinge].separate(self.lower.corners[self.hinge])
        self.hinge ^= 1
        for band in self.bands:
            band.active = not band.active

    def lock(self) -> None:
        """Thesis, Algorithm 6: hinged points combined once more make one body. They are made straight first, so
        that the ribbons of both lie along the body's frame."""
        p, q = self.upper.beyond[self.hinge & 1], self.lower.middle
        p.combine(q)
        p.separate(q)
        self._join(self.hinge)
        self.locked = True

    def parts(self, below: list[Block]) -> bool:
        """Whether the forces of the last step pull a locked pair open. below: the blocks under it. What the upper blocks do to the
        lower ones of their body is net force less outside force; straight, its moment about the hinge must push them open."""
        at, origins, moment = self.upper.corners[self.hinge].position, [block.body for block in below], 0.0
        for part in self.upper.ends[0].body.parts:
            if part.origin in origins:
                mass_points = [p.position * (p.mass / part.mass) for p in part.particles]
                arm = sum(mass_points, iota.Vec3()) - at
                load = arm.cross(part.net_force - part.outside_force) + part.net_torque - part.outside_torque
                moment += load.z
        return -self.sense * moment > STICK

    def move_ribbons(self) -> None:
        """Outer ones run from end 0 above to end 1 below, inner ones from end 1 to end 0, so a flip moves them to the other block.
        They pull at the end with the hinge."""
        self.shown = self.hinge
        first, second = (self.upper, self.lower) if self.hinge & 1 else (self.lower, self.upper)
        for kind in RIBBONS:
            for block, shown in ((first, kind == "outer"), (second, kind == "inner")):
                for strip in block.strips[self.hinge >> 1][kind]:
                    strip.visible = shown
        for end, band in enumerate(self.bands):
            band.active = end == self.hinge & 1

    def _join(self, corner: int) -> None:
        self.upper.corners[corner].combine(self.lower.corners[corner])


class Ladder:
    """Blocks from the top down, the first of them on an axle. Thesis 5.1.3."""

    def __init__(self, world: iota.World, blocks: int = 7, top: iota.Vec3 = TOP) -> None:
        self.world, system = world, world.system
        self.blocks = [Block(world, number, top - (0, LENGTH * number, 0)) for number in range(blocks)]
        self.axle = system.revolute(self.blocks[0].body, at=top, axis=(0, 0, 1), limits=(0, math.pi))
        for block in self.blocks[1:]:  # two points far from all hinges keep it in the plane z = 0 of the axle
            for x in (-LENGTH, LENGTH):
                side = block.body.particle(block.body.position + (x, 0, 0), mass=0)
                system.on_surface(side, iota.HalfSpace((0, 0, 1)), at=top)
        pull = SPARE * abs(system.gravity) * self.blocks[0].body.mass * 2 * THICKNESS / LENGTH  # for each block below
        self.pairs = [
            Pair(system, p, q, 3 * (number % 2), pull * (blocks - 1 - number))
            for number, (p, q) in enumerate(pairwise(self.blocks))
        ]
        self.begun = [(block.body, list(block.corners)) for block in self.blocks]
        self.aim = 0.0  # of the top block, rad
        self.rest()
        world.scene.shows_edits = False
        world.on_step(self.step)
        world.on_reset(self.begin_anew)

    def begin_anew(self) -> None:
        """After a reset, when the system is what it was."""
        for block, (body, corners) in zip(self.blocks, self.begun, strict=True):
            block.body, block.corners = body, list(corners)
        for number, pair in enumerate(self.pairs):
            pair.hinge, pair.locked = 3 * (number % 2), False
            pair.move_ribbons()
        self.rest()

    def tip(self) -> None:
        """Turns the top block over."""
        self.aim = math.pi - self.aim
        self.axle.angle.servo = (self.aim, TORQUE, SPEED)

    def rest(self) -> None:
        """Holds the top block as it is, or the other way up."""
        self.aim = math.pi * round(self.axle.angle.value / math.pi)
        self.axle.angle.servo = (self.aim, TORQUE, SPEED)

    def step(self) -> None:
        """Thesis, Algorithm 4; a hand on the top block turns it. A ladder that complexity management has frozen waits."""
        if self.blocks[0].body.stride == 0:
            return
        if self.world.users.held() == self.blocks[0].ends[0].body:
            self.axle.angle.servo = None
        elif self.axle.angle.servo is None:
            self.rest()
        for number, pair in enumerate(self.pairs):
            if pair.locked:
                if pair.parts(self.blocks[number + 1 :]):
                    self.unlock(pair)
            elif (angle := pair.angle) < -math.pi / 2:
                pair.flip()
            elif angle < 0:
                pair.lock()
            # Blocks that are folded flat rock on their faces and flip to and fro: ribbons would flash.
            if pair.shown != pair.hinge and (pair.locked or 0 < pair.angle < math.pi - OPENED):
                pair.move_ribbons()

    def unlock(self, pair: Pair) -> None:
        """Thesis, Algorithm 7: every block of their body is its own again, and the other pairs of it are locked anew."""
        body = pair.upper.ends[0].body
        locked = [other for other in self.pairs if other.locked and other.upper.ends[0].body == body]
        of = {block.body: block for block in self.blocks}
        for part in body.parts[1:]:
            block = of[part.origin]
            (block.body, *_) = part.separate().created_bodies
            self.world.draw(block.body, BLOCK)
        for each in locked:
            # The hinge is back; one of its two particles is another than before.
            p, q = each.upper.corners[each.hinge], each.lower.corners[each.hinge]
            ring = {particle.body: particle for particle in (p if p.alive else q).ring}
            for block in (each.upper, each.lower):
                block.corners[each.hinge] = ring[block.body]
        pair.locked = False
        for each in locked:
            if each.locked:
                each._join(each.hinge)


def stand(world: iota.World, top: iota.Vec3 = TOP, floor: float = 0.0) -> None:
    """Its arm is the axle of the top block. floor: height of what it stands on, m."""
    x, y, z = top
    back = z - WIDTH
    world.add_strut((x, y, back), (x, y, z + 0.7 * WIDTH), looks.cylinder(0.003, "steel"))
    world.add_static(looks.cylinder(0.012, "brass", 0.012, rotation=("y", 90)), (x, y, z + 0.7 * WIDTH))
    world.add_strut((x, floor + 0.015, back), (x, y + 0.03, back), looks.cylinder(0.006, "steel"))
    world.add_static(looks.box((0.26, 0.02, 0.16), "wood", 0.004), (x - 0.02, floor + 0.01, back + 0.04))


def present(world: iota.World) -> None:
    """A stand in a room."""
    stand(world)
    world.stage("room")
    world.camera = iota.Camera(position=(0.56, 0.44, 0.69), target=(0, 0.285, 0))
