# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
import re
from itertools import pairwise
from pathlib import Path

import pytest
from shown import show

import iota
from iota import looks
from iota._protocol import NO_COLOR, BodyKind, TieKind
from iota.frames import into_frame, turn_from_x
from iota.world.visuals import Visuals

ROOT = Path(__file__).parents[2]


def test_bodies_without_a_class_get_a_look_by_their_particles(system: iota.System) -> None:
    rod, ball = system.body(), system.body(kind="static")
    rod.particle((0, 0, 0))
    rod.particle((2, 0, 0))
    ball.particle((0, 1, 0))
    with show(system) as shown:
        assert shown.bodies[0]["kind"] == BodyKind.DYNAMIC and shown.bodies[0]["length"] == 2.0
        assert shown.bodies[1]["kind"] == BodyKind.STATIC and shown.bodies[1]["length"] == 0.0
        (thick,), (round_,) = shown.parts(rod), shown.parts(ball)
        assert thick["shape"]["kind"] == "capsule" and thick["shape"]["sizes"][0] == pytest.approx(0.12)
        assert round_["shape"]["kind"] == "sphere" and round_["style"] == "*"


def test_movable_solids_without_a_look_stand_out_from_the_ground_in_light_and_dark(system: iota.System) -> None:
    def luminance(code: str) -> float:
        shares = [int(code[at : at + 2], 16) / 255 for at in (0, 2, 4)]
        linear = [share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4 for share in shares]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    movable = system.body(shape=iota.Sphere(0.1), mass=1)
    fixed = system.body(shape=iota.Box((1, 1, 1)), position=(3, 0, 0), kind="static")
    with show(system) as shown:
        (drawn,), (plain,) = shown.parts(movable), shown.parts(fixed)
    assert plain["color"] == NO_COLOR, "what is fixed is as its surroundings"
    own = luminance(f"{drawn['color']:06x}")
    grounds = re.findall(r'ground: "#(\w{6})"', (ROOT / "web/src/scene/stage.ts").read_text())
    assert len(grounds) == 2
    for ground in map(luminance, grounds):
        assert (max(own, ground) + 0.05) / (min(own, ground) + 0.05) > 1.9, "under the same light"


def test_a_rod_is_drawn_from_end_to_end_whatever_its_masses_and_joints(system: iota.System) -> None:
    """With the drawn frame's origin at the center of mass and x from the first end to the second."""
    visuals = Visuals()
    visuals.looks["rod"] = looks.by_style([looks.cylinder(0.01), looks.sphere(0.1)])
    rods = []
    for drawn, masses in ((True, (0.1, 1.9)), (False, (3.0, 1.0)), (True, (1.0, 1.0))):
        rod = system.body()
        for x, mass in zip((0, 2), masses, strict=True):
            rod.particle((x, 0, 0), mass)
        rods.append(rod)
        if drawn:
            visuals.assign([rod], "rod")
    block = system.body(shape=iota.Box((0.1, 0.1, 0.1)), mass=1, position=(2, 0, 0))
    for rod in rods:
        system.revolute(block, rod, at=(2, 0, 0), axis=(0, 0, 1))
    with show(system, visuals) as shown:
        for rod in rods:
            assert len(rod.particles) > 2, "the joint has points of its own on the rod"
            assert shown.bodies[rod.slot]["length"] == pytest.approx(2)
            line, *more = shown.parts(rod)
            middle = rod.center_of_mass.x + line["offset"][0]
            assert middle == pytest.approx(1, abs=2e-3)
            assert [part["offset"] for part in more] == [(0, 0, 0)] * len(more), "what has no length is where it was"


def test_bodies_of_a_class_take_turns_to_be_odd(system: iota.System, chain: list[iota.Body]) -> None:
    visuals = Visuals()
    visuals.looks["link"] = {"rope": looks.cylinder(0.01, "rope"), "chain": looks.chain_link(0.1)}
    visuals.assign(chain, "link")
    with show(system, visuals) as shown:
        assert [shown.bodies[body.slot]["odd"] for body in chain] == [False, True] * 3
        assert len({shown.bodies[body.slot]["visual"] for body in chain}) == 1
        visual = shown.page.visual_of(chain[0].slot)
        assert visual["name"] == "link" and [part["style"] for part in visual["parts"]] == ["rope", "chain"]


