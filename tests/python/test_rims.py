# SPDX-License-Identifier: Apache-2.0
"""Bodies on a flat round end: their support is the whole circle, however they are turned about their axis."""

from __future__ import annotations

from math import atan, cos, pi, radians, sin

import pytest

import iota

R = 0.03
LIMIT = atan(0.5)  # of a can four radii high


def can_on_slope(slope: float, turn: float, floor: str, mode: str, rate: int) -> tuple[iota.System, iota.Body]:
    system = iota.System(mode=mode)
    system.usual_material = iota.Material(friction=0.8)
    normal = iota.Vec3(-sin(slope), cos(slope), 0)
    if floor == "half_space":
        system.obstacle(iota.HalfSpace(normal))
    elif floor == "box":
        system.obstacle(iota.Box((2, 0.1, 2)), position=-0.05 * normal, orientation=("z", slope * 180 / pi))
    else:
        corners = [(-1, 0, -1), (-1, 0, 1), (1, 0, 1), (1, 0, -1)]
        mesh = iota.Mesh(corners, [(0, 1, 2), (0, 2, 3)], closed=False)
        system.obstacle(mesh, orientation=("z", slope * 180 / pi))
    half = (pi / 2 + slope) / 2
    c, s = cos(turn / 2), sin(turn / 2)
    stands = (cos(half) * s, sin(half) * s, sin(half) * c, cos(half) * c)
    return system, system.body(shape=iota.Cylinder(R, 4 * R), position=2 * R * normal, orientation=stands)


@pytest.mark.parametrize("floor", ["half_space", "box", "mesh"])
@pytest.mark.parametrize(("mode", "rate"), [("energy_keeping", 60), ("energy_keeping", 240), ("robust", 120)])
def test_a_can_stands_up_to_the_slope_on_which_it_tips(floor: str, mode: str, rate: int) -> None:
    for turn in (0, 10, 20, 30, 45):
        for below in (radians(2), radians(0.5)):
            system, can = can_on_slope(LIMIT - below, radians(turn), floor, mode, rate)
            for _ in range(rate // 2):
                system.step(1 / rate)
            settled = can.position
            assert (settled - 2 * R * iota.Vec3(-sin(LIMIT - below), cos(LIMIT - below), 0)).length < 1e-2 * R
            for _ in range(3 * rate):
                system.step(1 / rate)
            assert (can.position - settled).length < 1e-5, (turn, below)
        system, can = can_on_slope(LIMIT + radians(0.3), radians(turn), floor, mode, rate)
        for _ in range(2 * rate):
            system.step(1 / rate)
        assert can.position.y < R, turn


@pytest.mark.parametrize("share", [0.88, 0.95])
def test_a_loaded_disk_lies_still(share: float) -> None:
    system = iota.System()
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    disk = system.body(shape=iota.Cylinder(0.05, 0.04), mass=1, position=(0, 0.02, 0), orientation=("z", 90))
    disk.set_mass_properties(1, (share * 0.05, 0.02, 0), disk.inertia)
    for _ in range(120):
        system.step(1 / 60)
        assert disk.angular_velocity.length < 1e-5


def test_a_can_pushed_sideways_stands_until_it_tips() -> None:
    for turn in (0, 10, 30):
        for share, tips in ((0.47, False), (0.52, True)):
            system, can = can_on_slope(0, 0, "half_space", "energy_keeping", 120)
            begin, weight = can.position, 9.81 * can.mass
            for _ in range(360):
                can.apply_force((share * weight * cos(radians(turn)), 0, share * weight * sin(radians(turn))))
                system.step(1 / 120)
            assert ((can.position - begin).length > R) == tips, (turn, share)
            assert tips or (can.position - begin).length < 5e-3 * R
