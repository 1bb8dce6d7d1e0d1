# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from itertools import pairwise

import pytest

import iota


@pytest.mark.parametrize("links", [1, 2, 24])
def test_a_chain_has_its_length_mass_and_place(system: iota.System, links: int) -> None:
    chain = iota.builder.chain(system, links, length=2.4, top=(0, 3, 0), direction=(0, -2, 0), mass=1.2)
    assert len(chain) == links and system.articulate_count == 1
    assert sum(link.mass for link in chain) == pytest.approx(1.2)
    assert chain[0].particles[0].position == (0, 3, 0)
    assert chain[-1].particles[1].position == pytest.approx((0, 0.6, 0))
    assert chain[0].particles[0].is_nailed
    for upper, lower in pairwise(chain):
        assert lower.particles[0] in upper.particles[1].ring
    assert system.validate() == [] and system.energy.kinetic == 0


def test_a_chain_need_not_be_nailed(system: iota.System) -> None:
    chain = iota.builder.chain(system, links=3, nailed=False)
    assert not any(p.is_nailed for link in chain for p in link.particles)


def test_a_long_chain_is_quick_to_build(system: iota.System) -> None:
    chain = iota.builder.chain(system, links=2000)
    report = system.step()
    assert len(chain) == 2000 and report.articulates == 1 and report.worst_gap < 1e-9