def test_pages_get_the_names_of_the_script_and_for_a_new_name_only_that_body(
    system: iota.System, chain: list[iota.Body]
) -> None:
    chain[1].name = "left arm"
    with show(system) as shown:
        names = [shown.bodies[body.slot]["name"] for body in chain]
        assert names == ["", "left arm", *[""] * (len(chain) - 2)]
        before = {slot: dict(body) for slot, body in shown.bodies.items()}
        chain[2].name = "Häns"
        assert shown.look() == 1, "one record: that body's"
        assert shown.bodies[chain[2].slot] == before[chain[2].slot] | {"name": "Häns"}
        chain[2].name = ""
        with system.edit():
            chain[1].name = "right arm"
        system.undo()
        shown.look()
        assert [shown.bodies[body.slot]["name"] for body in chain[1:3]] == ["left arm", ""]


@pytest.mark.parametrize(
    "shape",
    [
        iota.Sphere(0.01), iota.Cylinder(0.01, 0.1), iota.Capsule(0.01, 0.1), iota.Cone(0.01, 0.1),
        iota.Torus(0.05, 0.01),  # as thick as its wire
    ],
    ids=lambda shape: shape.kind,
)  # fmt: skip
def test_welded_bodies_get_a_compound_as_thick_as_their_looks(
    system: iota.System, chain: list[iota.Body], shape: iota.Shape
) -> None:
    visuals = Visuals()
    visuals.looks["link"] = {"*": looks.Look(shape, "brass")}
    visuals.assign(chain, "link")
    with show(system, visuals) as shown:
        chain[0].combine(chain[1])
        shown.look()
        parts = shown.parts(chain[0])
        assert len(shown.bodies) == 5 and shown.page.visual_of(chain[2].slot)["name"] == "link"
        assert all(part["material"] == "brass" for part in parts)
        assert [part["shape"]["sizes"][0] for part in parts] == pytest.approx([0.01] * len(parts))
        assert sum(part["shape"]["sizes"][1] for part in parts) == pytest.approx(0.2)


def test_a_body_is_drawn_along_its_cosmetic_bonds(system: iota.System) -> None:
    body = system.body()
    a, b, c = (body.particle(at) for at in ((0, 0, 0), (1, 0, 0), (0, 1, 0)))
    system.cosmetic_bond(a, b)
    system.cosmetic_bond(a, c)
    with show(system) as shown:
        assert [part["shape"]["sizes"][1] for part in shown.parts(body)] == pytest.approx([1, 1])


def test_particles_with_a_radius_are_drawn_as_balls_on_their_body_and_go_with_its_pieces(system: iota.System) -> None:
    body = system.body()
    points = [body.particle((x, 1, 0)) for x in (0, 1, 2)]
    lines = [system.cosmetic_bond(p, q) for p, q in pairwise(points)]
    for point in points[1:]:
        point.radius, point.color = 0.2, (1, 0, 0)
    with show(system) as shown:
        balls = [part for part in shown.parts(body) if part["shape"]["kind"] == "sphere"]
        assert [ball["shape"]["sizes"][0] for ball in balls] == pytest.approx([0.2, 0.2])
        assert {ball["color"] for ball in balls} == {0xFF0000}
        assert sorted(round(abs(ball["offset"][0]), 6) for ball in balls) == [0, 1]  # the middle one, and an outer one
        lines[1].destroy()
        shown.look()
        kinds = [[part["shape"]["kind"] for part in shown.parts(piece)] for piece in system.bodies]
        assert sorted(map(sorted, kinds)) == [["capsule", "sphere"], ["sphere"]]
        points[2].radius = 0.5
        shown.look()
        (ball,) = shown.parts(points[2].body)
        assert ball["shape"]["sizes"] == [0.5]
        points[1].radius = 0.1
        shown.look()
        assert shown.parts(points[1].body)[-1]["shape"]["sizes"] == pytest.approx([0.1])


