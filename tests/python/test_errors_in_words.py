# SPDX-License-Identifier: Apache-2.0
"""Whatever a script passes to the engine, a refusal is a sentence about what it wrote: no text of the binding's."""

from __future__ import annotations

import inspect
import math
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sweep

import iota
from iota import _core, arguments, builder, elsewhere, looks
from iota.world.callbacks import one_line
from iota.world.pages import Pages
from iota.world.world import ELSEWHERE, PARTS

# What nanobind, C++ and Python's object system say, and scripts do not.
RAW = re.compile(
    r"incompatible function|no constructor|nanobind|iota\._core|std::|bad_cast|Invoked with|has no setter|NoneType"
)
WRONG: list[Any] = [None, 5, -1, 2.5, 2**70, "word", b"bytes", (), (1,), (1, 2), {1, 2, 3}, {}, [[1, 2], [3]], object()]
# They take the process along, open files or ports, or give the system to another thread.
LEFT_OUT = {"Server", "Room", "load", "save", "adopt", "profile", "replay"}


def instances(scene: sweep.Scene) -> dict[str, Any]:
    """One of each type that a script meets."""
    s = scene.system
    emitted = iota.types.StepReport(step=1, time=0.0, dt=0.1)
    things = [
        s, scene.box, scene.point, scene.surfel, scene.spring, scene.line, scene.hinge, scene.hinge.angle, scene.crowd,
        scene.well, scene.pair_force, scene.law, scene.fountain, scene.grip, emitted, emitted.energy, iota.Vec3(1, 2, 3),
        iota.Box((1, 1, 1)), iota.Sphere(1), s.diagnose(scene.box), scene.rods[0].articulate, s.edit(),
    ]  # fmt: skip
    return {type(thing).__name__: thing for thing in things}


def members(kind: type) -> Iterator[tuple[str, Any]]:
    for name in dir(kind):
        if not name.startswith("_") and name not in LEFT_OUT:
            yield name, getattr(kind, name)


def refusal(call: Callable[[], Any]) -> str:
    """What a call is refused with, with the type of it; empty where it is taken."""
    try:
        call()
    except (TypeError, ValueError, AttributeError, RuntimeError, OverflowError) as error:
        return f"{type(error).__name__}: {error}"
    except Exception:  # of the script's own kind: a stop of an iteration, a missing key
        return ""
    return ""


TYPES = sorted(instances(sweep.Scene()))


@pytest.mark.parametrize("kind", TYPES)
@pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::numpy.exceptions.VisibleDeprecationWarning"
)
def test_no_method_or_property_answers_wrong_arguments_with_a_raw_text(kind: str) -> None:
    raw = []
    for name, member in members(type(instances(sweep.Scene())[kind])):
        thing = instances(sweep.Scene())[kind]
        calls: list[Callable[[], Any]]
        if isinstance(member, property):
            calls = [lambda t=thing, n=name, v=value: setattr(t, n, v) for value in WRONG]
        else:
            method = getattr(thing, name)
            calls = [
                method,
                lambda m=method: m(no_such_argument=1),
                lambda m=method: m(*range(12)),
                *(lambda m=method, v=value: m(v) for value in WRONG),
                *(lambda m=method, v=value: m(v, v) for value in WRONG),
            ]
            words = re.findall(r"(\w+):", str(getattr(member, "__nb_signature__", ((("",),),))[0][0]))
            calls += [lambda m=method, w=word, v=value: m(**{w: v}) for word in words[1:] for value in WRONG]
        for call in calls:
            if RAW.search(text := refusal(call)):
                raw.append(f"{kind}.{name}: {text[:200]}")
    assert not raw, "\n".join(raw[:20])


