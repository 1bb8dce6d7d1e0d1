# SPDX-License-Identifier: Apache-2.0
"""Predefined interaction: break, join, copy, undo, redo, measure; sockets for plugs; forces as arrows, joints as lines."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from time import perf_counter
from typing import Any

from iota._core import Body, Bond, Constraint, Group, Particle, System, Vec3
from iota.arguments import SHORT, is_number
from iota.colors import ColorLike, color_text
from iota.world.clients import Clients, alive
from iota.world.controls import Controls
from iota.world.drawings import Drawings
from iota.world.event import Event
from iota.world.events import Events
from iota.world.fingers import Fingers
from iota.world.ghosts import FREE, READY, Ghost
from iota.world.history import History
from iota.world.joining import Joins, hinge_above, nearest_ends
from iota.world.joint_marks import JointMarks
from iota.world.parts import Part
from iota.world.scene import Scene
from iota.world.shown import Arrow, Label, Line
from iota.world.visuals import Visuals

REWIND, REWIND_EVERY, REWIND_LONGEST = 1.0, 0.5, 10.0  # s, simulated
REWIND_BYTES = 64 << 20
REWIND_SHARE = 0.01  # of the time: what copies of the world may take
CARRIED = "carried"  # name of a group
MOST_COPIES = 400  # that are there; some thousand bodies, doubled by "select all", stop a world
PARTS_COLORS = (
    "#d0402b",
    "#3f7fd0",
    "#4c9a52",
    "#f2a324",
    "#8a4fb0",
    "#2f9d92",
    "#c0508e",
    "#8a8f94",
)  # of articulates


class Tools(Part):
    """Common interactions and displays, by one call each.

    world.tools.offer("break", "join")
    """

    def __init__(
        self,
        system: System,
        visuals: Visuals,
        scene: Scene,
        drawings: Drawings,
        controls: Controls,
        events: Events,
        history: History,
        clients: Clients,
        fingers: Fingers,
    ) -> None:
        self._system, self._visuals, self._scene, self._history = system, visuals, scene, history
        self._fingers = fingers
        self._drawings, self._controls, self._events, self._clients = drawings, controls, events, clients
        self._joins = Joins()

    def offer(self, *parts: str) -> None:
        """Lets users break ("break", key b), join ("join", c) and copy ("copy", n) the held or selected body, measure
        ("measure", v) between two bodies, go back by a second, up to ten ("rewind", Backspace; this forgets undone
        edits), and undo ("undo", z) and redo ("redo", y) these edits and those of the script
        in `with world.system.edit():`. Without names all of them. Raises ValueError for other names.

        world.offer("break", "join")
        """
        for name in parts or OFFERS:
            if not isinstance(name, str) or name not in OFFERS:
                raise ValueError(f"there are {', '.join(map(repr, OFFERS))}, not {name!r}")
            OFFERS[name](self)

    def push(self, key: str = "h", radius: float = 0.04, color: ColorLike = "#f2a324") -> None:
        """Lets users push what they touch, with at most 50 N: in a headset the tips of index fingers and controllers do, and with a mouse
        the key gives a paddle, a ball at the pointer, and takes it away. It moves at the depth of the body that the mouse
        pointed at first, or of the middle of the scene. A hand that holds something pushes nothing. radius: of the paddle, m. Worlds with ready parts have fingertips already.
        Raises ValueError for a radius that is not above 0.

        world.tools.push()
        """
        if not (is_number(radius) and 0 < float(radius) < math.inf):
            raise ValueError(f"radius must be a finite number above 0 m, not {SHORT.repr(radius)}")
        size, shade = float(radius), color_text(color)
        self._fingers.begin()

        @self._controls.action(
            "paddle", key=key, help="takes a paddle that pushes what it touches, or puts it away", on="world"
        )
        def turn(event: Event) -> None:
            self._fingers.turn_paddle(event.client, size, shade)

    def socket(
        self,
        place: Particle,
        plugs: Iterable[Particle],
        within: float = 0.1,
        on_snap: Callable[[Particle], object] | None = None,
        pull: float = 0.0,
    ) -> Socket:
        """A place that plugs snap into: a plug that a user releases within `within` m of it is joined to it. While a
        plug is held, its body is shown as it would be once joined, amber when a release would join it. on_snap gets the joined plug. pull: largest force that
        draws a held plug to the place, N; it acts within twice the distance.

        world.tools.socket(wall.particles[0], [cable.particles[-1]], within=0.2)
        """
        return Socket(self, place, plugs, within, on_snap, pull)

    def show_forces(self, bodies: Iterable[Body] | None = None, scale: float | None = None) -> Forces:
        """Arrows for the forces of nails (red) and hinges (blue) on bodies (None: all), of length force times
        `scale` (m/N; None: the largest is a fifth of the scene). `forces.destroy()` removes them.

        forces = world.tools.show_forces()
        """
        return Forces(self._system, self._drawings, self._events, bodies, scale)

    def show_joints(self, joints: Iterable[Constraint] | None = None, length: float | None = None) -> JointMarks:
        """Lines for joints (None: all): the axis (blue), stops as an arc or a track (red), the present value (amber). Ropes,
        rods and couplings have none. length: of an axis, m; None: by the size of the joint's first body.
        `marks.destroy()` removes them.

        marks = world.tools.show_joints()
        """
        if length is not None and not 0 < length < math.inf:
            raise ValueError(f"length must be a finite number above 0 m, not {length}")
        return JointMarks(self._system, self._drawings, self._events, joints, length)

    def show_articulates(self) -> Articulates:
        """Colors bodies by the articulate that they are in: those that hinges connect have one color, another after a break or
        a join. `articulates.destroy()` removes the colors."""
        return Articulates(self._system, self._drawings, self._events)

    def carry(self, bodies: Any = "anything") -> Carry:
        """Lets users move bodies exactly, whatever hangs on them, instead of pulling at them by a spring: while held they are
        scripted. A release throws them. bodies: one, several, or "anything". `carry.destroy()` ends it.

        world.tools.carry(chess_pieces)
        """
        return Carry(self._system, self._events, self._clients, bodies)


def named(body: Body) -> str:
    """A body in the words of a notice."""
    return body.name or "this body"


# --- offers --------------------------------------------------------------------------------------------------------------


def _break(tools: Tools) -> None:
    @tools._controls.action(
        "break", key="b", button="b", help="separates the held or selected body from the one above, or calls a join off"
    )
    def break_it(event: Event) -> None:
        pair = hinge_above(event.body) or tools._joins.under_way(event.body)
        if pair is None:
            event.notice("Nothing to break", f"No hinge is above {named(event.body)}.")
            return
        above, own = pair
        with tools._system.edit():
            above.separate(own)


def _join(tools: Tools) -> None:
    @tools._controls.action(
        "join", key="c", button="a", help="joins the held or selected part to the nearest loose end"
    )
    def join(event: Event) -> None:
        pair = nearest_ends(event.body)
        if pair is None:
            event.notice(
                "Nothing to join", f"Everything is connected already, or {named(event.body)} has no loose end."
            )
            return
        with tools._system.edit():
            tools._joins.begin(*pair, shortest=0.3)


def _copy(tools: Tools) -> None:
    copies: list[Body] = []

    @tools._controls.action("copy", key="n", help="copies the held or selected body")
    def copy_it(event: Event) -> None:
        if len(copies) >= MOST_COPIES:
            copies[:] = [copy for copy in copies if copy.alive]
        if len(copies) >= MOST_COPIES:
            event.notice("That is enough", f"There are {MOST_COPIES} copies. A reset removes them.")
            return
        with tools._system.edit():
            made = copy_body(event.body)
        copies.append(made)
        tools._visuals.dress_alike(made, event.body)


def _undo(tools: Tools) -> None:
    @tools._controls.action("undo", key="z", help="undoes the last edit", on="world")
    def undo(event: Event) -> None:
        if not tools._history.undo():
            event.notice("Nothing to undo")


def _redo(tools: Tools) -> None:
    @tools._controls.action("redo", key="y", help="repeats the undone edit", on="world")
    def redo(event: Event) -> None:
        if not tools._history.redo():
            event.notice("Nothing to redo")


def _measure(tools: Tools) -> None:
    first: list[Body] = []
    shown: list[tuple[Body, Body, Line, Label]] = []

    def clear() -> None:
        first.clear()
        while shown:
            *_, line, label = shown.pop()
            line.destroy()
            label.destroy()

    @tools._controls.action("measure", key="v", help="the distance of two bodies: press it on one, then on the other")
    def measure(event: Event) -> None:
        if shown or not first or first[0] == event.body or not first[0].alive:
            clear()
            first.append(event.body)
            title = f"Measure from {event.body.name or 'here'}"
            event.notice(title, "Select the other body and press v again.")
            return
        line = tools._drawings.line(first[0], event.body, color=READY)
        label = tools._drawings.label("", at=event.body, color="#23272b")
        shown.append((first[0], event.body, line, label))
        follow()

    @tools._events.on_frame
    def follow() -> None:
        for a, b, _, label in shown:
            if a.alive and b.alive:
                apart = b.center_of_mass - a.center_of_mass
                label.text = f"{abs(apart):.4g} m"
                label.offset = apart * -0.5

    tools._events.on_reset(clear)


def _rewind(tools: Tools) -> None:
    kept: deque[tuple[float, Any, int]] = deque()  # simulated time, snapshot, its bytes
    every = REWIND_EVERY

    @tools._events.on_frame
    def keep() -> None:
        nonlocal every
        now, earlier = tools._system.time, tools._history.earlier
        kept.extend((time, snapshot, len(snapshot)) for time, snapshot in earlier)
        earlier.clear()
        while kept and kept[-1][0] > now:  # after an undo
            kept.pop()
        if kept and now - kept[-1][0] < every:
            return
        start = perf_counter()
        snapshot = tools._system.snapshot()
        every = max(REWIND_EVERY, (perf_counter() - start) / REWIND_SHARE)
        kept.append((now, snapshot, len(snapshot) if isinstance(snapshot, bytes) else 0))
        while kept[0][0] < now - REWIND_LONGEST or (sum(size for *_, size in kept) > REWIND_BYTES and len(kept) > 1):
            kept.popleft()

    @tools._controls.action("rewind", key="Backspace", help="goes back by a second, up to ten", on="world")
    def rewind(event: Event) -> None:
        now = tools._system.time
        while len(kept) > 1 and kept[-1][0] > now - REWIND:
            kept.pop()
        if not kept or kept[-1][0] >= now:
            event.notice("Nothing to go back to")
            return
        tools._history.restore(kept[-1][1])

    tools._events.on_reset(kept.clear)


OFFERS: dict[str, Callable[[Tools], None]] = {
    "break": _break, "join": _join, "copy": _copy, "undo": _undo, "redo": _redo, "measure": _measure,
    "rewind": _rewind,
}  # fmt: skip


def copy_body(body: Body) -> Body:
    """Makes a body of the same shape, mass and motion, beside it along x, without its hinges, nails and bonds. Raises
    ValueError for a body of several solids."""
    system = body.system
    places = [p.position for p in body.particles]
    reach = max(abs(place - body.center_of_mass) for place in places)
    aside = Vec3(2.2 * reach or 0.1, 0, 0)
    if len(body.solids) > 1:
        raise ValueError("a body of several solids cannot be copied; make its parts again instead")
    if body.solids:
        solid = body.solids[0]
        made = system.body(
            shape=solid.shape,
            mass=body.mass,
            position=solid.position + aside,
            orientation=solid.orientation,
            velocity=body.velocity,
            spin=body.angular_velocity,
            material=body.material,
            color=body.color,
        )
        for particle in body.attachments:
            made.attachment(particle.position + aside)
        return made
    made = system.body(material=body.material, color=body.color)
    for particle in body.particles:
        made.particle(particle.position + aside, particle.mass).velocity = particle.velocity
    made.radius = body.radius
    return made


class Socket:
    """A place that plugs snap into."""

    def __init__(
        self,
        tools: Tools,
        place: Particle,
        plugs: Iterable[Particle],
        within: float,
        on_snap: Callable[[Particle], object] | None,
        pull: float,
    ) -> None:
        if not within > 0:
            raise ValueError(f"within must be more than 0 m, not {within}")
        if not 0 <= pull < math.inf:
            raise ValueError(f"pull must be a finite force of 0 N or more, not {pull}")
        self.pull = pull
        self._bond: Bond | None = None
        self.place, self.within, self._tools, self._on_snap = place, within, tools, on_snap
        self.plugs = list(plugs)
        self._ghost: Ghost | None = None
        self._drag = tools._events.on_drag("anything")(self._dragged)
        self._frame = tools._events.on_frame(self._end_with_plug)

    def destroy(self) -> None:
        """Removes the socket; joined plugs stay joined."""
        self._tools._events.forget(self._drag)
        self._tools._events.forget(self._frame)
        self._draw(None)
        self._show(None, FREE)

    def _show(self, plug: Particle | None, color: str) -> None:
        """Shows the plug's body as it would be once joined; None: nothing any more."""
        if self._ghost is not None and (plug is None or self._ghost.body != plug.body):
            self._ghost.destroy()
            self._ghost = None
        if plug is None:
            return
        if self._ghost is None:
            self._ghost = Ghost(self._tools._drawings, self._tools._scene, plug.body, color)
        self._ghost.paint(color)
        self._ghost.follow(self.place.position - plug.position)

    def _draw(self, plug: Particle | None) -> None:
        """Draws a plug to the place, or none any more."""
        bond = self._bond if self._bond is not None and self._bond.alive else None
        if bond is not None and (plug is None or plug not in bond.ends):
            bond.destroy()
            bond = None
        if bond is None and plug is not None:
            # As strong from everywhere but close to the place, where it fades.
            law = "energy = pull*sqrt(r^2 + soft^2)"
            bond = self._tools._system.bond(plug, self.place, law, pull=self.pull, soft=0.2 * self.within)
            self._tools._clients.fleeting.add(bond)
        self._bond = bond

    def _held(self, body: Body) -> Particle | None:
        """The nearest plug on the held part, unless it is joined already."""
        mine = [p for p in self.plugs if p.alive and self.place.alive and p.body.articulate == body.articulate]
        free = [p for p in mine if p.body != self.place.body and p not in self.place.ring]
        return min(free, key=lambda p: abs(p.position - self.place.position), default=None)

    def _end_with_plug(self) -> None:
        """A plug that is destroyed in the hand, or taken out of it by a reset or an undo, is not let go of."""
        if self._ghost is None:
            return
        plug, holds = self._ghost.body, self._tools._clients.holds()
        held = [body for body in (alive(hold.last) for hold in holds) if body is not None]
        if not plug.alive or all(body.articulate != plug.articulate for body in held):
            self._draw(None)
            self._show(None, FREE)

    def _dragged(self, event: Event) -> None:
        plug = None if event.target is None else self._held(event.target)
        if plug is None:
            self._draw(None)
            self._show(None, FREE)
            return
        apart = abs(plug.position - self.place.position)
        is_near = apart <= 2 * self.within and event.phase != "end"
        self._draw(plug if is_near and self.pull > 0 else None)
        self._show(None if event.phase == "end" else plug, READY if apart <= self.within else FREE)
        if event.phase != "end" or event.reason == "reset" or apart > self.within:
            return
        with self._tools._system.edit():
            self._tools._joins.begin(self.place, plug, shortest=0.1)
        if self._on_snap is not None:
            self._on_snap(plug)


