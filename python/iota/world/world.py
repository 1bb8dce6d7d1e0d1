# SPDX-License-Identifier: Apache-2.0
"""The world loop: steps a system in real time, shows it on a page, and passes users' hands and keys to the script."""

from __future__ import annotations

import atexit
import concurrent.futures
import html
import math
import threading
import time
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NoReturn, TypeVar, cast

from iota._core import StepReport, System
from iota.arguments import SHORT, is_number, refuse_reading, refuse_unknown, suggestion
from iota.simulator import Simulator
from iota.world import options as run_options
from iota.world.callbacks import SLOW_STEP, Guard, is_terminal, print_on_terminal
from iota.world.clock import Clock
from iota.world.controls import Controls
from iota.world.drawings import Drawings
from iota.world.events import Events
from iota.world.fingers import Fingers
from iota.world.fixtures import Fixtures
from iota.world.ground import level_below
from iota.world.inputs import Inputs
from iota.world.journal import Journal
from iota.world.lan import Lan
from iota.world.levels import Levels
from iota.world.pages import Pages
from iota.world.parts import forward
from iota.world.queries import Queries
from iota.world.real_time import RealTime
from iota.world.scene import Camera, Scene
from iota.world.server import Server
from iota.world.skins import Skin
from iota.world.state import State
from iota.world.stepper import Stepper
from iota.world.summary import RunSummary
from iota.world.tools import Tools
from iota.world.users import Users
from iota.world.view import View
from iota.world.widgets import Plot

Result = TypeVar("Result")

HEADLESS_SECONDS = 10.0  # default
PARTS = (Scene, Drawings, Controls, Events, Tools, Fixtures, Queries, Users, Clock, Pages, Levels)
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
ELSEWHERE = (
    {name: f"world.{part.__name__.lower()}.{name}" for part in PARTS for name in dir(part) if name[0] != "_"}
    # Names of other libraries.
    | {name: f"world.drawings.shape(looks.{name}(...))" for name in SOLIDS}
    | {
        "contacts": "world.system.contacts",
        "polyline": "world.drawings.line(points), with closed=True back to the first",
        "lines": "world.drawings.segments(starts, ends, radius=...)",
        "curve": "world.drawings.tube(points, radius=...)",
        "mesh": "world.surface(points, triangles)",
        "gravity": "world.system.gravity",
        "time": "world.system.time",
        "bodies": "world.system.bodies",
        "body": "world.system.body(...)",
        "add": "world.system.body(...), which a World shows by itself",
        "add_body": "world.system.body(...)",
        "background": "world.drawings.stage(sky=...)",
        "fps": "world.clock.dt, the length of a step",
        "screenshot": "world.users.clients[0].screenshot(file), of an open page",
        "show": "world.run()",
        "start_recording": "world.pages.record(file)",
    }
)
SLOW_MOTION, PATIENCE = 0.8, 3.0  # of real time; s until users are told
PAUSED = "The world is paused. A reset begins it anew."
ENDING_SECONDS = 2.0  # for a world in the background when the process ends


