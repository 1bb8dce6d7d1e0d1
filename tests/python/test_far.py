# SPDX-License-Identifier: Apache-2.0
"""Rows that are fixed in the world act ten million meters away as at the origin."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import iota

At = Callable[..., tuple[float, float, float]]
TOP = (0.4, 0.3, 0)


def point(system: iota.System, body: iota.Body, at: At) -> iota.Particle:
    return body.attachment(at(*TOP))


def anchor(system: iota.System, at: At) -> iota.Particle:
    return system.body(kind="static").particle(at(0.4, 1.3, 0))


def driven(system: iota.System, body: iota.Body, at: At) -> None:
    system.revolute(body, at=at(*TOP), axis=(0, 0, 1)).angle.motor = (3, 40)


def coupled(system: iota.System, body: iota.Body, at: At) -> None:
    turns = system.revolute(body, at=at(*TOP), axis=(0, 0, 1))
    slider = system.body(shape=iota.Box((0.2, 0.2, 0.2)), position=at(2, 0, 0))
    slides = system.prismatic(slider, at=at(2, 0, 0), axis=(0, 1, 0))
    system.couple([(turns.angle, 1), (slides.slide, 0.5)])


def on_path(system: iota.System, body: iota.Body, at: At) -> None:
    corners = [(-1, 1, 0), (0, 0.4, 0), TOP, (1, 0.3, 0.1), (2, 1, 0)]
    system.on_path(point(system, body, at), [at(*corner) for corner in corners])


ROWS: dict[str, Callable[[iota.System, iota.Body, At], object]] = {
    "ball": lambda s, b, at: s.ball(b, at=at(*TOP)),
    "weld": lambda s, b, at: s.weld(b, at=at(*TOP)),
    "revolute": lambda s, b, at: s.revolute(b, at=at(*TOP), axis=(0, 0, 1)),
    "prismatic": lambda s, b, at: s.prismatic(b, at=at(*TOP), axis=(1, 0, 0)),
    "cylindrical": lambda s, b, at: s.cylindrical(b, at=at(*TOP), axis=(1, 0, 0)),
    "planar": lambda s, b, at: s.planar(b, at=at(*TOP), axis=(0, 0, 1)),
    "screw": lambda s, b, at: s.screw(b, at=at(*TOP), axis=(0, 1, 0), lead=0.3),
    "motor": driven,
    "coupling": coupled,
    "path": on_path,
    "surface": lambda s, b, at: s.on_surface(point(s, b, at), iota.Sphere(1), at=at(0.4, 1.3, 0)),
    "inside": lambda s, b, at: s.inside(point(s, b, at), iota.Sphere(1), at=at(0.4, 1.2, 0)),
    "surfaces": lambda s, b, at: s.surface_to_surface(b, iota.Sphere(0.3), None, iota.Sphere(1), at_b=at(0.2, -1.3, 0)),
    "nail": lambda s, b, at: point(s, b, at).nail(),
    "rod": lambda s, b, at: s.rod(point(s, b, at), anchor(s, at)),
    "spring": lambda s, b, at: s.bond(point(s, b, at), anchor(s, at), "spring", stiffness=500, length=1),
}


def swing(row: str, mode: str, far: tuple[float, float, float]) -> tuple[np.ndarray, int, float]:
    """Places after a third of a second, steps that were not solved, and iterations."""

    def at(x: float, y: float, z: float) -> tuple[float, float, float]:
        return (far[0] + x, far[1] + y, far[2] + z)

    system = iota.System(mode=mode)
    first = system.body(shape=iota.Box((0.2, 0.6, 0.2)), position=at(0.4, 0, 0))
    second = system.body(shape=iota.Box((0.2, 0.6, 0.2)), position=at(0.8, 0.3, 0))
    ROWS[row](system, first, at)
    system.ball(first, second, at=at(0.5, 0.1, 0))
    unsolved, iterations = 0, 0.0
    for _ in range(40):
        report = system.step(1 / 120)
        unsolved += report.unconverged
        iterations += report.iterations_mean
    return np.array([first.position, second.position]) - far, unsolved, iterations


@pytest.mark.parametrize("mode", ["plausible", "robust", "energy_keeping", "accurate"])
@pytest.mark.parametrize("row", ROWS)
def test_moves_as_at_the_origin(row: str, mode: str) -> None:
    near, _, iterations = swing(row, mode, (0, 0, 0))
    far, unsolved, iterations_far = swing(row, mode, (1e7, -1e7, 1e7))
    assert unsolved == 0
    assert iterations_far <= 2 * iterations + 4  # of thousands, where a step is halved again and again
    assert np.abs(near - ((0.4, 0, 0), (0.8, 0.3, 0))).max() > 0.05
    assert np.abs(far - near).max() < 1e-6
