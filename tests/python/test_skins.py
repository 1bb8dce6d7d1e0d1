# SPDX-License-Identifier: Apache-2.0
"""Surfaces around particles, as pages are told of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from page_client import PageClient

import iota
from iota import effects

Runner = Callable[[iota.World], str]


def test_a_skin_is_the_surface_around_its_particles_and_follows_them(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    bodies = [system.body() for _ in range(2)]
    balls = [body.particle((x, 1, 0)) for body, x in zip(bodies, (0.0, 0.15), strict=True)]
    world = iota.World(system)
    skin = world.drawings.skin(balls, 0.1, color="#4c9a52")
    places, triangles = effects.skin([ball.position for ball in balls], 0.1)
    with PageClient(run_world(world)) as page:
        seen = page.wait_for(lambda: page.entities["surface"].get(0))
        assert np.reshape(seen["points"], (-1, 3)) == pytest.approx(places, abs=1e-6)
        assert list(seen["triangles"]) == triangles.ravel().tolist() and seen["color"] == 0x4C9A52
        world.call(lambda: setattr(balls[1], "position", (3, 1, 0)))
        page.wait_for(lambda: max(page.entities["surface"][0]["points"]) > 3)
        world.call(lambda: setattr(skin, "radius", 0.2))
        page.wait_for(lambda: max(page.entities["surface"][0]["points"][1::3]) > 1.15)
        world.call(bodies[0].destroy)
        page.wait_for(lambda: min(page.entities["surface"][0]["points"][0::3]) > 2)
        world.call(bodies[1].destroy)
        page.wait_for(lambda: not page.entities["surface"])
        assert skin.alive


def test_a_skin_around_points_of_a_function_is_switched_off_by_an_error(run_world: Runner) -> None:
    world = iota.World(iota.System())
    places: Any = [[0, 0, 0]]
    skin = world.drawings.skin(lambda: places, 0.1, cell=0.05)
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: page.entities["surface"].get(0))

        def spread() -> None:
            nonlocal places
            places = [[0, 0, 0], [100, 100, 100]]

        world.call(spread)
        notice = page.wait_for(lambda: page.notices)[0]
        assert "make cell larger" in notice["text"]
        world.call(skin.destroy)
        page.wait_for(lambda: not page.entities["surface"])
        assert len(page.notices) == 1
    with pytest.raises(TypeError, match="particles or bodies, or a function"):
        world.drawings.skin([1, 2], 0.1)
