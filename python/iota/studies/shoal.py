# SPDX-License-Identifier: Apache-2.0
"""A thousand fish keep together and apart, follow a leader, and drift with a current; c turns the current off, s scatters them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import iota
from iota import looks

FISH = 1000
CRUISE = 1.2  # m/s
KEEN = 2.0  # 1/s, how soon a fish has its speed again
FOLLOW = 0.9  # m/s^2, towards the leader
MIDDLE, WAY = (
    np.array([0.0, 4.0, 0.0]),
    np.array([6.0, 1.2, 4.5]),
)  # of the leader's path, and how far it goes from there, m


def build(fish: int = FISH) -> iota.World:
    """The world of the study."""
    system = iota.System(mode="robust", gravity=(0, 0, 0))
    world = iota.World(system, title="shoal", dt=1 / 60)
    random = np.random.default_rng(5)
    shoal = iota.builder.Structure()
    shoal.points.add(leader_at(0) + random.normal(size=(fish, 3)) * [1.5, 0.8, 1.5], 1.0, (CRUISE, 0, 0))
    shoal.group("shoal", range(fish))
    made = shoal.realize(system)
    group = made.groups["shoal"]
    # Long-range attraction, short-range repulsion, and neighbors swim alike.
    system.pair_force(
        "attract_repel", cutoff=1.4, group=group, attraction=0.06, attraction_range=1.0, repulsion=1.3,
        repulsion_range=0.15, alignment=0.03,
    )  # fmt: skip
    system.field(swim, group=group)
    current = system.field("current", group=group, drag=0.5, speed=0.8, size=2.5, octaves=3, evolution=0.2)
    present(world, [point.body for point in made.points])
    phase = random.uniform(0, 2 * math.pi, fish)

    @world.on_step
    def steer() -> None:
        if system.step_count % 2 == 0:
            for particle, turn in zip(made.points, headings(system, phase).tolist(), strict=True):
                particle.orientation = turn

    @world.action("current", key="c", button="a", help="turns the current off and on", on="world")
    def turn() -> None:
        current.active = not current.active

    @world.action("scatter", key="s", button="b", help="scatters the shoal", on="world")
    def scatter() -> None:
        system.velocities = system.velocities + random.normal(size=(fish, 3)) * 3

    return world


def leader_at(time: float) -> Any:
    """Where the fish want to be, m: a loop in half a minute."""
    turn = 2 * math.pi * time / 30
    return MIDDLE + WAY * np.array([math.cos(turn), math.sin(2 * turn), math.sin(turn)])


def swim(batch: iota.types.ParticleBatch) -> Any:
    """Each fish keeps its speed along its way, and turns towards the leader."""
    speed = np.linalg.norm(batch.velocity, axis=1, keepdims=True)
    to_leader = leader_at(batch.time) - batch.position
    distance = np.linalg.norm(to_leader, axis=1, keepdims=True)
    push = KEEN * (CRUISE / np.maximum(speed, 0.05) - 1) * batch.velocity
    return batch.mass[:, None] * (push + FOLLOW * to_leader / np.maximum(distance, 0.5))


def headings(system: iota.System, phase: Any) -> Any:
    """Quaternions that look along each fish's way, level but for a bank into its turn, and wag from side to side: (n, 4)."""
    velocity = system.velocities
    speed = np.maximum(np.linalg.norm(velocity, axis=1), 1e-6)
    wag = 0.22 * np.sin(2 * math.pi * (1.2 + 0.3 * np.sin(phase)) * system.time + phase)
    yaw = np.arctan2(-velocity[:, 2], velocity[:, 0]) + wag
    pitch = np.arcsin(np.clip(velocity[:, 1] / speed, -0.9, 0.9))
    sideways = np.cross((leader_at(system.time) - system.positions), velocity)[:, 1]
    roll = 0.5 * np.tanh(sideways / (3 * speed))
    (cy, cp, cr), (sy, sp, sr) = ([f(angle / 2) for angle in (yaw, pitch, roll)] for f in (np.cos, np.sin))
    # Roll about x, then pitch about z, then yaw about y.
    x, y = sr * cp * cy + cr * sp * sy, cr * cp * sy + sr * sp * cy
    z, w = cr * sp * cy - sr * cp * sy, cr * cp * cy - sr * sp * sy
    return np.stack([x, y, z, w], axis=1)


def present(world: iota.World, fish: list[iota.Body]) -> None:
    """A body, a tail fin, and a reef of stones that does not move."""
    world.draw(
        fish,
        [
            looks.Look(iota.Ellipsoid((0.26, 0.1, 0.05)), "paint", "#5b86a8"),
            looks.Look(iota.Cone(0.055, 0.09), "paint", "#e0a040", offset=(-0.14, 0, 0)),
        ],
    )
    for x, z, size in ((-3, -2, 0.8), (2.5, 1.5, 0.6), (4.5, -3, 1.1), (-5, 2.5, 0.9), (0.5, -5, 1.3)):
        world.add_static(
            looks.Look(iota.Ellipsoid((2 * size, size, 1.6 * size)), "rubber", "#5a6a5c"), (x, 0.3 * size, z)
        )
    world.camera = iota.Camera(position=(4, 4.5, 12), target=(1.5, 4, 0))
