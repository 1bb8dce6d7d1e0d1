# SPDX-License-Identifier: Apache-2.0
"""An ingredient's handle in Python."""

import pytest

import iota


def test_a_balloon_lifts_what_it_is_tied_to_until_it_is_destroyed() -> None:
    system = iota.System(gravity=(0, 0, 0))
    body = system.body()
    low = body.particle((0, 0, 0), mass=1)
    body.particle((0, 1, 0), mass=1)
    balloon = system.balloon(low, 4)
    assert isinstance(balloon, iota.Balloon)
    for _ in range(100):
        system.step(0.01)
    assert low.position.y == pytest.approx(1)
    balloon.up = 2
    assert balloon.up == 2
    balloon.destroy()
    assert not balloon.alive
    with pytest.raises(iota.StaleIdError, match="balloon"):
        balloon.destroy()
