# SPDX-License-Identifier: Apache-2.0
"""The three scripts of the thesis' Appendix E, run as they are."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import pytest

import iota
from iota.world.options import RunOptions, use

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "python"


def run(name: str, seconds: float) -> tuple[dict[str, Any], iota.types.RunSummary]:
    with use(RunOptions(headless=True, seconds=seconds)) as options:
        space = runpy.run_path(str(EXAMPLES / name), run_name="__main__")
    assert options.summary is not None
    return space, options.summary


def test_e1_one_body_falls_without_turning() -> None:
    space, summary = run("appendix_e1.py", 2.0)
    assert space["particle1"].position == pytest.approx((0, -2, 0), abs=0.01)
    assert space["particle2"].position == pytest.approx((30, -2, 0), abs=0.01)
    assert summary.worst_gap_m < 1e-9 and summary.articulates == 1


def test_e2_two_particles_move_within_the_force_function() -> None:
    space, _ = run("appendix_e2.py", 2.0)
    p, q = space["particle1"].position, space["particle2"].position
    assert q.y == p.y == pytest.approx(-2, abs=0.02)
    assert p.x + q.x == pytest.approx(30), "the force is equal and opposite"
    assert q.x - p.x < 29


def test_e3_the_hinge_closes_and_holds() -> None:
    space, summary = run("appendix_e3.py", 2.0)
    assert space["particle1"].position == space["particle2"].position
    for first, second in (("particle1", "particle1a"), ("particle2", "particle2a")):
        arm = abs(space[first].position - space[second].position)
        rest = {"particle1a": (30**2 + 35**2) ** 0.5, "particle2a": (35**2 + 35**2) ** 0.5}[second]
        assert arm == pytest.approx(rest, rel=1e-9)
    assert summary.worst_gap_m < 1e-7 and summary.articulates == 1
    assert space["system"].articulate_count == 1


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.name)
def test_every_example_runs(path: Path) -> None:
    _, summary = run(path.name, 0.5)
    assert summary.steps == 60


def test_the_script_in_the_readme_is_the_example_and_fits_twenty_lines() -> None:
    script = (EXAMPLES / "pendulum.py").read_text().split("\n", 1)[1]  # without the license line
    assert len(script.splitlines()) <= 20
    assert f"```python\n{script}```" in (EXAMPLES.parents[1] / "README.md").read_text()
