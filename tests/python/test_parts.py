# SPDX-License-Identifier: Apache-2.0
"""A world consists of parts, and forwards what scripts use daily."""

from __future__ import annotations

import gc
import inspect
import weakref

import pytest

import iota
from iota import looks
from iota.world.fixtures import Fixtures
from iota.world.world import PARTS

OF_PARTS = {name for part in PARTS for name in vars(part)}
FORWARDS = [
    name for name in vars(iota.World) if name in OF_PARTS and callable(getattr(iota.World, name)) and name[0] != "_"
]
MOST_NAMES = 58  # of a world, beside those that make one fixture each


def test_a_world_has_few_names_of_its_own() -> None:
    others = set(dir(iota.World)) - set(vars(Fixtures))
    assert len([name for name in others if not name.startswith("_")]) <= MOST_NAMES


@pytest.mark.parametrize("name", FORWARDS)
def test_a_forward_has_the_signature_and_the_text_of_the_function_of_its_part(name: str) -> None:
    world = iota.World(iota.System())
    (part,) = [part for part in PARTS if name in vars(part)]
    of_part = getattr(getattr(world, part.__name__.lower()), name)
    of_world = getattr(world, name)
    assert inspect.signature(of_world) == inspect.signature(of_part)
    assert inspect.getdoc(of_world) == inspect.getdoc(of_part) != None  # noqa: E711


def test_a_forward_calls_the_function_of_its_part() -> None:
    system = iota.System()
    rod = system.body()
    rod.particle(), rod.particle((1, 0, 0))
    world = iota.World(system)
    world.draw(rod, looks.cylinder(0.1))
    assert world.scene.look_of(rod) is not None
    assert world.label("top", at=rod, height=0.1) in world.drawings.things
    world.offer("undo")
    world.action("push", key="p", help="pushes")(lambda: None)
    assert [(action.name, action.key) for action in world.controls.actions] == [("undo", "z"), ("push", "p")]
    world.camera, world.dt = iota.Camera((1, 1, 1), (0, 0, 0)), 0.02
    assert world.scene.camera is world.camera and world.camera.position == (1, 1, 1) and world.clock.dt == 0.02


def test_a_world_of_parts_goes_with_its_last_reference() -> None:
    world = iota.World(iota.System())
    world.offer()
    gone = weakref.ref(world)
    del world
    gc.collect()
    assert gone() is None


def test_every_part_refuses_an_attribute_that_it_does_not_have() -> None:
    world = iota.World(iota.System())
    for kind in PARTS:
        part = getattr(world, kind.__name__.lower())
        assert type(part) is kind
        with pytest.raises(AttributeError, match="has no attribute 'no_such_name'"):
            part.no_such_name = 1
        with pytest.raises(AttributeError, match="has no attribute 'no_such_name'"):
            _ = part.no_such_name


def test_all_functions_on_events_can_be_forgotten() -> None:
    world = iota.World(iota.System(), dt=0.01)
    called: list[str] = []

    def hear() -> None:
        called.append("")

    world.on_step(hear)
    world.on_reset(hear)
    world.on_frame(hear)
    world.step()
    world.reset()
    assert len(called) == 2
    assert world.events.forget(hear) and not world.events.forget(hear)
    world.step()
    world.reset()
    assert len(called) == 2
