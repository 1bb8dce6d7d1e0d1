# SPDX-License-Identifier: Apache-2.0
"""The world loop: steps a system in real time, shows it on a page, and passes users' hands and keys to the script."""

from __future__ import annotations

import atexit
import concurrent.futures
import html
import math
import sys
import threading
import time
import webbrowser
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NoReturn, TypeVar, cast

from iota._core import Body, StepReport, System, Vec3
from iota.arguments import SHORT, is_number, refuse_reading, refuse_unknown, suggestion
from iota.looks import Drawn, Look, Looks, by_style
from iota.simulator import SimulatedBody, Simulator
from iota.world import options as run_options
from iota.world.actions import Action
from iota.world.asking import Asking
from iota.world.callbacks import Guard, Hook, add_once, print_on_terminal
from iota.world.client_modules import add_module
from iota.world.clients import Client
from iota.world.clock import Clock
from iota.world.custom import checked_volume
from iota.world.floor import level_below
from iota.world.frames import turn_from_x
from iota.world.inputs import Inputs
from iota.world.interacting import Interacting
from iota.world.lan import Lan
from iota.world.publisher import Publisher
from iota.world.recording import LiveRecording
from iota.world.scene import Camera, Static, camera_or_none
from iota.world.server import Server
from iota.world.skins import Skin
from iota.world.state import TIES, State
from iota.world.stepper import Stepper
from iota.world.summary import RunSummary
from iota.world.things import unit_quaternion, vector
from iota.world.view import View
from iota.world.widgets import Plot

Callback = TypeVar("Callback", bound=Callable[..., Any])
Result = TypeVar("Result")

EFFECTS = ("break", "join", "grab", "impact")
HEADLESS_SECONDS = 10.0  # default
SOLIDS = (
    "sphere",
    "box",
    "cylinder",
    "capsule",
    "torus",
    "cone",
    "ellipsoid",
    "disc",
    "pyramid",
    "half_sphere",
    "polygon",
)
ELSEWHERE = {name: f"world.shape(looks.{name}(...))" for name in SOLIDS} | {  # for names of other libraries
    "polyline": "world.line(points), with closed=True back to the first",
    "lines": "world.segments(starts, ends, radius=...)",
    "curve": "world.tube(points, radius=...)",
    "mesh": "world.surface(points, triangles)",
}
ENDING_SECONDS = 2.0  # for a world in the background when the process ends


