# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import gc
import subprocess
import sys
import weakref
from typing import Any

import numpy as np
import pytest

import iota


def test_handles_of_one_thing_are_equal_and_hash_alike(system: iota.System) -> None:
    body = system.body()
    particle = body.particle()
    assert particle.body == body and particle.body is not body
    assert {particle.body: "found"}[body] == "found"
    assert system.bodies == [body] and system.particles == body.particles == [particle]
    assert particle != body and body != None  # noqa: E711
    assert iota.System().body() != body


def test_properties_are_assignable(system: iota.System) -> None:
    body = system.body(damping=0.5)
    particle = body.particle(position=(1, 2, 3), mass=2, velocity=(0, 1, 0))
    assert (particle.position, particle.velocity, particle.mass) == ((1, 2, 3), (0, 1, 0), 2)
    particle.position, particle.velocity, particle.mass = (0, 0), (1, 0, 0), 3
    assert (particle.position, particle.velocity, particle.mass) == ((0, 0, 0), (1, 0, 0), 3)
    assert body.mass == 3 and body.damping == 0.5 and body.kind == "dynamic"
    body.damping, body.kind = 0.0, "inactive"
    assert body.damping == 0 and body.kind == "inactive"
    system.gravity, system.mode, system.damping = (0, -1), "robust", 0.1
    assert (system.gravity, system.mode, system.damping) == ((0, -1, 0), "robust", 0.1)


def test_positions_and_velocities_come_and_go_as_arrays(system: iota.System, chain: list[iota.Body]) -> None:
    positions = system.positions
    assert positions.shape == (12, 3) and positions.dtype == np.float64
    for row, particle in zip(positions, system.particles, strict=True):
        np.testing.assert_array_equal(row, particle.position)
    system.positions += [0, 1, 0]
    np.testing.assert_array_equal(system.positions, positions + [0, 1, 0])
    positions[:] = 7
    assert not (system.positions == 7).any(), "the array is a copy"
    system.velocities = np.tile([0.0, 0.0, 1.0], (12, 1))
    assert chain[-1].particles[-1].velocity == (0, 0, 1)


@pytest.mark.parametrize("bad", [np.zeros((11, 3)), np.zeros((12, 2)), np.zeros(36), [[1, 2, 3]], "abc"])
def test_an_array_of_another_shape_is_refused(system: iota.System, chain: list[iota.Body], bad: object) -> None:
    before = system.positions
    with pytest.raises(ValueError):
        system.positions = bad
    np.testing.assert_array_equal(system.positions, before)


def test_a_row_that_is_not_finite_is_named_and_nothing_is_assigned(system: iota.System, chain: list[iota.Body]) -> None:
    before = system.positions
    bad = before.copy()
    bad[3, 1] = np.nan
    with pytest.raises(ValueError, match="positions must be finite; row 3 is not"):
        system.positions = bad
    np.testing.assert_array_equal(system.positions, before)


def test_a_destroyed_particle_says_so(system: iota.System) -> None:
    body = system.body()
    particle, other = body.particle(), body.particle((1, 0, 0))
    particle.destroy()
    assert not particle.alive and particle.survivor is None and other.alive
    with pytest.raises(iota.StaleIdError, match=r"particle 0.*destroyed") as caught:
        particle.position = (0, 0, 0)
    assert caught.value.survivor is None
    assert "gone" in repr(particle)


def test_an_absorbed_particle_names_its_successor(system: iota.System) -> None:
    body = system.body()
    p, q, _ = body.particle(), body.particle((1, 0, 0)), body.particle((2, 0, 0))
    p.combine(q)
    with pytest.raises(iota.StaleIdError, match=r"particle 1.*absorbed by particle 0") as caught:
        _ = q.mass
    assert caught.value.survivor == p == q.survivor
    assert isinstance(caught.value, ValueError)


def test_an_absorbed_body_names_its_successor(system: iota.System) -> None:
    a, b = system.body(), system.body()
    a.particle()
    b.particle((1, 0, 0))
    report = a.combine(b)
    assert report.absorbed_bodies == [(b, a)]
    assert not b.alive and b.survivor == a
    with pytest.raises(iota.StaleIdError, match=r"body 1.*absorbed by body 0"):
        _ = b.particles


