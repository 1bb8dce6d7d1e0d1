# SPDX-License-Identifier: Apache-2.0
"""A pendulum, an orbit and a weight on a spring, with sliders and live plots: change a number and see what it does."""

from __future__ import annotations

import math

import iota
from iota import looks
from iota.world.widgets import Slider

PIVOT, SUN, BEAM = iota.Vec3(-1.3, 2.0, 0), iota.Vec3(0, 1.6, 0), iota.Vec3(1.3, 2.0, 0)
ORBIT, PULL = 0.4, 0.4  # m, where the planet starts; m^3/s^2
TEXT = 0.07  # m
LAUNCH = 1.1  # times the speed of a circle
START = -0.5  # rad, of the pendulum: outwards


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(gravity=(0, 0, 0))
    world = iota.World(system, title="physics class: pendulum, orbit and spring beside their formulas; 2.6 m wide")
    heavy = system.group("heavy")
    field = system.field("energy = m*g*y", group=heavy, g=9.81)
    gravity = world.controls.slider("gravity", 0.5, 25, 9.81, unit="m/s²", help="on pendulum and weight")

    @gravity.on_change
    def change() -> None:
        field.set(g=gravity.value)

    pendulum(world, heavy, gravity)
    orbit(world)
    spring(world, heavy)
    world.controls.plot(
        "energy", {"moving": lambda: system.energy.kinetic, "total": lambda: system.energy.total}, unit="J"
    )
    world.stage("room")
    world.camera = iota.Camera(position=(0.47, 1.6, 4.35), target=(0.33, 1.22, 0))
    return world


class Period:
    """Measures how long a swing takes: from one passage upwards through zero to the next."""

    def __init__(self) -> None:
        self.seconds = math.nan
        self._last, self._before = math.nan, (0.0, 0.0)

    def take(self, time: float, value: float) -> None:
        then, before = self._before
        if before < 0 <= value and time > then:
            now = then + (time - then) * before / (before - value)
            self.seconds, self._last = now - self._last, now
        self._before = (time, value)


def say(title: str, period: Period, expected: float) -> str:
    measured = "... s" if math.isnan(period.seconds) else f"{period.seconds:.2f} s"
    return f"{title} {measured}\nideal {expected:.2f} s"


def pendulum(world: iota.World, heavy: iota.Group, gravity: Slider) -> None:
    """A bob on a rod; its length is a slider."""
    system, period = world.system, Period()
    rod = system.body()
    top, bob = rod.particle(PIVOT), rod.particle(PIVOT - (0, 1, 0), mass=1)
    heavy.add(bob)
    top.nail()
    world.draw(rod, looks.cylinder(0.008, "steel"))
    bob.radius, bob.color = 0.08, (0.85, 0.25, 0.15)
    stand(world, PIVOT)
    length = world.controls.slider("length", 0.3, 1.4, 1.0, step=0.05, unit="m", help="of the pendulum")
    label = world.label("", at=PIVOT + (0, 0.22, 0), height=TEXT)

    @length.on_change
    def hang() -> None:
        with system.edit():
            bob.position = PIVOT + iota.Vec3(math.sin(START), -math.cos(START), 0) * length.value
            bob.velocity = (0, 0, 0)

    def angle() -> float:
        return math.atan2(bob.position.x - PIVOT.x, PIVOT.y - bob.position.y)

    @world.on_step
    def measure() -> None:
        period.take(system.time, angle())

    @world.every(0.25)
    def tell() -> None:
        label.text = say("pendulum", period, 2 * math.pi * math.sqrt(length.value / gravity.value))

    hang()
    world.on_reset(lambda: setattr(length, "value", 1.0))
    world.controls.plot("pendulum", lambda: math.degrees(angle()), unit="°", seconds=8)


def orbit(world: iota.World) -> None:
    """A planet about a sun that is nailed. Kepler: an ellipse, whatever the speed, below sqrt(2) of the circle's."""
    system = world.system
    sun = system.body().particle(SUN, mass=1)
    sun.nail()
    planet = system.body().particle(SUN + (0, ORBIT, 0), mass=1)
    planet.radius, planet.color = 0.045, (0.2, 0.5, 0.75)
    sun.radius, sun.color = 0.1, (0.95, 0.7, 0.15)
    system.bond(planet, sun, "gravity", strength=PULL, softening=0)
    stand(world, SUN)
    world.drawings.trace(planet, seconds=6, color="#3f7fd0")
    speed = world.controls.slider(
        "launch", 0.6, 1.25, LAUNCH, step=0.05, unit="of a circle", help="launches the planet anew"
    )
    label = world.label("", at=SUN + (0, 0.58, 0), height=TEXT)

    @speed.on_change
    def launch() -> None:
        planet.position = SUN + (0, ORBIT, 0)
        planet.velocity = (-speed.value * math.sqrt(PULL / ORBIT), 0, 0)

    @world.every(0.25)
    def tell() -> None:
        to = planet.position - SUN
        energy = 0.5 * abs(planet.velocity) ** 2 - PULL / abs(to)
        half = -PULL / (2 * energy)  # of the long axis
        year = f"{2 * math.pi * math.sqrt(half**3 / PULL):.2f} s" if energy < 0 else "never back"
        label.text = f"orbit {year}"

    launch()
    world.on_reset(lambda: setattr(speed, "value", LAUNCH))
    world.controls.plot("orbit", {"distance": lambda: abs(planet.position - SUN)}, unit="m", seconds=8)


def spring(world: iota.World, heavy: iota.Group) -> None:
    """A weight on a spring from a beam."""
    system, period = world.system, Period()
    weight = system.body().particle(BEAM - (0, 0.9, 0), mass=1)
    hook = system.body().particle(BEAM, mass=1)
    hook.radius = 0.02
    hook.nail()
    heavy.add(weight)
    weight.radius, weight.color = 0.09, (0.2, 0.45, 0.4)
    bond = system.bond(hook, weight, "spring", stiffness=40, damping=0, length=0.5)
    world.draw_ties("spring", looks.spring(0.035, 0.004, "steel"))
    stand(world, BEAM)
    stiffness = world.controls.slider("stiffness", 15, 150, 40, unit="N/m", help="of the spring")
    damping = world.controls.slider("damping", 0, 2, 0, unit="N s/m", help="of the spring")
    label = world.label("", at=BEAM + (0, 0.22, 0), height=TEXT)

    @stiffness.on_change
    @damping.on_change
    def change() -> None:
        bond.set(stiffness=stiffness.value, damping=damping.value)

    def stretch() -> float:
        return BEAM.y - weight.position.y

    @world.on_step
    def measure() -> None:
        rest = 0.5 + world.system.fields[0].parameters["g"] / stiffness.value
        period.take(system.time, stretch() - rest)

    @world.every(0.25)
    def tell() -> None:
        label.text = say("spring", period, 2 * math.pi * math.sqrt(weight.mass / stiffness.value))

    @world.on_reset
    def back() -> None:
        stiffness.value, damping.value = 40, 0

    world.controls.plot("spring", stretch, unit="m", seconds=8)


def stand(world: iota.World, top: iota.Vec3) -> None:
    """A post behind what hangs, with an arm to it."""
    x, y, z = top
    world.add_strut((x, 0, z - 0.35), (x, y + 0.02, z - 0.35), looks.cylinder(0.022, "wood"))
    world.add_strut((x, y, z - 0.36), (x, y, z + 0.03), looks.cylinder(0.014, "steel"))
    world.add_static(looks.box((0.5, 0.03, 0.4), "wood", 0.006), (x, 0.015, z - 0.3))
