# SPDX-License-Identifier: Apache-2.0
"""A workbench of small machines: an engine, a torsion pendulum, a shaft with two crosses, scales, a crane whose rope can break."""

from __future__ import annotations

import math
from itertools import product

import iota
from iota import looks

BENCH = 0.55  # height of the bench's top, m
BENCH_SIZE = (2.5, 0.05, 0.6)  # of its top, m
BENCH_PLACE = (0.15, BENCH - 0.025, 0.0)
STEEL = 7800.0  # kg/m^3
WOOD = 700.0
RED = "#c8322b"
ABOUT_Z = (0.0, 0.5**0.5, 0.0, 0.5**0.5)  # of a cylinder, which lies along x
ABOUT_Y = (0.0, 0.0, 0.5**0.5, 0.5**0.5)
SHAFT, BAR = 0.2, 0.13  # m: from one cross to the next, and the bar between two forks


def build() -> iota.World:
    """The world of the study."""
    world = iota.World(iota.System(), title="mechanisms: joints, gears and ropes on a bench of 2.5 m")
    world.system.usual_material = iota.Material(friction=0.6, touches="obstacles")  # links are drawn through each other
    present(world)
    axis = engine(world, iota.Vec3(-0.78, BENCH + 0.24, 0)).angle
    pendulum(world, iota.Vec3(-0.2, BENCH + 0.2, 0))
    shaft(world, iota.Vec3(-0.02, BENCH + 0.24, 0))
    scales(world, iota.Vec3(0.72, BENCH + 0.62, 0))
    weight, rope = crane(world, iota.Vec3(0.98, BENCH, 0))
    start = weight.center_of_mass
    # The bench holds the weight as the ground does, without friction.
    top = iota.Box((BENCH_SIZE[0] + 0.1, BENCH_SIZE[1] + 0.1, BENCH_SIZE[2] + 0.1))
    world.system.outside(weight.attachment(start), top, at=BENCH_PLACE)

    @world.action("reverse", key="x", help="turns the engine's motor the other way", on="world")
    def reverse() -> None:
        assert axis.motor is not None
        speed, torque = axis.motor
        axis.motor = (-speed, torque)

    @world.action("mend", key="c", help="hangs the crane's weight on its rope again", on="world")
    def mend() -> None:
        if rope.active:
            return
        weight.set_pose(start, (0, 0, 0, 1))
        weight.velocity = weight.angular_velocity = (0, 0, 0)
        rope.active = True

    return world


def present(world: iota.World) -> None:
    """The bench, and where one stands in front of it."""
    world.add_static(looks.box(BENCH_SIZE, "wood", 0.006), BENCH_PLACE)
    for x in (-1.0, 1.3):
        for z in (-0.22, 0.22):
            world.add_static(looks.box((0.07, BENCH - 0.05, 0.07), "wood"), (x, (BENCH - 0.05) / 2, z))
    names = {"engine": -0.6, "torsion pendulum": -0.2, "two crosses": 0.2, "scales": 0.7, "crane": 1.1}
    for name, x in names.items():
        world.label(name, at=(x, BENCH - 0.025, BENCH_SIZE[2] / 2 + 0.03), height=0.026)
    world.draw_ties("spring", looks.spring(0.016, 0.0022))
    world.draw_ties("rope", looks.cylinder(0.005, "rope"))
    world.stage("room")
    world.camera = iota.Camera(position=(0.25, 1.15, 2.15), target=(0.15, 0.64, 0))


def stand(world: iota.World, at: iota.Vec3, depth: float = 0.1, floor: float = BENCH) -> None:
    """A bearing block behind `at`, with its axle along z, on a post."""
    behind = at - (0, 0, depth)
    world.add_strut((at.x, floor, behind.z), tuple(behind), looks.cylinder(0.016, "steel"))
    world.add_strut(tuple(behind - (0, 0, 0.02)), tuple(at + (0, 0, 0.02)), looks.cylinder(0.01, "brass"))


def bar(system: iota.System, start: iota.Vec3, end: iota.Vec3, width: float, density: float = STEEL) -> iota.Body:
    """A flat bar from `start` to `end` in a plane across z."""
    along, middle = end - start, (start + end) * 0.5
    turn = math.atan2(along.y, along.x) / 2
    return system.body(
        shape=iota.Box((abs(along) + width, width, 0.012)),
        density=density,
        position=middle,
        orientation=(0, 0, math.sin(turn), math.cos(turn)),
    )


