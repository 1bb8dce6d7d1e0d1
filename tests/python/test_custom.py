# SPDX-License-Identifier: Apache-2.0
"""Objects of a script's own classes: what pages are told of them, and a class at work in a browser."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from page_client import PageClient
from pages import needs_browser, open_page

import iota
from iota._protocol import NO_BODY

Runner = Callable[[iota.World], str]


def test_an_object_has_its_values_and_follows_its_anchor(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    ball = system.body().particle((0, 1, 0)).body
    world = iota.World(system, ground=None)
    flower = world.drawings.custom("flower", at=ball, values={"petals": 7, "names": ["a", None]})
    world.drawings.custom("flower", at=(1, 2, 3))
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.entities["custom"]) == 2)
        told, still = page.entities["custom"][0], page.entities["custom"][1]
        assert told["class_name"] == "flower" and told["values"] == '{"petals": 7, "names": ["a", null]}'
        assert told["at"]["body"] == ball.slot and still["at"] == {"body": NO_BODY, "point": (1, 2, 3)}
        assert still["values"] == "{}"
        flower.values = {"petals": 8}
        assert flower.values == {"petals": 8}
        page.wait_for(lambda: page.entities["custom"][0]["values"] == '{"petals": 8}')
        world.call(ball.destroy)
        page.wait_for(lambda: 0 not in page.entities["custom"])


@pytest.mark.parametrize(
    "values", [{"a": float("nan")}, {"a": object()}, 7, {"a": "x" * 70_000}], ids=["nan", "object", "number", "long"]
)
def test_values_that_cannot_be_sent_are_refused(values: Any) -> None:
    world = iota.World(iota.System())
    with pytest.raises(ValueError, match=r"^values: (must be a dictionary|may have 65536 bytes)"):
        world.drawings.custom("flower", values=values)
    assert world.drawings.things == []


CLASS = """
const { three } = globalThis.iota;
globalThis.marks = [];
iota.define("plate", {
  // A plate of 2 m in the plane of x and y, with a hole in the middle that only `distance` knows.
  make: ({ color }) => new three.Mesh(new three.BoxGeometry(2, 2, 0.02), new three.MeshBasicMaterial({ color, toneMapped: false })),
  bounds: () => [[-1, -1, -0.01], [1, 1, 0.01]],
  distance: (values, [x, y, z]) => Math.max(Math.abs(x) - 1, Math.abs(y) - 1, Math.abs(z) - 0.01, 0.3 - Math.hypot(x, y)),
  select: (object, mark) => globalThis.marks.push(mark),
});
iota.define("broken", { make: () => { throw new Error("no petals"); } });
"""


@needs_browser
def test_a_class_of_a_module_draws_is_framed_met_and_selected(tmp_path: Path) -> None:
    (tmp_path / "plate.js").write_text(CLASS)
    system = iota.System(gravity=(0, 0, 0))
    ball = system.body(shape=iota.Sphere(0.05), mass=1.0, position=(0, 1, 0))
    world = iota.World(system, ground=None)
    world.draw(ball, [])
    world.pages.client_module(tmp_path / "plate.js")
    plate = world.drawings.custom("plate", at=ball, values={"color": "#00ff00"})
    world.drawings.custom("broken", at=ball)
    url = world.start(port=0)
    try:
        with open_page(640, 360, draws=True) as page:
            page.goto(url)
            page.wait_for_function(
                "() => globalThis.iota?.page.world.entities.custom.view?.count === 1", timeout=60_000
            )
            # The camera stands back for the bounds of the plate: the ball alone has 0.05 m.
            page.wait_for_function("() => iota.page.viewer.size > 1")
            page.wait_for_function("() => document.getElementById('cards').textContent.includes('no petals')")
            green = """([x, y]) => {
              const { renderer, scene, camera } = iota.page.viewer;
              renderer.render(scene, camera);
              const at = camera.position.clone().set(x, y, 0).project(camera), gl = renderer.getContext(), out = new Uint8Array(4);
              const px = [at.x * gl.drawingBufferWidth, at.y * gl.drawingBufferHeight].map(
                (v, i) => Math.round((v + [gl.drawingBufferWidth, gl.drawingBufferHeight][i]) / 2));
              gl.readPixels(...px, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, out);
              return out[1] > 2 * out[0] && out[1] > 2 * out[2];
            }"""
            page.wait_for_function(green, arg=[0.7, 1.6])
            screen = """([x, y]) => {
              const at = iota.page.viewer.camera.position.clone().set(x, y, 0).project(iota.page.viewer.camera);
              return [(at.x + 1) / 2 * innerWidth, (1 - at.y) / 2 * innerHeight];
            }"""
            # Through the hole nothing is met, beside it the ball that the plate is on.
            page.mouse.click(*page.evaluate(screen, [0, 1.15]))
            page.mouse.move(*page.evaluate(screen, [0.6, 1.5]))
            page.wait_for_function("() => globalThis.marks.includes('hovered')")
            assert page.evaluate("iota.selected") == -1
            page.mouse.down()
            page.wait_for_function("() => iota.held >= 0 && globalThis.marks.at(-1) === 'held'")
            page.mouse.up()
            page.wait_for_function("() => iota.selected >= 0 && globalThis.marks.at(-1) === 'selected'")
            plate.values = {"color": "#0000ff"}
            page.wait_for_function(f"() => !({green})([0.7, 1.6])")
    finally:
        world.stop()
