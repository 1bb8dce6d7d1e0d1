# SPDX-License-Identifier: Apache-2.0
"""Ready parts of interaction, asked for by a page."""

from __future__ import annotations

import time
from collections.abc import Callable
from itertools import pairwise

import pytest
from page_client import NOTHING, PageClient

import iota
from iota import looks
from iota.world.joining import SPEED, hinge_above, nearest_ends

Runner = Callable[[iota.World], str]


@pytest.fixture
def chain(system: iota.System) -> list[iota.Body]:
    """Six links of 0.2 m on a nail at (0, 2, 0)."""
    system.gravity = (0, -9.81, 0)
    system.damping = 1.0
    return iota.builder.chain(6, 1.2, top=(0, 2, 0)).realize(system).bodies


def act(page: PageClient, name: str, body: tuple[int, int] = NOTHING) -> None:
    page.send("action", name=name, body=body)


def test_the_link_above_is_the_one_towards_the_nail(chain: list[iota.Body]) -> None:
    assert hinge_above(chain[0]) is None
    hinge = hinge_above(chain[3])
    assert hinge == (chain[2].particles[1], chain[3].particles[0])
    hinge[0].separate(hinge[1])
    assert hinge_above(chain[3]) is None or hinge_above(chain[5]) is not None


def test_join_finds_the_nearest_loose_ends(chain: list[iota.Body]) -> None:
    assert nearest_ends(chain[4]) is None
    chain[2].particles[1].separate(chain[3].particles[0])
    assert nearest_ends(chain[4]) == (chain[2].particles[1], chain[3].particles[0])
    assert nearest_ends(chain[1]) == (chain[3].particles[0], chain[2].particles[1])


def test_a_nailed_end_is_not_joined(chain: list[iota.Body]) -> None:
    link = chain[0].system.body()
    near = chain[0].particles[0].position + (0.01, 0, 0)  # beside the nail
    ends = [link.particle(near), link.particle(near + (1, 0, 0))]
    lowest = chain[-1].particles[1]
    assert nearest_ends(link) == (lowest, min(ends, key=lambda end: abs(end.position - lowest.position)))


def test_solids_are_joined_at_their_attachments_not_at_their_own_points(system: iota.System) -> None:
    balls = [system.body(shape=iota.Sphere(0.1), mass=1, position=(x, 0, 0)) for x in (0, 1)]
    assert nearest_ends(balls[0]) is None
    eyes = [ball.attachment((x, 0, 0)) for ball, x in zip(balls, (0.1, 0.9), strict=True)]
    assert nearest_ends(balls[0]) == (eyes[1], eyes[0])


def test_an_action_on_several_bodies_is_one_edit(chain: list[iota.Body], run_world: Runner) -> None:
    system = chain[0].system
    world = iota.World(system)
    world.offer()
    seen: list[int] = []

    @world.action("destroy", on="body")
    def destroy(event: iota.Event) -> None:
        seen.append(event.body.slot)
        event.body.destroy()

    looks: list[int] = []

    @world.action("look", on="body")
    def look(event: iota.Event) -> None:
        looks.append(event.body.slot)

    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.bodies) == 6 and page.parts() == 1)

        def act_on(name: str, *links: int) -> None:
            first, *others = (page.body(chain[link].slot) for link in links)
            page.send("action", name=name, body=first, others=others)

        before = world.call(lambda: system.undo_count)
        for name, done in (
            ("break", lambda: page.parts() == 4),
            ("copy", lambda: len(page.bodies) == 9),
            ("destroy", lambda: len(page.bodies) == 3),
        ):
            act_on(name, 1, 3, 5)
            page.wait_for(done)
            assert world.call(lambda: system.undo_count) == before + 1
            act(page, "undo")
            page.wait_for(lambda: page.parts() == 1 and len(page.bodies) == 6)
            assert world.call(lambda: system.undo_count) == before
        act_on("look", 1, 3, 5)
        page.wait_for(lambda: len(looks) == 3)
        act(page, "redo")
        page.wait_for(lambda: len(page.bodies) == 3)
        act(page, "undo")
        page.wait_for(lambda: len(page.bodies) == 6)
        assert world.call(lambda: system.undo_count) == before, "an action without an edit is not undone"
        assert seen == [chain[link].slot for link in (1, 3, 5)]
        # One that is gone, and one twice: the others are meant.
        gone = page.body(chain[5].slot)
        world.call(chain[5].destroy)
        page.wait_for(lambda: len(page.bodies) == 5)
        seen.clear()
        page.send("action", name="destroy", body=gone, others=[page.body(chain[0].slot)] * 2)
        page.wait_for(lambda: len(page.bodies) == 4)
        assert seen == [chain[0].slot]