class Forces:
    """Arrows that follow the forces on bodies. scale: m/N."""

    def __init__(
        self, system: System, drawings: Drawings, events: Events, bodies: Iterable[Body] | None, scale: float | None
    ) -> None:
        self.scale = scale
        self._system, self._drawings, self._events = system, drawings, events
        self._bodies = None if bodies is None else list(bodies)
        self._arrows: dict[tuple[Particle, str], Arrow] = {}
        self._follow = events.on_frame(self._write)

    def destroy(self) -> None:
        """Removes them from the page."""
        self._events.forget(self._follow)
        for arrow in self._arrows.values():
            arrow.destroy()
        self._arrows.clear()

    def _write(self) -> None:
        bodies: Sequence[Body] = self._system.bodies if self._bodies is None else [b for b in self._bodies if b.alive]
        forces: dict[tuple[Particle, str], Vec3] = {}
        for body in bodies:
            for particle in body.particles:
                if particle.is_nailed:
                    forces[particle, "nail"] = particle.nail_force
                if len(particle.ring) > 1:
                    forces[particle, "hinge"] = particle.hinge_force
        for gone in self._arrows.keys() - forces.keys():
            self._arrows.pop(gone).destroy()
        largest = max(map(abs, forces.values()), default=0.0)
        scale = self.scale if self.scale is not None else 0.2 * _size(self._system) / (largest or 1.0)
        for key, force in forces.items():
            arrow = self._arrows.get(key)
            if arrow is None:
                colors = {"nail": "#d0402b", "hinge": "#3f7fd0"}
                arrow = self._arrows[key] = self._drawings.arrow(key[0], color=colors[key[1]])
            arrow.vector = force * scale


