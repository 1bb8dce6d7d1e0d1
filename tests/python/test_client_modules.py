# SPDX-License-Identifier: Apache-2.0
"""JavaScript modules that a script adds to its page."""

from __future__ import annotations

import re
import tempfile
import urllib.error
import urllib.request
from pathlib import Path

import pytest
from page_client import PageClient
from pages import listen_for_complaints, needs_browser, open_page

import iota

HALO = """
const { page, three } = globalThis.iota;
const halo = new three.Mesh(new three.SphereGeometry(0.3), new three.MeshBasicMaterial({ color: "#00ff00" }));
halo.name = "halo";
page.viewer.add({ root: halo, draw: () => {
  if (iota.bodies().length > 0) halo.position.set(...iota.bodyPosition(iota.bodies()[0]));
} });
"""


def make_world() -> tuple[iota.World, iota.Particle]:
    system = iota.System(gravity=(0, 0, 0))
    ball = system.body().particle((0, 1, 0), velocity=(0.5, 0, 0))
    return iota.World(system, title="halo", ground=None), ball


@needs_browser
def test_a_module_of_the_script_draws_in_the_page(tmp_path: Path) -> None:
    (tmp_path / "halo.js").write_text(HALO)
    world, _ = make_world()
    world.pages.client_module(tmp_path / "halo.js")
    url = world.start(port=0)
    try:
        with open_page() as page:
            complaints = listen_for_complaints(page)
            page.goto(url)
            halo = "iota.page.viewer.scene.getObjectByName('halo')?.position.x"
            page.wait_for_function(f"() => globalThis.iota?.connected && {halo} > 0.2", timeout=60_000)
            assert page.evaluate(f"{halo} - iota.bodyPosition(iota.bodies()[0])[0]") == pytest.approx(0, abs=0.05)
            assert complaints == []
    finally:
        world.stop()


def test_only_clients_learn_where_the_named_modules_are_and_they_are_gone_afterwards(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(temporary))
    for name in ("halo.js", "secret.js", "other ö.mjs"):
        (tmp_path / name).write_text(HALO)
    world, _ = make_world()
    world.pages.client_module(tmp_path / "halo.js")
    world.pages.client_module(tmp_path / "other ö.mjs")
    world.pages.client_module(tmp_path / "halo.js")
    url = world.start(port=0)
    base = url.split("?")[0]
    try:
        with PageClient(url) as page:
            page.wait_for(lambda: "world_settings" in page.last)
            modules = page.last["world_settings"]["modules"]
        assert [re.sub("[0-9a-f]{32}", "SECRET", module) for module in modules] == [
            "modules/SECRET/halo.js",
            "modules/SECRET/other%20%C3%B6.mjs",
        ]
        for module in modules:
            assert urllib.request.urlopen(base + module).read().decode() == HALO
        index = urllib.request.urlopen(base).read().decode()
        secret = modules[0].split("/")[1]
        assert secret not in index and "modules" not in index
        for name in ("halo.js", "", f"{secret}/secret.js", f"{secret}/", secret, f"{'0' * 32}/halo.js"):
            with pytest.raises(urllib.error.HTTPError, match="404"):
                urllib.request.urlopen(f"{base}modules/{name}")
        with pytest.raises(RuntimeError, match="before"):
            world.pages.client_module(tmp_path / "secret.js")
        assert len(list(temporary.iterdir())) == 1
    finally:
        world.stop()
    assert list(temporary.iterdir()) == []


def test_a_file_that_is_no_module_is_refused_where_it_is_named(tmp_path: Path) -> None:
    world, _ = make_world()
    (tmp_path / "a.py").write_text("")
    (tmp_path / "huge.js").write_bytes(bytes((4 << 20) + 1))
    (tmp_path / "same.js").write_text("")
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "same.js").write_text("")
    with pytest.raises(ValueError, match=r"\.js or \.mjs"):
        world.pages.client_module(tmp_path / "a.py")
    with pytest.raises(FileNotFoundError, match=r"none\.js"):
        world.pages.client_module("none.js")
    with pytest.raises(ValueError, match="4 MiB"):
        world.pages.client_module(tmp_path / "huge.js")
    world.pages.client_module(tmp_path / "same.js")
    with pytest.raises(ValueError, match="already"):
        world.pages.client_module(tmp_path / "deep" / "same.js")
    server = iota.Server(port=0)
    with pytest.raises(ValueError, match="server of its own"):
        world.serve(server=server)
    server.close()
