# SPDX-License-Identifier: Apache-2.0
"""What a release needs: one version everywhere, and a list of changes that begins with what is not released yet."""

from __future__ import annotations

import json
import re
from datetime import date
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
VERSION = re.search(r'^version = "(.+)"$', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)[1]  # type: ignore[index]


def numbers(version: str) -> tuple[int, ...]:
    return tuple(map(int, version.split(".")))


def test_engine_page_and_package_have_one_version() -> None:
    page = json.loads((ROOT / "web" / "package.json").read_text())
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text())
    stub = (ROOT / "tests" / "python" / "golden" / "core_stub.txt").read_text()
    told = {page["version"], lock["version"], lock["packages"][""]["version"]}
    assert told == {VERSION} and f"version: str = '{VERSION}'" in stub


def test_the_changes_begin_with_what_is_not_released_and_go_back_in_time() -> None:
    first, *released = re.findall(r"^## (.+)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert first == "Unreleased"
    found = [re.fullmatch(r"(\d+\.\d+\.\d+) \((\d{4}-\d\d-\d\d)\)", title) for title in released]
    assert None not in found, released
    versions = [(numbers(one[1]), date.fromisoformat(one[2])) for one in found if one]
    assert versions == sorted(versions, reverse=True)
    assert all(version <= numbers(VERSION) for version, _ in versions)
