# SPDX-License-Identifier: Apache-2.0
"""`iota bench forces`: the cost of a bond for each way to write a law in docs/forces.md, and of pairwise forces."""

from __future__ import annotations

import argparse
import ctypes
import json
import platform
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np

import iota
from iota.profiling import ForceCost, profile

BONDS = 2000
_Radial = ctypes.CFUNCTYPE(
    ctypes.c_double, ctypes.c_double, ctypes.c_double, ctypes.c_double, ctypes.POINTER(ctypes.c_double)
)


def _arrays(bonds: iota.types.BondBatch) -> np.ndarray:
    r = bonds.distance
    return (bonds.parameters["k"] * (r - bonds.parameters["r0"]))[:, None] * bonds.direction


def _one(bond: iota.types.BondState) -> iota.Vec3:
    return 10 * (bond.distance - 0.1) * bond.direction


def _compiled(system: iota.System) -> iota.Law:
    """A function of the C library in place of compiled code: x y + z of r, v, t is not a spring, but as fast as one."""
    return system.law(_Radial(("fma", ctypes.CDLL(None))), name="compiled", k=10, r0=0.1)


RUNGS: tuple[tuple[str, Callable[[iota.System], Any], dict[str, Any]], ...] = (
    ("predefined", lambda s: "spring", {"stiffness": 10, "length": 0.1, "implicit": False}),
    ("expression", lambda s: "energy = 0.5*k*(r - r0)^2", {"k": 10, "r0": 0.1, "implicit": False}),
    ("compiled code", _compiled, {}),
    ("function of arrays", lambda s: s.law(_arrays, name="arrays", k=10, r0=0.1), {}),
    ("function for one bond", lambda s: _one, {}),
    ("predefined, implicit", lambda s: "spring", {"stiffness": 10, "length": 0.1}),
    ("expression, implicit", lambda s: "energy = 0.5*k*(r - r0)^2", {"k": 10, "r0": 0.1}),
)


def measure() -> list[ForceCost]:
    rows = []
    for name, law, arguments in RUNGS:
        system = iota.System(gravity=(0, 0, 0))
        ready = law(system)
        for i in range(BONDS):
            p = system.body().particle((0.1 * i, 0, 0))
            system.bond(p, system.body().particle((0.1 * i, 0.11, 0)), ready, **arguments)
        (row,) = profile(system)
        rows.append(ForceCost(name, "bond", row.count, row.ns))
    for name, text, names in (
        ("pairs, predefined", "lennard_jones", ("depth", "size")),
        ("pairs, expression", "energy = 4*e*((s/r)^12 - (s/r)^6)", ("e", "s")),
    ):
        system = iota.System(gravity=(0, 0, 0))
        for i in range(20**3):  # about 30 neighbors within the cut-off
            system.body().particle((1.3 * (i % 20), 1.3 * (i // 20 % 20), 1.3 * (i // 400)))
        parameters: dict[str, Any] = dict.fromkeys(names, 1.0)
        system.pair_force(text, cutoff=2.5, **parameters)
        (row,) = profile(system)
        rows.append(ForceCost(name, "particle", row.count, row.ns))
    return rows


def run(arguments: argparse.Namespace) -> None:
    rows = measure()
    if arguments.json:
        print(
            json.dumps({"iota": iota.__version__, "machine": platform.machine(), "forces": [asdict(r) for r in rows]})
        )
        return
    print(f"{'written as':24} {'ns each':>10}")
    for row in rows:
        print(f"{row.force:24} {row.ns:10.1f} a {row.kind}")
