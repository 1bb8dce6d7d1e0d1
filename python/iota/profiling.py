# SPDX-License-Identifier: Apache-2.0
"""The cost of each force of a system."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from iota._core import Field, Law, PairForce, System

LEAST = 0.02  # s of processor time per row, much longer than the clock's resolution


@dataclass
class ForceCost:
    """One row. ns: processor time of one evaluation of one bond, particle or, for pairwise forces, particle."""

    force: str
    kind: str
    count: int
    ns: float


class ForceProfile(list[ForceCost]):
    """Rows as a list; printed as a table."""

    def __str__(self) -> str:
        lines = [f"{'force':32} {'as':20} {'count':>8} {'ns each':>10}"]
        lines += [f"{row.force[:32]:32} {row.kind:20} {row.count:8} {row.ns:10.1f}" for row in self]
        return "\n".join(lines)

    __repr__ = __str__


def profile(system: System, dt: float = 1 / 120) -> ForceProfile:
    """The cost of each law, field and pairwise force of a system, in ns for each bond or particle.

    Forces are evaluated repeatedly at the present state, without being applied; functions of the script are called.
    Implicit bonds: force and stiffness once, as in each iteration of the solver.

        print(system.profile())
    """
    rows = ForceProfile()
    laws: dict[Law, str] = {}
    for bond in system.bonds:
        if bond.active:
            laws.setdefault(bond.law, "implicit" if bond.implicit else "held")
    rows.extend(_cost(system, law, _name(law), f"{_kind(law)}, {how}", dt) for law, how in laws.items())
    fields: Iterable[Field] = (f for f in system.fields if f.active)
    rows.extend(_cost(system, field, f"field {field.name}", "particles", dt) for field in fields)
    pairs: Iterable[PairForce] = (p for p in system.pair_forces if p.active)
    rows.extend(_cost(system, force, f"pair force {_name(force.law)}", "particles", dt) for force in pairs)
    return rows


def _name(law: Law) -> str:
    return law.name or law.text


def _kind(law: Law) -> str:
    return law.kind


def _cost(system: System, force: Law | Field | PairForce, name: str, kind: str, dt: float) -> ForceCost:
    count = system.rehearse(force, dt)  # warm
    spent, runs = 0.0, 0
    while spent < LEAST:
        began = time.thread_time()
        for _ in range(1 + runs):
            system.rehearse(force, dt)
        spent += time.thread_time() - began
        runs += 1 + runs
    return ForceCost(name, kind, count, spent / runs / max(count, 1) * 1e9)
