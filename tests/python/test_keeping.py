# SPDX-License-Identifier: Apache-2.0
"""What goes on when a script is saved: the state of a world in the world of the changed script."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import iota
from iota.world.keeping import Keeper


def make(change: Callable[[iota.System], None] = lambda _: None, **options: object) -> iota.System:
    """A chain on a nail, a ball on a spring, a hinged pair, and a box."""
    system = iota.System(**options)
    chain = iota.builder.chain(links=5, length=1, top=(0, 2, 0)).realize(system)
    chain.points[-1].velocity = (1, 0, 0)
    ball = system.body(shape=iota.Sphere(0.1), position=(2, 2, 0))
    anchor = system.body(kind="static").particle((2, 3, 0))
    system.bond(ball.particles[0], anchor, "spring", stiffness=20, length=0.5)
    left, right = system.body(), system.body()
    left.particle((4, 0, 0))
    p = left.particle((5, 0, 0), velocity=(0, 0, 1))
    q = right.particle((5, 0, 0))
    right.particle((6, 0, 0))
    p.combine(q)
    system.body(shape=iota.Box((0.5, 0.5, 0.5)), position=(8, 0, 0)).angular_velocity = (0, 1, 0)
    change(system)
    return system


def run(system: iota.System, file: Path, during: Callable[[iota.System], None] = lambda _: None) -> str:
    """As a run under --watch: takes what is kept, steps, keeps. Returns what is told."""
    keeper = Keeper(file, system)
    told = keeper.take()
    for step in range(100):
        if step == 50:
            during(system)
        system.step(1 / 240)
    keeper.keep()
    return told


def taken(system: iota.System, file: Path) -> str:
    return Keeper(file, system).take()


def test_an_unchanged_start_goes_on_to_the_last_bit(tmp_path: Path) -> None:
    file = tmp_path / "world"
    first, second = make(), make()
    assert run(first, file) == ""
    assert taken(second, file) == "The world goes on at 0.4 s." and second.state_hash() == first.state_hash()
    assert not file.exists()


def test_other_gravity_leaves_all_bodies_where_they_are(tmp_path: Path) -> None:
    file = tmp_path / "world"
    first, second = make(), make(gravity=(0, -1, 0))
    run(first, file)
    assert taken(second, file) == "10 of 10 bodies go on where they were."
    assert np.allclose(second.positions, first.positions, atol=1e-12)
    assert np.allclose(second.velocities, first.velocities, atol=1e-9)
    report = second.step(1 / 240)
    assert report.worst_gap < 1e-9 and second.validate() == []


@pytest.mark.parametrize(
    ("change", "anew"),
    [
        (lambda system: system.body().particle((9, 9, 9)), 1),
        (lambda system: setattr(system.bodies[-1], "position", (8, 1, 0)), 1),
        (lambda system: setattr(system.bodies[0].particles[0], "mass", 3.0), 5),
        (lambda system: system.bodies[6].particles[0].nail(), 2),
        (lambda system: system.bonds[0].destroy(), 2),
    ],
    ids=["new body", "moved body", "other mass", "new nail", "no bond"],
)
def test_only_what_starts_in_another_way_begins_anew(
    tmp_path: Path, change: Callable[[iota.System], None], anew: int
) -> None:
    file = tmp_path / "world"
    first, second = make(), make(change)
    start = second.positions
    run(first, file)
    count = len(second.bodies)
    told = taken(second, file)
    assert told.startswith(f"{count - anew} of {count} bodies go on where they were. The others start in another way")
    moved = [np.abs(second.array(body.particles).positions - start[rows]).max() for body, rows in rows_of(second)]
    assert sum(distance < 1e-12 for distance in moved) >= anew and max(moved) > 0.1
    assert second.step(1 / 240).worst_gap < 1e-9


def rows_of(system: iota.System) -> list[tuple[iota.Body, list[int]]]:
    particles = system.particles
    return [(body, [particles.index(particle) for particle in body.particles]) for body in system.bodies]


@pytest.mark.parametrize(
    "during",
    [
        lambda system: system.bodies[2].particles[0].separate(system.bodies[1].particles[-1]),
        lambda system: system.bodies[2].destroy(),
        lambda system: system.bodies[0].particles[0].release(),
    ],
    ids=["cut", "destroyed", "released"],
)
def test_parts_that_users_broke_begin_anew_and_the_rest_goes_on(
    tmp_path: Path, during: Callable[[iota.System], None]
) -> None:
    file = tmp_path / "world"
    first, second = make(), make()
    start = second.positions
    run(first, file, during)
    assert taken(second, file).startswith("5 of 10 bodies go on where they were.")
    assert np.array_equal(second.array(second.bodies[:5][0].particles).positions, start[:2])


def test_a_world_of_other_parts_begins_anew(tmp_path: Path) -> None:
    file = tmp_path / "world"
    run(make(), file)
    other = iota.System()
    other.body().particle((0, 0, 0))
    assert taken(other, file) == "The world begins anew, since its parts start in another way."
    file.write_text("{")
    assert taken(other, file) == ""
