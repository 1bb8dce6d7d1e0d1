# SPDX-License-Identifier: Apache-2.0
"""Threads: how many is a setting, what comes out is not."""

import pytest

import iota


def hashes(threads: int) -> list[int]:
    system = iota.System(threads=threads)
    for row in range(30):
        links = iota.builder.chain(links=20, length=2, top=(0, 3, row)).realize(system).bodies
        links[8].particles[1].separate(links[9].particles[0])
    found = []
    for _ in range(5):
        system.step(1 / 60)
        found.append(system.state_hash())
    return found


def test_two_threads_give_the_bits_of_one() -> None:
    assert hashes(2) == hashes(1)


def test_threads_can_be_read_assigned_and_refused() -> None:
    system = iota.System(threads=2)
    assert system.threads == 2
    system.threads = 0
    assert system.threads >= 1
    with pytest.raises(ValueError, match="threads must be between 1 and 1024"):
        system.threads = -1
