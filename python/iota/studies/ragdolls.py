# SPDX-License-Identifier: Apache-2.0
"""Twelve jointed figures fall down the stairs onto a heap: k lets the next fall, x blows the heap up, t takes a limb off or puts it on."""

from __future__ import annotations

import math

import numpy as np

import iota
from iota import looks
from iota.frames import into_frame, turned

from ._figure import Figure, person
from ._story import Story

ROWS, IN_ROW, APART = 3, 4, 0.72  # of hooks; m
STEPS, RISE, TREAD, WIDE, LANDING = 7, 0.19, 0.25, 3.0, 0.9  # m
FOOT, FRONT, BORDER = -0.75, 2.1, 0.4  # z of the foot of the stairs, from there to the border, its height, m
GLASS, PANE = 0.03, 1.6  # thickness and height of the panes, m
RAILS = ((2.25, -1.4), (2.8, -2.15), (3.15, -2.9))  # height and z, m; the front one first
HOOK = (0.0, 0.47, -0.075)  # at the neck of a figure, m
PUSH, EACH = 2.0, 0.75  # m/s, off the hook; s, from one to the next
BLAST, REACH, BELOW, FLASH = 7.0, 1.6, 0.4, 3.0  # m/s; m: of it, and of its middle below the heap's; of its light
CLOSE, ARM, MENDS = 0.03, 0.1, 1.5  # m; m; s, within which a limb is drawn back to its joint
LIMP, DAMPING = 0.4, 0.15  # friction of the joints, N m; 1/s
CLOTH = iota.Material(friction=0.3)
SHIRTS = ("#b5462f", "#d9a441", "#5b7f4b", "#2f6c80", "#8a5a83", "#d6d0c2")
TROUSERS = ("#34404a", "#5a4a3c", "#41566b")
SKINS = ("#e2b48c", "#9a6a48", "#c98f68")
HAIR = ("#3a2a20", "#b98a4a", "#17171a", "#7a3b22")
SHOE = "#22262a"
Socket = list[tuple[iota.Vec3, iota.Vec3]]


def build() -> iota.World:
    """The world of the study."""
    world = make_world()
    Ragdolls(world)
    return world


def make_world() -> iota.World:
    """Stairs between panes of glass. What lies still for half a second sleeps."""
    system = iota.System()
    system.rest_after, system.rest_speed = 0.5, 0.08
    system.budget_contacts = 1e6  # sweeps: equations of so many places of contact take up to 0.1 s in a blow
    system.usual_material = CLOTH
    world = iota.World(system, title="ragdolls: figures of 1.75 m fall down the stairs", ground=0.0)
    present(world)
    return world


def present(world: iota.World) -> None:
    """A room with stairs, panes beside them, and rails with hooks above."""
    world.stage("room")
    end, top, side, front = FOOT - TREAD * STEPS, RISE * STEPS, WIDE / 2, FOOT + FRONT
    back = end - LANDING
    world.stairs((0, 0, FOOT), STEPS, WIDE, RISE, TREAD)
    world.add_static(looks.box((WIDE, top, LANDING), "paint", color="#dcd8cd"), (0, top / 2, end - LANDING / 2))
    world.add_static(looks.box((WIDE, 0.02, FRONT), "rubber", color="#4f6a78"), (0, 0.01, FOOT + FRONT / 2))
    for x in (-1, 1):
        pane = looks.box((GLASS, PANE, front - back), "glass", color="#e3f0f460")
        world.add_static(pane, (x * (side + GLASS / 2), PANE / 2, (front + back) / 2))
        edge = x * (side + GLASS / 2)
        world.add_strut((edge, PANE, back), (edge, PANE, front), looks.cylinder(0.022, "steel"))
        for z in (back + 0.04, end, FOOT, front):
            world.add_strut((x * (side + 0.06), 0, z), (x * (side + 0.06), PANE, z), looks.cylinder(0.025, "steel"))
    world.add_static(looks.box((WIDE + 0.12, BORDER, 0.06), "wood"), (0, BORDER / 2, front + 0.03))
    for height, z in RAILS:
        world.add_strut((-side - 0.1, height, z), (side + 0.1, height, z), looks.cylinder(0.016, "steel"))
        for x in (-1, 1):
            post = looks.cylinder(0.025, "steel")
            world.add_strut((x * (side + 0.1), 0, z), (x * (side + 0.1), height + 0.03, z), post)
    world.camera = iota.Camera(position=(2.0, 2.3, 4.9), target=(0.08, 1.22, -1.0))


