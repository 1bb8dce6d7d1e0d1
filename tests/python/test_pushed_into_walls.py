# SPDX-License-Identifier: Apache-2.0
"""What is pushed by more than its size in a step stays before a wall: a force moves it there within the step in which it begins."""

from __future__ import annotations

from typing import Literal

import pytest

import iota

Mode = Literal["robust", "energy_keeping", "accurate"]
RADIUS, WAY = 0.005, 0.02


@pytest.mark.parametrize("mode", ["robust", "energy_keeping", "accurate"])
@pytest.mark.parametrize("wall", ["half-space", "plate", "triangles", "heavy box"])
@pytest.mark.parametrize("by", ["force", "field", "hand"])
@pytest.mark.parametrize("rate", [60, 240])
def test_a_small_ball_stops_at_a_wall(mode: Mode, wall: str, by: str, rate: int) -> None:
    system = iota.System(gravity=(0, 0, 0), mode=mode)
    system.usual_material = iota.Material(friction=0.4)
    box = None
    if wall == "half-space":
        system.obstacle(iota.HalfSpace((-1, 0, 0)))
    elif wall == "plate":
        system.obstacle(iota.Box((0.02, 2, 2)), position=(0.01, 0, 0))
    elif wall == "triangles":
        corners = [(0, -1, -1), (0, 1, -1), (0, 1, 1), (0, -1, 1)]
        system.obstacle(iota.Mesh(corners, [(0, 1, 2), (0, 2, 3)], closed=False))
    else:
        box = system.body(shape=iota.Box((1, 1, 1)), mass=1e6, position=(0.5, 0, 0))  # a field moves it, too
    ball = system.body(shape=iota.Sphere(RADIUS), mass=1, position=(-WAY - RADIUS, 0, 0))
    acceleration = 4 * WAY * rate**2 if by != "hand" else 60.0
    if by == "field":
        system.field("uniform", acceleration=(acceleration, 0, 0))
    elif by == "hand":
        system.grip(ball, (0, 0, 0), (3, 0, 0))
    for _ in range(rate // 2):
        if by == "force":
            ball.apply_force((acceleration, 0, 0))
        system.step(1 / rate)
        face = box.position.x - 0.5 if box else 0
        assert ball.position.x - face < -0.7 * RADIUS, "it is at the wall at -RADIUS"