def test_an_edit_sends_only_the_entities_that_it_touches(system: iota.System) -> None:
    links = iota.builder.chain(links=100).realize(system).bodies
    with show(system) as shown:
        assert len(shown.bodies) == 100
        links[50].particles[0].separate(links[49].particles[-1])
        assert shown.look() == 50, "the half that hangs together anew, and none of the bodies"
        assert shown.look() == 0


def test_a_destroyed_entity_is_reported_and_its_slot_gets_another_generation(
    system: iota.System, chain: list[iota.Body]
) -> None:
    with show(system) as shown:
        slot, before = chain[5].slot, shown.bodies[chain[5].slot]["id"]
        chain[5].destroy()
        shown.look()
        assert slot not in shown.bodies and slot not in shown.page.articulates
        new = system.body()
        new.particle((0, 5, 0))
        shown.look()
        assert new.slot == slot and shown.bodies[slot]["id"] == (slot, before[1] + 1)


def test_after_a_restore_a_body_made_since_is_another_one(system: iota.System, chain: list[iota.Body]) -> None:
    with show(system) as shown:
        start, kept = system.snapshot(), shown.bodies[0]["id"]
        system.body().particle((0, 5, 0))
        shown.look()
        (first,) = (body["id"] for slot, body in shown.bodies.items() if slot >= len(chain))
        system.restore(start)
        system.body().particle((0, 6, 0))  # under the very id that the engine had given before
        shown.look()
        (second,) = (body["id"] for slot, body in shown.bodies.items() if slot >= len(chain))
        assert first[0] == second[0] and first[1] != second[1]
        assert shown.bodies[0]["id"] == kept


def test_springs_ropes_and_rods_are_ties_while_they_are_active(system: iota.System) -> None:
    a, b = system.body(), system.body()
    p, q = a.particle((0, 0, 0)), b.particle((1, 0, 0))
    spring = system.bond(p, q, "spring", stiffness=1, length=0.5)
    with show(system) as shown:
        ties = shown.page.entities["tie"]
        (tie,) = ties.values()
        assert tie["kind"] == TieKind.SPRING and tie["length"] == 0.5
        assert (tie["a"]["body"], tie["b"]["body"]) == (a.slot, b.slot)
        spring.active = False
        shown.look()
        assert not ties
        spring.active = True
        spring.set(length=0.25)
        shown.look()
        (tie,) = ties.values()
        assert tie["length"] == 0.25
        spring.destroy()
        shown.look()
        assert not ties


def test_nails_and_emitters_are_sent(system: iota.System, chain: list[iota.Body]) -> None:
    fire = system.emitter(rate=1, max_count=7)
    with show(system) as shown:
        page = shown.page
        (emitter,) = page.entities["particle_set"].values()
        assert emitter["active"] and emitter["capacity"] == 7
        nails = len(page.entities["nail"])
        chain[5].particles[-1].nail()
        fire.destroy()
        shown.look()
        assert len(page.entities["nail"]) == nails + 1
        assert not page.entities["particle_set"]


def test_joins_and_breaks_are_seen_when_they_happen(system: iota.System) -> None:
    p, q = system.body().particle((0, 0, 0)), system.body().particle((1, 0, 0))
    with show(system) as shown:
        effects = shown.page.effects
        p.combine(q, over=0.1)
        shown.look()
        assert not effects, "they have not met yet"
        for _ in range(15):
            system.step(0.01)
        shown.look()
        shown.page.wait_for(lambda: [effect["kind"] for effect in effects] == ["join"])
        p.separate(q)
        shown.look()
        shown.page.wait_for(lambda: [effect["kind"] for effect in effects] == ["join", "break"])