def engine(world: iota.World, axle: iota.Vec3, floor: float = BENCH, speed: float = 4.0) -> iota.Constraint:
    """A motor turns a crank, a rod pushes a piston along its guide: one closed loop, exact all the way round. floor: height of what it
    stands on, m. speed: rad/s. Returns the joint of the motor."""
    system, crank, rod = world.system, 0.09, 0.3
    wheel = system.body(shape=iota.Cylinder(0.12, 0.02), density=STEEL, position=axle, orientation=ABOUT_Z)
    pin, wrist = axle + (crank, 0, 0.03), axle + (crank + rod, 0, 0.03)
    connecting_rod = bar(system, pin, wrist, 0.025)
    piston = system.body(shape=iota.Box((0.1, 0.07, 0.07)), density=2700, position=wrist)
    world.draw(wheel, [*spoked_wheel(0.12, 0.02), *crank_of(crank)])
    ends = [looks.cylinder(0.02, "brass", 0.02, offset=(x, 0, 0), rotation=ABOUT_Z) for x in (-rod / 2, rod / 2)]
    world.draw(connecting_rod, [looks.solid("paint", RED), *ends])
    world.draw(piston, looks.solid("steel"))
    drive = system.revolute(wheel, at=axle, axis=(0, 0, 1), motor=(speed, 20.0))
    system.revolute(connecting_rod, wheel, at=pin, axis=(0, 0, 1))
    system.revolute(connecting_rod, piston, at=wrist, axis=(0, 0, 1))
    system.prismatic(piston, at=wrist, axis=(1, 0, 0))
    stand(world, axle, floor=floor)
    for y, z in product((-0.05, 0.05), (-0.0325, 0.0325)):  # two rails above and two below, the rod swings between them
        world.add_static(looks.box((0.34, 0.012, 0.025), "steel"), (wrist.x - crank, wrist.y + y, wrist.z + z))
    post = (wrist.x, (axle.y + floor) / 2 - 0.03, axle.z - 0.05)
    world.add_static(looks.box((0.04, axle.y - floor, 0.04), "steel"), post)
    return drive


def spoked_wheel(radius: float, width: float) -> list[looks.Look]:
    """A rim, a hub and spokes about local x, one of them marked, so that one sees it turn."""
    rim = looks.torus(0.9 * radius, 0.1 * radius, "brass", rotation=(0, 0.5**0.5, 0, 0.5**0.5))
    hub = looks.cylinder(0.22 * radius, "steel", 1.4 * width)
    spokes = [
        looks.cylinder(
            0.055 * radius,
            "rubber" if number == 0 else "brass",
            0.72 * radius,
            offset=(0, 0.5 * radius * math.cos(angle), 0.5 * radius * math.sin(angle)),
            rotation=turn_to((0, math.cos(angle), math.sin(angle))),
        )
        for number, angle in enumerate(2 * math.pi * n / 6 for n in range(6))
    ]
    return [rim, hub, *spokes]


def crank_of(radius: float) -> list[looks.Look]:
    """An arm on the wheel, and the pin that holds the rod; the wheel's x points away from the viewer."""
    return [
        looks.box((0.012, 0.036, radius + 0.03), "paint", 0.004, color=RED, offset=(-0.016, 0, radius / 2)),
        looks.cylinder(0.011, "steel", 0.05, offset=(-0.025, 0, radius)),
    ]


def fork(end: float, along_z: bool) -> list[looks.Look]:
    """Two cheeks at an end of a bar along x, and the pin of the cross between them, along z or y."""
    side = math.copysign(1.0, end)
    middle, length = (BAR / 2 + abs(end)) / 2 + 0.004, abs(end) - BAR / 2 + 0.016
    parts = []
    for far in (-0.021, 0.021):
        size = (length, 0.022, 0.007) if along_z else (length, 0.007, 0.022)
        place = (side * middle, 0.0, far) if along_z else (side * middle, far, 0.0)
        parts.append(looks.box(size, "steel", 0.002, offset=place))
    pin = looks.cylinder(0.0055, "brass", 0.052, offset=(end, 0, 0), rotation=ABOUT_Z if along_z else ABOUT_Y)
    return [*parts, pin, looks.sphere(0.011, "brass", offset=(end, 0, 0))]


def turn_to(direction: tuple[float, float, float]) -> tuple[float, float, float, float]:
    """The rotation that takes local x to a direction across it."""
    _, y, z = direction
    half = 0.5**0.5
    return (0.0, -half * z, half * y, half)