def test_an_action_that_raises_for_one_body_is_not_repeated_for_the_others(
    chain: list[iota.Body], run_world: Runner
) -> None:
    world = iota.World(chain[0].system)
    calls: list[int] = []

    @world.action("poke")
    def poke(event: iota.Event) -> None:
        calls.append(event.body.slot)
        if len(calls) == 2:
            raise ArithmeticError("two")

    with PageClient(run_world(world)) as page:
        first, *others = (page.body(link.slot) for link in chain[:4])
        page.send("action", name="poke", body=first, others=others)
        notice = page.wait_for(lambda: page.notices)[0]
        assert "'poke' failed" in notice["title"] and len(calls) == 2 and len(page.notices) == 1


def test_users_break_join_and_take_it_back(chain: list[iota.Body], run_world: Runner) -> None:
    system = chain[0].system
    world = iota.World(system)
    world.offer()
    slot = chain[3].slot
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.bodies) == 6 and page.parts() == 1)
        act(page, "break", page.body(slot))
        page.wait_for(lambda: page.parts() == 2)
        act(page, "undo")
        page.wait_for(lambda: page.parts() == 1)
        act(page, "redo")
        page.wait_for(lambda: page.parts() == 2)
        act(page, "join", page.body(slot))
        page.wait_for(lambda: page.parts() == 1)
    with pytest.raises(ValueError, match="there are 'break', 'join'"):
        world.offer("dance")


def test_a_break_during_a_join_calls_it_off(chain: list[iota.Body], run_world: Runner) -> None:
    system = chain[0].system
    end, own = chain[2].particles[1], chain[3].particles[0]
    end.separate(own)
    for body in chain[3:]:
        for particle in body.particles:
            particle.position += (2.0, 0.0, 0.0)
    system.gravity = (0, 0, 0)  # nothing else moves the two together
    world = iota.World(system, ground=None)
    world.offer("break", "join")
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.bodies) == 6)
        lower = page.body(chain[3].slot)
        act(page, "join", lower)
        page.wait_for(lambda: world.call(lambda: system.closing_count) == 1)
        act(page, "break", lower)
        page.wait_for(lambda: world.call(lambda: system.closing_count) == 0)
        assert world.call(lambda: system.articulate_count) == 2
        assert world.call(lambda: abs(end.position - own.position)) > 0.5
        act(page, "break", lower)  # now there is nothing above it any more
        page.wait_for(lambda: any(n["title"] == "Nothing to break" for n in page.notices))


def test_far_ends_are_drawn_together_no_faster_than_eyes_follow(chain: list[iota.Body]) -> None:
    system = chain[0].system
    end, own = chain[2].particles[1], chain[3].particles[0]
    end.separate(own)
    for body in chain[3:]:
        for particle in body.particles:
            particle.position += (2.0, 0.0, 0.0)
    system.gravity = (0, 0, 0)
    world = iota.World(system, ground=None)
    world.offer("join")
    world.controls.act("join", chain[3])
    gaps = [abs(end.position - own.position)]
    while system.closing_count and system.time < 5:
        world.step()
        gaps.append(abs(end.position - own.position))
    assert system.articulate_count == 1 and gaps[-1] == 0
    assert system.time > 0.99 * gaps[0] / SPEED, "on average"
    assert max(a - b for a, b in pairwise(gaps)) < 2.01 * SPEED * world.dt, "at any time"


def test_a_copy_has_the_same_shape_mass_motion_and_look(system: iota.System, run_world: Runner) -> None:
    system.gravity = (0, 0, 0)
    turned = (0.0, 0.6, 0.0, 0.8)
    box = system.body(
        shape=iota.Box((0.1, 0.2, 0.3)),
        mass=3,
        position=(0, 1, 0),
        orientation=turned,
        velocity=(0, 0.01, 0),
        spin=(0, 0, 1),
    )
    box.attachment((0, 1.1, 0))
    rod = system.body()
    rod.particle((0, 0, 2), 1.0)
    rod.particle((0.5, 0, 2), 2.0)
    slots = box.slot, rod.slot
    world = iota.World(system, ground=None)
    world.draw([box, rod], looks.capsule(0.02, "brass"))
    world.offer("copy")
    world.clock.paused = True
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.bodies) == 2)
        for slot in slots:
            act(page, "copy", page.body(slot))
        page.wait_for(lambda: len(page.bodies) == 4)

        def figures() -> list[tuple[object, ...]]:
            found = []
            for body in system.bodies:
                solid = body.solids[0] if body.solids else None
                motion = [round(x, 9) for vector in (body.velocity, body.angular_velocity) for x in vector]
                orientation = solid and [round(x, 9) for x in solid.orientation]
                found.append((body.mass, motion, solid and str(solid.shape), orientation, len(body.particles)))
            return found

        first, second, third, fourth = world.call(figures)
        assert first == third and second == fourth
        visuals = [page.visual_of(slot)["name"] for slot in page.bodies]
        assert visuals[1] == visuals[3]
        apart = world.call(lambda: abs(system.bodies[2].center_of_mass - system.bodies[0].center_of_mass))
        assert 0.2 < apart < 1


