# SPDX-License-Identifier: Apache-2.0
"""The world loop: steps a system in real time, shows it on a page, and brings users' hands and keys to the script."""

from __future__ import annotations

import concurrent.futures
import math
import queue
import sys
import threading
import time
import webbrowser
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar, cast

from iota._core import Body, StepReport, System, Vec3
from iota.errors import ForceError
from iota.looks import Looks, Shape
from iota.simulator import Simulator
from iota.world import options as run_options
from iota.world.callbacks import GO_ON, Guard, Hook
from iota.world.event import Event
from iota.world.frames import turn_from_x
from iota.world.hands import Client, Hands
from iota.world.inputs import MAX_SPEED, Inputs
from iota.world.pacer import Pacer
from iota.world.publisher import LEVELS, Action, Publisher
from iota.world.scene import Camera, Scene
from iota.world.schedule import Schedule
from iota.world.summary import RunSummary, Tally

Callback = TypeVar("Callback", bound=Callable[..., Any])
Result = TypeVar("Result")

HEADLESS_SECONDS = 10.0  # where nobody says how long
SWITCHED_OFF = "It is switched off until reset. Correct the script and run it again."


class World:
    """Runs a system in real time and serves a page that shows it.

    system: a System, or any Simulator in its place. title: on the page. dt: length of a step, s. look: the look that pages start with. ground: height of the drawn
    ground, m, None for none.

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
        look: str | None = None,
        ground: float | None = 0.0,
        camera: Camera | None = None,
    ) -> None:
        if not (math.isfinite(dt) and 0 < dt <= 1):
            raise ValueError(f"dt must be above 0 and at most 1 s, not {dt}")
        self.system = cast(System, system)  # scripts see the built-in one; nothing here asks for more than a Simulator
        self.title, self.dt = title, float(dt)
        self.default_look, self.ground, self.camera = look, ground, camera
        self.paused = False
        self.step_ms = 0.0
        self.statics: list[dict[str, Any]] = []
        self._scene = Scene(self.system)
        self._actions: dict[str, Action] = {}
        self._schedule = Schedule()
        self._on_step: list[Hook] = []
        self._on_reset: list[Hook] = []
        self._off: set[Hook] = set()  # raised since the last reset
        self._hands = Hands(self.system)
        self._pacer = Pacer(self.dt)
        self._guard = Guard(self._tell("error"), self._tell("warning"))
        self._calls: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._inputs = Inputs(self)
        self._publisher: Publisher | None = None
        self._tally: Tally | None = None
        self._start: bytes | None = None
        self._dirty = True
        self._told: set[str] = set()
        self._runner: int | None = None
        self._background: threading.Thread | None = None
        self._stopping = False
        self._stop_at = math.inf

    # --- what the script asks for ---------------------------------------------------------------------------------

    def action(
        self,
        name: str,
        key: str | None = None,
        help: str = "",
        button: str | None = None,
        on: str = "body",
        label: str | None = None,
    ) -> Callable[[Callback], Callback]:
        """Decorator: lets users call a function by a key, a controller's face button ("a" or "b") or the page's panel.

        on: "body" (the event has the held or selected body; without one the user is told so) or "world".
        """
        if on not in ("body", "world"):
            raise ValueError(f"on must be 'body' or 'world', not {on!r}")
        if button not in (None, "a", "b"):
            raise ValueError(f"button must be 'a', 'b' or None, not {button!r}")
        for other in self._actions.values():
            if other.name == name:
                raise ValueError(f"there is an action {name!r} already")
            if key is not None and other.key == key:
                raise ValueError(f"the key {key!r} is taken by the action {other.name!r}")

        def register(function: Callback) -> Callback:
            self._actions[name] = Action(name, Hook.of(function), key, button, help, label or name, on)
            self._dirty = True
            return function

        return register

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
        self._on_step.append(Hook.of(function))
        return function

    def on_reset(self, function: Callback) -> Callback:
        """Decorator: calls a function after each reset, for what the script keeps itself."""
        self._on_reset.append(Hook.of(function))
        return function

    @property
    def classes(self) -> dict[str, Looks]:
        """Shapes of each class of bodies by look, see `iota.looks`. Fill it before `run`."""
        return self._scene.classes

    def look(self, bodies: Body | Iterable[Body], name: str) -> None:
        """Gives bodies the looks of a class; every other one counts as odd for shapes that turn."""
        self._scene.assign([bodies] if isinstance(bodies, Body) else bodies, name)
        self._dirty = True

    def add_static(self, shape: Shape, position: Sequence[float], rotation: Sequence[float] = (0, 0, 0, 1)) -> None:
        """Adds something that is only drawn: a beam, a stand. position: m. rotation: quaternion x y z w."""
        self.statics.append({"shape": shape, "position": list(Vec3(*position)), "rotation": list(rotation)})
        self._dirty = True

    def add_strut(self, start: Sequence[float], end: Sequence[float], shape: Shape) -> None:
        """Adds a shape that is only drawn from `start` to `end` (m): its local x runs along the line, and a cylinder or
        capsule without a length gets that of the line."""
        a, b = Vec3(*start), Vec3(*end)
        length = abs(b - a)
        if not length > 0:
            raise ValueError(f"a strut needs two different ends, not {a} twice")
        direction = (b - a) * (1 / length)
        if shape["type"] in ("cylinder", "capsule"):
            shape = {"length": length, **shape}
        self.add_static(shape, list((a + b) * 0.5), turn_from_x(direction))

    def notice(self, title: str, text: str = "", hint: str = "", level: str = "info", client: int = 0) -> None:
        """Shows a small card on all pages, or on one client's. level: "info", "warning" or "error"."""
        if level not in LEVELS:
            raise ValueError(f"level must be one of {', '.join(LEVELS)}, not {level!r}")
        if self._publisher is not None:
            self._publisher.notice(level, title, text, hint, client)

    # --- who is there ---------------------------------------------------------------------------------------------

    @property
    def clients(self) -> list[Client]:
        """The open pages."""
        return list(self._hands.clients.values())

    def held(self, client: int | None = None) -> Body | None:
        """The body that a client holds, or that anyone holds."""
        return self._hands.held(client)

    def selected(self, client: int) -> Body | None:
        """The body that a client has selected."""
        return self._hands.selected(client)

    # --- control --------------------------------------------------------------------------------------------------

    @property
    def speed(self) -> float:
        """Simulated seconds per real second that users asked for; 0 to 10."""
        return self._pacer.speed

    @speed.setter
    def speed(self, value: float) -> None:
        if not (math.isfinite(value) and 0 <= value <= MAX_SPEED):
            raise ValueError(f"speed must be from 0 to {MAX_SPEED:g} times real time, not {value}")
        self._pacer.speed = float(value)

    @property
    def reached_speed(self) -> float:
        """Share of that speed that this machine reaches; below 1 the world runs in slow motion."""
        return self._pacer.reached

    @property
    def url(self) -> str | None:
        """The page's address, with its token, while it is served."""
        return None if self._publisher is None else self._publisher.server.url

    def reset(self) -> None:
        """Back to where the run began, with timed events as they were asked for before it."""
        if self._start is None:
            return
        self.system.restore(self._start)
        self._hands.forget()
        self._schedule.rewind()
        self._off.clear()
        self._dirty = True
        for hook in self._on_reset:
            self._call(f"on_reset ({hook.name})", hook, "reset")

    def undo(self) -> bool:
        """Back to just before the last batch of edits (`with world.system.edit(): ...`), time included. False when there
        is none. Timed events and what the script keeps itself stay as they are."""
        return self._moved_in_history(self.system.undo())

    def redo(self) -> bool:
        """Undoes the last `undo`."""
        return self._moved_in_history(self.system.redo())

    def _moved_in_history(self, moved: bool) -> bool:
        if moved:
            self._hands.forget()
            self._dirty = True
        return moved

    # --- running --------------------------------------------------------------------------------------------------

    def run(self, seconds: float | None = None, port: int = 8080, open: bool = False) -> RunSummary:
        """Runs until Ctrl-C, `stop()`, or for `seconds` of real time; prints the page's address and the keys.

        port: 0 for any free one. open: shows the page in the system's browser. Under `iota run --headless` nothing is
        served and `seconds` are simulated ones, as fast as they go. Raises OSError for a port that is taken.
        """
        options = run_options.current()
        options.ran = True
        seconds = seconds if options.seconds is None else options.seconds
        self.system.adopt()
        try:
            if options.headless:
                summary = self._run_headless(HEADLESS_SECONDS if seconds is None else seconds)
            else:
                self.serve(port if options.port is None else options.port)
                self._announce(open if options.open is None else options.open)
                summary = self._run_served(math.inf if seconds is None else seconds)
        finally:
            self.close()
        options.summary = summary
        return summary

    def start(self, port: int = 8080) -> str:
        """Runs in the background, for notebooks and prompts; returns the page's address. Use `call` to reach the system
        meanwhile and `stop` to end it."""
        if self._background is not None:
            raise RuntimeError("the world runs already")
        ready: concurrent.futures.Future[str] = concurrent.futures.Future()

        def background() -> None:
            try:
                self.system.adopt()
                self.serve(port)
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

        self._calls.put(work)
        return future.result()

    def stop(self) -> None:
        """Ends `run` after the step under way. From any thread; after `start` it waits and takes the system back."""
        self._stopping = True
        if self._background is not None and self._background is not threading.current_thread():
            self._background.join()
            self._background = None
            self.system.adopt()

    def serve(self, port: int = 8080, host: str = "127.0.0.1") -> str:
        """Serves the page, for scripts with a loop of their own around `step()`; returns its address."""
        if self._publisher is None:
            options = run_options.current()
            self._publisher = Publisher.open(self, host, port if options.port is None else options.port)
            self._begin()
            self._guard.watch()
            try:
                self._publisher.frame(dirty=True)
            except BaseException:
                self.close()
                raise
            self._dirty = False
        return self._publisher.server.url

    def step(self) -> StepReport | None:
        """One round of a script's own loop: users' input, one step in real time (none while paused), a frame to the page.

        world.serve()
        while True:
            world.step()
        """
        options = run_options.current()
        if self._tally is None:
            self._begin()
            if options.seconds is not None:
                self._stop_at = self.system.time + options.seconds
        options.ran = True
        self._inputs.take()
        report = None if self.paused else self._advance()
        if self._publisher is not None:
            self._pace_one_step()
        if self.system.time >= self._stop_at:
            assert self._tally is not None
            options.summary = self._tally.summary()
            self.close()
            raise SystemExit(0)
        return report

    def close(self) -> None:
        """Ends serving; open pages say so and wait for a new server."""
        self._guard.close()
        self._runner = None
        self._stopping = False
        if self._publisher is not None:
            for client in self.clients:
                self._hands.let_go(client)
            self._hands.clients.clear()
            self._publisher.close()
            self._publisher = None
        while not self._calls.empty():
            self._calls.get()()

    # --- the loop -------------------------------------------------------------------------------------------------

    def _begin(self) -> None:
        self._runner = threading.get_ident()
        self._tally = Tally(self.system, self.dt)
        self._start = self.system.snapshot()
        self._schedule.begin()
        self._pacer.restart()

    def _run_headless(self, seconds: float) -> RunSummary:
        self._begin()
        assert self._tally is not None
        for _ in range(round(seconds / self.dt)):
            if self._stopping:
                break
            self._advance()
        return self._tally.summary()

    def _run_served(self, seconds: float) -> RunSummary:
        end = time.monotonic() + seconds
        assert self._tally is not None and self._publisher is not None
        try:
            while not self._stopping and time.monotonic() < end:
                self._inputs.take()
                for _ in range(self._pacer.due(self.paused)):
                    self._advance()
                if self._pacer.frame_due():
                    self._send_frame()
                self._pacer.sleep(self.paused)
        except KeyboardInterrupt:
            pass
        return self._tally.summary()

    def _pace_one_step(self) -> None:
        while True:
            if self._pacer.frame_due():
                self._send_frame()
            stepped = self._pacer.due(self.paused) > 0
            if not stepped:
                self._pacer.sleep(self.paused)
            if stepped or self.paused:
                return

    def _advance(self) -> StepReport:
        for task in self._schedule.due(self.system.time + 1e-9):
            again = task.period is not None
            if not self._call(f"The timed event {task.hook.name!r}", task.hook, "time", again) and again:
                self._schedule.drop(task.hook)
        for hook in self._on_step:
            if hook not in self._off and not self._call(f"on_step ({hook.name})", hook, "step", again=True):
                self._off.add(hook)
        began = time.perf_counter()
        try:
            report = self.system.step(self.dt)
        except ForceError as error:
            report = error.report
            self._guard.failed("A force", error, "It is switched off. " + GO_ON)
        self.step_ms += 0.05 * ((time.perf_counter() - began) * 1e3 - self.step_ms)
        assert self._tally is not None
        self._tally.add(report)
        for warning in report.warnings:
            self._warn_once(warning)
        return report

    def _send_frame(self) -> None:
        assert self._publisher is not None
        self._publisher.frame(self._dirty)
        self._dirty = False
        if self._pacer.reached < 0.8:
            self._warn_once("This world is too much for real time on this machine: it runs in slow motion.")

    def _warn_once(self, text: str) -> None:
        if text not in self._told and len(self._told) < 100:
            self._told.add(text)
            self.notice("Note", text, level="warning")

    # --- small things ---------------------------------------------------------------------------------------------

    def _timer(self, time: float, period: float | None) -> Callable[[Callback], Callback]:
        def register(function: Callback) -> Callback:
            self._schedule.add(time, Hook.of(function), period)
            return function

        return register

    def _call(self, what: str, hook: Hook, name: str, again: bool = False) -> bool:
        """Calls one of the script's functions; False when it raised."""
        arguments = (Event(self, name),) if hook.takes_event else ()
        return self._guard.call(what, hook.function, *arguments, hint=SWITCHED_OFF if again else GO_ON)

    def _tell(self, level: str) -> Callable[[str, str, str], None]:
        return lambda title, text, hint: self.notice(title, text, hint, level)

    def _announce(self, show: bool) -> None:
        lines = [f"{self.title}: {self.url}"]
        lines += [f"  {action.key}  {action.help or action.label}" for action in self._actions.values() if action.key]
        print("\n".join(lines), flush=True)
        if show and self.url and not webbrowser.open(self.url):
            print("iota: no browser could be opened", file=sys.stderr)