@pytest.mark.parametrize("kind", sorted(n for n, t in vars(_core).items() if isinstance(t, type) and n not in LEFT_OUT))
def test_no_type_answers_wrong_arguments_with_a_raw_text(kind: str) -> None:
    make = getattr(_core, kind)
    calls: list[Callable[[], Any]] = [make, lambda: make(no_such_argument=1), lambda: make(*range(12))]
    calls += [lambda v=value: make(v) for value in WRONG] + [lambda v=value: make(v, v) for value in WRONG]
    raw = [text for call in calls if RAW.search(text := refusal(call))]
    assert not raw, "\n".join(raw)


def test_functions_of_the_module_answer_in_sentences() -> None:
    system = iota.System()
    text = refusal(lambda: _core.make_bodies(system, 3, 4, 5, 6))
    assert "make_bodies" in text and not RAW.search(text)


MISTAKES: dict[str, tuple[Callable[[sweep.Scene], Any], str]] = {
    "motor of one number": (
        lambda c: setattr(c.hinge.angle, "motor", 5),
        r"motor must be 2 numbers or None, not 5: \(speed, largest torque or force\)",
    ),
    "mass None": (lambda c: setattr(c.point, "mass", None), "mass must be a number, not None"),
    "a handle called": (lambda c: iota.Particle(c.system), "a Particle is made by Body.particle$"),
    "too many numbers": (lambda c: iota.Box(1, 1, 1), r"Box takes 2 arguments by place \(size, rounding\), not 3"),
    "a particle for a body": (lambda c: c.box.combine(c.point), "combine: other must be a Body, not <Particle"),
    "a body for a particle": (lambda c: c.system.bond(c.box, c.point, "spring"), "bond: p must be a Particle, not <Body"),
    "an attribute as an argument": (
        lambda c: c.box.particle(V, spin=(0, 0, 1)),
        "has no argument 'spin'; assign it to the result: particle.spin = ...",
    ),
    "a misspelled argument": (
        lambda c: c.system.revolute(c.box, c.ball, at=V, axis=V, limit=3),
        r"no argument 'limit'; did you mean 'limits'\? It takes a, b, at,",
    ),
    "a missing argument": (lambda c: c.system.revolute(c.box, c.ball), "revolute needs at: 2 or 3 numbers"),
    "an argument by place": (
        lambda c: c.system.revolute(c.box, c.ball, V, V),
        "by name also at, axis, limits",
    ),
    "a misspelled attribute": (lambda c: setattr(c.point, "postion", V), "no attribute 'postion'; did you mean 'position'"),
    "a read-only attribute": (
        lambda c: setattr(c.hinge, "angle", 0.5),
        r"Constraint.angle can be read but not assigned: it is a JointCoordinate; assign .*\.angle\.motor",
    ),
    "a method": (lambda c: setattr(c.point, "nail", V), "Particle.nail is a method and cannot be assigned"),
    "a set": (lambda c: setattr(c.point, "velocity", {1, 2, 3}), r"velocity must be 2 or 3 numbers, not \{1, 2, 3\}"),
    "density and mass": (
        lambda c: c.system.body(shape=iota.Sphere(1), density=3, mass=1),
        "density or mass",
    ),
    "density without a shape": (lambda c: c.system.body(density=3), "density, mass, position.* are of bodies with a shape"),
    "a spring": (lambda c: c.system.bond(c.p, c.point, "spring"), r"a spring needs stiffness=\.\.\., N/m"),
    "a tether": (lambda c: c.system.bond(c.p, c.point, "tether", length=1), r"a tether needs stiffness"),
    "a particle of a system": (lambda c: c.system.particle(V), r"a System has no attribute 'particle': it is body.particle"),
    "a nail of a body": (lambda c: c.box.nail(), r"a Body has no attribute 'nail': it is particle.nail\(\)"),
    "the shape of a body": (lambda c: c.box.shape, r"a Body has no attribute 'shape': it is body.solids\[0\].shape"),
    "a friction": (lambda c: setattr(c.box, "friction", 0.5), r"no attribute 'friction': it is body.material = iota.Material"),
    "a box that is added": (lambda c: c.system.add_box(), r"no attribute 'add_box': it is system.body\(shape=iota.Box"),
    "a body that is created": (lambda c: c.system.create_body(), r"no attribute 'create_body': it is system.body\(\.\.\.\)"),
    "a pin": (lambda c: c.p.pin(), r"a Particle has no attribute 'pin': it is particle.nail\(\)"),
    "another library's shape": (lambda c: iota.Cube, "module 'iota' has no attribute 'Cube': it is iota.Box"),
    "a coupling of one": (lambda c: c.system.couple([(c.hinge.angle, 1)]), "couples two or more coordinates"),
    "a scripted body that flies": (lambda c: c.system.body("scripted", shape=iota.Sphere(1), velocity=V), "set its position"),
}  # fmt: skip
V = (0.1, 0.2, 0.3)


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_named(name: str) -> None:
    scene = sweep.Scene()
    before = scene.system.state_hash()
    use, text = MISTAKES[name]
    with pytest.raises((TypeError, ValueError, AttributeError), match=text):
        use(scene)
    assert scene.system.state_hash() == before