def test_two_bodies_are_measured(chain: list[iota.Body], run_world: Runner) -> None:
    world = iota.World(chain[0].system)
    world.offer("measure")
    slots = chain[1].slot, chain[4].slot
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.bodies) == 6)
        for slot in slots:
            act(page, "measure", page.body(slot))
        label = page.wait_for(lambda: page.entities["label"].get(0))
        assert float(label["text"].removesuffix(" m")) == pytest.approx(0.6, abs=0.05)
        act(page, "measure", page.body(slots[0]))
        page.wait_for(lambda: not page.entities["label"] and not page.entities["line"])


def test_a_plug_that_is_let_go_near_its_socket_is_joined(system: iota.System, run_world: Runner) -> None:
    system.gravity = (0, 0, 0)
    wall = system.body()
    place = wall.particle((0, 1, 0))
    place.nail()
    wall.particle((0, 2, 0)).nail()
    cable = system.body()
    plug = cable.particle((1, 1, 0))
    cable.particle((2, 1, 0))
    cable.damping = 5.0
    slot = cable.slot
    world = iota.World(system, ground=None)
    joined: list[iota.Particle] = []
    world.tools.socket(place, [plug], within=0.2, on_snap=joined.append)
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.bodies) == 2)
        assert not page.entities["marker"], "nobody holds a plug"

        def carry(x: float) -> None:
            page.send("grab_start", hold=1, body=page.body(slot), local_point=(-0.5, 0, 0), target=(1, 1, 0))
            ghost = page.wait_for(lambda: page.entities["marker"].get(0))["part"]
            assert ghost["color"] & 0xFFFFFF == 0x2F9D92
            assert ghost["shape"]["kind"] == "capsule" and ghost["shape"]["sizes"][1] == pytest.approx(1), (
                "the cable's shape"
            )
            began = time.monotonic()
            while abs(world.call(lambda: plug.position.x) - x) > 0.05 and time.monotonic() - began < 20:
                page.send("grab_move", hold=1, target=(x, 1, 0))
                time.sleep(0.05)

        carry(0.5)
        page.send("grab_end", hold=1)
        page.wait_for(lambda: not page.entities["marker"])
        assert page.parts() == 2 and not joined, "too far away"
        carry(0.1)
        page.wait_for(lambda: page.entities["marker"][0]["part"]["color"] & 0xFFFFFF == 0xF2A324)
        # Its middle, half a meter from the plug, as it would be once joined.
        page.wait_for(lambda: page.entities["frame"][0]["at"]["point"] == pytest.approx((0.5, 1, 0), abs=0.02))
        page.send("grab_end", hold=1)
        page.wait_for(lambda: page.parts() == 1)
        assert world.call(lambda: joined == [plug])


@pytest.mark.parametrize("pull", [0.0, 3.0])
def test_a_socket_pulls_a_held_plug_that_is_near_with_a_bounded_force(
    system: iota.System, run_world: Runner, pull: float
) -> None:
    system.gravity = (0, 0, 0)
    system.damping = 2.0
    wall = system.body()
    place = wall.particle((0, 1, 0))
    place.nail()
    plug = system.body().particle((1, 1, 0))
    slot = plug.body.slot
    world = iota.World(system, ground=None)
    world.tools.socket(place, [plug], within=0.2, pull=pull)
    forces: list[float] = []

    @world.on_frame
    def record() -> None:
        forces.extend(abs(bond.force) for bond in system.bonds)

    with PageClient(run_world(world)) as page:
        page.send("grab_start", hold=1, body=page.body(slot), local_point=(0, 0, 0), target=(1, 1, 0))

        def rest(x: float) -> float:
            """Where the plug comes to rest under a hand."""
            for _ in range(40):
                page.send("grab_move", hold=1, target=(x, 1 + 1e-4 * (_ % 2), 0))
                time.sleep(0.03)
            return world.call(lambda: plug.position.x)

        assert rest(0.8) == pytest.approx(0.8, abs=0.01) and not forces
        drawn = rest(0.3)
        assert drawn < 0.295 if pull else drawn == pytest.approx(0.3, abs=0.003)
        assert max(forces, default=0.0) <= pull
        if pull:
            assert forces[-1] > 0.9 * pull
        page.send("grab_end", hold=1)
        page.wait_for(lambda: world.call(lambda: not list(system.bonds)))
    with pytest.raises(ValueError, match="pull must be a finite force"):
        world.tools.socket(place, [plug], pull=-1)