class Ragdolls:
    """Figures on hooks, and what happens to them."""

    def __init__(self, world: iota.World, count: int = ROWS * IN_ROW) -> None:
        self.world, self.system = world, world.system
        self.figures = [self._figure(number) for number in range(count)]
        self.sockets = {joint: socket(joint) for figure in self.figures for joint in figure.joints.values()}
        self.mending: dict[iota.Constraint, tuple[list[iota.Grip], float]] = {}  # and until when, s
        self.lamp = world.drawings.light("point", at=(0, 0.6, 1), color="#ffd9a0", intensity=0, reach=6)
        self.story = Story(world, wait=5.0, first=0.8)
        for number in range(count):
            self.story.at(EACH * number)(self.drop)
        self.story.at(EACH * count + 4.0)(self.blow_up)
        self.story.at(EACH * count + 8.0)(world.reset)
        self.story.action("drop", key="k", help="lets the next figure fall")(self.drop)
        self.story.action("blow up", key="x", help="blows the heap apart")(self.blow_up)
        self.story.action("hang up", key="c", help="all hang on their hooks again")(world.reset)
        world.action("limb", key="t", help="takes the held or selected limb off, or puts it on again")(self.turn_limb)
        world.on_step(self._follow)
        world.on_reset(self._forget)
        self._forget()

    # --- what they are ------------------------------------------------------------------------------------------------

    def _figure(self, number: int) -> Figure:
        row, place = divmod(number, IN_ROW)
        height, z = RAILS[row % len(RAILS)]
        dress = Dress(self.world, number)
        parts = person(HOOK)
        low, ahead = (sum(part.mass * (part.at[k] - HOOK[k]) for part in parts) for k in (1, 2))
        lean = math.atan2(ahead, -low)  # so it hangs still
        turn = (math.sin(lean / 2), 0.0, 0.0, math.cos(lean / 2))
        at = iota.Vec3((place - (IN_ROW - 1) / 2) * APART, height, z) - turned(turn, iota.Vec3(*HOOK))
        figure = Figure(self.system, parts, at, dress, turn, LIMP, DAMPING)
        figure.hangs[0].nail()
        for body in figure.distinct:
            body.kind = "resting"
        return figure

    @property
    def hung(self) -> list[Figure]:
        """The figures on their hooks."""
        return [figure for figure in self.figures if figure.hangs[0].is_nailed]

    # --- what is done -------------------------------------------------------------------------------------------------

    def drop(self) -> None:
        """The next one leaves its hook, and turns head over heels."""
        if not self.hung:
            self.world.users.notice("All have fallen", "c hangs them up again.")
            return
        figure = self.hung[self.random.integers(min(len(self.hung), IN_ROW))]
        hips = figure.bodies["hips"].position
        way = iota.Vec3(self.random.uniform(-0.3, 0.3), 0.3, PUSH)
        spin = iota.Vec3(self.random.uniform(0.5, 2.5), *self.random.uniform(-1, 1, 2))
        with self.system.edit():
            figure.hangs[0].release()
            for body in figure.distinct:
                body.velocity += way + spin.cross(body.center_of_mass - hips)

    def blow_up(self) -> None:
        """Throws those away that are near the middle of the heap."""
        hung = self.hung
        fallen = [body for figure in self.figures if figure not in hung for body in figure.distinct]
        if not fallen:
            return
        middle = iota.Vec3(*np.median([tuple(body.position) for body in fallen], axis=0)) - (0, BELOW, 0)
        self.lamp.at, self.lamp.intensity = middle + (0, 2 * BELOW, 0), FLASH
        with self.system.edit():
            for body in fallen:
                way = body.center_of_mass - middle
                body.velocity += way * (BLAST / (abs(way) + BELOW) * math.exp(-((abs(way) / REACH) ** 2)))

    def turn_limb(self, event: iota.Event) -> None:
        """Takes the limb off that is held or selected; one that is off is drawn back to its joint."""
        joint = next((joint for joint in self.sockets if joint.a == event.body), None)
        if joint is None:
            event.notice("Nothing to take off", "Hold or select an arm, a leg, a hand, a head or a chest.")
        elif joint.active:
            joint.active = False
        elif joint not in self.mending:
            grips = [
                self.system.grip(joint.a, own, frequency=3, max_acceleration=150) for own, _ in self.sockets[joint]
            ]
            self.mending[joint] = grips, self.system.time + MENDS

    def _follow(self) -> None:
        """A hand takes a figure off its hook; limbs are drawn to their joints; the flash dims."""
        if (held := self.world.users.held()) is not None:
            for figure in self.hung:
                if held in figure.distinct:
                    figure.hangs[0].release()
        if self.lamp.intensity:
            self.lamp.intensity = 0.9 * self.lamp.intensity if self.lamp.intensity > 0.02 else 0
        for joint, (grips, until) in list(self.mending.items()):
            ways = gaps(joint, self.sockets[joint])
            if max(map(abs, ways)) > CLOSE and self.system.time < until and all(grip.alive for grip in grips):
                for grip, (_, other) in zip(grips, self.sockets[joint], strict=True):
                    grip.move(place_of(joint.b, other))
                continue
            self._let_go(grips)
            joint.active = True
            del self.mending[joint]

    def _let_go(self, grips: list[iota.Grip]) -> None:
        for grip in grips:
            if grip.alive:
                grip.destroy()

    def _forget(self) -> None:
        for grips, _ in self.mending.values():
            self._let_go(grips)
        self.mending.clear()
        self.random = np.random.default_rng(5)