def test_what_stands_in_for_a_missing_name_exists() -> None:
    """The names in iota.elsewhere are not those of things that are there, and the places that they name are."""
    world = iota.World(iota.System())
    body = world.system.body(shape=iota.Box((1, 1, 1)))
    things = {"body": body, "particle": body.particles[0], "system": world.system, "world": world, "iota": iota}
    for owner, words in (
        ("body", elsewhere.OF_BODY),
        ("particle", elsewhere.OF_PARTICLE),
        ("system", elsewhere.OF_SYSTEM),
        ("iota", elsewhere.OF_MODULE),
    ):
        for word, place in words.items():
            if word != "ball":
                assert not hasattr(things[owner], word), f"{owner}.{word} exists"
            for named, path in re.findall(r"\b(body|particle|system|world|iota)((?:\.\w+)+)", place):
                found = things[named]
                for part in path.split(".")[1:]:
                    found = getattr(found, part)
            plain = re.fullmatch(r"(\w+)(\(.*\)|: .*|\.\w)?", place)
            if plain and plain[1] not in things and owner != "iota":
                assert plain[1] in ("a",) or hasattr(things[owner], plain[1]), f"{owner}.{word} -> {place}"


def test_good_calls_cost_nothing_more() -> None:
    """Arguments are looked at only after a call was refused."""
    system = iota.System()
    particle = system.body().particle((0, 1, 0))
    particle.velocity = np.array([1.0, 2.0, 3.0])
    assert particle.velocity == (1, 2, 3)


# --- functions in Python -------------------------------------------------------------------------------------------------

# What Python and numpy say of wrong arguments, and scripts do not.
RAW_PYTHON = re.compile(
    RAW.pattern
    + r"|unexpected keyword|positional argument|unsupported operand|not iterable|real number|could not convert"
    r"|not callable|object has no attribute|truth value|argument after|to unpack|setting an array|argument must be"
    r"|not supported between|cannot convert|has no len|not subscriptable|unhashable|inhomogeneous|ufunc|no attribute '__"
)
# They run the world, or open files or ports; `call` and `at` of a frame call the script's own.
RUN = {
    "run",
    "start",
    "serve",
    "step",
    "advance",
    "call",
    "stop",
    "close",
    "client_module",
    "record",
    "act",
    "screenshot",
    "ears",
}


OF_A_WORLD = {part.__name__.lower(): part for part in PARTS if part is not Pages}  # its functions open files


def public_functions(thing: Any) -> Iterator[tuple[str, Callable[..., Any]]]:
    for name in getattr(thing, "__all__", None) or dir(thing):
        member = getattr(thing, name)
        if thing is looks and getattr(member, "__module__", "") != looks.__name__:
            continue
        if not name.startswith("_") and name not in RUN | LEFT_OUT and callable(member):
            if inspect.isfunction(member) or (
                inspect.isclass(member) and not issubclass(member, BaseException | tuple)
            ):
                yield name, member