class World(Interacting, Asking):
    """Runs a system in real time and serves a page that shows it.

    system: a System, or any other Simulator. title: on the page. dt: length of a step, s. style: the style of
    drawing that pages start with, one of those in `draw`; checked when the world begins. ground: height of the ground, m, which supports falling bodies (not of
    another Simulator); "auto": 0, or below bodies that start or hang lower; None for none. camera: the first view,
    None: everything is visible.

        world = iota.World(system, title="pendulum")

        @world.action("push", key="p", help="pushes the held or selected body")
        def push(event):
            event.body.particles[-1].velocity += (1, 0, 0)

        world.run()

    Callbacks run on the thread that runs the world, between steps; they take one Event, or nothing. An exception is
    shown on the page and the terminal, and the world continues.
    """

    def __init__(
        self,
        system: System | Simulator,
        title: str = "iota",
        dt: float = 1 / 120,
        style: str | None = None,
        ground: float | Literal["auto"] | None = "auto",
        camera: Camera | None = None,
    ) -> None:
        if not isinstance(system, System | Simulator):
            raise TypeError(f"a world shows a System or another Simulator, not {SHORT.repr(system)}")
        if not isinstance(title, str):
            raise TypeError(f"title must be a text, not {SHORT.repr(title)}")
        if not (style is None or isinstance(style, str)):
            raise TypeError(f"style must be a text or None, not {SHORT.repr(style)}")
        if ground not in ("auto", None) and not (is_number(ground) and math.isfinite(float(ground))):
            raise ValueError(f'ground must be "auto", a height or None, not {SHORT.repr(ground)}')
        # Typed as System for scripts; this class uses only the interface of Simulator.
        self._state = State(cast(System, system), Clock(dt), title, style, None if ground == "auto" else ground, None)
        self.camera = camera
        self._finds_ground = ground == "auto"
        self._guard = Guard(
            self._state.notices.error, self._state.notices.warning, self._state.notices.over, self._state.costs
        )
        self._stepper = Stepper(self._state, self._guard)
        self._inputs = Inputs(self._state, self._guard, self._stepper.step, self._stepper.reset)
        self._state.clients.take_picture = self._take_picture
        self._publisher: Publisher | None = None
        self._recordings: list[LiveRecording] = []
        self._runner: int | None = None
        self._background: threading.Thread | None = None
        self._stopping = False
        self._stop_at = math.inf

    def __setattr__(self, name: str, value: Any) -> None:
        """A misspelled attribute would change nothing."""
        refuse_unknown(self, name)
        super().__setattr__(name, value)

    if not TYPE_CHECKING:  # checkers would take any name

        def __getattr__(self, name: str) -> NoReturn:
            refuse_reading(self, name, ELSEWHERE)

    # --- properties -----------------------------------------------------------------------------------------------

    @property
    def system(self) -> System:
        """The simulator."""
        return self._state.system

    @property
    def title(self) -> str:
        """Shown on the page."""
        return self._state.title

    @property
    def dt(self) -> float:
        """Length of a step, s; above 0, at most 1. A new value is used from the next step on."""
        return self._state.clock.dt

    @dt.setter
    def dt(self, value: float) -> None:
        self._state.clock.dt = value
        self._state.is_changed = True

    @property
    def camera(self) -> Camera | None:
        """The first view; None: everything is visible."""
        return self._state.camera

    @camera.setter
    def camera(self, camera: Camera | None) -> None:
        self._state.camera = camera_or_none(camera)
        self._state.is_changed = True

    @property
    def shows_edits(self) -> bool:
        """Whether joins and breaks show a ring of light, with a sound, by themselves. False where a script's mechanism makes
        them all the time, as that of the study ladder; `effect` still shows what users should see."""
        return self._state.shows_edits

    @shows_edits.setter
    def shows_edits(self, shows: bool) -> None:
        self._state.shows_edits = shows

    # --- callbacks and drawing ---------------------------------------------------------------------------------

    def at(self, time: float) -> Callable[[Callback], Callback]:
        """Decorator: calls a function once at a simulated time (s). If registered before `run`, it is restored by a
        reset."""
        return self._timer(time, None)

    def after(self, delay: float) -> Callable[[Callback], Callback]:
        """Decorator: calls a function once, `delay` simulated seconds from now."""
        return self._timer(self.system.time + delay, None)

    def every(self, period: float, start: float | None = None) -> Callable[[Callback], Callback]:
        """Decorator: calls a function every `period` simulated seconds, first at `start` (default: one period from now)."""
        return self._timer(self.system.time + period if start is None else start, period)

    def on_step(self, function: Callback) -> Callback:
        """Decorator: calls a function before each step."""
        add_once(self._stepper.on_step, function, "on_step")
        return function

    def on_reset(self, function: Callback) -> Callback:
        """Decorator: calls a function after each reset, for the script's own state."""
        add_once(self._stepper.on_reset, function, "on_reset")
        return function

    def draw(self, bodies: Body | Iterable[Body], look: Drawn) -> None:
        """Sets the looks of bodies: a look of `iota.looks`, several drawn together, or one for each style, between
        which users switch on the page. Every second body is odd, for looks with a turn.

            world.draw(wheel, looks.solid("brass"))
            world.draw(links, {"rope": looks.capsule(0.012, "rope"), "chain": looks.chain_link(0.1)})
        """
        drawn = list(bodies) if isinstance(bodies, Iterable) else [bodies]
        for body in drawn:
            if not isinstance(body, Body | SimulatedBody):
                raise TypeError(f"draw: bodies must be a body or several, not {SHORT.repr(body)}")
        self._state.scene.assign(drawn, self._state.class_of(by_style(look)))
        self._state.is_changed = True

    def look_of(self, body: Body) -> Looks | None:
        """The looks that `draw` gave to a body, for each style; None without one. A body that another one absorbed keeps
        its own."""
        return self._state.scene.looks_of(body)

    def draw_ties(self, kind: Literal["spring", "rope", "rod"], look: Drawn) -> None:
        """Sets the looks of springs, ropes or rods between bodies, as `draw`; an empty list hides them."""
        if kind not in TIES:
            raise ValueError(f"kind must be one of {', '.join(TIES)}, not {kind!r}")
        self._state.scene.classes[kind] = by_style(look)
        self._state.is_changed = True

    def add_static(self, look: Look, position: Sequence[float], rotation: Sequence[float] = (0, 0, 0, 1)) -> Static:
        """Adds a shape without physics: a beam, a stand. Walks end at it, and `ray` meets it. position: m. rotation: quaternion
        x y z w."""
        if not isinstance(look, Look) or look.shape is None:
            raise TypeError(f"add_static: look must be a Look with a shape, not {SHORT.repr(look)}")
        added = Static(look, vector(position), unit_quaternion(rotation))
        self._state.statics.append(added)
        if look.texture is not None:
            self._state.things.images.use(look.texture.name, look.texture)
        self._state.is_changed = True
        return added

    def add_strut(self, start: Sequence[float], end: Sequence[float], look: Look) -> Static:
        """Adds a look without physics from `start` to `end` (m): its local x runs along the line, and a cylinder or
        capsule without a length gets that of the line."""
        a, b = Vec3(*start), Vec3(*end)
        length = abs(b - a)
        if not length > 0:
            raise ValueError(f"a strut needs two different ends, not {a} twice")
        direction = (b - a) * (1 / length)
        return self.add_static(look.of_length(length), list((a + b) * 0.5), turn_from_x(direction))

    def notice(self, title: str, text: str = "", hint: str = "", level: str = "info", client: int = 0) -> None:
        """Shows a small card on all pages, or on one client's. level: "info", "warning" or "error"."""
        self._state.notices.send(title, text, hint, level, client)

    def effect(
        self, kind: Literal["break", "join", "grab", "impact"], position: Sequence[float], volume: float = 1.0
    ) -> None:
        """The sound and the pulse in users' hands of a break, a join, a grab or an impact at a place (m), on all pages; with a
        ring of light, but for an impact. volume: from 0 to 10. For sounds of your own see `sound`.

            world.on_contact(door_hinge)(lambda event: world.effect("impact", event.contact.position))
        """
        if kind not in EFFECTS:
            raise ValueError(f"kind must be one of {', '.join(map(repr, EFFECTS))}, not {kind!r}")
        self._state.things.play(kind, vector(position), checked_volume(volume))

    def client_module(self, file: str | Path) -> None:
        """Lets pages load a JavaScript module (.js or .mjs, at most 4 MiB), before the world is served. A relative path is
        searched in the folder of the running script. The module finds the page in `iota`, which web/README.md
        describes. Only pages that know the token can read it. Raises FileNotFoundError, ValueError for other files.

        world.client_module("halo.js")
        """
        if self._publisher is not None:
            raise RuntimeError("pages load modules when they open: call client_module before the world is served")
        add_module(self._state.client_modules, Path(file))

    def record(self, file: str | Path) -> LiveRecording:
        """Writes what pages show, with all that users do, to a file while the world is served, until `stop` of the result,
        its with block, or the world ends; `iota play` shows it. The file ends in .iota. If the process is killed, it plays
        up to then. If the disk is full, a card tells so and the world goes on. Raises ValueError for another ending,
        OSError for a file that cannot be written.

        with world.record("lesson.iota"):
            world.run()
        """
        path = Path(file)
        if path.suffix.lower() != ".iota":
            raise ValueError(f"a recording must end in .iota, not {path.name!r}")

        def fail(text: str) -> None:
            print_on_terminal(f"iota: {text}\n")
            self._inputs.call(lambda: self._state.notices.send("The recording ended", text, level="warning", keep=True))

        try:
            recording = LiveRecording(path, fail)
        except OSError as error:
            raise OSError(f"{path} cannot be written: {error.strerror or error}") from None
        self._recordings.append(recording)
        if self._publisher is not None:
            recording.begin(self._publisher.room)
        return recording

    # --- clients ---------------------------------------------------------------------------------------------

    @property
    def clients(self) -> list[Client]:
        """The open pages."""
        return list(self._state.clients.by_id.values())

    def held(self, client: int | None = None) -> Body | None:
        """The body that a client holds, or that anyone holds."""
        return self._state.clients.held(client)

    def selected(self, client: int) -> Body | None:
        """The body that a client has selected."""
        return self._state.clients.selected(client)

    @property
    def actions(self) -> list[Action]:
        """What users can do, in the order of creation."""
        return list(self._state.actions)

    def act(self, name: str, body: Body | None = None) -> None:
        """Runs an action as a user does, on a body or without one. Raises LookupError for an unknown one. An action that
        raises is reported as one that a user runs."""
        self._inputs.act(self._state.actions[name], 0, [] if body is None else [body])

    # --- control --------------------------------------------------------------------------------------------------

    @property
    def paused(self) -> bool:
        """While True, no steps are made; users' hands and edits of the script still act."""
        return self._state.clock.paused

    @paused.setter
    def paused(self, value: bool) -> None:
        self._state.clock.paused = value

    @property
    def speed(self) -> float:
        """Simulated seconds per real second, requested by users; 0 to 10."""
        return self._state.clock.speed

    @speed.setter
    def speed(self, value: float) -> None:
        self._state.clock.speed = value

    @property
    def reached_speed(self) -> float:
        """Achieved share of that speed; below 1 the world runs in slow motion."""
        return self._state.clock.reached

    @property
    def costs(self) -> dict[str, float]:
        """Seconds that each part of the world has taken since it was made: "simulator", "floor", "pages", "script: ..." for each
        of the script's functions. `iota profile` prints them as a table, with the parts of the simulator."""
        return dict(self._state.costs.seconds)

    @property
    def url(self) -> str | None:
        """The page's address, with its token, while it is served."""
        return None if self._publisher is None else self._publisher.url

    @property
    def lan_url(self) -> str | None:
        """Address of the page for other machines; None while it is not served with lan."""
        return None if self._publisher is None else self._publisher.lan_url

    def _repr_html_(self) -> str:
        """The page in a cell of a notebook."""
        title = html.escape(self.title)
        if self.url is None:
            return f"<p>The world {title!r} is on no page. Try: <code>world.start()</code></p>"
        style = "width: 100%; height: 480px; border: 0; border-radius: 8px"
        allowed = "fullscreen; gamepad; xr-spatial-tracking"
        return f'<iframe src="{html.escape(self.url)}" title="{title}" allow="{allowed}" style="{style}"></iframe>'

    def reset(self) -> None:
        """Returns to the start of the run, with the timed events registered before it and the camera of then."""
        self._stepper.reset()

    def undo(self) -> bool:
        """Restores the state before the last batch of edits (`with world.system.edit(): ...`), time included. False if
        there is none. Timed events and the script's own state do not change."""
        return self._moved_in_history(self.system.undo())

    def redo(self) -> bool:
        """Undoes the last `undo`."""
        return self._moved_in_history(self.system.redo())

    def _moved_in_history(self, moved: bool) -> bool:
        if moved:
            self._state.forget_holds()
        return moved

    # --- running --------------------------------------------------------------------------------------------------

    def run(
        self,
        seconds: float | None = None,
        port: int = 8080,
        open: bool = False,
        lan: bool | Lan = False,
        view: View | None = None,
    ) -> RunSummary:
        """Runs until Ctrl-C, `stop()`, or for `seconds` of real time; prints the page's address and the keys.

        port: 0 for any free one. open: shows the page in the system's browser. lan: for phones, headsets and other
        computers too, by https; prints their address and a QR code of it. view: shows the world instead of the page. Under `iota run --headless` nothing is
        served and `seconds` are simulated, as fast as possible. Raises OSError for a port in use.
        """
        options = run_options.current()
        options.ran = True
        seconds = seconds if options.seconds is None else options.seconds
        self.system.adopt()
        try:
            if options.headless:
                summary = self._run_headless(HEADLESS_SECONDS if seconds is None else seconds)
            elif options.drive is not None:
                options.drive(self)
                summary = self._stepper.summary()
            elif view is not None or options.view is not None:
                summary = self._run_viewed(options.view or cast(View, view), math.inf if seconds is None else seconds)
            else:
                self.serve(port, lan=lan)
                self._announce(open if options.open is None else options.open)
                summary = self._run_served(math.inf if seconds is None else seconds)
        finally:
            self.close()
        options.summary = summary
        return summary

    def start(self, port: int | None = None, server: Server | None = None, id: str = "default") -> str:
        """Runs in the background, for notebooks and prompts; returns the page's address. A cell of a notebook that ends in
        the world shows its page. Use `call` to access the system meanwhile and `stop` to end it. port: None for 8080, or
        a free one if that is taken, as by the world of a cell that is run again. server, id: see `serve`."""
        if self._background is not None:
            raise RuntimeError("the world runs already")
        ready: concurrent.futures.Future[str] = concurrent.futures.Future()

        def background() -> None:
            try:
                self.system.adopt()
                try:
                    self.serve(8080 if port is None else port, server=server, id=id)
                except OSError:
                    if port is not None or run_options.current().port is not None:
                        raise
                    self.serve(0, server=server, id=id)
                ready.set_result(self.url or "")
            except BaseException as error:
                ready.set_exception(error)
                return
            try:
                self._run_served()
            finally:
                self.close()

        self._background = threading.Thread(target=background, name="iota-world", daemon=True)
        self._background.start()
        try:
            return ready.result()
        except BaseException:
            self._background.join()
            self._background = None
            self.system.adopt()
            raise

    def call(self, function: Callable[[], Result]) -> Result:
        """Runs a function on the thread that runs the world, between steps, and returns its result. From any thread."""
        if self._runner in (None, threading.get_ident()):
            return function()
        future: concurrent.futures.Future[Result] = concurrent.futures.Future()

        def work() -> None:
            try:
                future.set_result(function())
            except BaseException as error:
                future.set_exception(error)

        self._inputs.call(work)
        return future.result()

    def stop(self) -> None:
        """Ends `run` after the present step. May be called on any thread; after `start` it waits and makes this thread
        the owner of the system."""
        self._stopping = True
        if self._background is not None and self._background is not threading.current_thread():
            self._background.join()
            self._background = None
            self.system.adopt()

    def serve(
        self,
        port: int = 8080,
        host: str = "127.0.0.1",
        server: Server | None = None,
        id: str = "default",
        lan: bool | Lan = False,
    ) -> str:
        """Serves the page, for scripts with a loop of their own around `step()`; returns its address.

        server: one that several worlds share, each with its own id; without it the world makes its own.
        lan: for phones, headsets and other computers too, by https, see `lan_url`.
        """
        if self._publisher is None:
            self._check_style()  # before a port is opened
            if server is None:
                options = run_options.current()
                port = port if options.port is None else options.port
                self._publisher = Publisher.open(self._state, host, port, options.lan or lan)
            else:
                self._publisher = Publisher.join(self._state, server, id)
            atexit.register(self._end)  # for scripts that do not call close or stop
            self._begin()
            self._guard.watch()
            try:
                self._publisher.frame()
                self._begin_recordings()
            except BaseException:
                self.close()
                raise
        return self._publisher.url

    def step(self) -> StepReport | None:
        """One round of a script's own loop: users' input, one step in real time (none while paused), a frame to the page.

        world.serve()
        while True:
            world.step()
        """
        options = run_options.current()
        if not self._stepper.has_begun:
            self._begin()
            if options.seconds is not None:
                self._stop_at = self.system.time + options.seconds
        options.ran = True
        self._take_inputs()
        report = None if self.paused else self._stepper.step()
        if self._publisher is not None:
            self._pace_one_step()
        if self.system.time >= self._stop_at:
            options.summary = self._stepper.summary()
            self.close()
            raise SystemExit(0)
        return report

    def advance(self, steps: int) -> None:
        """Takes steps as fast as possible, then handles users' input and sends a frame: for films and tests, after
        `serve`."""
        for _ in range(steps):
            self._stepper.step()
        self._take_inputs()
        self._send_frame()

    def close(self) -> None:
        """Ends serving; open pages show this and wait for a new server."""
        self._guard.close()
        self._runner = None
        self._stopping = False
        if self._publisher is not None:
            for client in self.clients:
                self._state.clients.let_go(client)
            self._state.clients.by_id.clear()
            self._stepper.keep()
            for recording in self._recordings:
                recording.stop()
            self._recordings.clear()
            self._publisher.close()
            self._publisher = None
            atexit.unregister(self._end)
        self._inputs.take_calls()

    def _end(self) -> None:
        """With the process. What runs in the background ends by itself, unless a callback hangs."""
        if self._background is None:
            self.close()
        else:
            self._stopping = True
            self._background.join(ENDING_SECONDS)

    # --- the loop -------------------------------------------------------------------------------------------------

    def _check_style(self) -> None:
        """Only now: the looks of each style are given after the world was made."""
        style, known = self._state.style, self._state.styles
        if style is not None and style not in known:
            there = f"the styles in draw are {', '.join(map(repr, known))}" if known else "no look in draw has a style"
            raise ValueError(
                f"a world starts with one of its styles, not {style!r}{suggestion(style, known)} ({there})"
            )

    def _begin(self) -> None:
        self._check_style()
        self._runner = threading.get_ident()
        if self._finds_ground:
            self._finds_ground = False
            self._state.ground = level_below(self.system)
        self._stepper.begin(run_options.current().kept)
        self._state.clock.restart()

    def _begin_recordings(self) -> None:
        assert self._publisher is not None
        options = run_options.current()
        if options.record is not None:
            file, options.record = options.record, None  # of the first world that is served
            self.record(file)
        for recording in self._recordings:
            recording.begin(self._publisher.room)

    def _run_headless(self, seconds: float) -> RunSummary:
        self._begin()
        end = self.system.time + seconds
        while not self._stopping and self.system.time < end - self.dt / 2:
            self._stepper.step()
        return self._stepper.summary()

    def _run_served(self, seconds: float = math.inf) -> RunSummary:
        end = time.monotonic() + seconds
        clock = self._state.clock
        try:
            while not self._stopping and time.monotonic() < end:
                self._take_inputs()
                for _ in range(clock.due()):
                    self._stepper.step()
                if clock.frame_due():
                    self._send_frame()
                clock.sleep()
        except KeyboardInterrupt:
            pass
        return self._stepper.summary()

    def _run_viewed(self, view: View, seconds: float) -> RunSummary:
        notices, clock = self._state.notices, self._state.clock
        self._begin()
        notices.show = lambda client, level, title, text, hint, keep: view.notice(title, text, hint)
        end = time.monotonic() + seconds
        view.open(self)
        try:
            while not self._stopping and time.monotonic() < end:
                self._inputs.take_calls()
                for _ in range(clock.due()):
                    self._stepper.step()
                if clock.frame_due():
                    self._inputs.frame()
                    view.frame(self)
                clock.sleep()
        except KeyboardInterrupt:
            pass
        finally:
            notices.show = None
            view.close()
        return self._stepper.summary()

    def _pace_one_step(self) -> None:
        clock = self._state.clock
        while True:
            if clock.frame_due():
                self._send_frame()
            stepped = clock.due() > 0
            if not stepped:
                clock.sleep()
            if stepped or self.paused:
                return

    def _take_inputs(self) -> None:
        self._inputs.take_calls()
        if self._publisher is not None:
            self._inputs.take(self._publisher.take_input())

    def _take_picture(self, client: int, seconds: float) -> bytes:
        """Waits for a picture without steps; other input is handled after it."""

        def wait() -> bytes:
            if self._publisher is None:
                raise RuntimeError("this world is not on a page")
            pictures = self._state.pictures
            number = pictures.ask()
            self._publisher.frame()  # so that it shows the latest changes of the script
            self._publisher.room.ask_picture(client, number)
            end = time.monotonic() + seconds
            try:
                while (picture := pictures.ready(number)) is None:
                    if time.monotonic() > end:
                        raise TimeoutError(f"no picture came from client {client} within {seconds:g} s")
                    time.sleep(0.005)
                    self._inputs.take_pictures(self._publisher.take_input())
            finally:
                pictures.forget(number)
            if not picture:
                raise RuntimeError(f"client {client} could not make a picture")
            return picture

        return self.call(wait)

    def _send_frame(self) -> None:
        assert self._publisher is not None
        self._inputs.frame()
        for thing in self.things:
            if isinstance(thing, Plot | Skin):
                thing.sample(self.system.time, self._guard)
        with self._state.costs.of("pages"):
            self._publisher.frame()
        if self.reached_speed < 0.8:
            text = "This machine is too slow for this world in real time: it runs in slow motion."
            self._state.notices.warn_once(text)

    # --- helpers ---------------------------------------------------------------------------------------------

    def _timer(self, time: float, period: float | None) -> Callable[[Callback], Callback]:
        def register(function: Callback) -> Callback:
            self._stepper.schedule.add(time, Hook.of(function), period)
            return function

        return register

    def _announce(self, show: bool) -> None:
        lines = [f"{self.title}: {self.url}"]
        if self._publisher is not None:
            lines += self._publisher.announce_lan(shows_code=sys.stdout.isatty())
        lines += [action.line for action in self._state.actions if action.key]
        print("\n".join(lines), flush=True)
        if show and self.url and not webbrowser.open(self.url):
            print("iota: no browser could be opened", file=sys.stderr)
