# SPDX-License-Identifier: Apache-2.0
"""A derrick: mast, boom, sheets, block and tackle, a winch with a crank. Ropes show their forces. k takes the brake off, c begins anew."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import iota
from iota import looks
from iota.studies._story import Story

HEEL, HEAD = iota.Vec3(-1.1, 1.0, 0), iota.Vec3(-1.25, 4.4, 0)  # the joint of the boom, and the top of the mast, m
BOOM, BEAM = 3.0, 1.6  # m: length of the boom, and how far beside the mast the sheets end
WINCH, DRUM, CRANK = iota.Vec3(-2.1, 0.75, 0), 0.09, 0.3  # m
CRATE, BLOCK = 120.0, 8.0  # kg
BRAKE, RATCHET = 160.0, 3.0  # N m, that hold the drum with the brake on, and off
PEAK, SWING = 35.0, 0.0  # degrees, of the boom at the start: upwards, and to the side
HANG = 1.3  # m, from the boom to the block at the start
TURN, HASTE, LEAN = 1.6, 2.0, 12.0  # rad/s and rad/s^2 of the winch, degrees a second of the boom, at most
ACROSS = iota.Vec3(0.05, 0, 0.03)  # from one rope of the tackle to the next, m
PARTS = (1, 2, 3, 4)
STRETCH = (5e-6, 0.0, 0.05)  # of lift and sheets, m/N, and its relaxation, s
RED = 2500.0  # N, of the rope that is drawn red
GRAVITY = 9.81


def build() -> iota.World:
    """The world of the study."""
    world = make_world()
    world.stage(sky="#9cc3dc", horizon="#dfe8ea", ground="#41758a")
    world.camera = iota.Camera(position=(0.9, 2.8, 7.6), target=(0.35, 2.05, 0))
    rig = Derrick(world)
    winch = world.controls.slider("winch", -1, 1, 0, step=0.05, help="heaves above 0, lowers below it")
    peak = world.controls.slider("boom", 15, 60, PEAK, step=1, unit="°", help="how high the lift holds it")
    swing = world.controls.slider("swing", -45, 45, SWING, step=1, unit="°", help="to which side the sheets pull it")
    parts = world.controls.choice(
        "parts of the tackle", [str(n) for n in PARTS], "4", help="ropes that carry the block"
    )
    world.controls.plot(
        "at the winch",
        {"measured": lambda: rig.tension("tackle"), "weight / parts": rig.expected},
        unit="N",
        seconds=12,
    )

    def stop() -> None:
        winch.value = 0

    story = Story(world, wait=12, first=0.3, on_stop=stop)
    for control in (winch, peak, swing):
        control.on_change(story.touch)

    @parts.on_change
    def reeve() -> None:
        story.touch()
        rig.reeve(int(parts.value))

    @world.on_step
    def drive() -> None:
        rig.drive(winch.value, peak.value, swing.value)

    @world.action("brake", key="k", help="takes the winch's brake off, or on: the crank holds the load", on="world")
    def brake() -> None:
        story.touch()
        rig.is_braked = not rig.is_braked

    @world.action("anew", key="c", help="begins anew", on="world")
    def anew() -> None:
        world.reset()

    @world.on_reset
    def again() -> None:
        rig.begin()
        rig.find_tackle()
        winch.value, peak.value, swing.value, parts.value = 0, PEAK, SWING, str(rig.parts)

    def move(at: float, **values: float) -> None:
        @story.at(at)
        def change() -> None:
            for name, value in values.items():
                {"winch": winch, "peak": peak, "swing": swing}[name].value = value

    move(0, winch=0.8)
    move(5, winch=0)
    move(5.5, swing=35)
    move(11, swing=-35)
    move(19, swing=0, peak=50)
    move(24, peak=PEAK, winch=-0.8)
    move(30, winch=0)
    return world


def make_world() -> iota.World:
    """A world without the derrick."""
    system = iota.System(damping=0.08)
    return iota.World(system, title="rigging: ropes of a 4.4 m mast show their forces", dt=1 / 240, ground=-0.4)


class Derrick:
    """All that is rigged, and the ropes by name. is_braked: the drum is held; otherwise only its crank holds the load."""

    def __init__(self, world: iota.World) -> None:
        self.world, self.system = world, world.system
        self.ropes: dict[str, iota.Constraint] = {}
        self.lines: dict[str, iota.world.shown.Line] = {}
        self.labels: dict[str, iota.world.shown.Label] = {}
        self.stand()
        self.boom = self.swing_boom()
        self.hang()
        self.drum = self.place_winch()
        self.begin()
        self.spans: list[iota.Constraint] = []
        self.tackles: list[
            tuple[iota.Constraint, int, list[iota.Constraint]]
        ] = []  # all that were led, with parts and spans
        self.reeve(4)
        for name, ends in {
            "lift": (self.head, self.tip),
            "port": (self.tip, self.eyes[0]),
            "starboard": (self.tip, self.eyes[1]),
        }.items():
            self.ropes[name] = self.system.rope(*ends)
            self.ropes[name].compliance = STRETCH
            self.show(name, ends)
        for kind in ("rope", "rod", "spring"):  # drawn with their forces
            world.draw_ties(kind, [])
        world.every(0.1)(self.tell)

    def begin(self) -> None:
        """At the start of a run."""
        self.peak, self.swing, self.is_braked, self.parts, self.turning = PEAK, SWING, True, 4, 0.0

    # --- what stands and hangs ----------------------------------------------------------------------------------------

    def stand(self) -> None:
        """A barge with a mast."""
        add, strut = self.world.add_static, self.world.add_strut
        deck = add(looks.box((7.4, 0.5, 4.0), "wood", 0.04, color="#f2dfc0"), (0.3, -0.25, 0))
        deck.material = iota.Material(friction=0.6)
        for z in (-2.0, 2.0):
            add(looks.box((7.5, 0.14, 0.1), "paint", 0.02, color="#2d4a5e"), (0.3, 0.02, z))
        strut((HEAD.x, 0, 0), tuple(HEAD + (0, 0.12, 0)), looks.cylinder(0.09, "wood"))
        add(looks.cylinder(0.14, "steel", 0.12), (HEAD.x, 0.06, 0), (0, 0, 0.5**0.5, 0.5**0.5))
        strut((HEAD.x, HEEL.y, 0), tuple(HEEL), looks.cylinder(0.05, "steel"))
        strut(tuple(HEAD - (0.02, 0, 0)), tuple(HEAD + (0.16, 0, 0)), looks.cylinder(0.03, "steel"))
        self.head = self.anchor(HEAD + (0.15, 0, 0))
        self.heel = self.anchor(HEEL + (0, 0.09, 0))
        self.eyes = [self.anchor(iota.Vec3(HEEL.x + 0.2, 0.14, z)) for z in (-BEAM, BEAM)]
        for eye in self.eyes:
            add(looks.torus(0.06, 0.018, "steel"), tuple(eye.position - (0, 0.06, 0)))
        add(looks.cylinder(0.07, "brass", 0.04), tuple(HEEL + (0, 0.04, 0)), (0, 0.5**0.5, 0, 0.5**0.5))

    def anchor(self, place: iota.Vec3) -> iota.Particle:
        """A place of the barge that ropes hold on to."""
        point = self.system.body().particle(place)
        point.nail()
        self.world.draw(point.body, looks.sphere(0.018, "steel"))
        return point

    def swing_boom(self) -> iota.Body:
        """On a joint that lets it rise and swing."""
        end = tip_at(PEAK, SWING)
        half = math.radians(PEAK) / 2
        boom = self.system.body(
            shape=iota.Capsule(0.055, BOOM - 0.2), mass=22, position=(HEEL + end) * 0.5, orientation=(0, 0, math.sin(half), math.cos(half)),
            material=iota.Material(touches="obstacles"),
        )  # fmt: skip
        boom.name = "boom"
        self.world.draw(boom, looks.solid("wood"))
        self.system.universal(boom, at=HEEL, axis=(0, 0, 1), second_axis=(0, 1, 0))
        self.tip = boom.particle(end, mass=0)
        # Sheaves beside each other: a rope for each place.
        self.tops = [boom.particle(end - (0, 0.09, 0) + ACROSS * side, mass=0) for side in (-0.5, 0.5, 1.5)]
        self.over = boom.particle(end + (0.03, 0.06, 0), mass=0)
        return boom

    def hang(self) -> None:
        """The lower block, and the crate at its hook."""
        middle = tip_at(PEAK, SWING) - (0, 0.09 + HANG, 0)
        size = (0.14, 0.2, 0.14)
        self.block = self.system.body(
            shape=iota.Box(size, 0.03), mass=BLOCK, position=middle, material=iota.Material(touches="obstacles")
        )
        self.block.name = "block"
        self.world.draw(self.block, [looks.solid("wood", "#c99a63"), *sheaves((0, 0.03, 0))])
        self.bottoms = [self.block.particle(middle + (0, 0.07, 0) + ACROSS * side, mass=0) for side in (-1.0, 0.0, 1.0)]
        hook = self.block.attachment(middle - (0, 0.22, 0))
        side = 0.62
        self.crate = self.system.body(
            shape=iota.Box((side, side, side), 0.01), mass=CRATE, position=hook.position - (0, side / 2 + 0.22, 0)
        )
        self.crate.name = "crate"
        ribs = [
            looks.box((side + 0.03, 0.07, side + 0.03), "wood", offset=(0, y, 0), color="#d9b98a")
            for y in (-0.24, 0.24)
        ]
        self.world.draw(self.crate, [looks.solid("wood", "#f0d9b4"), *ribs])
        eye = self.crate.attachment(hook.position)
        eye.combine(hook)
        corners = [(x * side / 2, side / 2, z * side / 2) for x in (-1, 1) for z in (-1, 1)]
        for corner in corners:
            sling = self.crate.particle(self.crate.position + corner, mass=0)
            self.world.drawings.line(eye, sling, radius=0.008, color="#6b5a45")
        self.world.drawings.line(
            self.block.particle(middle - (0, 0.08, 0), mass=0), hook, radius=0.016, color="#4a4f55"
        )

    def place_winch(self) -> iota.Constraint:
        """A drum on two posts, with a crank that can be turned by hand."""
        about_z = (0.0, 0.5**0.5, 0.0, 0.5**0.5)
        drum = self.system.body(
            shape=iota.Cylinder(DRUM, 0.4),
            mass=14,
            position=WINCH,
            orientation=about_z,
            material=iota.Material(touches="nothing"),
        )
        arm = self.system.body(
            shape=iota.Box((0.05, CRANK, 0.03), 0.01),
            mass=2,
            position=WINCH + (0, CRANK / 2, 0.3),
            material=iota.Material(touches="nothing"),
        )
        grip = self.system.body(
            shape=iota.Capsule(0.025, 0.14), mass=1, position=WINCH + (0, CRANK, 0.4), orientation=about_z,
            material=iota.Material(touches="nothing"),
        )  # fmt: skip
        drum.combine(arm)
        drum.combine(grip)
        drum.name = "winch"
        self.world.draw(drum, [looks.solid("rope"), looks.solid("steel"), looks.solid("paint", "#c8322b")])
        self.world.add_strut(tuple(WINCH - (0, 0, 0.3)), tuple(WINCH + (0, 0, 0.28)), looks.cylinder(0.022, "steel"))
        for z in (-0.26, 0.26):
            self.world.add_static(
                looks.box((0.16, WINCH.y + 0.12, 0.05), "paint", 0.01, color="#2d4a5e"),
                (WINCH.x, (WINCH.y + 0.12) / 2, z),
            )
            self.world.add_static(looks.cylinder(1.8 * DRUM, "steel", 0.015), (WINCH.x, WINCH.y, 0.8 * z), about_z)
        return self.system.revolute(drum, at=WINCH, axis=(0, 0, 1), motor=(0, BRAKE))

    # --- ropes --------------------------------------------------------------------------------------------------------

    def reeve(self, parts: int) -> None:
        """Leads the rope of the tackle anew: `parts` of it carry the block. Where it has been heaved to stays."""
        if not self.drum.alive or not all(sheave.alive for sheave in (*self.tops, *self.bottoms)):
            return  # somebody has taken the derrick apart
        self.parts = parts
        way = reeved(parts, self.tops, self.bottoms)
        with self.system.edit():
            for span in self.spans:
                if span.alive:
                    span.destroy()
            self.spans = [self.system.span(p, q) for p, q in pairwise(way)]
            terms = [(span.slide, 1.0) for span in self.spans]
            tackle = self.system.couple([*terms, (self.drum.angle, DRUM)], one_sided=True)
        self.tackles.append((tackle, parts, self.spans))
        self.find_tackle()

    def find_tackle(self) -> None:
        """Reads and shows the tackle that there is: a reset or an undo brings an earlier one back."""
        there = [led for led in self.tackles if led[0].alive]
        if not there:
            return
        self.ropes["tackle"], self.parts, self.spans = there[-1]
        way = reeved(self.parts, self.tops, self.bottoms)
        self.show("tackle", [*way, self.over, self.heel, WINCH + (0, DRUM, 0)])

    def show(self, name: str, places: Sequence[Any]) -> None:
        """Draws a rope, with a label for its force."""
        if name in self.lines:
            self.lines[name].destroy()
        self.lines[name] = self.world.drawings.line(*places, radius=0.012, color="#6b8f4e")
        if name not in self.labels:
            self.labels[name] = self.world.label("", height=0.075)

    def drive(self, winch: float, peak: float, swing: float) -> None:
        """Before each step. winch: from -1 to 1. peak, swing: degrees that the boom goes to."""
        dt = self.world.dt
        self.turning += min(max(TURN * winch - self.turning, -HASTE * dt), HASTE * dt)
        motor = (self.turning, BRAKE) if self.is_braked or self.turning != 0 else (0.0, RATCHET)
        if self.drum.angle.motor != motor:
            self.drum.angle.motor = motor
        before = (self.peak, self.swing)
        self.peak += min(max(peak - self.peak, -LEAN * dt), LEAN * dt)
        self.swing += min(max(swing - self.swing, -LEAN * dt), LEAN * dt)
        if (self.peak, self.swing) != before:
            end = tip_at(self.peak, self.swing)
            self.ropes["lift"].length = abs(self.head.position - end)
            for name, eye in zip(("port", "starboard"), self.eyes, strict=True):
                self.ropes[name].length = abs(eye.position - end) + 0.01

    def tension(self, name: str) -> float:
        """The force in a rope in the last step, N; 0 if it is gone."""
        rope = self.ropes[name]
        return abs(rope.force) if rope.alive else 0.0

    def expected(self) -> float:
        """The force at the winch of a tackle without friction that holds the load in the air, N."""
        return (CRATE + BLOCK) * GRAVITY / self.parts

    def tell(self) -> None:
        """Writes the forces at the ropes, and paints these."""
        if not self.ropes["tackle"].alive:
            self.find_tackle()
        places = {
            "lift": (self.head.position + self.tip.position) * 0.5 + (0, 0.12, 0),
            "port": self.tip.position * 0.25 + self.eyes[0].position * 0.75,
            "starboard": self.tip.position * 0.25 + self.eyes[1].position * 0.75,
            "tackle": WINCH + (-0.35, 0.5, 0),
        }
        for name, place in places.items():
            force = self.tension(name)
            self.labels[name].text = f"{name} {force:.0f} N" if force > 0.5 else f"{name} slack"
            self.labels[name].at = tuple(place)
            self.lines[name].color = tint(force)


def reeved(parts: int, tops: Sequence[iota.Particle], bottoms: Sequence[iota.Particle]) -> list[iota.Particle]:
    """The places that the rope goes through, from its fixed end to the last sheave of the boom: at the boom if `parts` is even, at
    the block if it is odd."""
    up = list(tops[: parts // 2 + 1])
    down = list(bottoms[: (parts + 1) // 2])
    if parts == 1:
        down = [bottoms[1]]
    first, second = (up, down) if parts % 2 == 0 else (down, up)
    way = [first[number // 2] if number % 2 == 0 else second[number // 2] for number in range(parts + 1)]
    return way


def tip_at(peak: float, swing: float) -> iota.Vec3:
    """The end of the boom, m. peak, swing: degrees."""
    a, b = math.radians(peak), math.radians(swing)
    return HEEL + iota.Vec3(math.cos(a) * math.cos(b), math.sin(a), math.cos(a) * math.sin(b)) * BOOM


def sheaves(middle: tuple[float, float, float]) -> list[looks.Look]:
    """Three wheels on a pin."""
    about_z = (0.0, 0.5**0.5, 0.0, 0.5**0.5)
    x, y, z = middle
    wheels = [
        looks.cylinder(0.065, "brass", 0.025, offset=(x, y, z + side), rotation=about_z) for side in (-0.06, 0.0, 0.06)
    ]
    return [*wheels, looks.cylinder(0.018, "steel", 0.2, offset=middle, rotation=about_z)]


def tint(force: float) -> tuple[float, float, float]:
    """Green without a load, over yellow to red."""
    share = min(force / RED, 1.0)
    return (0.25 + 0.65 * min(2 * share, 1), 0.55 - 0.4 * max(2 * share - 1, 0), 0.25 - 0.1 * share)


if __name__ == "__main__":
    build().run()