def test_a_join_that_is_called_off_or_undone_is_not_seen(system: iota.System) -> None:
    p, q = system.body().particle((0, 0, 0)), system.body().particle((1, 0, 0))
    with show(system) as shown:
        p.combine(q, over=0.1)
        p.separate(q)
        with system.edit():
            p.combine(q)
        system.undo()
        for _ in range(15):
            system.step(0.01)
        shown.look()
        shown.room.notice(0, 0, "end", "")
        shown.page.wait_for(lambda: shown.page.notices)
        assert [effect["kind"] for effect in shown.page.effects if effect["kind"] == "join"] == []


@pytest.mark.parametrize("direction", [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0.6, 0, -0.8)])
def test_turn_from_x_takes_x_to_a_direction(direction: tuple[float, float, float]) -> None:
    quaternion = turn_from_x(iota.Vec3(*direction))
    assert math.hypot(*quaternion) == pytest.approx(1)
    x, y, z, w = quaternion
    back = into_frame(iota.Vec3(*direction), iota.Vec3(), (x, y, z, w))
    assert tuple(back) == pytest.approx((1, 0, 0), abs=1e-6)


def test_shapes_refuse_unknown_names() -> None:
    with pytest.raises(ValueError, match=r"material must be one of steel.*not 'gold'"):
        looks.sphere(0.1, "gold")
    with pytest.raises(ValueError, match=r"the radius of a sphere must be between .* got -1"):
        looks.sphere(-1)
    with pytest.raises(TypeError, match="no argument 'colour'; did you mean 'color'"):
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
    assert list(world._state.visuals.looks) == ["rope", "visual 2", "visual 3"]
    with pytest.raises(TypeError, match=r"a look is made by iota.looks.* not 'brass'"):
        world.draw(chain, "brass")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="kind must be one of spring, rope, rod, not 'bond'"):
        world.draw_ties("bond", looks.cylinder(0.01))  # type: ignore[arg-type]


def test_a_body_of_particles_has_the_usual_radius_until_it_is_drawn_round_or_given_its_own() -> None:
    system = iota.System()
    rod, point, ball, box = system.body(), system.body(), system.body(), system.body(shape=iota.Box((1, 1, 1)))
    rod.particle((0, 0, 0))
    rod.particle((0, 2, 0))
    point.particle((5, 0, 0))
    ball.particle((6, 0, 0)).radius = 0.3
    assert system.usual_radius == pytest.approx(0.12)
    assert [rod.radius, point.radius, ball.radius, box.radius] == pytest.approx([0.12, 0.24, 0.3, 0])
    world = iota.World(system, ground=None)
    world.draw([rod, point, ball, box], {"rope": looks.capsule(0.05, "rope"), "chain": looks.torus(0.1, 0.02)})
    assert [rod.radius, point.radius, ball.radius, box.radius] == [0.05, 0.05, 0.3, 0]
    world.draw(rod, looks.solid("brass"))
    assert rod.radius == 0.05, "this look is not round"
    rod.radius = 0.5
    hit = world.queries.ray((3, 1, 0), (-1, 0, 0))
    assert hit is not None and hit.body == rod and hit.point.x == pytest.approx(0.5, abs=1e-5)
    system.usual_radius = 0.2
    assert rod.radius == 0.5
    again = iota.System()
    again.restore(system.snapshot())
    assert [body.radius for body in again.bodies] == [0.5, 0.05, 0.3, 0]
    assert again.usual_radius == 0.2
    with pytest.raises(ValueError, match="given by shape"):
        box.radius = 1
    for bad in (0, -1, float("nan")):
        with pytest.raises(ValueError, match="radius"):
            rod.radius = bad
        with pytest.raises(ValueError, match="usual_radius"):
            system.usual_radius = bad


def test_a_radius_that_is_assigned_during_a_step_holds_after_it() -> None:
    system = iota.System()
    body = system.body()
    body.particle((0, 0, 0))
    end, other = body.particle((0, 1, 0)), system.body().particle((0, 2, 0))
    during = []

    def force(bond: iota.Bond) -> tuple[float, float, float]:
        body.radius = 0.4
        during.append(body.radius)
        return 0, 0, 0

    system.bond(end, other, force)
    system.step(0.01)
    assert during == [system.usual_radius] and body.radius == 0.4
