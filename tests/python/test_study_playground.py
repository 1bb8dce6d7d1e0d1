# SPDX-License-Identifier: Apache-2.0
"""The playground: what users place, connect, save and take away as a script."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import iota
from iota.studies import playground
from iota.studies._scene import Scene


@pytest.fixture
def world(tmp_path: Path) -> iota.World:
    return playground.build(tmp_path)


def act(world: iota.World, name: str, body: iota.Body) -> None:
    world._state.actions[name].hook.function(iota.Event(world.system, name, target=body, notices=world._state.notices))


def widget(world: iota.World, label: str) -> Any:
    return next(thing for thing in world.things if getattr(thing, "label", "") == label)


def push(world: iota.World, label: str) -> None:
    widget(world, label).take(1.0, "", iota.Event(world.system, label), world._guard)


def click(world: iota.World, what: str, origin: tuple[float, ...], direction: tuple[float, ...]) -> None:
    widget(world, "place").value = what
    (listener,) = world._state.listeners.of("click", None)
    event = iota.Event(world.system, "click", origin=iota.Vec3(*origin), direction=iota.Vec3(*direction))
    listener.hook.function(event)


def told(world: iota.World) -> list[str]:
    """Texts of cards, from now on."""
    texts: list[str] = []
    world._state.notices.show = lambda client, level, title, text, *more, **rest: texts.append(f"{title}: {text}")
    return texts


def run(world: iota.World, seconds: float) -> None:
    for _ in range(round(seconds / world.dt)):
        report = world.step()
        assert report is not None and report.unconverged == 0


def shape_of(system: iota.System) -> list[tuple[float, ...]]:
    return sorted(tuple(round(x, 6) for x in (*body.center_of_mass, body.mass)) for body in system.bodies)


def test_a_click_places_what_is_chosen_where_the_ray_meets_the_middle_or_the_ground(world: iota.World) -> None:
    before = len(world.system.bodies)
    click(world, "nothing", (0, 1, 4), (0, 0, -1))
    assert len(world.system.bodies) == before
    click(world, "ball", (0, 1, 4), (0.1, 0, -1))
    assert world.system.bodies[-1].center_of_mass == pytest.approx((0.4, 1, 0), abs=1e-9)
    click(world, "box", (0, 2, 4), (0, -1, -1))
    assert world.system.bodies[-1].center_of_mass == pytest.approx((0, 0.15, 2.15), abs=1e-9)
    click(world, "chain", (1, 1.5, 4), (0, 0, -1))
    click(world, "rod", (-1, 1.5, 4), (0, 0, -1))
    click(world, "particle", (-1, 1.9, 4), (0, 0, -1))
    assert len(world.system.bodies) == before + 2 + 8 + 2
    click(world, "ball", (0, 1, 4), (0, 1, 0))
    assert len(world.system.bodies) == before + 12, "a ray into the sky places nothing"
    world.undo()
    assert len(world.system.bodies) == before + 11
    run(world, 1.0)


def test_nails_springs_and_combining_do_what_they_say_and_are_undone(world: iota.World) -> None:
    system = world.system
    ball = playground.PLACE["ball"](world, iota.Vec3(2, 1.5, 0))
    box = playground.PLACE["box"](world, iota.Vec3(2.3, 1.5, 0))
    act(world, "nail", ball)
    act(world, "spring", ball)
    act(world, "spring", box)
    assert len(system.bonds) == 2
    run(world, 3.0)
    assert abs(ball.center_of_mass - (2, 1.5, 0)) < 1e-6, "it hangs on its nail"
    assert box.center_of_mass.y > 0.3, "and the box on its spring"
    mass = ball.mass + box.mass
    act(world, "combine", ball)
    act(world, "combine", box)
    assert ball.mass == pytest.approx(mass) and len(ball.solids) == 2
    assert world.undo() and len(system.bonds) == 2 and box.alive and box.survivor == box
    act(world, "delete", box)
    assert not box.alive and len(system.bonds) == 1
    act(world, "nail", ball)
    assert not any(particle.is_nailed for particle in ball.particles)


def test_what_is_saved_is_loaded_again_and_goes_on_as_before(world: iota.World, tmp_path: Path) -> None:
    ball = playground.PLACE["ball"](world, iota.Vec3(2, 1.5, 0))
    ball.combine(playground.PLACE["box"](world, iota.Vec3(2.2, 1.5, 0)))
    run(world, 0.5)
    push(world, "save")
    saved = shape_of(world.system)
    run(world, 0.5)
    later = shape_of(world.system)
    click(world, "box", (0, 1, 4), (0, 0, -1))
    push(world, "load")
    assert shape_of(world.system) == saved
    assert world.system.validate() == []
    run(world, 0.5)
    assert np.array(shape_of(world.system)) == pytest.approx(np.array(later), abs=2e-4)
    assert [file.name for file in tmp_path.iterdir() if file.is_file()] == ["playground.json"]


def test_the_script_makes_the_same_world(world: iota.World, tmp_path: Path) -> None:
    playground.PLACE["ball"](world, iota.Vec3(2, 1.5, 0)).combine(
        playground.PLACE["box"](world, iota.Vec3(2.2, 1.5, 0))
    )
    run(world, 0.5)
    push(world, "export script")
    script = tmp_path / "playground.py"
    script.write_text(script.read_text() + "print([tuple(b.center_of_mass) for b in world.system.bodies])\n")
    done = subprocess.run(
        [sys.executable, "-m", "iota", "run", script, "--headless", "--seconds", "1"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    run(world, 1.0)
    there = json.loads(done.stdout.replace("(", "[").replace(")", "]"))
    here = [list(body.center_of_mass) for body in world.system.bodies]
    assert len(there) == len(here)
    for place in here:
        assert min(np.linalg.norm(np.array(other) - place) for other in there) < 1e-3


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "No such file"),
        ("", "Expecting value"),
        ("[1, 2", "Expecting"),
        ("{}", "no saved playground"),
        ('{"structure": {"points": {"position": [[0, 1, 0]], "mass": [1]}, "hinges": [[0, 7]]}, "combined": []}', "7"),
        ('{"structure": {"points": {"position": [[0, 1, 0]], "mass": [1]}}, "combined": [[0, 9]]}', "not there"),
    ],
)
def test_a_file_that_cannot_be_loaded_leaves_the_world_as_it_is(
    world: iota.World, tmp_path: Path, content: str | None, words: str
) -> None:
    if content is not None:
        (tmp_path / "playground.json").write_text(content)
    before, texts = world.system.state_hash(), told(world)
    push(world, "load")
    assert world.system.state_hash() == before
    assert len(texts) == 1 and "playground.json" in texts[0] and words in texts[0], texts


def test_files_go_nowhere_else_and_failures_are_told(world: iota.World, tmp_path: Path) -> None:
    texts = told(world)
    for name in ("../out", "/tmp/out", "a b", "", "x" * 300):
        widget(world, "file").value = name
        push(world, "save")
    assert len(texts) == 5 and not any(file.is_file() for file in tmp_path.iterdir())
    lost = playground.build(tmp_path / "no folder")
    texts = told(lost)
    push(lost, "save")
    assert "cannot be written: No such file or directory" in texts[0]
    system = iota.System()
    wheel = system.body(shape=iota.Sphere(0.1), density=500)
    system.revolute(wheel, at=(0, 0, 0), axis=(1, 0, 0))
    with pytest.raises(ValueError, match="joints"):
        Scene.of(system)