class Dress:
    """How the parts of a figure are drawn: clothes, skin, hair and shoes by its number."""

    def __init__(self, world: iota.World, number: int) -> None:
        self.world = world
        self.shirt, self.trousers = SHIRTS[number % len(SHIRTS)], TROUSERS[number % len(TROUSERS)]
        self.skin, self.hair = SKINS[number * 2 % len(SKINS)], HAIR[number * 3 % len(HAIR)]

    def __call__(self, name: str, body: iota.Body) -> None:
        """In the frames of the parts: x is up in all but hips, chest and feet, and y is to the right."""
        body.name = name
        last = name.split()[-1]
        cloth = {"hips": self.trousers, "thigh": self.trousers, "shank": self.trousers, "foot": SHOE}.get(
            last, self.shirt
        )
        parts = [looks.solid("paint", self.skin if last in ("head", "neck") else cloth)]
        if last == "head":
            parts += [
                looks.sphere(0.096, "paint", color=self.hair, offset=(0.032, 0, -0.01)),
                *(looks.sphere(0.02, "paint", color="#1c1d20", offset=(0.02, y, 0.071)) for y in (-0.035, 0.035)),
            ]
        elif last == "hand":
            sleeve = looks.capsule(0.042, "paint", 0.12, color=self.shirt, offset=(0.07, 0, 0))
            arm = looks.capsule(0.033, "paint", 0.16, color=self.skin, offset=(-0.03, 0, 0))
            parts = [sleeve, arm, looks.ellipsoid((0.13, 0.05, 0.085), color=self.skin, offset=(-0.115, 0, 0))]
        self.world.draw(body, parts)


def socket(joint: iota.Constraint) -> Socket:
    """Three places at a joint in the frames of both its bodies, m: where they meet, they have the pose of the start."""
    assert joint.b is not None
    places = [joint.position + offset for offset in ((0, 0, 0), (ARM, 0, 0), (0, ARM, 0))]
    a, b = ([into_frame(place, body.position, body.orientation) for place in places] for body in (joint.a, joint.b))
    return list(zip(a, b, strict=True))


def gaps(joint: iota.Constraint, places: Socket) -> list[iota.Vec3]:
    """Between the places of its bodies that belong together, m."""
    return [place_of(joint.b, other) - place_of(joint.a, own) for own, other in places]


def place_of(body: iota.Body | None, point: iota.Vec3) -> iota.Vec3:
    assert body is not None
    return body.position + turned(body.orientation, point)


if __name__ == "__main__":
    build().run()
