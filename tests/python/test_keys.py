# SPDX-License-Identifier: Apache-2.0
"""Keys of scripts and of the page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import iota
from iota.world.actions import PAGE_KEYS

WEB = Path(__file__).resolve().parents[2] / "web" / "src"


def test_the_list_of_the_pages_keys_is_that_of_the_page() -> None:
    commands = (WEB / "page" / "page_commands.ts").read_text() + (WEB / "ui" / "overlay.ts").read_text()
    lists = re.findall(r'keys: \[((?:"[^"]*"(?:, )?)+)\]', commands)
    keys = {key for listed in lists for key in re.findall(r'"([^"]+)"', listed)}
    walk = re.search(r"walkKeys.*?= {(.*?)};", (WEB / "ui" / "keys.ts").read_text(), re.DOTALL)
    assert walk is not None
    assert keys | set(re.findall(r"(\w): \[", walk[1])) == set(PAGE_KEYS)


def test_a_key_that_is_taken_from_the_page_is_reported_at_the_start(capsys: pytest.CaptureFixture[str]) -> None:
    world = iota.World(iota.System())
    world.action("mend", key="r", help="mends", on="world")(lambda: None)
    world.action("push", key="k", help="pushes", on="world")(lambda: None)
    world._announce(False)
    lines = capsys.readouterr().out.splitlines()
    assert "  r  mends  (instead of the page's: reset)" in lines
    assert "  k  pushes" in lines
