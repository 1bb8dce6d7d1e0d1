# SPDX-License-Identifier: Apache-2.0
"""Every case of `iota verify` at its small size, and the command itself."""

from __future__ import annotations

from pathlib import Path

import pytest

from iota.cli import main
from iota.verify.cases import CASES
from iota.verify.run import Case, Run


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_computed_values_agree_with_known_ones(case: Case) -> None:
    run = Run(scale="quick")
    case.check(run)
    assert [row for row in run.rows if not row.passed] == []
    assert sum(bool(row.expected) for row in run.rows) >= 2, "a case that asks nothing proves nothing"


def test_a_wrong_or_missing_number_fails() -> None:
    run = Run()
    run.near("off", 1.1, 1.0, 0.05)
    run.near("not a number", float("nan"), 1.0, 0.05)
    run.at_most("not a number", float("nan"), 1.0)
    run.at_least("too little", 0.9, 1.0)
    assert [row.passed for row in run.rows] == [False] * 4


def test_verify_writes_a_page_with_its_figures_and_keeps_the_sections_it_did_not_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("oscillator", "orbit"):
        assert main(["verify", "--quick", "--figure", name, "--out", str(tmp_path)]) == 0
    page = (tmp_path / "verification.md").read_text()
    assert page.index("## Two-body orbit") < page.index("## Damped oscillator"), "in the order of the report"
    for picture in ("orbit", "oscillator"):
        assert (tmp_path / "verification" / f"{picture}.svg").read_text().startswith("<?xml")
        assert f"](verification/{picture}.svg)" in page
    assert "period, s" in capsys.readouterr().out


def test_verify_suggests_the_name_that_was_meant(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify", "--figure", "pendulun"]) == 1
    assert "Did you mean pendulum?" in capsys.readouterr().err