class Articulates:
    """Colors of bodies by the articulate that they are in."""

    def __init__(self, system: System, drawings: Drawings, events: Events) -> None:
        self._system, self._drawings, self._events = system, drawings, events
        self._version = -1
        self._paint = drawings.paint([], PARTS_COLORS[0])
        self._follow = events.on_frame(self._write)
        self._write()

    def destroy(self) -> None:
        """Removes them."""
        self._events.forget(self._follow)
        self._paint.destroy()

    def _write(self) -> None:
        system = self._system
        if system.structure_version == self._version:
            return
        self._version = system.structure_version
        parts = [[body for body in part if not body.is_spark] for part in system.articulates]
        parts = [part for part in parts if part]
        self._paint.destroy()
        colors = [PARTS_COLORS[index % len(PARTS_COLORS)] for index, part in enumerate(parts) for _ in part]
        self._paint = self._drawings.paint([body for part in parts for body in part], colors or PARTS_COLORS[0])


class Carried:
    """The bodies that hands carry, as a group, which the states of the system contain."""

    def __init__(self, group: Group) -> None:
        self.group = group

    @property
    def alive(self) -> bool:
        # Made after a return to an earlier state, a group of the script may have the same identity.
        return self.group.alive and self.group.name == CARRIED

    def destroy(self) -> None:
        """Lets go of them."""
        for body in {particle.body for particle in self.group.particles}:
            body.kind = "dynamic"
            self.group.remove(body)


