# SPDX-License-Identifier: Apache-2.0
"""The world loop: steps a system in real time, shows it on a page, and brings users' hands and keys to the script."""

from __future__ import annotations

import atexit
import concurrent.futures
import math
import sys
import threading
import time
import webbrowser
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Literal, TypeVar, cast

from iota._core import Body, StepReport, System, Vec3
from iota.looks import Drawn, Look, by_style
from iota.simulator import Simulator
from iota.world import options as run_options
from iota.world.callbacks import Guard, Hook
from iota.world.clock import Clock
from iota.world.floor import level_below
from iota.world.frames import turn_from_x
from iota.world.hands import Client
from iota.world.inputs import Inputs
from iota.world.interacting import Interacting
from iota.world.lan import Lan
from iota.world.publisher import Publisher
from iota.world.scene import Camera
from iota.world.server import Server
from iota.world.state import TIES, State
from iota.world.stepper import Stepper
from iota.world.summary import RunSummary
from iota.world.widgets import Plot

Callback = TypeVar("Callback", bound=Callable[..., Any])
Result = TypeVar("Result")

HEADLESS_SECONDS = 10.0  # where nobody says how long


class World(Interacting):
    """Runs a system in real time and serves a page that shows it.

    system: a System, or any Simulator in its place. title: on the page. dt: length of a step, s. style: the style of
    drawing that pages start with, see `draw`. ground: height of the ground, m, which holds what falls on it (not under another
    Simulator); "auto": 0, or below what begins or hangs lower; None for none. camera: where viewers start, None: all is in view.

        world = iota.World(system, title="pendulum")

        @world.action("push", key="p", help="pushes the held or selected body")
        def push(event):
            event.body.particles[-1].velocity += (1, 0, 0)

        world.run()

    Callbacks run on the thread that runs the world, between steps; they take one Event, or nothing. One that raises is
    told on the page and the terminal, and the world goes on.
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
        # Scripts see the built-in system; nothing here asks for more than a Simulator.
        self._state = State(cast(System, system), Clock(dt), title, style, None if ground == "auto" else ground, camera)
        self._finds_ground = ground == "auto"
        self._guard = Guard(
            self._state.notices.error, self._state.notices.warning, self._state.notices.over, self._state.costs
        )
        self._stepper = Stepper(self._state, self._guard)
        self._inputs = Inputs(self._state, self._guard, self._stepper.step, self._stepper.reset)
        self._state.hands.take_picture = self._take_picture
        self._publisher: Publisher | None = None
        self._runner: int | None = None
        self._background: threading.Thread | None = None
        self._stopping = False
        self._stop_at = math.inf

    # --- what it is -----------------------------------------------------------------------------------------------

    @property
    def system(self) -> System:
        """What is simulated."""
        return self._state.system

    @property
    def title(self) -> str:
        """On the page."""
        return self._state.title

    @property
    def dt(self) -> float:
        """Length of a step, s; above 0, at most 1. Assigned, it holds from the next step on."""
        return self._state.clock.dt

    @dt.setter
    def dt(self, value: float) -> None:
        self._state.clock.dt = value
        self._state.is_changed = True

    @property
    def camera(self) -> Camera | None:
        """Where viewers start; None: where all is in view."""
        return self._state.camera

    @camera.setter
    def camera(self, camera: Camera | None) -> None:
        self._state.camera = camera
        self._state.is_changed = True

    # --- what the script asks for ---------------------------------------------------------------------------------

    def at(self, time: float) -> Callable[[Callback], Callback]:
        """Decorator: calls a function once at a simulated time (s). Asked for before `run`, it comes back after a reset."""
        return self._timer(time, None)

    def after(self, delay: float) -> Callable[[Callback], Callback]:
        """Decorator: calls a function once, `delay` simulated seconds from now."""
        return self._timer(self.system.time + delay, None)

    def every(self, period: float, start: float | None = None) -> Callable[[Callback], Callback]:
        """Decorator: calls a function every `period` simulated seconds, first at `start` (default: one period from now)."""
        return self._timer(self.system.time + period if start is None else start, period)

    def on_step(self, function: Callback) -> Callback:
        """Decorator: calls a function before each step."""
        self._stepper.on_step.append(Hook.of(function))
        return function

    def on_reset(self, function: Callback) -> Callback:
        """Decorator: calls a function after each reset, for what the script keeps itself."""
        self._stepper.on_reset.append(Hook.of(function))
        return function

    def draw(self, bodies: Body | Iterable[Body], look: Drawn) -> None:
        """Says how bodies are drawn: a look of `iota.looks`, several that are drawn together, or one for each style that
        users switch between on the page. Every other one of the bodies counts as odd for looks that turn.

            world.draw(wheel, looks.solid("brass"))
            world.draw(links, {"rope": looks.capsule(0.012, "rope"), "chain": looks.chain_link(0.1)})
        """
        name = self._state.class_of(by_style(look))
        self._state.scene.assign(bodies if isinstance(bodies, Iterable) else [bodies], name)
        self._state.is_changed = True

    def draw_ties(self, kind: Literal["spring", "rope", "rod"], look: Drawn) -> None:
        """Says how springs, ropes or rods between bodies are drawn, as `draw`; an empty list hides them."""
        if kind not in TIES:
            raise ValueError(f"kind must be one of {', '.join(TIES)}, not {kind!r}")
        self._state.scene.classes[kind] = by_style(look)
        self._state.is_changed = True

    def add_static(self, look: Look, position: Sequence[float], rotation: Sequence[float] = (0, 0, 0, 1)) -> None:
        """Adds something that is only drawn: a beam, a stand. position: m. rotation: quaternion x y z w."""
        self._state.statics.append(
            {"shape": look.describe(), "position": list(Vec3(*position)), "rotation": list(rotation)}
        )
        self._state.is_changed = True

    def add_strut(self, start: Sequence[float], end: Sequence[float], look: Look) -> None:
        """Adds a look that is only drawn from `start` to `end` (m): its local x runs along the line, and a cylinder or
        capsule without a length gets that of the line."""
        a, b = Vec3(*start), Vec3(*end)
        length = abs(b - a)
        if not length > 0:
            raise ValueError(f"a strut needs two different ends, not {a} twice")
        direction = (b - a) * (1 / length)
        self.add_static(look.of_length(length), list((a + b) * 0.5), turn_from_x(direction))

    def notice(self, title: str, text: str = "", hint: str = "", level: str = "info", client: int = 0) -> None:
        """Shows a small card on all pages, or on one client's. level: "info", "warning" or "error"."""
        self._state.notices.send(title, text, hint, level, client)

    # --- who is there ---------------------------------------------------------------------------------------------

    @property
    def clients(self) -> list[Client]:
        """The open pages."""
        return list(self._state.hands.clients.values())

    def held(self, client: int | None = None) -> Body | None:
        """The body that a client holds, or that anyone holds."""
        return self._state.hands.held(client)

    def selected(self, client: int) -> Body | None:
        """The body that a client has selected."""
        return self._state.hands.selected(client)

    # --- control --------------------------------------------------------------------------------------------------

    @property
    def paused(self) -> bool:
        """No steps are made; users' hands and the script's own edits act all the same."""
        return self._state.clock.paused

    @paused.setter
    def paused(self, value: bool) -> None:
        self._state.clock.paused = value

    @property
    def speed(self) -> float:
        """Simulated seconds for each real second that users asked for; 0 to 10."""
        return self._state.clock.speed

    @speed.setter
    def speed(self, value: float) -> None:
        self._state.clock.speed = value

    @property
    def reached_speed(self) -> float:
        """Share of that speed that this machine reaches; below 1 the world runs in slow motion."""
        return self._state.clock.reached

    @property
    def costs(self) -> dict[str, float]:
        """Seconds that each part of the world has taken since it was made: "simulator", "floor", "pages", "script: ..." for each
        of the script's functions. `iota profile` prints them as a table."""
        return dict(self._state.costs.seconds)

    @property
    def url(self) -> str | None:
        """The page's address, with its token, while it is served."""
        return None if self._publisher is None else self._publisher.url

    @property
    def lan_url(self) -> str | None:
        """Address of the page for other machines; None while it is not served with lan."""
        return None if self._publisher is None else self._publisher.lan_url

    def reset(self) -> None:
        """Back to where the run began, with timed events as they were asked for before it."""
        self._stepper.reset()

    def undo(self) -> bool:
        """Back to just before the last batch of edits (`with world.system.edit(): ...`), time included. False when there
        is none. Timed events and what the script keeps itself stay as they are."""
        return self._moved_in_history(self.system.undo())

    def redo(self) -> bool:
        """Undoes the last `undo`."""
        return self._moved_in_history(self.system.redo())

    def _moved_in_history(self, moved: bool) -> bool:
        if moved:
            self._state.forget_hands()
        return moved

    # --- running --------------------------------------------------------------------------------------------------

    def run(
        self, seconds: float | None = None, port: int = 8080, open: bool = False, lan: bool | Lan = False
    ) -> RunSummary:
        """Runs until Ctrl-C, `stop()`, or for `seconds` of real time; prints the page's address and the keys.

        port: 0 for any free one. open: shows the page in the system's browser. lan: for phones, headsets and other
        computers too, by https; prints their address and a QR code of it. Under `iota run --headless` nothing is
        served and `seconds` are simulated ones, as fast as they go. Raises OSError for a port that is taken.
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
            else:
                self.serve(port, lan=lan)
                self._announce(open if options.open is None else options.open)
                summary = self._run_served(math.inf if seconds is None else seconds)
        finally:
            self.close()
        options.summary = summary
        return summary

    def start(self, port: int = 8080, server: Server | None = None, id: str = "default") -> str:
        """Runs in the background, for notebooks and prompts; returns the page's address. Use `call` to reach the system
        meanwhile and `stop` to end it. server, id: as for `serve`."""
        if self._background is not None:
            raise RuntimeError("the world runs already")
        ready: concurrent.futures.Future[str] = concurrent.futures.Future()

        def background() -> None:
            try:
                self.system.adopt()
                self.serve(port, server=server, id=id)
                ready.set_result(self.url or "")
            except BaseException as error:
                ready.set_exception(error)
                return
            try:
                self._run_served(math.inf)
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
        """Ends `run` after the step under way. From any thread; after `start` it waits and takes the system back."""
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

        server: one that several worlds share, each with an id of its own; without it the world makes one for itself.
        lan: for phones, headsets and other computers too, by https, see `lan_url`.
        """
        if self._publisher is None:
            if server is None:
                options = run_options.current()
                port = port if options.port is None else options.port
                self._publisher = Publisher.open(self._state, host, port, options.lan or lan)
            else:
                self._publisher = Publisher.join(self._state, server, id)
            atexit.register(self.close)  # for loops of scripts that end without it
            self._begin()
            self._guard.watch()
            try:
                self._publisher.frame()
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
        """So many steps as fast as they go, then users' input and a frame to the page: for films and tests, after `serve`."""
        for _ in range(steps):
            self._stepper.step()
        self._take_inputs()
        self._send_frame()

    def close(self) -> None:
        """Ends serving; open pages say so and wait for a new server."""
        self._guard.close()
        self._runner = None
        self._stopping = False
        if self._publisher is not None:
            for client in self.clients:
                self._state.hands.let_go(client)
            self._state.hands.clients.clear()
            self._publisher.close()
            self._publisher = None
            atexit.unregister(self.close)
        self._inputs.take_calls()

    # --- the loop -------------------------------------------------------------------------------------------------

    def _begin(self) -> None:
        self._runner = threading.get_ident()
        if self._finds_ground:
            self._finds_ground = False
            self._state.ground = level_below(self.system)
        self._stepper.begin()
        self._state.clock.restart()

    def _run_headless(self, seconds: float) -> RunSummary:
        self._begin()
        end = self.system.time + seconds
        while not self._stopping and self.system.time < end - self.dt / 2:
            self._stepper.step()
        return self._stepper.summary()

    def _run_served(self, seconds: float) -> RunSummary:
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
        """Waits for it without a step; what users do meanwhile comes after it."""

        def wait() -> bytes:
            if self._publisher is None:
                raise RuntimeError("this world is not on a page")
            pictures = self._state.pictures
            number = pictures.ask()
            self._publisher.frame()  # it shows what the script has just done
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
            if isinstance(thing, Plot):
                thing.sample(self.system.time, self._guard)
        with self._state.costs.of("pages"):
            self._publisher.frame()
        if self.reached_speed < 0.8:
            text = "This world is too much for real time on this machine: it runs in slow motion."
            self._state.notices.warn_once(text)

    # --- small things ---------------------------------------------------------------------------------------------

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