def pendulum(world: iota.World, axle: iota.Vec3, floor: float = BENCH, stiffness: float = 25.0) -> iota.Body:
    """A bar on a torsion spring, with stops. stiffness: N m/rad. Returns the bar."""
    system = world.system
    swing = bar(system, axle - (0, 0.05, 0), axle + (0, 0.24, 0), 0.03)
    world.draw(swing, looks.solid("brass"))
    system.revolute(swing, at=axle, axis=(0, 0, 1), limits=(-1.0, 1.0), spring=(stiffness, 0.02, 0.0))
    swing.angular_velocity = (0, 0, 6)
    stand(world, axle, 0.06, floor)
    return swing


def shaft(world: iota.World, bearing: iota.Vec3, floor: float = BENCH) -> None:
    """A motor turns a shaft; two crosses carry the turn round a corner and make it even again."""
    system, lean, length = world.system, 0.5, SHAFT
    directions = [iota.Vec3(math.cos(a), math.sin(a), 0) for a in (0, lean, 0)]
    place, parts = bearing, []
    for direction, angle in zip(directions, (0, lean, 0), strict=True):
        end = place + direction * length
        parts.append(
            system.body(
                shape=iota.Box((BAR, 0.035, 0.035), 0.003),
                density=STEEL,
                position=(place + end) * 0.5,
                orientation=(0, 0, math.sin(angle / 2), math.cos(angle / 2)),
            )
        )
        place = end
    first, middle, last = parts
    red, half = looks.solid("paint", RED), length / 2
    world.draw(first, [red, *fork(half, along_z=True)])
    world.draw(middle, [red, *fork(-half, along_z=False), *fork(half, along_z=False)])
    world.draw(last, [red, *fork(-half, along_z=True)])
    cross = bearing + directions[0] * length
    system.revolute(first, at=bearing + directions[0] * (length / 2), axis=(1, 0, 0), motor=(3.0, 5))
    system.universal(first, middle, at=cross, axis=(0, 0, 1), second_axis=directions[1].cross((0, 0, 1)))
    cross = cross + directions[1] * length
    system.universal(middle, last, at=cross, axis=directions[1].cross((0, 0, 1)), second_axis=(0, 0, 1))
    system.cylindrical(last, at=cross + directions[2] * (length / 2), axis=(1, 0, 0))
    for x, y in ((bearing.x + length / 2, bearing.y), (cross.x + length / 2, cross.y)):
        world.add_strut((x, floor, bearing.z), (x, y - 0.03, bearing.z), looks.cylinder(0.014, "steel"))
        world.add_static(looks.torus(0.036, 0.012, "brass"), (x, y, bearing.z), (0, 0.5**0.5, 0, 0.5**0.5))


def scales(world: iota.World, beam: iota.Vec3, floor: float = BENCH) -> None:
    """Three weights on springs: one solve for soft and rigid; the middle one pulls the beam's ends along."""
    system = world.system
    yoke = bar(system, beam - (0.14, 0, 0), beam + (0.14, 0, 0), 0.02)
    world.draw(yoke, looks.solid("steel"))
    system.revolute(yoke, at=beam, axis=(0, 0, 1), friction=0.01)
    stand(world, beam, 0.05, floor)
    for x, drop in ((-0.13, 0.20), (0.13, 0.26)):
        end = yoke.attachment(beam + (x, 0, 0))
        place = end.position - (0, drop, 0)
        weight = system.body(
            shape=iota.Cylinder(0.03, 0.05),
            density=STEEL,
            position=place,
            orientation=(0, 0, 0.5**0.5, 0.5**0.5),
            attachments=[(0.025, 0, 0)],
        )
        world.draw(weight, looks.solid("brass"))
        system.bond(end, weight.attachments[0], "spring", stiffness=120, damping=0.15, length=0.11)


def crane(world: iota.World, foot: iota.Vec3) -> tuple[iota.Body, iota.Constraint]:
    """A boom that a weld holds; from its end a weight on a rope that breaks when it is pulled too hard. Returns weight and rope."""
    system = world.system
    shoulder = foot + (0, 0.55, 0)
    tip = shoulder + (0.32, 0.12, 0)
    boom = bar(system, shoulder, tip, 0.03)
    system.weld(boom, at=shoulder)
    hook = boom.attachment(tip)
    weight = system.body(
        shape=iota.Sphere(0.05), density=STEEL, position=tip - (0, 0.36, 0), attachments=[(0, 0.05, 0)]
    )
    world.draw(boom, looks.solid("wood"))
    world.draw(weight, looks.solid("rubber"))
    rope = system.rope(hook, weight.attachments[0], break_force=150)
    world.add_strut(tuple(foot), tuple(shoulder), looks.cylinder(0.025, "steel"))
    return weight, rope