def test_every_use_of_a_stale_handle_raises(system: iota.System) -> None:
    body, other = system.body(), system.body()
    p, q = body.particle(), other.particle()
    bond, grip, line = system.bond(p, q, "drag"), system.grip(body), system.cosmetic_bond(p, body.particle((1, 0, 0)))
    body.destroy()
    uses = [
        lambda: p.position,
        lambda: p.ring,
        lambda: p.nail(),
        lambda: p.release(),
        lambda: p.destroy(),
        lambda: p.apply_force((1, 0, 0)),
        lambda: body.particles,
        lambda: body.kind,
        lambda: body.destroy(),
        lambda: body.set_rod(1, 0.1),
        lambda: body.particle(),
        lambda: system.bond(p, q, "spring", stiffness=100),
        lambda: system.cosmetic_bond(q, p),
        lambda: system.grip(body),
        lambda: q.combine(p),
        lambda: other.combine(body),
        lambda: p.separate(q),
        lambda: bond.active,
        lambda: bond.ends,
        lambda: bond.destroy(),
        lambda: grip.move((0, 0, 0)),
        lambda: grip.destroy(),
        lambda: line.destroy(),
    ]
    for number, use in enumerate(uses):
        with pytest.raises(iota.StaleIdError):
            use()
            pytest.fail(f"use {number} did not raise")
    assert system.validate() == []


def test_a_reused_slot_does_not_revive_old_handles(system: iota.System) -> None:
    old = system.body()
    old.destroy()
    new = system.body()
    assert new.slot == old.slot and new != old and not old.alive and new.alive


def test_a_handle_keeps_its_system_alive() -> None:
    particle = iota.System().body().particle((1, 2, 3))
    gc.collect()
    assert particle.position == (1, 2, 3)


def make_a_ring() -> tuple[weakref.ref[Any], weakref.ref[Any]]:
    """A system whose bond's function refers to the system and to a handle."""
    system = iota.System()
    p, q = system.body().particle(), system.body().particle((1, 0, 0))

    def force(bond: iota.types.BondState) -> iota.Vec3:
        return system.gravity + p.position

    system.bond(p, q, force)
    system.step()
    return weakref.ref(system), weakref.ref(force)


def test_a_ring_of_system_and_bond_function_is_collected() -> None:
    system, force = make_a_ring()
    gc.collect()
    assert system() is None and force() is None


def test_the_function_of_a_destroyed_bond_is_let_go(system: iota.System) -> None:
    p, q = system.body().particle(), system.body().particle((1, 0, 0))

    def force(bond: iota.types.BondState) -> tuple[float, float, float]:
        return (0, 0, 0)

    before = sys.getrefcount(force)
    bond = system.bond(p, q, force)
    bond.destroy()
    system.step()
    assert sys.getrefcount(force) == before


def test_handles_print_their_kind_and_id(system: iota.System, chain: list[iota.Body]) -> None:
    assert repr(chain[0]) == "<Body 0: dynamic, 2 particles>"
    assert repr(chain[0].particles[0]) == "<Particle 0 of body 0 at (0, 2, 0)>"
    assert "6 bodies in 1 articulates" in repr(system)
    assert "1 articulates" in repr(system.step())


def test_objects_that_a_script_has_at_its_end_are_freed_quietly() -> None:
    """A function that the system holds sees the script's names, which hold the system: a ring that must come free."""
    script = """
import iota
system = iota.System()
a, b = (system.body(shape=iota.Box((1, 1, 1)), position=(x, 0, 0), attachments=[(0.5 - x, 0, 0)]) for x in (0, 1))
bond = system.bond(a.particles[0], b.particles[0], lambda bond: a.velocity)
joint = system.revolute(a, at=(0, 0, 0), axis=(0, 0, 1), break_force=1e-9)
angle = joint.angle
report = system.step(0.01)
broken = system.broken
combined = a.combine(b)
part = a.parts[0]
with system.edit() as edit:
    ball = system.body(shape=iota.Sphere(0.1))
assert broken and part and angle
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=60)
    assert "leaked" not in done.stderr, done.stderr
