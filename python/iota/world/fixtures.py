# SPDX-License-Identifier: Apache-2.0
"""Ready parts of training rigs and furniture, each by one call."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, Literal, TypeVar

from iota._core import Body, Constraint, System
from iota.fixtures import (
    Dial,
    Door,
    Drawer,
    Fixture,
    Furniture,
    Knob,
    Lever,
    PlugAndSocket,
    PushButton,
    Switch,
    furniture,
)
from iota.fixtures.mount import Mount, Scenery
from iota.world.callbacks import Guard, Hook
from iota.world.clients import Clients
from iota.world.controls import Controls
from iota.world.drawings import Drawings
from iota.world.event import Event
from iota.world.events import Events
from iota.world.fingers import Fingers
from iota.world.ghosts import FREE, READY, Ghost
from iota.world.guiding import Guiding
from iota.world.notices import Notices
from iota.world.parts import Part
from iota.world.scene import Scene

Made = TypeVar("Made", bound=Fixture)
Callback = Callable[..., Any] | None
Place = Sequence[float]
USE_KEY = "Enter"
PULSE = (0.5, 0.03)  # strength, s
RED, OAK = "#c8322b", "#fff1dc"


class Fixtures(Part):
    """Ready parts of training rigs and furniture: real joints, springs and latches of the engine. Hands, controllers and the mouse pull
    them, fingertips and thrown things press them, a click or the key Enter on the selected one uses it.

    at: the place where it is fixed, world, m; of a door the middle of its sill, of furniture the middle of its foot. facing: the
    direction from there to who uses it, (0, 0, 1) by default, (0, 1, 0) for the top of a desk. label: written at it, and its name.
    The function that is given gets one Event (client: who holds, touches or used it, 0 for a thing that hits it; target: its body) or
    nothing. Their values are part of the world's state: a reset, an undo and a journal bring them back, and tell of the
    change. `fixture.destroy()` removes one. They need a System, and raise TypeError in a World of another Simulator.

        def start(): motor.angle.motor = (6, 20)

        world.push_button(at=(0, 1, 0), label="start", on_press=start)
    """

    def __init__(
        self,
        system: System,
        scene: Scene,
        drawings: Drawings,
        controls: Controls,
        events: Events,
        clients: Clients,
        notices: Notices,
        guard: Guard,
        fingers: Fingers,
    ) -> None:
        self._system, self._scene, self._drawings, self._controls = system, scene, drawings, controls
        self._events, self._clients, self._notices, self._guard = events, clients, notices, guard
        self._made: dict[Fixture, Hook | None] = {}
        self._users: dict[Fixture, int] = {}
        self._of: dict[Body, Fixture] = {}
        self._guiding: Guiding | None = None
        self._fingers = fingers
        self._ghosts: dict[Fixture, Ghost] = {}

    def __iter__(self) -> Iterator[Fixture]:
        """All that exist, in the order of creation."""
        return iter([fixture for fixture in self._made if fixture.is_alive])

    # --- what acts ----------------------------------------------------------------------------------------------------

    def push_button(
        self,
        at: Place,
        on_press: Callback = None,
        facing: Place = (0, 0, 1),
        label: str = "",
        radius: float = 0.03,
        travel: float = 0.008,
        force: float = 6.0,
        color: str = RED,
    ) -> PushButton:
        """A button that a finger, a click, the key or anything that hits it presses; a spring pushes it back. on_press: called when it
        is in. radius: of its cap, m. travel: m. force: that holds it in, N.

        world.push_button(at=(0, 1, 0), on_press=start)
        """
        return self._make(PushButton, at, facing, on_press, label, radius, travel, force, color)

    def switch(
        self,
        at: Place,
        on_change: Callback = None,
        facing: Place = (0, 0, 1),
        label: str = "",
        on: bool = False,
    ) -> Switch:
        """A toggle switch; up is on. on: at the start."""
        return self._make(Switch, at, facing, on_change, label, on)

    def lever(
        self,
        at: Place,
        on_change: Callback = None,
        facing: Place = (0, 0, 1),
        label: str = "",
        value: float = 0.0,
        notches: int = 0,
        color: str = RED,
    ) -> Lever:
        """A lever of 22 cm that stays where it is put. value: at the start, from 0, down, to 1. notches: 0 for none, or the number
        of places at which it rests. on_change: called when it has moved by a hundredth, or to another notch."""
        return self._make(Lever, at, facing, on_change, label, value, notches, color)

    def knob(
        self,
        at: Place,
        on_change: Callback = None,
        facing: Place = (0, 0, 1),
        label: str = "",
        minimum: float = 0.0,
        maximum: float = 1.0,
        value: float | None = None,
        radius: float = 0.03,
        color: str = "#f2a324",
    ) -> Knob:
        """A knob for a number from `minimum` to `maximum`, turned by 270 degrees. value: at the start, None: the minimum. on_change:
        called when it has turned by a two-hundredth. radius: m."""
        first = minimum if value is None else value
        return self._make(Knob, at, facing, on_change, label, minimum, maximum, first, radius, color)

    def dial(
        self,
        at: Place,
        options: Sequence[str],
        on_change: Callback = None,
        facing: Place = (0, 0, 1),
        label: str = "",
        value: str | None = None,
        radius: float = 0.03,
        color: str = "#f2a324",
    ) -> Dial:
        """A dial with a notch for each of 2 to 12 options, from the left. value: at the start, None: the first.

        mode = world.dial(at=(0, 1, 0), options=["off", "slow", "fast"], on_change=lambda: print(mode.value))
        """
        first = value if value is not None else (options[0] if options else "")
        return self._make(Dial, at, facing, on_change, label, options, first, radius, color)

    def door(
        self,
        at: Place,
        on_change: Callback = None,
        facing: Place = (0, 0, 1),
        label: str = "",
        width: float = 0.9,
        height: float = 2.0,
        hinge: Literal["left", "right"] = "left",
        color: str = "#b9c4c6",
    ) -> Door:
        """A door in a frame. Its latch holds it shut until the handle is turned: a hand that takes the handle turns it. It opens
        towards `facing`. on_change: called when it has been opened or shut. width, height: of the opening, m."""
        return self._make(Door, at, facing, on_change, label, width, height, hinge, color)

    def drawer(
        self,
        at: Place,
        on_change: Callback = None,
        facing: Place = (0, 0, 1),
        label: str = "",
        width: float = 0.4,
        height: float = 0.16,
        depth: float = 0.4,
        color: str = OAK,
    ) -> Drawer:
        """A drawer in its case, in which things lie. at: the middle of its front. on_change: called when it has been opened or shut.
        width, height, depth: of the inside of the case, m."""
        return self._make(Drawer, at, facing, on_change, label, width, height, depth, color)

    def plug_and_socket(
        self,
        at: Place,
        plug_at: Place,
        on_change: Callback = None,
        facing: Place = (0, 0, 1),
        label: str = "",
        plug_facing: Place = (0, 0, 1),
        cable_from: Place | None = None,
        hold: float = 60.0,
        color: str = "#f2a324",
    ) -> PlugAndSocket:
        """A socket and the plug that fits it in one direction. Within 14 cm the socket turns the plug and draws it in; a pull of more
        than `hold` N takes it out. plug_at: the middle of the plug at the start. plug_facing: the direction of its back, from the
        tip. cable_from: where its cable begins; None for no cable. on_change: called when it is in, or out."""
        given = (label, plug_at, plug_facing, cable_from, hold, color)
        return self._make(PlugAndSocket, at, facing, on_change, *given)

    # --- what stands --------------------------------------------------------------------------------------------------

    def table(
        self,
        at: Place = (0, 0, 0),
        size: Place = (1.4, 0.7),
        height: float = 0.75,
        facing: Place = (0, 0, 1),
        color: str = OAK,
    ) -> Furniture:
        """A table. size: of its top, along its front and in depth, m.

        world.table(at=(0, 0, -1)).top  # where things are put
        """
        return self._make(furniture.table, at, facing, None, size, height, color)

    def wall(
        self,
        at: Place,
        size: Place = (4.0, 2.6),
        thickness: float = 0.1,
        facing: Place = (0, 0, 1),
        color: str = "#dfe3e2",
    ) -> Furniture:
        """A wall behind `at`, with a skirting if it is higher than 1 m; a lower one is a panel. size: width and height, m."""
        return self._make(furniture.wall, at, facing, None, size, thickness, color)

    def ramp(
        self,
        at: Place,
        length: float = 2.0,
        width: float = 0.8,
        height: float = 0.5,
        facing: Place = (0, 0, 1),
        color: str = OAK,
    ) -> Furniture:
        """A ramp with rails, which rises from `at` away from `facing`. length: on the ground, m."""
        return self._make(furniture.ramp, at, facing, None, length, width, height, color)

    def stairs(
        self,
        at: Place,
        steps: int = 6,
        width: float = 1.0,
        rise: float = 0.17,
        tread: float = 0.28,
        facing: Place = (0, 0, 1),
        color: str = OAK,
    ) -> Furniture:
        """Stairs, which rise from `at` away from `facing`. rise, tread: height and depth of a step, m."""
        return self._make(furniture.stairs, at, facing, None, steps, width, rise, tread, color)

    def shelf(
        self,
        at: Place,
        size: Place = (0.9, 1.8, 0.3),
        boards: int = 5,
        facing: Place = (0, 0, 1),
        color: str = OAK,
    ) -> Furniture:
        """A shelf with its back at `at`. size: width, height and depth, m.

        for place in world.shelf(at=(0, 0, -2)).tops: put_a_box_on(place)
        """
        return self._make(furniture.shelf, at, facing, None, size, boards, color)

    # --- inside -------------------------------------------------------------------------------------------------------

    def _make(self, kind: Callable[..., Made], at: Any, facing: Any, function: Callback, *given: Any) -> Made:
        """kind: makes it of a Mount and of what is given. function: the callback, checked before anything is made."""
        system: object = self._system
        if not isinstance(system, System):
            raise TypeError("fixtures need a System; this world has a simulator of its own")
        hook = None if function is None else Hook.of(function)
        scenery = Scenery(
            self._scene.draw, lambda text, place, height: self._drawings.label(text, at=place, height=height)
        )
        mount = Mount(system, at, facing, scenery)
        try:
            made = kind(mount, *given)
        except BaseException:
            mount.clear()
            raise
        self._made[made] = hook
        if made.bodies:
            if self._guiding is None:
                self._begin()
            self._of |= dict.fromkeys(made.bodies, made)
            self._listen(made)
        return made

    def _begin(self) -> None:
        """With the first that acts."""
        self._guiding = Guiding(self._system, self._events, self._clients, self._guide_of)
        self._fingers.begin()
        self._events.on_step(self._act)
        taken = {action.key for action in self._controls.actions}
        if "use" not in {action.name for action in self._controls.actions}:
            key = None if USE_KEY in taken else USE_KEY
            text = "presses, flips, turns, opens or plugs in the held or selected part"
            self._controls.action("use", key=key, help=text)(self._use)

    def _listen(self, made: Fixture) -> None:
        assert self._guiding is not None
        if made.is_grabbed:
            self._guiding.listen(made.bodies)
        else:
            self._events.on_drag(made.bodies, grab=False)(self._pressed)
        if made.is_clicked:
            self._events.on_click(made.bodies)(self._use)

    def _guide_of(self, body: Body) -> Constraint | None:
        fixture = self._of.get(body)
        return None if fixture is None else fixture.guides.get(body)

    def _pressed(self, event: Event) -> None:
        """The hold of the hand is what presses: see `_act`."""

    def _use(self, event: Event) -> None:
        fixture = self._of.get(event.body)
        if fixture is None or not fixture.is_alive:
            event.notice("Nothing to use", f"{event.body.name or 'This body'} is not a part of a rig.")
            return
        self._users[fixture] = event.client
        fixture.use()

    def _act(self) -> None:
        """Before each step."""
        held: dict[Body, int] = {}
        for hold in self._clients.holds():
            held[hold.taken] = hold.client
        for fixture, hook in list(self._made.items()):
            if not fixture.is_alive:
                self._hide_home(fixture)
                continue
            fixture.hands = held.keys() & set(fixture.bodies) if held else set()
            for body in fixture.hands:
                self._users[fixture] = held[body]
            is_changed = fixture.act()
            if isinstance(fixture, PlugAndSocket):
                self._show_home(fixture)
            if not is_changed:
                continue
            self._feel(fixture)
            if fixture.is_told:
                self._tell(fixture, hook)

    def _show_home(self, fixture: PlugAndSocket) -> None:
        """While its plug is held, it is shown as it will be in the socket."""
        if not fixture.hands or fixture.is_plugged:
            self._hide_home(fixture)
            return
        ghost = self._ghosts.get(fixture)
        if ghost is None:
            ghost = self._ghosts[fixture] = Ghost(self._drawings, self._scene, fixture.plug, FREE)
            ghost.put(*fixture.home)
        ghost.paint(READY if fixture.is_near else FREE)

    def _hide_home(self, fixture: Fixture) -> None:
        ghost = self._ghosts.pop(fixture, None)
        if ghost is not None:
            ghost.destroy()

    def _feel(self, fixture: Fixture) -> None:
        """A fingertip that moves a part is felt in its hand, and its user is the one of the event."""
        touch = self._fingers.touching(fixture.bodies)
        client = None if touch is None else self._clients.by_id.get(touch[0])
        if touch is not None and client is not None:
            self._users[fixture] = client.id
            client.pulse(touch[1], *PULSE)

    def _tell(self, fixture: Fixture, hook: Hook | None) -> None:
        """A function that raises is reported, and called again the next time."""
        if hook is None:
            return
        name = type(fixture).__name__
        client = self._users.pop(fixture, 0) if not fixture.hands else self._users.get(fixture, 0)
        event = Event(self._system, name, client, fixture.bodies[0], notices=self._notices)
        what = f"The function of the {name} {fixture.label!r}" if fixture.label else f"The function of a {name}"
        self._guard.call(f"{what} ({hook.name})", hook.function, *((event,) if hook.takes_event else ()))
