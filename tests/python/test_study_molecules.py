# SPDX-License-Identifier: Apache-2.0
"""The studies bucky, molecule and soft-molecule."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest

import iota
from iota.studies import bucky, molecule, soft_molecule
from iota.world.shown import Label


def test_the_ball_breathes_with_the_period_of_its_springs_and_never_collapses() -> None:
    system = bucky.build().system
    particles = system.particles[:60]
    radii, spread = [], []
    for _ in range(1200):
        assert system.step(1 / 120).unconverged == 0
        places = np.array([tuple(particle.position) for particle in particles])
        own = np.linalg.norm(places - np.asarray(bucky.CENTER), axis=1)
        radii.append(own.mean())
        spread.append(np.ptp(own))
    swing = np.array(radii) - np.mean(radii)
    rising = np.flatnonzero((swing[:-1] < 0) & (swing[1:] >= 0))
    period = float(np.mean(np.diff(rising))) / 120
    assert abs(period - bucky.PERIOD) < 0.03 * bucky.PERIOD  # in the limit of small breaths; this one is not small
    assert 0.06 * bucky.RADIUS < np.ptp(radii) < 0.4 * bucky.RADIUS
    assert max(spread) > 0.02 * bucky.RADIUS  # not too uniformly
    assert min(radii) > 0.7 * bucky.RADIUS


def test_who_has_looked_from_within_the_ball_comes_out_again() -> None:
    world = bucky.build()
    outside = world.camera
    look = world._state.actions["within"].hook.function
    look()
    assert world.camera is not None and abs(world.camera.position - bucky.CENTER) < 0.5 * bucky.RADIUS
    look()
    assert world.camera == outside


def test_the_ball_is_mended_by_a_key_and_breathes_on() -> None:
    world = bucky.build()
    system = world.system
    whole = system.positions
    for _ in range(600):  # pulls an atom through the middle
        atom = system.particles[0]
        atom.body.apply_force(
            (atom.position - bucky.CENTER) * -8.0 - iota.Vec3(*(whole[0] - np.asarray(bucky.CENTER))) * 12
        )
        world.step()
    for _ in range(240):
        world.step()
    assert np.linalg.norm(system.positions - whole, axis=1).max() > 0.5 * bucky.RADIUS
    world.controls.act("mend")
    assert np.abs(system.positions - whole).max() < 1e-9
    system.undo()
    world.controls.act("mend")
    radii = []
    for _ in range(960):
        world.step()
        radii.append(np.linalg.norm(system.positions[:60] - np.asarray(bucky.CENTER), axis=1).mean())
    assert np.ptp(radii[240:]) > 0.05 * bucky.RADIUS  # by itself
    assert np.ptp(radii) < 0.4 * bucky.RADIUS


def test_a_breath_tires() -> None:
    system = bucky.build().system  # without its world nothing breathes anew
    energy = system.energy.kinetic
    for _ in range(120 * 30):
        system.step(1 / 120)
    assert system.energy.kinetic < 0.2 * energy


def period_about_nail(system: iota.System, body: iota.Body) -> float:
    """Of a small swing about z, from mass and inertia."""
    arm = abs(body.center_of_mass - molecule.NAIL)
    inertia = body.inertia[2, 2] + body.mass * arm**2
    return 2 * math.pi * math.sqrt(inertia / (body.mass * 9.81 * arm))


def swing_about(system: iota.System, body: iota.Body) -> float:
    """The period of a small swing of a body that hangs still from the nail, as it is seen."""
    body.angular_velocity = (0, 0, 0.1)
    times, before = [], 0.0
    for step in range(1, 1500):
        system.step(1 / 240)
        now = body.center_of_mass.x - molecule.NAIL.x
        if before < 0 <= now:
            times.append((step - now / (now - before)) / 240)
        before = now
    return float(np.diff(times).mean())


def settle(system: iota.System) -> None:
    system.damping = 3.0
    for _ in range(2400):
        system.step(1 / 120)
    system.damping = 0.0


def test_the_molecule_swings_as_its_inertia_says() -> None:
    system = molecule.build().system
    (body,) = system.bodies
    settle(system)
    body.velocity = (0, 0, 0)
    expected = period_about_nail(system, body)
    assert abs(swing_about(system, body) - expected) < 0.03 * expected


def test_two_bonds_break_on_time_and_the_freed_half_falls() -> None:
    world = molecule.build(repeat=False)
    system = world.system
    bonds = len(system.cosmetic_bonds)

    def run(until: float) -> None:
        while system.time < until - 1e-9:
            world.step()

    run(molecule.TIMES[0] - 0.1)
    assert len(system.cosmetic_bonds) == bonds and len(system.bodies) == 1
    mass = system.bodies[0].mass
    run(molecule.TIMES[0] + 0.1)
    assert len(system.cosmetic_bonds) == bonds - 1 and len(system.bodies) == 1
    run(molecule.TIMES[1] + 0.02)
    assert len(system.cosmetic_bonds) == bonds - 2 and len(system.bodies) == 2
    held = next(body for body in system.bodies if any(p.is_nailed for p in body.particles))
    freed = next(body for body in system.bodies if body != held)
    assert abs(held.mass + freed.mass - mass) < 1e-12 and freed.mass > 0.3 * mass
    speed, time = freed.velocity.y, system.time
    run(molecule.TIMES[1] + 0.2)
    assert abs((freed.velocity.y - speed) / (system.time - time) + 9.81) < 0.1  # a little air
    settle(system)
    expected = period_about_nail(system, held)
    assert abs(swing_about(system, held) - expected) < 0.03 * expected


def test_it_begins_anew_four_seconds_after_the_second_bond_broke() -> None:
    world = molecule.build()
    for _ in range(round((molecule.TIMES[1] + 4.5) / world.dt)):
        world.step()
    assert world.system.time == pytest.approx(0.5, abs=2 * world.dt)
    assert len(world.system.cosmetic_bonds) == 24 and len(world.system.bodies) == 1


def test_the_soft_molecule_settles_longer_than_the_rigid_one() -> None:
    lengths, starts = [], []
    for study in (molecule, soft_molecule):
        system = study.build().system  # type: ignore[attr-defined]
        starts.append(system.positions[:24])  # the rigid one is beside the soft one
        settle(system)
        lengths.append(molecule.NAIL.y - min(particle.position.y for particle in system.particles[:24]))
    assert starts[1] == pytest.approx(starts[0], abs=1e-9), "it is the same molecule"
    assert lengths[1] > 1.1 * lengths[0]
    # No part of it lies in another one: atoms without a bond between them keep more than a bond's length apart.
    bonded = {frozenset(bond.ends) for bond in system.bonds if bond.law.name == "spring"}
    pairs = [pair for pair in combinations(system.particles[:24], 2) if frozenset(pair) not in bonded]
    assert min(abs(p.position - q.position) for p, q in pairs) > 0.9 * soft_molecule.ROOM


def test_the_rigid_molecule_hangs_beside_the_soft_one_and_a_push_of_that_makes_no_energy(
    capsys: pytest.CaptureFixture[str],
) -> None:
    world = soft_molecule.build()
    soft, rigid = (world.system.particles[first : first + 24] for first in (0, 24))
    settle(world.system)
    lowest = [min(atom.position.y for atom in ring) for ring in (soft, rigid)]
    assert lowest[0] < lowest[1] - 0.08
    before = world.system.energy.kinetic
    world._state.actions["nudge"].hook.function()
    assert world.system.energy.kinetic > before + 4e-3
    assert max(abs(atom.velocity) for atom in rigid) < 1e-3
    for _ in range(480):
        world.step()
    assert "gained energy" not in capsys.readouterr().err


def test_the_stands_tell_how_much_longer_the_soft_ring_hangs_and_it_is_nudged_when_it_is_calm() -> None:
    world = soft_molecule.build()
    labels = [thing for thing in world.drawings.things if isinstance(thing, Label)]
    soft, rigid = world.system.positions[:24], world.system.positions[24:]
    settle(world.system)
    world.step()
    told = {name: float(text.split()[0]) for name, text in (label.text.split(": ") for label in labels)}
    for name, start in (("soft", slice(0, 24)), ("rigid", slice(24, 48))):
        reach = molecule.NAIL.y - float(world.system.positions[start, 1].min())
        assert told[name] == pytest.approx(0.77 * reach, abs=0.02)
    assert told["soft"] > 1.1 * told["rigid"] and soft.shape == rigid.shape
    world.advance(round(4 / world.dt))
    assert world.system.energy.kinetic > 4e-3
