# SPDX-License-Identifier: Apache-2.0
"""The files of the built page."""

from __future__ import annotations

import re

import pytest

from iota.world.page import page_folder


@pytest.mark.parametrize("name", ["index", "gallery", "rooms", "enter"])
def test_each_page_has_the_common_head_and_an_icon_that_browsers_keep(name: str) -> None:
    page = page_folder()
    head = (page / f"{name}.html").read_text().split("</head>")[0]
    (icon,) = re.findall(r'<link rel="icon" href="\./(.+?)"', head)
    assert icon.startswith("assets/"), "the server lets browsers keep these only"
    assert (page / icon).read_text().count("<rect") == 2
    for part in ('charset="utf-8"', "viewport-fit=cover", 'name="color-scheme"', 'rel="license"'):
        assert head.count(part) == 1, part
