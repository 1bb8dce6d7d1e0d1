# SPDX-License-Identifier: Apache-2.0
"""Lamps of a script, as pages are told of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from page_client import PageClient

import iota
from iota._protocol import NO_BODY, NO_COLOR, LightKind

Runner = Callable[[iota.World], str]


def test_lights_have_the_records_of_the_protocol_and_follow_their_anchor(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    lamp = system.body().particle((0, 2, 0)).body
    world = iota.World(system)
    spot = world.drawings.light("spot", at=lamp, color="#ffd9a0", intensity=2, reach=3, angle=0.4, shadow=True)
    world.drawings.light("sun", at=(3, 5, 2))
    world.drawings.light("point", at=(0, 1, 0))
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.entities["light"]) == 3)
        seen, sun, point = (page.entities["light"][slot] for slot in range(3))
        assert seen["kind"] == LightKind.SPOT and seen["shadow"] and seen["color"] == 0xFFD9A0
        assert seen["at"] == seen["to"] == {"body": lamp.slot, "point": (0, 0, 0)}, "straight down"
        assert (seen["intensity"], seen["reach"], seen["angle"]) == pytest.approx((2, 3, 0.4))
        assert sun["kind"] == LightKind.SUN and sun["at"]["point"] == (3, 5, 2) and sun["to"]["point"] == (0, 0, 0)
        assert point["kind"] == LightKind.POINT and point["color"] == NO_COLOR and not point["shadow"]
        world.call(lambda: setattr(spot, "intensity", 0.5))
        page.wait_for(lambda: page.entities["light"][0]["intensity"] == 0.5)
        world.call(lambda: setattr(spot, "to", (1, 0, 0)))
        page.wait_for(lambda: page.entities["light"][0]["to"] == {"body": NO_BODY, "point": (1, 0, 0)})
        world.call(lamp.destroy)
        page.wait_for(lambda: 0 not in page.entities["light"])


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda w: w.drawings.light("lamp"), "kind: must be one of point, spot, sun, not 'lamp'"),
        (lambda w: w.drawings.light("point", shadow=True), "a point casts none"),
        (lambda w: w.drawings.light(intensity=-1), "intensity: must be a finite number"),
        (lambda w: w.drawings.light("spot", angle=3), "angle: must be a finite number"),
        (lambda w: [w.drawings.light() for _ in range(9)], "at most 8 lights"),
        (
            lambda w: [w.drawings.light("spot", shadow=True) for _ in range(3)],
            "at most 2 lights of a world cast shadows",
        ),
    ],
)
def test_lights_that_cannot_be_are_refused(make: Callable[[iota.World], Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        make(iota.World(iota.System()))


def test_a_light_that_is_gone_makes_room_for_another() -> None:
    world = iota.World(iota.System())
    lights = [world.drawings.light("spot", shadow=number < 2) for number in range(8)]
    lights[0].destroy()
    world.drawings.light("sun", at=(1, 1, 1), shadow=True)