class Carry:
    """Bodies that follow hands exactly."""

    def __init__(self, system: System, events: Events, clients: Clients, bodies: Any) -> None:
        self._system, self._events, self._clients = system, events, clients
        # By client and hold: the body, its center relative to the hand, its kind before.
        self._held: dict[tuple[int, int], tuple[Body, Vec3, Any]] = {}
        self._carried: Carried | None = None
        self._drag = events.on_drag(bodies, grab=False)(self._dragged)

    def destroy(self) -> None:
        """Users pull at the bodies again; those in hands are let go."""
        self._events.forget(self._drag)
        for hand in list(self._held):
            self._let_go(hand)

    def _dragged(self, event: Event) -> None:
        hand = (event.client, event.hold)
        if event.phase == "start" and event.point is not None:
            # A second hand on the same body only watches.
            if all(alive(body) != event.body for body, *_ in self._held.values()):
                self._held[hand] = (event.body, event.body.center_of_mass - event.point, event.body.kind)
                if event.body.kind in ("dynamic", "resting"):
                    self._mark(event.body)
                event.body.kind = "scripted"
        elif event.phase == "update" and event.point is not None and hand in self._held:
            event.body.set_pose(event.point + self._held[hand][1])
        elif event.phase == "end" and event.reason == "reset":
            self._held.pop(hand, None)
        elif event.phase == "end":
            self._let_go(hand)

    def _let_go(self, hand: tuple[int, int]) -> None:
        if hand not in self._held:
            return
        body, _, kind = self._held.pop(hand)
        now = alive(body)
        if now is not None:
            now.kind = "dynamic" if kind == "resting" else kind
            if self._carried is not None and self._carried.alive:
                self._carried.group.remove(now)

    def _mark(self, body: Body) -> None:
        """Puts a body among those that are let go in a restored state."""
        if self._carried is None or not self._carried.alive:
            self._carried = Carried(self._system.group(CARRIED))
        self._carried.group.add(body)
        self._clients.fleeting.add(self._carried)


def _size(system: System) -> float:
    """Size of the scene, m."""
    places: Any = system.positions
    return float(abs(places.max(axis=0) - places.min(axis=0)).max()) if len(places) else 1.0
