# SPDX-License-Identifier: Apache-2.0
"""A message about a missing package names the command that installs it, in a checkout and for an installed wheel."""

import re
import sys
from pathlib import Path

import pytest

from iota import extras

ROOT = Path(__file__).resolve().parents[2]
PROJECT = (ROOT / "pyproject.toml").read_text()
EXTRAS = re.findall(r"^(\w+) = \[", PROJECT.partition("[project.optional-dependencies]")[2].partition("\n[")[0], re.M)


def test_the_distribution_has_the_name_of_the_project_file() -> None:
    assert f'\nname = "{extras.DISTRIBUTION}"\n' in PROJECT


@pytest.mark.parametrize("extra", EXTRAS)
def test_a_checkout_installs_from_its_own_list(extra: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(sys, "executable", str(ROOT / ".venv" / "bin" / "python"))
    monkeypatch.chdir(ROOT)
    assert extras.how_to_get(extra) == f"Try: .venv/bin/python -m pip install -r tools/requirements-{extra}.txt"
    monkeypatch.chdir(tmp_path)
    advice = extras.how_to_get(extra)
    assert advice.endswith(f" -m pip install -r {ROOT}/tools/requirements-{extra}.txt")
    assert Path(advice.split()[1]) == ROOT / ".venv" / "bin" / "python"


@pytest.mark.parametrize("extra", EXTRAS)
def test_an_installed_wheel_asks_pip_for_an_extra(extra: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(extras, "SOURCES", tmp_path)
    assert extras.how_to_get(extra) == f"Try: pip install 'iota-worlds[{extra}]'"
