# SPDX-License-Identifier: Apache-2.0
"""The playground: what users place, connect, save and take away as a script."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

import iota
from iota import looks
from iota.studies import playground
from iota.studies._scene import BEAM, FRAME, Scene


@pytest.fixture
def world(tmp_path: Path) -> iota.World:
    return playground.build(tmp_path)


def act(world: iota.World, name: str, body: iota.Body) -> None:
    world._state.actions[name].hook.function(iota.Event(world.system, name, target=body, notices=world._state.notices))


def widget(world: iota.World, label: str) -> Any:
    return next(thing for thing in world.drawings.things if getattr(thing, "label", "") == label)


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


def test_a_click_places_the_chosen_thing_where_the_ray_meets_the_middle_or_the_ground(world: iota.World) -> None:
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


def test_a_shape_seen_through_is_where_a_click_will_place_the_chosen_thing(world: iota.World) -> None:
    (frame,) = (thing for thing in world.drawings.things if isinstance(thing, iota.world.Frame))
    ghosts = [thing for thing in world.drawings.things if getattr(thing, "on", None) is frame]
    (listener,) = world._state.listeners.of("pointer", None)

    def shown(what: str, origin: tuple[float, ...], direction: tuple[float, ...], pointer: str = "mouse") -> Any:
        widget(world, "place").value = what
        event = iota.Event(
            world.system, "pointer", origin=iota.Vec3(*origin), direction=iota.Vec3(*direction), pointer=pointer
        )
        listener.hook.function(event)
        visible = [ghost for ghost in ghosts if ghost.visible]
        assert len(visible) <= 1
        return frame.at if visible else None

    assert len(ghosts) == len(playground.PLACE)
    for number, what in enumerate(playground.PLACE):
        way = (0.4 + 0.2 * number, -0.05, -1)
        at = shown(what, (0, 1.5, 4), way)
        assert at is not None
        click(world, what, (0, 1.5, 4), way)
        center = world.system.bodies[-1].center_of_mass
        assert abs(center.x - at.x) < 1e-9 and center.y <= at.y + 1e-9
    assert shown("nothing", (0, 1.5, 4), (0, 0, -1)) is None
    assert shown("box", (0, 1.5, 4), (0, 0, -1)) is not None
    assert shown("box", (0, 1, 4), (0, 1, 0)) is None, "in the sky"
    box = world.system.bodies[0]
    assert shown("box", (box.center_of_mass.x, box.center_of_mass.y, 4), (0, 0, -1)) is None, (
        "a click takes what is there"
    )
    assert shown("box", (0, 1.5, 4), (0, 0, -1), "touch 1") is None


def test_nails_ties_and_combining_act_and_are_undone(world: iota.World) -> None:
    system = world.system
    ball = playground.PLACE["ball"](world, iota.Vec3(2, 1.5, 0))
    box = playground.PLACE["box"](world, iota.Vec3(2.3, 1.5, 0))
    act(world, "nail", ball)
    act(world, "tie", ball)
    act(world, "tie", box)
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


def test_a_tie_at_the_axle_of_a_rod_is_saved(world: iota.World) -> None:
    rod = playground.PLACE["rod"](world, iota.Vec3(2, 1.5, 0))
    world.system.revolute(rod, None, at=(2.1, 1.5, 0), axis=(0, 0, 1))
    (listener,) = world._state.listeners.of("press", rod)
    listener.hook.function(iota.Event(world.system, "press", target=rod, point=iota.Vec3(2.1, 1.5, 0)))
    act(world, "tie", rod)
    act(world, "tie", world.system.bodies[0])
    texts = told(world)
    push(world, "save")
    assert [text.split(":")[0] for text in texts] == ["Saved"]


def test_a_saved_world_is_loaded_and_goes_on_as_before(world: iota.World, tmp_path: Path) -> None:
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


def test_axles_ropes_and_rods_hold_their_bodies(world: iota.World) -> None:
    system = world.system
    wheel = playground.PLACE["box"](world, iota.Vec3(2, 1.5, 0))
    act(world, "axle", wheel)
    act(world, "axle", wheel)
    (axle,) = system.constraints
    assert axle.kind == "revolute" and axle.b is None
    arm = playground.PLACE["rod"](world, iota.Vec3(2.25, 1.5, 0))
    act(world, "axle", arm)
    act(world, "axle", wheel)
    assert [joint.b for joint in system.constraints] == [None, arm]
    for kind in ("rope", "rod"):
        widget(world, "tie").value = kind
        ball = playground.PLACE["ball"](world, iota.Vec3(3.2, 1.5, 0))
        act(world, "tie", ball)
        act(world, "tie", arm)
        assert system.constraints[-1].kind == kind
    run(world, 2.0)
    assert abs(wheel.center_of_mass - (2, 1.5, 0)) < 1e-6
    assert max(joint.gap for joint in system.constraints) < 1e-6
    world.undo()
    assert len(system.constraints) == 3


def test_an_axle_that_two_rods_cannot_hold_is_refused_in_a_card(world: iota.World) -> None:
    texts, before = told(world), len(world.system.constraints)
    act(world, "axle", playground.PLACE["rod"](world, iota.Vec3(2, 1.5, 0)))
    act(world, "axle", playground.PLACE["rod"](world, iota.Vec3(2, 1.8, 0)))
    assert "That cannot be done" in texts[-1] and "neither side holds the axis" in texts[-1]
    assert len(world.system.constraints) == before


def build_all_kinds(world: iota.World) -> None:
    """Everything that a saved playground may have: bodies of parts with and without solids, joints with all options, ties."""
    system, place = world.system, playground.PLACE
    rods = [place["rod"](world, iota.Vec3(2, y, 0)) for y in (1.0, 1.6)]
    rods[0].combine(rods[1])
    rods[0].combine(place["ball"](world, iota.Vec3(2, 1.3, 0)))
    ball = place["ball"](world, iota.Vec3(3, 2, 0))
    ball.combine(place["particle"](world, iota.Vec3(3, 1, 0)))
    ball.combine(place["box"](world, iota.Vec3(3.2, 2, 0)))
    world.draw(ball, [looks.solid("steel", "#c8343c"), looks.torus(0.2, 0.01, "brass", offset=(0, 0.1, 0))])
    wheel, arm = place["box"](world, iota.Vec3(-2, 2, 0)), place["rod"](world, iota.Vec3(-2, 1.5, 0))
    world.draw(wheel, {"plain": looks.solid("paint"), "wood": looks.solid("wood")})
    hook = arm.particles[0].position
    system.revolute(wheel, arm, at=hook, axis=(0, 0, 1), limits=(-0.5, 0.5), friction=0.1, break_torque=1e3)
    system.revolute(wheel, at=(-2, 2, 0), axis=(0, 0, 1), motor=(1, 0.2), spring=(1, 0.1, 0.2))
    system.cylindrical(ball, at=(3, 2, 0), axis=(1, 0, 0), angle={"limits": (-1, 1)}, slide={"friction": 0.1})
    system.rope(wheel.attachment((-2.1, 2, 0)), rods[0].particles[0], break_force=1e4)
    system.rod(wheel.attachment((-1.9, 2, 0)), place["particle"](world, iota.Vec3(-1.5, 2.4, 0)).particles[0])
    system.bond(arm.particles[1], rods[0].particles[1], "spring", stiffness=20, break_force=50)


def plain(scene: Scene) -> Any:
    """As in a file, with tuples as lists."""
    return json.loads(json.dumps(scene.to_json()))


def assert_alike(one: Any, other: Any, place: str = "", within: float = 1e-9) -> None:
    if isinstance(one, dict):
        # A motion that is 0 is left out; one of 1e-12 may become 0 by rounding.
        still = {key: [0.0, 0.0, 0.0] for key in ("velocity", "spin") if key in one or key in other}
        one, other = still | one, still | other
        assert one.keys() == other.keys(), place
        for key in one:
            assert_alike(one[key], other[key], f"{place}/{key}", within)
    elif isinstance(one, list):
        assert len(one) == len(other), place
        for number, (a, b) in enumerate(zip(one, other, strict=True)):
            assert_alike(a, b, f"{place}/{number}", within)
    else:
        assert one == (pytest.approx(other, abs=within) if isinstance(other, float) else other), place


def test_saved_loaded_and_exported_it_is_the_same_world(world: iota.World, tmp_path: Path) -> None:
    """From the file and from the script: the same bodies, joints, ties and looks, and the same motion afterwards."""
    build_all_kinds(world)
    run(world, 0.5)
    push(world, "save")
    saved = json.loads((tmp_path / "playground.json").read_text())
    counts = {name: len(saved["structure"][name]) for name in ("joints", "ties", "looks", "nails", "hinges")}
    assert counts == {"joints": 3, "ties": 2, "looks": 4, "nails": 2, "hinges": 7} and len(saved["combined"]) == 4
    push(world, "load")
    assert world.system.validate() == []
    loaded = iota.World(iota.System(damping=world.system.damping))
    for start, end in FRAME:
        loaded.add_strut(start, end, BEAM)
    Scene.from_json(saved).realize(loaded)
    assert_alike(plain(Scene.of(loaded)), saved)

    script = tmp_path / "loaded.py"
    printed = "\nprint(world.system.state_hash())\n"
    script.write_text(Scene.from_json(saved).script(world.system) + printed)
    done = subprocess.run(
        [sys.executable, "-m", "iota", "run", script, "--headless", "--seconds", "1"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    loaded._run_headless(1.0)
    assert int(done.stdout) == loaded.system.state_hash(), "the script and the file make worlds of the same bits"

    push(world, "export script")
    assert "made.joint('revolute'" in (tmp_path / "playground.py").read_text()


def test_constraints_that_cannot_be_saved_are_named(world: iota.World) -> None:
    ball = playground.PLACE["ball"](world, iota.Vec3(2, 1.5, 0))
    joint = world.system.revolute(ball, at=(2, 1.5, 0), axis=(1, 0, 0))
    joint.angle.servo = (1.0, 5.0)
    with pytest.raises(ValueError, match="servo cannot be saved"):
        Scene.of(world)
    joint.angle.servo = None
    joint.compliance = 1e-6
    with pytest.raises(ValueError, match="constraint 0, a revolute with compliance, cannot be saved"):
        Scene.of(world)
    joint.destroy()
    world.system.on_surface(ball.attachment((2, 1.4, 0)), iota.HalfSpace((0, 1, 0)), at=(2, 1.4, 0))
    with pytest.raises(ValueError, match="a surface, cannot be saved"):
        Scene.of(world)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "No such file"),
        (b"", "this is not JSON: Expecting value: line 1"),
        (b"[1, 2", "this is not JSON: Expecting"),
        (b"\xff\xfe\x00", "not a text in UTF-8"),
        (b"[" * 100_000, "nested too deeply"),
        (b"[]", "a saved playground must be an object, not []"),
        (b"{}", "not a saved playground: it has no 'structure'"),
        (
            b'{"structure": {"points": {"position": [[0, 1, 0]], "mass": [1, 2]}}, "combined": []}',
            "mass has 2 rows for 1",
        ),
        (b'{"structure": {"points": {"position": [[0, 1, 0]], "mass": [1]}, "hinges": [[0, 7]]}, "combined": []}', "7"),
        (b'{"structure": {"points": {"position": [[0, 1, 0]], "mass": [1]}}, "combined": [[0, 9]]}', "not there"),
    ],
)
def test_a_file_that_cannot_be_loaded_leaves_the_world_as_it_is(
    world: iota.World, tmp_path: Path, content: bytes | None, words: str
) -> None:
    if content is not None:
        (tmp_path / "playground.json").write_bytes(content)
    before, texts = world.system.state_hash(), told(world)
    push(world, "load")
    assert world.system.state_hash() == before
    assert len(texts) == 1 and "playground.json" in texts[0] and words in texts[0], texts


def test_every_damage_to_a_saved_file_is_told_in_one_line_that_names_it(world: iota.World, tmp_path: Path) -> None:
    ball = playground.PLACE["ball"](world, iota.Vec3(2, 1.5, 0))
    world.system.revolute(ball, at=(2, 1.5, 0), axis=(0, 0, 1), limits=(-1, 1))
    push(world, "save")
    file, random = tmp_path / "playground.json", Random(3)
    good = file.read_text()
    before, told_cases = world.system.state_hash(), 0
    for _ in range(120):
        file.write_text(damaged(good, random))
        texts = told(world)
        push(world, "load")
        if not texts:  # what still is a playground
            world.undo()
            continue
        told_cases += 1
        assert len(texts) == 1 and texts[0].startswith(f"That cannot be done: {file}: "), texts
        assert not re.search(r"\n|Error|object is not|NoneType|array|argument must", texts[0]), texts
        assert world.system.state_hash() == before
    assert told_cases > 60


def damaged(text: str, random: Random) -> str:
    """A saved file that was cut, or in which a value is gone or is another one."""
    if random.random() < 0.2:
        return text[: random.randrange(len(text))]
    data = json.loads(text)
    inner, holder = data, data
    while inner and isinstance(inner, dict | list) and random.random() < 0.8:
        holder, keys = inner, list(inner) if isinstance(inner, dict) else list(range(len(inner)))
        key = random.choice(keys)
        inner = holder[key]
    if holder is inner:
        return "[]"
    if random.random() < 0.4:
        del holder[key]
    else:
        holder[key] = random.choice(
            [None, True, -1, 1e308, float("nan"), "x", "", [], [[]], {}, {"a": 1}, 10**30, [0] * 4]
        )
    return json.dumps(data)


def test_files_stay_in_their_folder_and_failures_are_reported(world: iota.World, tmp_path: Path) -> None:
    texts = told(world)
    for name in ("../out", "/tmp/out", "a b", "", "x" * 300):
        widget(world, "file").value = name
        push(world, "save")
    assert len(texts) == 5 and not any(file.is_file() for file in tmp_path.iterdir())
    lost = playground.build(tmp_path / "no folder")
    texts = told(lost)
    push(lost, "save")
    assert "cannot be written: No such file or directory" in texts[0]