def test_a_world_goes_back_by_a_second_at_a_time_to_where_it_was(system: iota.System, run_world: Runner) -> None:
    system.gravity = (0, 0, 0)
    ball = system.body().particle((0, 1, 0), velocity=(0.5, 0, 0))
    world = iota.World(system, ground=None)
    world.offer("rewind")

    def now() -> tuple[float, float]:
        return world.call(lambda: (system.time, ball.position.x))

    def go_back() -> tuple[float, float, float]:
        before = now()[0]
        act(page, "rewind")
        page.wait_for(lambda: now()[0] < before - 0.3)
        return (before, *now())

    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: now()[0] > 3)
        page.send("grab_start", hold=1, body=page.body(0), local_point=(0, 0, 0), target=(now()[1], 1, 0))
        page.wait_for(lambda: world.call(lambda: world.users.held() is not None))
        world.call(lambda: setattr(world.clock, "paused", True))
        before, time_now, x = go_back()
        assert 0.9 <= before - time_now <= 1.6 and x == pytest.approx(0.5 * time_now, abs=1e-6)
        assert world.call(lambda: world.users.held() is None), "the hands of that time are not those of now"
        while now()[0] > 0.1:
            before, time_now, x = go_back()
            assert x == pytest.approx(0.5 * time_now, abs=1e-6)
        act(page, "rewind")
        page.wait_for(lambda: [notice["title"] for notice in page.notices] == ["Nothing to go back to"])


def test_going_back_to_a_time_at_which_a_hand_held_the_body_already_takes_it_away(
    system: iota.System, run_world: Runner
) -> None:
    system.gravity = (0, 0, 0)
    ball = system.body().particle((0, 1, 0))
    world = iota.World(system, ground=None)
    world.offer("rewind")
    with PageClient(run_world(world)) as page:
        page.send("grab_start", hold=1, body=page.body(0), local_point=(0, 0, 0), target=(0.5, 1, 0))
        page.wait_for(lambda: world.call(lambda: world.users.held() is not None))
        taken = world.call(lambda: system.time)
        page.wait_for(lambda: world.call(lambda: system.time) > taken + 2.5)
        page.send("control", command=0, value=0.0)
        act(page, "rewind")
        page.wait_for(lambda: world.call(lambda: system.time) < taken + 2.2)
        assert world.call(lambda: system.time) > taken, "the hand is older"
        assert world.call(lambda: world.users.held()) is None
        page.send("grab_move", hold=1, target=(3, 1, 0))
        for _ in range(20):
            page.single_step()
        assert world.call(lambda: ball.position.x) < 1, "and does not pull any more"


@pytest.mark.parametrize("end", ["destroy", "reset"])
def test_a_plug_that_leaves_the_hand_without_being_let_go_leaves_no_ghost(
    system: iota.System, run_world: Runner, end: str
) -> None:
    system.gravity = (0, 0, 0)
    place = system.body().particle((0, 1, 0))
    place.nail()
    plug = system.body().particle((0.3, 1, 0))
    slot = plug.body.slot
    world = iota.World(system, ground=None)
    world.tools.socket(place, [plug], within=0.2, pull=1.0)
    with PageClient(run_world(world)) as page:
        page.send("grab_start", hold=1, body=page.body(slot), local_point=(0, 0, 0), target=(0.3, 1, 0))
        page.wait_for(lambda: page.entities["marker"])
        world.call(lambda: plug.body.destroy() if end == "destroy" else world.reset())
        page.wait_for(lambda: not page.entities["marker"])
        assert world.call(lambda: not list(system.bonds)), "nothing draws it any more"


