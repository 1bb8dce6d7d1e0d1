# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import json
import math
from typing import Any

import pytest

import iota
from iota import looks
from iota.world.frames import into_frame, turn_from_x
from iota.world.scene import Scene, fitting_camera


def described(scene: Scene) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    classes, bodies = scene.describe()
    return json.loads(classes), json.loads(bodies)


def test_bodies_without_a_class_get_a_look_by_their_particles(system: iota.System) -> None:
    rod, ball = system.body(), system.body(kind="static")
    rod.particle()
    rod.particle((2, 0, 0))
    ball.particle((0, 1, 0))
    classes, bodies = described(Scene(system))
    assert bodies[0] == {"body": 0, "class": "(rod)", "odd": 0, "kind": "dynamic", "length": 2.0}
    assert bodies[1] == {"body": 1, "class": "(particle)", "odd": 0, "kind": "static"}
    assert classes["(rod)"]["*"]["kind"] == "capsule" and classes["(particle)"]["*"]["kind"] == "sphere"
    assert classes["(rod)"]["*"]["sizes"][0] == pytest.approx(0.12)


def test_bodies_of_a_class_take_turns_to_be_odd(system: iota.System, chain: list[iota.Body]) -> None:
    scene = Scene(system)
    scene.classes["link"] = {"rope": looks.cylinder(0.01, "rope"), "chain": looks.chain_link(0.1)}
    scene.assign(chain, "link")
    classes, bodies = described(scene)
    assert [body["odd"] for body in bodies] == [0, 1, 0, 1, 0, 1]
    assert {body["class"] for body in bodies} == {"link"}
    assert set(classes["link"]) == {"rope", "chain"}


def test_welded_bodies_get_a_compound_of_their_own(system: iota.System, chain: list[iota.Body]) -> None:
    scene = Scene(system)
    scene.classes["link"] = {"*": looks.cylinder(0.01, "brass")}
    scene.assign(chain, "link")
    chain[0].combine(chain[1])
    classes, bodies = described(scene)
    assert bodies[0]["class"] == "(body 0)" and len(bodies) == 5
    shapes = classes["(body 0)"]["*"]
    assert all(shape["material"] == "brass" and shape["sizes"][0] == 0.01 for shape in shapes)
    assert sum(shape["sizes"][1] for shape in shapes) == pytest.approx(0.2)


def test_a_body_is_drawn_along_its_cosmetic_bonds(system: iota.System) -> None:
    body = system.body()
    a, b, c = (body.particle(at) for at in ((0, 0, 0), (1, 0, 0), (0, 1, 0)))
    system.cosmetic_bond(a, b)
    system.cosmetic_bond(a, c)
    classes, _ = described(Scene(system))
    lengths = [shape["sizes"][1] for shape in classes["(body 0)"]["*"]]
    assert lengths == pytest.approx([1, 1])


@pytest.mark.parametrize("direction", [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0.6, 0, -0.8)])
def test_turn_from_x_takes_x_to_a_direction(direction: tuple[float, float, float]) -> None:
    quaternion = turn_from_x(iota.Vec3(*direction))
    assert math.hypot(*quaternion) == pytest.approx(1)
    x, y, z, w = quaternion
    back = into_frame(iota.Vec3(*direction), iota.Vec3(), (x, y, z, w))
    assert tuple(back) == pytest.approx((1, 0, 0), abs=1e-6)


def test_the_camera_sees_everything(system: iota.System, chain: list[iota.Body]) -> None:
    camera = fitting_camera(system)
    assert camera.target == pytest.approx((0.18, 1.76, 0), abs=0.01)
    assert fitting_camera(iota.System()).position


def test_shapes_refuse_what_they_do_not_know() -> None:
    with pytest.raises(ValueError, match=r"material must be one of steel.*not 'gold'"):
        looks.sphere(0.1, "gold")
    with pytest.raises(ValueError, match=r"the radius of a sphere must be between .* got -1"):
        looks.sphere(-1)
    with pytest.raises(TypeError, match="unexpected keyword argument 'colour'"):
        looks.capsule(0.1, colour="#ff0000")


def test_links_of_a_real_chain_touch_where_they_are_hinged() -> None:
    link = looks.chain_link(0.1).shape
    assert isinstance(link, iota.Torus)
    end = link.stretch / 2 + link.radius  # center line at the end of the link
    assert end - 0.05 == pytest.approx(link.tube), "the wire goes once around the hinge"
    assert link.radius - link.tube > link.tube, "the neighbor fits inside"


def test_bodies_that_are_drawn_alike_share_a_class(system: iota.System, chain: list[iota.Body]) -> None:
    world = iota.World(system)
    world.draw_ties("rope", looks.cylinder(0.01))
    world.draw(chain[:3], looks.cylinder(0.01))
    world.draw(chain[3], looks.cylinder(0.01))
    world.draw(chain[4:], {"thin": looks.cylinder(0.001), "thick": [looks.cylinder(0.1), looks.sphere(0.2)]})
    assert list(world._state.scene.classes) == ["rope", "class 2", "class 3"]
    with pytest.raises(TypeError, match=r"a look is made by iota.looks.* not 'brass'"):
        world.draw(chain, "brass")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="kind must be one of spring, rope, rod, not 'bond'"):
        world.draw_ties("bond", looks.cylinder(0.01))  # type: ignore[arg-type]
