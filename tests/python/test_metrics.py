# SPDX-License-Identifier: Apache-2.0
"""Figures of a served world in the text format of Prometheus."""

from __future__ import annotations

import re
from collections.abc import Callable
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest
from page_client import PageClient

import iota
from iota.metrics import Metric, text_of

Runner = Callable[[iota.World], str]
SAMPLE = re.compile(r'[a-z_]+(\{[a-z_]+="[^"]*"(,[a-z_]+="[^"]*")*\})? [-+.e0-9]+')


def read(url: str) -> dict[str, float]:
    answer = urlopen(url.replace("/?", "/metrics?"), timeout=20)
    assert answer.headers["Content-Type"] == "text/plain; version=0.0.4; charset=utf-8"
    text = answer.read().decode()
    assert text.endswith("\n")
    samples = [line for line in text.splitlines() if not line.startswith("#")]
    assert all(SAMPLE.fullmatch(line) for line in samples), samples
    assert len({line.split()[2] for line in text.splitlines() if line.startswith("# TYPE")}) * 2 == text.count("# ")
    return {name: float(value) for name, value in (line.rsplit(" ", 1) for line in samples)}


def test_a_served_world_tells_its_figures_to_whoever_may_watch_it(
    system: iota.System, chain: list[iota.Body], run_world: Runner
) -> None:
    world = iota.World(system, title="chain")
    url = run_world(world)
    with PageClient(url) as page:
        page.wait_for(lambda: page.last["poses"]["step"] > 5)
        viewer = world.pages.link("viewer")
        assert viewer is not None
        told = read(viewer)
        assert told["iota_steps_total"] >= 5 and told["iota_bodies"] == len(chain)
        assert told['iota_people{role="host"}'] == 1 and told['iota_people{role="guest"}'] == 0
        assert told["iota_sent_bytes_total"] > 0 and told["process_resident_memory_bytes"] > 1e7
        assert read(viewer)["iota_steps_total"] >= told["iota_steps_total"]
    with pytest.raises(HTTPError, match="403"):
        urlopen(url.split("/?")[0] + "/metrics")


def test_labels_of_any_text_stay_in_their_line() -> None:
    told = text_of([Metric("iota_x", "gauge", "Some.", [({"room": 'a"b\\c\nd'}, 0.1 + 0.2)])])
    assert told == '# HELP iota_x Some.\n# TYPE iota_x gauge\niota_x{room="a\\"b\\\\c\\nd"} 0.3\n'