class World:
    """Runs a system in real time and serves a page that shows it.

    system: a System, or any other Simulator. title: on the page; what follows ": " is a line that says what the world is. dt: length of a step, s. style: the style of
    drawing that pages start with, one of those in `draw`; checked when the world begins. ground: height of the ground, m, a static body that supports falling
    ones (not those of another Simulator); "auto": 0, or below bodies that start or hang lower; None for none. camera: the first view,
    None: everything is visible.

        world = iota.World(system, title="pendulum")

        @world.action("push", key="p", help="pushes the held or selected body")
        def push(event):
            event.body.particles[-1].velocity += (1, 0, 0)

        world.run()

    It consists of parts, each for one matter, and has what scripts use daily of them: `world.draw` is `world.scene.draw`.
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
        height: Any = ground
        is_height = is_number(height) and not isinstance(height, bool) and math.isfinite(float(height))
        if ground not in ("auto", None) and not is_height:
            raise ValueError(f'ground must be "auto", a height or None, not {SHORT.repr(ground)}')
        # Typed as System for scripts; this class uses only the interface of Simulator.
        self._state = state = State.of(cast(System, system), title, dt, style, None if ground == "auto" else ground)
        self._finds_ground = ground == "auto"
        self._guard = Guard(state.notices.error, state.notices.warning, state.notices.over, state.costs)
        self._stepper = Stepper(state, self._guard)
        self._inputs = inputs = Inputs(state, self._guard, self._stepper.step, self._stepper.reset)
        state.clients.take_picture = self._take_picture
        self._real_time = RealTime(state.clock)
        self._slow_since = math.inf  # s
        self._drawings = Drawings(state.things, state.notices, state.scene)
        self._controls = Controls(state.things, state.actions, lambda action, bodies: inputs.act(action, 0, bodies))
        self._events = Events(state.listeners, state.system)
        fingers = Fingers(state.system, state.scene, self._drawings, self._events)
        self._tools = Tools(
            state.system,
            state.visuals,
            state.scene,
            self._drawings,
            self._controls,
            self._events,
            state.history,
            state.clients,
            fingers,
        )
        self._fixtures = Fixtures(
            state.system,
            state.scene,
            self._drawings,
            self._controls,
            self._events,
            state.clients,
            state.notices,
            self._guard,
            fingers,
        )
        self._queries = Queries(state.system, state.scene)
        self._users = Users(state.clients, state.notices, self._controls, self._events, self._guard, title, self.call)
        self._pages = Pages(state, inputs.call)
        self._unkept: dict[str, Any] = {}
        self._levels = state.levels = Levels(state.system, state.scene, state.clients, self._guard, state.costs)
        self.camera = camera
        self._runner: int | None = None
        self._background: threading.Thread | None = None
        self._stopping = False
        self._stop_at = math.inf

    def __setattr__(self, name: str, value: Any) -> None:
        """A misspelled attribute would change nothing."""
        refuse_unknown(self, name, ELSEWHERE)
        super().__setattr__(name, value)

    def __repr__(self) -> str:
        return f"<World {self._state.title!r}>"

    if not TYPE_CHECKING:  # checkers would take any name

        def __getattr__(self, name: str) -> NoReturn:
            refuse_reading(self, name, ELSEWHERE)

    # --- parts ------------------------------------------------------------------------------------------------------

    @property
    def system(self) -> System:
        """The simulator."""
        return self._state.system

    @property
    def scene(self) -> Scene:
        """How bodies are drawn, what is fixed beside them, the first view."""
        return self._state.scene

    @property
    def drawings(self) -> Drawings:
        """Things without physics: labels, lines, surfaces, lights, sounds."""
        return self._drawings

    @property
    def controls(self) -> Controls:
        """Actions, buttons, sliders, plots."""
        return self._controls

    @property
    def events(self) -> Events:
        """Functions that are called on events."""
        return self._events

    @property
    def tools(self) -> Tools:
        """Common interactions and displays."""
        return self._tools

    @property
    def fixtures(self) -> Fixtures:
        """Ready parts of training rigs and furniture, each by one call."""
        return self._fixtures

    @property
    def queries(self) -> Queries:
        """Questions about places."""
        return self._queries

    @property
    def users(self) -> Users:
        """People: what they hold and select, cards for them."""
        return self._users

    @property
    def clock(self) -> Clock:
        """Time: the length of a step, pauses, the speed, timed events."""
        return self._state.clock

    @property
    def pages(self) -> Pages:
        """The pages that show the world."""
        return self._pages

    @property
    def levels(self) -> Levels:
        """Complexity management: what is simulated in full, and what is not."""
        return self._levels

    # --- what scripts use daily, of the parts -----------------------------------------------------------------------

    draw = forward(Scene.draw)
    draw_ties = forward(Scene.draw_ties)
    add_static = forward(Scene.add_static)
    add_strut = forward(Scene.add_strut)
    label = forward(Drawings.label)
    points = forward(Drawings.points)
    surface = forward(Drawings.surface)
    stage = forward(Drawings.stage)
    action = forward(Controls.action)
    ask = forward(Users.ask)
    offer = forward(Tools.offer)
    push_button = forward(Fixtures.push_button)
    switch = forward(Fixtures.switch)
    lever = forward(Fixtures.lever)
    knob = forward(Fixtures.knob)
    dial = forward(Fixtures.dial)
    door = forward(Fixtures.door)
    drawer = forward(Fixtures.drawer)
    plug_and_socket = forward(Fixtures.plug_and_socket)
    table = forward(Fixtures.table)
    wall = forward(Fixtures.wall)
    ramp = forward(Fixtures.ramp)
    stairs = forward(Fixtures.stairs)
    shelf = forward(Fixtures.shelf)
    at = forward(Clock.at)
    after = forward(Clock.after)
    every = forward(Clock.every)
    on_step = forward(Events.on_step)
    on_reset = forward(Events.on_reset)
    on_click = forward(Events.on_click)
    on_press = forward(Events.on_press)
    on_release = forward(Events.on_release)
    on_drag = forward(Events.on_drag)
    on_hover = forward(Events.on_hover)
    on_pointer = forward(Events.on_pointer)
    on_key = forward(Events.on_key)
    on_join = forward(Events.on_join)
    on_leave = forward(Events.on_leave)
    on_frame = forward(Events.on_frame)
    on_stop = forward(Events.on_stop)
    on_break = forward(Events.on_break)
    on_contact = forward(Events.on_contact)

    @property
    def dt(self) -> float:
        """Length of a step, s, see `Clock.dt`."""
        return self.clock.dt

    @dt.setter
    def dt(self, value: float) -> None:
        self.clock.dt = value

    @property
    def camera(self) -> Camera | None:
        """The first view; None: everything is visible."""
        return self.scene.camera

    @camera.setter
    def camera(self, camera: Camera | None) -> None:
        self.scene.camera = camera

    @property
    def title(self) -> str:
        """Shown on the page."""
        return self._state.title

    def _repr_html_(self) -> str:
        """The page in a cell of a notebook."""
        title = html.escape(self.title)
        url = self._pages._link("frame")  # the notebook is saved with it, and others may read that
        if url is None:
            return f"<p>The world {title!r} is on no page. Try: <code>world.start()</code></p>"
        style = "width: 100%; height: 480px; border: 0; border-radius: 8px"
        allowed = "fullscreen; gamepad; xr-spatial-tracking"
        return f'<iframe src="{html.escape(url)}" title="{title}" allow="{allowed}" style="{style}"></iframe>'

    def reset(self) -> None:
        """Returns to the start of the run, with the timed events registered before it and the camera of then."""
        self._stepper.reset()

    def undo(self) -> bool:
        """Restores the state before the last batch of edits (`with world.system.edit(): ...`), time included. False if
        there is none. Timed events and the script's own state do not change."""
        return self._state.history.undo()

    def redo(self) -> bool:
        """Undoes the last `undo`."""
        return self._state.history.redo()

    # --- what outlives the process ------------------------------------------------------------------------------------

    def keep(self, directory: str | Path, fresh: bool = False) -> None:
        """Keeps the world in a journal, from the begin of the run to its end. If the process is killed, the next one that
        keeps the same world there goes on where it was, with all edits, undo, controls and what `keep_state` names; at
        most 0.2 s are lost. The script has to start with the same bodies, joints, bonds and functions (not at the same
        places): otherwise it begins anew, and the world before is put aside. fresh: so, too. In a terminal it asks first,
        for 10 s. `iota run --keep DIR` and `--fresh` are the same.

            world.keep("classroom")
            world.run()

        directory: made if there is none. A disk that is full or read-only is told, and the world goes on. Raises
        RuntimeError if another process keeps a world there or this one has begun, OSError for a folder that cannot be
        made, TypeError for another simulator than a System.
        """
        if self._stepper.has_begun:
            raise RuntimeError("a world is kept from its begin: call keep before it runs")
        if self._stepper.journal is not None:
            raise RuntimeError("this world is kept already: call keep once, and before keep_state and kept_state")
        options = run_options.current()
        if options.keep is not None:  # of the first world
            directory, fresh, options.keep = options.keep, options.fresh, None
        is_saved_script = options.kept is not None and options.kept.exists()  # whose world goes on anyway
        self._stepper.journal = Journal(
            Path(directory), self._state, self._inputs.call, fresh, asks=not is_saved_script
        )

    def keep_state(self, key: str, value: Any) -> None:
        """Keeps a value of the script with the world, see `keep`: None, numbers, texts, lists and dicts (by text) of them,
        bodies, particles, bonds, constraints. Call it again when the value has changed. Raises TypeError for others. In
        a world that is not kept it lasts as long as the world."""
        journal = self._find_journal()
        if journal is None:
            self._unkept[key] = value
        else:
            journal.set(key, value)

    def kept_state(self, key: str, default: Any = None) -> Any:
        """The value of `keep_state`, of the run before if this one has given none; `default` without one. If the script
        starts another world than before, the values are gone when it begins.

            score = world.kept_state("score", 0)

        Before the world begins, handles of what was made in the run before are stale.
        """
        journal = self._find_journal()
        return self._unkept.get(key, default) if journal is None else journal.get(key, default)

    def _find_journal(self) -> Journal | None:
        """The script's journal, or that of the command line."""
        options = run_options.current()
        if self._stepper.journal is None and options.keep is not None and not self._stepper.has_begun:
            self.keep(options.keep, options.fresh)
        return self._stepper.journal

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
                self._limit_steps()
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
                self._limit_steps()
                try:
                    self.serve(8080 if port is None else port, server=server, id=id)
                except OSError:
                    if port is not None or run_options.current().port is not None:
                        raise
                    self.serve(0, server=server, id=id)
                ready.set_result(self.pages.url or "")
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
        self._inputs.wake()
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
        lan: for phones, headsets and other computers too, by https, see `Pages.lan_url`.
        """
        if self._pages._publisher is None:
            self._check_style()  # before a port is opened
            self._pages._open(port, host, server, id, lan)
            self._inputs.wake = self._pages._wake
            atexit.register(self._end)  # for scripts that do not call close or stop
            self._begin()
            self._guard.watch()
            try:
                self._pages._frame()
                self._pages._begin_recordings()
                if (on_serve := run_options.current().on_serve) is not None:
                    on_serve(self)
            except BaseException:
                self.close()
                raise
        assert self._pages.url is not None
        return self._pages.url

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
        report = None if self.clock.paused else self._stepper.step()
        if self._pages._publisher is not None:
            self._pace_one_step()
        if self.system.time >= self._stop_at:
            options.summary = self._stepper.summary()
            self.close()
            raise SystemExit(0)
        return report

    def advance(self, steps: int) -> None:
        """Takes steps as fast as possible, then handles users' input and, after `serve`, sends a frame: for films and tests."""
        if not self._stepper.has_begun:
            self._begin()
        for _ in range(steps):
            self._stepper.step()
        self._take_inputs()
        if self._pages._publisher is not None:
            self._send_frame()

    def close(self) -> None:
        """Ends serving; open pages show this and wait for a new server."""
        self._guard.close()
        self._runner = None
        self._stopping = False
        self._stepper.end()
        if self._pages._publisher is not None:
            for client in self.users.clients:
                self._state.clients.let_go(client)
            self._state.clients.by_id.clear()
            self._stepper.keep()
            self._inputs.wake = lambda: None
            self._pages._close()
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
        style, known = self.scene.style, self.scene.styles
        if style is not None and style not in known:
            there = f"the styles in draw are {', '.join(map(repr, known))}" if known else "no look in draw has a style"
            raise ValueError(
                f"a world starts with one of its styles, not {style!r}{suggestion(style, known)} ({there})"
            )

    def _limit_steps(self) -> None:
        """A search for a solution is given up at some time, since things that users build must not hold the world for all."""
        system = self.system
        if isinstance(system, System) and not (system.budget_seconds or system.budget_iterations):
            system.budget_seconds = SLOW_STEP

    def _begin(self) -> None:
        self._check_style()
        self._runner = threading.get_ident()
        if self._finds_ground:
            self._finds_ground = False
            self.scene.keep_ground(level_below(self.system))
        self._find_journal()
        self._stepper.begin(run_options.current().kept)
        self._real_time.restart()

    def _run_headless(self, seconds: float) -> RunSummary:
        self._begin()
        end = self.system.time + seconds
        while not self._stopping and self.system.time < end - self.dt / 2:
            self._stepper.step()
        return self._stepper.summary()

    def _run_served(self, seconds: float = math.inf) -> RunSummary:
        end = time.monotonic() + seconds
        clock = self._real_time
        has_news = False
        try:
            while not self._stopping and time.monotonic() < end:
                has_news |= self._take_inputs()
                for _ in range(clock.due()):
                    has_news = True
                    if not self._guard.outlive("The step", self._stepper.step, self._state.notices.error, PAUSED):
                        self.clock.paused = True
                        break
                if clock.frame_due(has_news or self._state.has_news):
                    self._guard.outlive("A frame", self._send_frame)
                    has_news = False
                is_quiet = not (has_news or self._state.has_news)
                clock.sleep(self._wait_for_input if is_quiet else None)
        except KeyboardInterrupt:
            pass
        return self._stepper.summary()

    def _run_viewed(self, view: View, seconds: float) -> RunSummary:
        notices, clock = self._state.notices, self._real_time
        self._begin()
        notices.show = lambda client, level, title, text, hint, *_: view.notice(title, text, hint) if title else None
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
        clock = self._real_time
        while True:
            if clock.frame_due():
                self._send_frame()
            stepped = clock.due() > 0
            if not stepped:
                clock.sleep()
            if stepped or self.clock.paused:
                return

    def _take_inputs(self) -> bool:
        """Whether there were any."""
        has_any = self._inputs.take_calls()
        if self._pages._publisher is not None:
            publisher = self._pages._publisher
            if inputs := publisher.room.take_input():
                self._inputs.take(inputs, publisher.bodies_of)
                return True
        return has_any

    def _wait_for_input(self, seconds: float) -> None:
        publisher = self._pages._publisher
        if publisher is None:
            time.sleep(seconds)
        else:
            publisher.room.wait_for_input(seconds)

    def _take_picture(self, client: int, seconds: float) -> bytes:
        """Waits for a picture without steps; other input is handled after it."""

        def wait() -> bytes:
            if self._pages._publisher is None:
                raise RuntimeError("this world is not on a page")
            pictures = self._state.pictures
            number = pictures.ask(client)
            self._pages._publisher.frame()  # so that it shows the latest changes of the script
            self._pages._publisher.room.ask_picture(client, number)
            end = time.monotonic() + seconds
            try:
                while (picture := pictures.ready(number)) is None:
                    if time.monotonic() > end:
                        raise TimeoutError(f"no picture came from client {client} within {seconds:g} s")
                    time.sleep(0.005)
                    for sender, part in self._pages._publisher.room.take_pictures():
                        pictures.take(sender, part)
            finally:
                pictures.forget(number)
            if not picture:
                raise RuntimeError(f"client {client} could not make a picture")
            return picture

        return self.call(wait)

    def _send_frame(self) -> None:
        self._inputs.frame()
        for thing in list(self._state.things):
            if isinstance(thing, Plot | Skin):
                thing.sample(self.system.time, self._guard)
        with self._state.costs.of("pages"):
            self._pages._frame()
        publisher = self._pages._publisher
        self._stepper.check_journal(None if publisher is None else publisher.room)
        self._keep_pace()

    def _keep_pace(self) -> None:
        """A world that is too slow for real time is simulated less where nobody sees it; if that does not help, users are told."""
        reached, now = self.clock.reached_speed, time.monotonic()
        if self.clock.speed > 0:
            self.levels._keep_pace(reached, 1e3 * self.dt / self.clock.speed)
        self._slow_since = math.inf if reached >= SLOW_MOTION else min(self._slow_since, now)
        if now > self._slow_since + PATIENCE:
            text = "This machine is too slow for this world in real time: it runs in slow motion."
            self._state.notices.warn_once(text)

    # --- helpers ---------------------------------------------------------------------------------------------

    def _announce(self, show: bool) -> None:
        lines = [f"{self.title}: {self.pages.url}"]
        if self._pages._publisher is not None:
            lines += self._pages._publisher.announce_lan(shows_code=is_terminal())
        if self.pages.lan_url is not None:
            lines.append(f"  for guests, who may touch, but not pause or reset: {self.pages.link('guest', lan=True)}")
            lines.append(f"  for those who only watch: {self.pages.link('viewer', lan=True)}")
        lines += [action.line for action in self._state.actions if action.key]
        print_on_terminal("\n".join(lines) + "\n", is_error=False)
        if show and self.pages.url and not webbrowser.open(self.pages.url):
            print_on_terminal("iota: no browser could be opened\n")