def given_wrongly(function: Callable[..., Any], rest: dict[str, Any]) -> Iterator[Callable[[], Any]]:
    """Calls with too much, too little, unknown words, and each argument of each wrong kind beside good ones in `rest`."""
    yield function
    yield lambda: function(no_such_argument=1)
    yield lambda: function(*range(12))
    words = [
        p for p in inspect.signature(function).parameters.values() if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)
    ]
    good = {p.name: rest[p.name] for p in words if p.name in rest and p.default is p.empty}
    for parameter in words:
        if parameter.kind is not parameter.POSITIONAL_ONLY:
            yield from (lambda w=parameter.name, v=value: function(**(good | {w: v})) for value in WRONG)
    yield from (lambda v=value: function(v) for value in WRONG)


@pytest.mark.parametrize("of", ["world", *OF_A_WORLD, "looks", "builder", "iota"])
@pytest.mark.filterwarnings("ignore::numpy.exceptions.VisibleDeprecationWarning", "ignore::RuntimeWarning")
def test_no_call_of_the_script_layer_is_refused_with_a_raw_text(
    of: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # some make files
    scene = sweep.Scene()
    rest = {
        "at": (0, 1, 0), "to": (0, 2, 0), "text": "word", "label": "word", "minimum": 0, "maximum": 1, "look": looks.sphere(0.1),
        "position": (0, 1, 0), "target": (0, 0, 0), "positions": [(0, 0, 0)], "points": [(0, 0, 0)], "radius": 0.1,
        "material": "wood", "length": 1.0, "size": (1, 1, 1), "options": ["a"], "name": "word", "shape": iota.Sphere(1),
        "bodies": [scene.box], "place": scene.point, "plugs": [scene.p], "origin": (0, 5, 0), "direction": (0, -1, 0),
        "kind": "spring", "start": (0, 0, 0), "end": (0, 1, 0), "title": "word", "particles": [scene.point], "system": scene.system,
    }  # fmt: skip
    raw = []
    known = {"world": iota.World, **OF_A_WORLD, "looks": looks, "builder": builder, "iota": iota}
    names = [name for name, _ in public_functions(known[of])]
    assert names
    for name in names:
        world = iota.World(sweep.Scene().system)
        thing: Any = {"world": world, "looks": looks, "builder": builder, "iota": iota}.get(of) or getattr(world, of)
        if isinstance(function := getattr(thing, name), type) and function.__module__ == "iota._core":
            continue
        for call in given_wrongly(function, rest):
            if RAW_PYTHON.search(text := refusal(call)):
                raw.append(f"{of}.{name}: {text[:160]}")
    assert not raw, f"{len(raw)}\n" + "\n".join(dict.fromkeys(raw))


PYTHON_MISTAKES: dict[str, tuple[Callable[[iota.World], Any], str]] = {
    "another library's word": (
        lambda w: iota.Camera(eye=(0, 1, 2)),
        r"Camera has no argument 'eye'; did you mean 'position'\? It takes position, target",
    ),
    "a misspelled word": (lambda w: w.label("a", colour="#fff"), "label has no argument 'colour'; did you mean 'color'"),
    "the beginning of a word": (lambda w: w.drawings.shape(looks.sphere(1), pos=V), "shape has no argument 'pos'; did you mean 'position'"),
    "a word of the result": (lambda w: w.label("a", visible=False), r"assign it to the result: label.visible = \.\.\."),
    "a word of a look": (lambda w: looks.sphere(0.1, colour="#ffffff"), "has no argument 'colour'; did you mean 'color'"),
    "a missing one": (lambda w: w.controls.slider("a"), "slider needs minimum: a number"),
    "too many": (lambda w: w.on_reset(1, 2), r"on_reset takes 1 argument by place \(function\), not 2"),
    "a decorator without parentheses": (lambda w: w.every(print), "every: period must be a number, not <built-in function"),
    "a number for a place": (lambda w: w.label("a", at=5), "at: must be a particle, a body, .* or 2 or 3 numbers, not 5"),
    "a text for a number": (lambda w: w.controls.slider("a", 0, "ten"), "maximum:? must be a number, not 'ten'"),
    "a camera without depth": (lambda w: iota.Camera((1,)), r"position: must be 2 or 3 numbers, not \(1,\)"),
    "a camera nowhere": (lambda w: iota.Camera((math.nan, 0, 0)), "position: must be finite"),
    "a misspelled attribute of a thing": (
        lambda w: setattr(w.label("a"), "txt", "b"), "a Label has no attribute 'txt'; did you mean 'text'",
    ),
    "a misspelled attribute of a world": (
        lambda w: setattr(w, "pause", True), "a World has no attribute 'pause'; did you mean 'world.clock.paused'",
    ),
    "another library's drawing": (lambda w: w.polyline([V, V]), r"no attribute 'polyline': it is world.drawings.line\(points\)"),  # type: ignore[attr-defined]
    "another library's shape": (lambda w: w.polygon([V]), r"no attribute 'polygon': it is world.drawings.shape\(looks.polygon\("),  # type: ignore[attr-defined]
    "what the system has": (lambda w: w.contacts, "no attribute 'contacts': it is world.system.contacts"),  # type: ignore[attr-defined]
    "what is not in a world": (lambda w: w.pausd, "a World has no attribute 'pausd'; did you mean 'world.clock.paused'"),  # type: ignore[attr-defined]
    "what is not in a thing": (lambda w: w.label("a").positon, "a Label has no attribute 'positon'; did you mean 'at'"),  # type: ignore[attr-defined]
    "what a thing has by another name": (lambda w: setattr(w.label("a"), "positon", V), "no attribute 'positon'; did you mean 'at'"),
    "a method": (lambda w: setattr(w, "reset", 1), "World.reset is a method and cannot be assigned"),
    "what can only be read": (lambda w: setattr(w, "title", "x"), "World.title can be read but not assigned"),
    "a part": (lambda w: setattr(w, "drawings", []), "World.drawings can be read but not assigned"),
    "what a part has": (lambda w: w.ray(V, V), "a World has no attribute 'ray': it is world.queries.ray$"),  # type: ignore[attr-defined]
    "what is assigned to a part": (lambda w: setattr(w, "paused", True), "no attribute 'paused': it is world.clock.paused$"),
    "what is near a name of a part": (lambda w: w.sliider, "did you mean 'world.controls.slider'"),  # type: ignore[attr-defined]
    "a misspelled attribute of a part": (lambda w: setattr(w.clock, "pausd", True), "a Clock has no attribute 'pausd'; did you mean 'paused'"),
    "a misspelled function of a part": (lambda w: w.queries.overlaps(V, V), "a Queries has no attribute 'overlaps'; did you mean 'overlap'"),  # type: ignore[attr-defined]
}  # fmt: skip


@pytest.mark.parametrize("name", PYTHON_MISTAKES)
def test_a_mistake_in_the_script_layer_is_named(name: str) -> None:
    world = iota.World(iota.System())
    things = len(world.drawings.things)
    use, text = PYTHON_MISTAKES[name]
    with pytest.raises((TypeError, ValueError, AttributeError), match=text):
        use(world)
    assert len(world.drawings.things) - things <= 1


def test_the_listed_names_exist() -> None:
    world = iota.World(iota.System())
    assert {"ray", "slider", "held", "polyline"} <= ELSEWHERE.keys()
    for use in ELSEWHERE.values():
        (place,) = re.findall(r"^world((?:\.\w+)+)", use)
        thing: Any = world
        for name in place.split(".")[1:]:
            assert hasattr(thing, name), use
            thing = getattr(thing, name)
        for name in re.findall(r"looks\.(\w+)", use):
            assert callable(getattr(looks, name))


def test_a_misspelled_name_in_a_callback_is_reported_with_a_near_one() -> None:
    particle = iota.System().body().particle(V)
    told = {}
    for name in ("positon", "zzz"):
        with pytest.raises(AttributeError) as failed:
            getattr(particle, name)
        told[name] = one_line(failed.value)
    assert "'Particle' object has no attribute 'positon'; did you mean 'position'? (test_errors" in told["positon"]
    assert "no attribute 'zzz' (test_errors" in told["zzz"]


def test_an_error_inside_of_a_property_is_not_taken_for_a_missing_one() -> None:
    class Game(iota.World):
        @property
        def score(self) -> int:
            return self.points_of_all  # type: ignore[attr-defined, no-any-return]

    with pytest.raises(AttributeError, match="'points_of_all'"):
        _ = Game(iota.System()).score


def test_a_style_that_no_look_has_is_refused_before_the_world_is_served() -> None:
    system = iota.System()
    world = iota.World(system, style="roap")
    world.draw(system.body().particle(V).body, {"rope": looks.sphere(0.1), "chain": looks.sphere(0.2)})
    for begin in (world.step, lambda: world.serve(port=0)):
        with pytest.raises(
            ValueError, match=r"not 'roap'; did you mean 'rope'\? \(the styles in draw are 'rope', 'chain'\)"
        ):
            begin()
    assert world.pages.url is None
    with pytest.raises(ValueError, match="no look in draw has a style"):
        iota.World(system, style="rope").step()
    iota.World(system).step()


def test_an_error_of_the_scripts_own_function_is_left_as_it_is() -> None:
    def mine(a: int) -> None:
        raise TypeError("mine")

    world = iota.World(iota.System())
    with pytest.raises(TypeError, match=r"^mine$"):
        world.call(lambda: mine(1))
    with pytest.raises(TypeError, match="missing 1 required"):
        world.call(lambda: mine())  # type: ignore[call-arg]


def test_a_raised_error_is_told_from_one_of_python_where_there_is_no_source() -> None:
    """As at a prompt."""
    scope: dict[str, Callable[[], None]] = {}
    exec("def said():\n    raise TypeError('mine')\ndef stumbles():\n    len(5)", scope)
    for name in ("said", "stumbles"):
        with pytest.raises(TypeError) as failed:
            scope[name]()
        assert arguments.is_said(failed.tb) == (name == "said")


def test_a_class_derived_from_a_world_may_have_attributes_of_its_own() -> None:
    class Game(iota.World):
        pass

    game = Game(iota.System())
    game.score = 3  # type: ignore[attr-defined]
    assert game.score == 3  # type: ignore[attr-defined]


DEGENERATE: dict[str, tuple[Callable[[iota.World], Any], str]] = {
    "a cylinder without length": (lambda w: looks.cylinder(0.1, length=0), "length of a cylinder must be between"),
    "half a ball of three segments": (lambda w: looks.half_sphere(1, segments=3), "segments must be at least 4, not 3"),
    "a polygon of one corner": (lambda w: looks.polygon([(0, 0)], 0.1), "at least three corners"),
    "a polygon in a line": (lambda w: looks.polygon([(0, 0), (1, 0), (2, 0)], 0.1), "encloses no volume"),
    "a polygon without thickness": (lambda w: looks.polygon([(0, 0), (1, 0), (0, 1)], 0), "thickness of a polygon"),
    "a look that is nowhere": (lambda w: looks.sphere(1, offset=(math.nan, 0, 0)), "offset must be 2 or 3 finite numbers"),
    "a look without a rotation": (lambda w: looks.sphere(1, rotation=(0, 0, 0, 0)), "a rotation must be finite and not zero"),
    "a look turned by nothing": (lambda w: looks.sphere(1, turn=math.nan), "turn must be a finite number"),
    "a look of a word": (lambda w: looks.Look("ball"), "a look is of a shape.*not of 'ball'"),  # type: ignore[arg-type]
    "a camera in its target": (lambda w: iota.Camera(V, V), "a target elsewhere than its position"),
    "a camera of numbers": (lambda w: setattr(w, "camera", V), "camera must be a Camera"),
    "a strut without length": (lambda w: w.add_strut(V, V, looks.cylinder(1)), "two different ends"),
    "a wall without a shape": (lambda w: w.add_static(looks.solid("wood"), V), "look must be a Look with a shape"),
    "a slider beyond its end": (lambda w: w.controls.slider("a", 0, 1, 5), "value: must be from 0 to 1, not 5"),
    "a function that is none": (lambda w: w.on_step(None), "a callback is a function, not None"),
    "a key by another name": (lambda w: w.action("go", key="spcae"), "a key is one character.* did you mean 'space'"),
    "a function in place of a key": (lambda w: w.action("go", lambda: 1), r"is a decorator: write @world.action\('go'\) above"),
    "a function in place of a start": (lambda w: w.every(1, lambda: 1), r"world.every\(1\) is a decorator"),
    "a function in place of a help": (lambda w: w.controls.button("go", lambda: 1), "is a decorator"),
    "a plot without a label": (lambda w: w.controls.plot(lambda: 1), "label: must be a text, not the function"),
    "a ground that is true": (lambda w: iota.World(w.system, ground=True), "a height or None, not True"),
    "a color in place of a material": (lambda w: looks.solid("red"), r"not 'red'; did you mean color='red'\?"),
    "a shape in place of a look": (lambda w: w.add_static(iota.Sphere(1), V), r"as in looks.box.* system.obstacle\(shape\)"),
    "the gravity of a world": (lambda w: iota.World(w.system, gravity=V), r"it is that of the system, as in iota.System\(gravity="),  # type: ignore[call-arg]
    "the gravity of a running world": (lambda w: setattr(w, "gravity", V), "it is world.system.gravity"),
    "a gravity along nothing": (lambda w: setattr(w.system, "gravity", -9.81), r"2 or 3 numbers, as in \(0, -9.81, 0\)"),
    "a body at the end of a rope": (
        lambda w: w.system.rope(w.system.body(), w.system.body()), r"is made by body.attachment\(place\)"
    ),
    "a bounce": (lambda w: iota.Material(bounce=1), "did you mean 'restitution'"),  # type: ignore[call-arg]
    "a key that is none": (lambda w: w.on_key(5), "a key is one character"),
    "a world of a number": (lambda w: iota.World(5), "a System or another Simulator, not 5"),  # type: ignore[arg-type]
    "a ground of a word": (lambda w: iota.World(iota.System(), ground="floor"), "ground must be"),  # type: ignore[arg-type]
}  # fmt: skip


@pytest.mark.parametrize("name", DEGENERATE)
def test_impossible_arguments_are_refused_where_they_are_written(name: str) -> None:
    use, text = DEGENERATE[name]
    with pytest.raises((TypeError, ValueError, AttributeError), match=text):
        use(iota.World(iota.System()))


@pytest.mark.parametrize("places", [(), (V,), (V, V), ([V],), ([],)])
def test_lines_of_no_length_are_there_and_show_nothing_or_a_point(places: Any) -> None:
    world = iota.World(iota.System())
    for thing in (world.drawings.line(*places), world.drawings.tube(*places, radius=0.1)):
        record = thing._record()
        assert record is not None and len(record["points"]) == len(np.reshape(np.array(places, float), (-1, 3)))


@pytest.mark.parametrize("color", ["#ff8000", 0xFF8000, (1, 0.502, 0), [1.0, 0.502, 0.0]])
def test_a_look_takes_colors_as_all_drawings_do(color: Any) -> None:
    assert looks.sphere(0.1, color=color).describe()["color"] == "#ff8000"


def test_parts_of_the_package_are_imported_when_they_are_first_used() -> None:
    script = """
import iota, sys
assert "iota.shapelib" not in sys.modules
print(len(iota.shapelib.polyhedron_names()))
iota.Shpere
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert int(done.stdout) > 100, done.stderr
    assert done.stderr.endswith("module 'iota' has no attribute 'Shpere'. Did you mean: 'Sphere'?\n")