def test_forces_are_shown_as_they_are(chain: list[iota.Body], run_world: Runner) -> None:
    system = chain[0].system
    for _ in range(2400):
        system.step(1 / 120)
    weight = 9.81 * sum(link.mass for link in chain)
    world = iota.World(system)
    forces = world.tools.show_forces(scale=1.0)
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.entities["arrow"]) == 1 + 2 * 5)
        nail = next(arrow for arrow in page.entities["arrow"].values() if arrow["color"] == 0xD0402B)
        assert nail["vector"] == pytest.approx((0, weight, 0), abs=0.02 * weight)
        world.call(lambda: chain[2].particles[1].separate(chain[3].particles[0]))
        page.wait_for(lambda: len(page.entities["arrow"]) == 1 + 2 * 4)
        world.call(forces.destroy)
        page.wait_for(lambda: not page.entities["arrow"])


def test_articulates_have_colors_of_their_own_also_after_a_break(chain: list[iota.Body], run_world: Runner) -> None:
    world = iota.World(chain[0].system)
    shown = world.tools.show_articulates()

    def colors(page: PageClient) -> dict[int, int]:
        return {
            slot: paint["colors"][index if len(paint["colors"]) > 1 else 0]
            for paint in page.entities["paint"].values()
            for index, slot in enumerate(paint["bodies"])
        }

    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(colors(page)) == 6)
        assert len(set(colors(page).values())) == 1
        world.call(lambda: chain[2].particles[1].separate(chain[3].particles[0]))
        page.wait_for(lambda: len(set(colors(page).values())) == 2)
        for part in (chain[:3], chain[3:]):
            assert len({colors(page)[link.slot] for link in part}) == 1
        world.call(shown.destroy)
        page.wait_for(lambda: not page.entities["paint"])


def test_a_carried_body_follows_the_hand_exactly_with_all_that_hangs_on_it_and_is_thrown(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    links = iota.builder.chain(3, 0.6, top=(0, 2, 0), nailed=False).realize(system).bodies
    other = system.body(shape=iota.Sphere(0.1), mass=1.0, position=(3, 2, 0))
    world = iota.World(system, ground=0.0)
    carry = world.tools.carry(links[0])
    start = links[0].center_of_mass
    with PageClient(run_world(world)) as page:
        grip = (start.x, start.y + 0.05, start.z)
        page.send("grab_start", hold=1, body=page.body(links[0].slot), local_point=(0.05, 0, 0), target=grip)
        page.wait_for(lambda: world.call(lambda: links[0].kind == "scripted"))
        page.send("grab_move", hold=1, target=(grip[0] + 0.5, grip[1] + 1.0, grip[2]))
        moved = start + iota.Vec3(0.5, 1.0, 0)
        page.wait_for(lambda: world.call(lambda: abs(links[0].center_of_mass - moved) < 1e-6))
        assert world.call(lambda: abs(links[2].center_of_mass - links[0].center_of_mass)) < 0.45, (
            "the others hang on it"
        )
        # Thrown: the hand goes on, 4 cm in each step, and lets go. Single steps keep its speed on a busy machine.
        page.send("control", command=0, value=0)
        page.wait_for(lambda: page.last["world_state"]["paused"])
        for step in range(1, 31):
            page.send("grab_move", hold=1, target=(grip[0] + 0.5 + 0.04 * step, grip[1] + 1.0, grip[2]))
            page.single_step()
        page.send("grab_end", hold=1)
        page.send("control", command=1, value=0)
        page.wait_for(lambda: world.call(lambda: links[0].kind == "dynamic"))
        assert world.call(lambda: sum(link.velocity.x for link in links)) > 3
        # Others are still pulled by a spring; a reset takes all out of the hand.
        page.send("grab_start", hold=2, body=page.body(other.slot), local_point=(0, 0, 0), target=(3, 2, 0))
        page.wait_for(lambda: world.call(lambda: world.users.held() == other))
        assert world.call(lambda: other.kind) == "dynamic"
        page.send("grab_start", hold=3, body=page.body(links[0].slot), local_point=(0, 0, 0), target=grip)
        page.wait_for(lambda: world.call(lambda: links[0].kind == "scripted"))
        world.call(world.reset)
        page.wait_for(lambda: world.call(lambda: not carry._held))
        assert world.call(lambda: links[0].kind) == "dynamic"
        page.send("grab_start", hold=4, body=page.body(links[0].slot), local_point=(0, 0, 0), target=grip)
        page.wait_for(lambda: world.call(lambda: links[0].kind == "scripted"))
        world.call(carry.destroy)
        assert world.call(lambda: links[0].kind) == "dynamic"
