# SPDX-License-Identifier: Apache-2.0
"""`iota.step_all`: many systems at once, with the bits of one after another."""

from __future__ import annotations

import threading

import pytest

import iota


def make(seed: int) -> iota.System:
    system = iota.System(threads=1)
    chain = iota.builder.chain(links=4 + seed % 3, length=1, top=(0, 2, 0), direction=(1, 0.1 * seed, 0)).realize(
        system
    )
    if seed % 2:
        system.bond(chain.points[-1], chain.points[0], pull)
    return system


def pull(bond: iota.types.BondState) -> iota.Vec3:
    assert bond.p.position.y < 100, "a function of the script reads its own system"
    return -2.0 * bond.direction


def test_systems_stepped_together_have_the_bits_of_those_stepped_alone() -> None:
    together, alone = [make(seed) for seed in range(12)], [make(seed) for seed in range(12)]
    for _ in range(3):
        reports = iota.step_all(together, 1 / 120, count=4, threads=3)
        assert len(reports) == 12
    for system, twin, report in zip(together, alone, reports, strict=True):
        for _ in range(3):
            own = twin.step(1 / 120, count=4)
        assert system.state_hash() == twin.state_hash() and system.time == pytest.approx(0.1)
        assert report.energy.total == own.energy.total and report.iterations_mean == own.iterations_mean
    together[0].step()  # they belong to this thread again


def test_a_force_that_fails_in_one_system_is_raised_after_all_have_stepped() -> None:
    systems = [make(0), make(2), make(4)]
    p = systems[1].bodies[0].particles[0]
    systems[1].bond(p, systems[1].bodies[-1].particles[-1], lambda bond: 1 / 0)
    with pytest.raises(iota.BondError, match="ZeroDivisionError"):
        iota.step_all(systems)
    assert [system.step_count for system in systems] == [1, 1, 1]
    iota.step_all(systems)
    assert [system.step_count for system in systems] == [2, 2, 2]


def test_bad_batches_are_refused_before_anything_moves() -> None:
    first, second = make(0), make(2)
    for arguments, words in (
        (([first, second, first],), r"systems\[2\] is there twice"),
        (([first], 0.0), "dt"),
        (([first], 1 / 120, 0), "count must be at least 1"),
    ):
        with pytest.raises(ValueError, match=words):
            iota.step_all(*arguments)
    with pytest.raises(TypeError):
        iota.step_all([first, "second"])  # type: ignore[list-item]
    others: list[iota.System] = []
    thread = threading.Thread(target=lambda: others.append(make(0)))
    thread.start()
    thread.join()
    with pytest.raises(iota.WrongThreadError):
        iota.step_all([first, *others])
    assert first.step_count == 0 and iota.step_all([]) == []
