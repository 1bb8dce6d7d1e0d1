# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from itertools import pairwise

import pytest

import iota


def test_a_batch_of_edits_has_one_report_and_is_undone_as_one(system: iota.System, chain: list[iota.Body]) -> None:
    system.step(0.01)
    before = system.state_hash()
    with system.edit() as edit:
        ball = system.body(shape=iota.Sphere(0.1))
        chain[1].particles[1].separate(chain[2].particles[0])
        chain[5].destroy()
    assert edit.report.created_bodies == [ball] and edit.report.destroyed_bodies == [chain[5]]
    assert edit.report.articulates_after == 3
    assert system.undo() and system.state_hash() == before and chain[5].alive
    assert system.undo_count == 1  # the batch in which the chain was made
    assert system.redo() and not chain[5].alive and not system.redo()
    assert (system.undo_count, system.redo_count) == (2, 0)


def test_a_batch_that_raises_never_was(system: iota.System, chain: list[iota.Body]) -> None:
    before = system.state_hash()
    with pytest.raises(ZeroDivisionError), system.edit() as edit:
        chain[0].destroy()
        _ = 1 / 0
    assert system.state_hash() == before and chain[0].alive and system.undo_count == 1
    with pytest.raises(RuntimeError, match="available after its block"):
        _ = edit.report


def test_edits_of_a_function_are_reported_by_the_step(system: iota.System, chain: list[iota.Body]) -> None:
    p = system.body().particle((0, 1, 0))

    def cut(bond: iota.types.BondState) -> tuple[float, float, float]:
        chain[1].particles[1].separate(chain[2].particles[0])
        return (0, 0, 0)

    bond = system.bond(p, chain[-1].particles[-1], cut)
    system.step(0.01)
    report = system.step_edits
    assert report is not None and report.changed
    assert report.articulates_after == report.articulates_before + 1
    bond.destroy()
    system.step(0.01)
    assert system.step_edits is None


def test_a_world_goes_back(system: iota.System, chain: list[iota.Body]) -> None:
    world = iota.World(system)
    with system.edit():
        chain[0].destroy()
    assert world.undo() and chain[0].alive and world.redo() and not world.redo()


def test_a_cosmetic_bond_that_broke_is_back_after_undo(system: iota.System) -> None:
    body = system.body()
    atoms = [body.particle((i, 0, 0)) for i in range(3)]
    bonds = [system.cosmetic_bond(p, q) for p, q in pairwise(atoms)]
    with system.edit():
        bonds[1].destroy()
    assert [bond.alive for bond in bonds] == [True, False]
    assert system.cosmetic_lines == [(atoms[0], atoms[1])] and system.cosmetic_bonds == bonds[:1]
    system.undo()
    assert system.cosmetic_bonds == bonds and bonds[1].ends == (atoms[1], atoms[2])
    assert len(system.cosmetic_lines) == 2 and len(system.bodies) == 1
