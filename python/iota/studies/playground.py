# SPDX-License-Identifier: Apache-2.0
"""Build by hand: choose what to place and click; nail, tie with springs, combine, break, copy, undo; save, load, get the script."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from pathlib import Path

import iota
from iota import looks
from iota.saving import replacing
from iota.studies._scene import BEAM, CAMERA, FRAME, TIES, Scene
from iota.world.widgets import Choice

COLORS = ((0.85, 0.3, 0.2), (0.2, 0.5, 0.6), (0.9, 0.65, 0.15), (0.35, 0.55, 0.3))
BALL, BOX = iota.Sphere(0.1), iota.Box((0.24, 0.16, 0.2), 0.015)
ROD = 0.018  # m, radius of rods
WOOD = 600.0  # kg/m^3
MOST = 400  # bodies
TOP = 2.02  # m, where the chain hangs from the beam
NAME = re.compile(r"[\w-]+")  # of a file, without its ending


def build(folder: Path | None = None) -> iota.World:
    """The world of the study. folder: where files go, None: the current one."""
    system = iota.System(damping=0.1)
    world = iota.World(
        system, title="playground: place boxes and balls of 0.2 m; drag, nail, tie and break", camera=CAMERA
    )
    world.stage(ground="#8a9670")
    start(world)
    world.offer()
    placing(world)
    connecting(world)
    files(world, folder or Path())
    return world


# --- things to place --------------------------------------------------------------------------------------------------


def particle(world: iota.World, at: iota.Vec3) -> iota.Body:
    point = world.system.body().particle(at, mass=0.3)
    point.radius, point.color = 0.05, COLORS[point.slot % len(COLORS)]
    return point.body


def rod(world: iota.World, at: iota.Vec3) -> iota.Body:
    body = world.system.body()
    for side in (-0.25, 0.25):
        body.particle(at + (side, 0, 0), mass=0.2)
    world.draw(body, looks.capsule(ROD, "brass"))
    return body


def chain(world: iota.World, at: iota.Vec3, links: int = 8, length: float = 0.8) -> iota.Body:
    made = iota.builder.chain(links, min(length, 0.95 * at.y), top=at, mass=0.6).realize(world.system).bodies
    world.draw(made, looks.capsule(ROD, "brass"))
    return made[0]


def solid(world: iota.World, at: iota.Vec3, shape: iota.Shape) -> iota.Body:
    body = world.system.body(shape=shape, density=WOOD, position=at)
    world.draw(body, looks.solid("wood"))
    return body


PLACE: dict[str, Callable[[iota.World, iota.Vec3], iota.Body]] = {
    "particle": particle, "rod": rod, "chain": chain,
    "box": lambda world, at: solid(world, at, BOX), "ball": lambda world, at: solid(world, at, BALL),
}  # fmt: skip


def start(world: iota.World) -> None:
    """Something to begin with: below a frame a chain with a box on its end, and a ball on a spring."""
    for foot, top in FRAME:
        world.add_strut(foot, top, BEAM)
    for kind, look in TIES.items():
        world.draw_ties(kind, look)
    with world.system.edit():
        top_link = chain(world, iota.Vec3(-0.7, TOP, 0), links=7)
        box = PLACE["box"](world, iota.Vec3(-0.7, TOP - 0.8 - 0.08, 0))
        end = min((p for body in top_link.articulate for p in body.particles), key=lambda p: p.position.y)
        end.combine(box.attachment(end.position))
        hook = particle(world, iota.Vec3(0.6, 2.0, 0)).particles[0]
        hook.nail()
        ball = PLACE["ball"](world, iota.Vec3(0.75, 1.3, 0))
        world.system.bond(hook, ball.attachment((0.75, 1.4, 0)), "spring", stiffness=60, damping=0.3)
        box.velocity = (0.8, 0, 0.3)


# Shapes that show what a click will place, and the turn and place of each.
GHOSTS: dict[str, tuple[looks.Look, tuple[str, float], float]] = {
    "particle": (looks.sphere(0.05), ("z", 0), 0.0),
    "rod": (looks.capsule(ROD, length=0.5), ("z", 0), 0.0),
    "chain": (looks.capsule(ROD, length=0.8), ("z", 90), -0.4),
    "box": (looks.Look(BOX), ("z", 0), 0.0),
    "ball": (looks.Look(BALL), ("z", 0), 0.0),
}
GHOST = "#2f9d92a0"


def placing(world: iota.World) -> None:
    """A click on nothing places what is chosen: on the ground, or in the upright plane through the middle, what is nearer."""
    what = world.controls.choice("place", ["nothing", *PLACE], "box", help="a click beside all things places one")
    foresee(world, what)

    def place(event: iota.Event) -> None:
        if what.value == "nothing" or event.origin is None or event.direction is None:
            return
        if len(world.system.bodies) >= MOST:
            event.notice("That is enough", f"There are {MOST} bodies. Delete some with x.")
            return
        at = aim(event.origin, event.direction)
        if at is None:
            event.notice("Nothing is there", "Click nearer to the middle.")
            return
        with world.system.edit():
            PLACE[what.value](world, at)

    world.on_click("nothing")(place)


def foresee(world: iota.World, what: Choice) -> None:
    """A shape seen through is where a click of the mouse, or of a hand, will place what is chosen."""
    frame = world.drawings.frame()
    ghosts = {
        name: world.drawings.shape(look, (0, shift, 0), turn, on=frame, color=GHOST)
        for name, (look, turn, shift) in GHOSTS.items()
    }

    def show(at: iota.Vec3 | None) -> None:
        if at is not None:
            frame.at = at
        for name, ghost in ghosts.items():
            ghost.visible = at is not None and name == what.value

    show(None)
    what.on_change(lambda: show(None))

    @world.on_pointer
    def follow(event: iota.Event) -> None:
        if event.pointer.startswith("touch") or event.origin is None or event.direction is None:
            return
        # Over a body a click selects that, and a press takes it.
        things = [body for body in world.system.bodies if body.kind != "static"]
        is_free = what.value in ghosts and world.queries.ray(event.origin, event.direction, bodies=things) is None
        show(aim(event.origin, event.direction) if is_free else None)


def aim(origin: iota.Vec3, direction: iota.Vec3) -> iota.Vec3 | None:
    """The first point at which a ray meets the ground or the plane z = 0, within some meters."""
    ways = [
        (0.15 - origin.y) / direction.y if direction.y else math.inf,
        -origin.z / direction.z if direction.z else math.inf,
    ]
    ahead = min((way for way in ways if way > 0), default=math.inf)
    at = origin + direction * ahead if ahead < 1e3 else None
    return None if at is None or max(abs(at.x), abs(at.z), at.y) > 8 else at


# --- what to do with them ---------------------------------------------------------------------------------------------


def connecting(world: iota.World) -> None:
    """Nail, spring, combine, delete: for what is held or selected, at the place that was pressed last."""
    system = world.system
    pressed: dict[iota.Body, iota.Vec3] = {}  # in the frame of the body's center, unturned: where it was taken hold of
    first: list[iota.Body] = []

    def press(event: iota.Event) -> None:
        if event.target is not None and event.point is not None:
            pressed[event.body] = event.point - event.body.center_of_mass

    world.on_press()(press)

    def point_of(body: iota.Body) -> iota.Particle:
        """Its particle nearest to where it was pressed; on a solid a new one there, if none is near."""
        place = body.center_of_mass + pressed.get(body, iota.Vec3(0, 0, 0))
        near = min(body.attachments, key=lambda p: abs(p.position - place), default=None)  # no mark of an axle
        if near is None or (body.solids and abs(near.position - place) > 0.05):
            return body.attachment(place)
        return near

    def two(event: iota.Event, what: str, or_one: bool = False) -> iota.Body | None:
        """The body that was named before this one; None: this is the first. or_one: it may be the same."""
        if first and first[0].alive and (or_one or first[0] != event.body):
            return first.pop()
        first[:] = [event.body]
        event.notice(f"{what}: with what?", "Select another one and press the key again.")
        return None

    @world.action("nail", key="k", help="nails what you hold or have selected to where it is, or draws its nails")
    def nail(event: iota.Event) -> None:
        nailed = [p for p in event.body.particles if p.is_nailed]
        with system.edit():
            for particle in nailed:
                particle.release()
            if not nailed:
                point_of(event.body).nail()

    tied_by = world.controls.choice("tie", list(TIES), help="what the key t ties two bodies by")

    @world.action("tie", key="t", help="a spring, rope or rod between two bodies: press it on one, then on the other")
    def tie(event: iota.Event) -> None:
        other = two(event, "Tie")
        if other is None:
            return
        with system.edit():
            p, q = point_of(other), point_of(event.body)
            if tied_by.value == "spring":
                system.bond(p, q, "spring", stiffness=80, damping=0.5)
            else:
                make = system.rope if tied_by.value == "rope" else system.rod
                make(p, q)

    @world.action(
        "axle", key="h", help="an axle through two bodies: press it on one, then on the other, or twice on one"
    )
    def axle(event: iota.Event) -> None:
        other = two(event, "Axle", or_one=True)
        if other is None:
            return
        # A rod reaches only places on its line.
        at = point_of(other if event.body.solids else event.body).position
        try:
            with system.edit():
                system.revolute(event.body, None if other == event.body else other, at=at, axis=(0, 0, 1))
        except ValueError as error:
            event.notice("That cannot be done", str(error))

    @world.action("combine", key="u", help="makes two bodies one: press it on one, then on the other")
    def combine(event: iota.Event) -> None:
        other = two(event, "Combine")
        if other is not None:
            with system.edit():
                other.combine(event.body)

    @world.action("delete", key="x", help="takes what you hold or have selected away")
    def delete(event: iota.Event) -> None:
        with system.edit():
            event.body.destroy()

    @world.on_reset
    def forget() -> None:
        pressed.clear()
        first.clear()


# --- files ------------------------------------------------------------------------------------------------------------


def files(world: iota.World, folder: Path) -> None:
    """Save, load, export: files in one folder, by names without a path."""
    name = world.controls.text("file", "playground", help="letters, digits, - and _")

    def path(ending: str) -> Path:
        if not NAME.fullmatch(name.value):
            raise ValueError(f"a file name is letters, digits, - and _, not {name.value!r}")
        return folder / (name.value + ending)

    def write(ending: str, text: str) -> None:
        with replacing(path(ending)) as fresh:
            fresh.write_text(text, encoding="utf-8")
        world.users.notice("Saved", str(path(ending).resolve()))

    def told(work: Callable[[], None]) -> Callable[[], None]:
        """Reports an action that fails in a card; the world stays as it is."""

        def run() -> None:
            try:
                work()
            except (OSError, ValueError) as error:
                world.users.notice("That cannot be done", str(error), level="warning")

        return run

    @world.controls.button("save", help="as FILE.json")
    @told
    def save() -> None:
        write(".json", json.dumps(Scene.of(world).to_json(), indent=1))

    @world.controls.button("export script", help="as FILE.py, which makes this world")
    @told
    def export() -> None:
        write(".py", Scene.of(world).script(world.system))

    @world.controls.button("load", help="FILE.json in place of what is here; z takes it back")
    @told
    def load() -> None:
        file = path(".json")
        try:
            text = file.read_text(encoding="utf-8")
            if len(text) > 10_000_000:
                raise ValueError("it is too large")
            scene = Scene.from_json(json.loads(text))
            with world.system.edit():
                for body in list(world.system.bodies):
                    if body.alive:
                        body.destroy()
                scene.realize(world)
        except json.JSONDecodeError as error:
            raise ValueError(f"{file}: this is not JSON: {error}") from None
        except UnicodeDecodeError:
            raise ValueError(f"{file}: this is not a text in UTF-8") from None
        except RecursionError:
            raise ValueError(f"{file}: this is nested too deeply") from None
        except (ValueError, TypeError) as error:
            raise ValueError(f"{file}: {'; '.join(str(error).splitlines()).replace(':;', ':')}") from None
