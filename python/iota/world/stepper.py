# SPDX-License-Identifier: Apache-2.0
"""One step of a world: timed events, the script's functions, the system."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from iota._core import Body, Broken, Room, StepReport, StepTimes, System
from iota.errors import ForceError
from iota.world.blame import told_of_energy
from iota.world.callbacks import GO_ON, SLOW_STEP, Guard, Hook, print_on_terminal
from iota.world.event import Event
from iota.world.journal import Journal
from iota.world.keeping import Keeper
from iota.world.listeners import Listener
from iota.world.scene import Camera
from iota.world.state import State
from iota.world.step_costs import EVERY, parts_of
from iota.world.summary import RunSummary, Tally

IMPACTS_EVERY = 0.05  # s, simulated
SMALLER = "Try a smaller world, or the mode 'plausible'."
KEPT = "iota kept"  # id of a card that the page completes, see web/src/page/session.ts
ASKING = 120.0  # s, in which pages that open ask whether the world goes on
SWITCHED_OFF = "It is switched off until reset. Correct the script and run it again."


class Stepper:
    """Calls the script's functions when they are due, steps the system, and resets it to the start of a run."""

    def __init__(self, state: State, guard: Guard) -> None:
        self._state, self._guard = state, guard
        self._off: set[Hook] = set()  # functions that raised since the last reset
        self._untold: set[tuple[Hook, Body, Body]] = set()  # touches whose begin was not told, nor will their end be
        self._start: bytes | None = None
        self._camera: Camera | None = None  # at the start
        self._keeper: Keeper | None = None
        self.journal: Journal | None = None
        self._tally: Tally | None = None
        self._impact_at = -math.inf  # s
        self._told_of_energy = False
        self._asks_until: float | None = None  # s

    @property
    def has_begun(self) -> bool:
        return self._tally is not None

    def begin(self, kept: Path | None = None) -> None:
        """Starts a run; `reset` returns to this state. kept: a file of `keep`, which the run goes on from as far as it fits."""
        state = self._state
        self._tally = Tally(state.system)
        state.scene.keep_ground()
        self._start, self._camera = state.system.snapshot(), state.scene.camera
        state.schedule.begin()
        if self.journal is not None:
            # After a change of the script, the parts that start in another way are the script's.
            self._go_on(self.journal, recovers=kept is None or not kept.exists())
        if kept is None or not isinstance(state.system, System):
            return
        self._keeper = Keeper(kept, state.system)
        start = state.system.time
        told = self._keeper.take()
        if state.system.time != start:
            state.schedule.skip(state.system.time)
        if told:
            print_on_terminal(f"iota: {told} r on the page resets it\n")
            state.notices.send("The script was saved", told, "A reset begins the world anew.", keep=True)

    def _go_on(self, journal: Journal, recovers: bool) -> None:
        told = journal.begin(self._start or b"", recovers)
        self._state.kept_picture = journal.kept_picture
        if told:
            print_on_terminal(f"iota: {told}\n")
            id, hint = "", "A reset begins the world anew."
            if journal.goes_on:
                id, self._asks_until = KEPT, time.monotonic() + ASKING
            self._state.notices.send("The journal", f"The world {told}.", hint, keep=True, id=id)

    def keep(self) -> None:
        """Writes the state for the run of a changed script."""
        if self._keeper is not None:
            self._keeper.keep()

    def check_journal(self, room: Room | None = None) -> None:
        """Between steps: a paused world is edited, too. room: of the pages that show the world."""
        if self.journal is not None:
            self.journal.check()
            if self._asks_until is not None and time.monotonic() > self._asks_until:
                self._asks_until = None
                self._state.notices.over(KEPT)
            if room is not None:
                self.journal.portrait.look(room)

    def end(self) -> None:
        """The run has ended."""
        if self.journal is not None:
            self.journal.close()
            self.journal = None

    def summary(self) -> RunSummary:
        """Whether there were steps since `begin`."""
        assert self._tally is not None
        return self._tally.summary()

    def step(self) -> StepReport:
        """Takes one step."""
        state = self._state
        for task in state.schedule.due(state.system.time + 1e-9):
            again = task.period is not None
            if not self._call(f"The timed event {task.hook.name!r}", task.hook, "time", again) and again:
                state.schedule.drop(task.hook)
        for hook in state.listeners.on_step:
            if hook not in self._off and not self._call(f"on_step ({hook.name})", hook, "step", again=True):
                self._off.add(hook)
        state.scene.keep_ground()
        dt, began = state.clock.dt, time.perf_counter()
        with self._guard.watching("A step of the world", SLOW_STEP, SMALLER):
            report = self._step_system(dt)
        seconds = time.perf_counter() - began
        state.step_ms += 0.05 * (seconds * 1e3 - state.step_ms)
        if self._tally is not None:
            self._tally.add(report, dt)
        for warning in report.warnings:
            if "energy.made" in warning:  # nothing that visitors of the page could mend
                self._tell_author(dt)
            else:
                state.notices.warn_once(warning)
        self._tell_what_happened()
        if self.journal is not None:  # without a call, which takes longer than all else that most steps cost for it
            if 0 < state.system.budget_seconds <= seconds:
                self.journal.note_cut_step()
            if began + seconds >= self.journal.next:
                self.journal.hand_over()
        return report

    def _tell_author(self, dt: float) -> None:
        if not self._told_of_energy:
            self._told_of_energy = True
            print_on_terminal(f"iota: {told_of_energy(self._state.system, dt)}\n")

    def _step_system(self, dt: float) -> StepReport:
        try:
            with self._state.costs.of("simulator"):
                report = self._take_step(dt)
        except ForceError as error:
            self._guard.failed("A force", error, "It is switched off. " + GO_ON)
            report = error.report
        if isinstance(self._state.system, System):
            self._tell_impact(report, dt)
        return report

    def _take_step(self, dt: float) -> StepReport:
        """Times the step if its costs are shown."""
        state = self._state
        is_shown = state.clients.is_profiled
        if not is_shown and state.step_costs.ms:
            state.step_costs.clear()
        levels = state.levels
        take: Callable[[float], StepReport] = state.system.step
        if levels is not None:
            take = levels._step_in_full if levels.budget_ms is None else levels._step
        is_due = state.costs.is_detailed or (is_shown and state.system.step_count % EVERY == 0)
        if not is_due or not isinstance(state.system, System):
            return take(dt)
        with StepTimes() as times:
            report = take(dt)
        if state.costs.is_detailed:
            state.costs.split("simulator", parts_of(times))
        if is_shown:
            state.step_costs.take(times)
        return report

    def _tell_impact(self, report: StepReport, dt: float) -> None:
        """The sound of what falls on the ground, as loud as it is fast; as many as ears tell apart."""
        system, impact = self._state.system, report.impact
        if not impact.speed > 0:
            return
        gravity = abs(system.gravity)
        # A body that only settles by the fall of a few steps makes no impact.
        if not (impact.speed > 4 * gravity * dt and gravity > 0) or not self._state.scene.shows_edits:
            return
        if 0 <= system.time - self._impact_at < IMPACTS_EVERY:
            return
        self._impact_at = system.time
        # A fall from half the size of the scene or higher is as loud as usual.
        size = float(np.linalg.norm(np.ptp(system.positions, axis=0)))
        usual = math.sqrt(gravity * size)
        self._state.things.play("impact", impact.position, impact.speed / max(usual, impact.speed))

    def _tell_what_happened(self) -> None:
        """Calls the script's functions for stops, breaks and contacts."""
        system, listeners = self._state.system, self._state.listeners
        if listeners.has("stop"):
            for stop in system.stops:
                joint = stop.constraint
                if not joint.alive:  # destroyed by an earlier function
                    continue
                phase, place = "start" if stop.met else "end", stop.position
                for each in listeners.of_any("stop", (joint, joint.a, joint.b)):
                    self._tell(each.hook, "stop", target=joint.a, stop=stop, phase=phase, point=place)
        if listeners.has("break"):
            for broken in system.broken:
                things = _broken_things(broken)
                for each in listeners.of_any("break", things):
                    self._tell(each.hook, "break", broken=broken, point=broken.position)
        for each in listeners.of("contact") if listeners.has("contact") else ():
            self._tell_contacts(each)

    def _tell_contacts(self, listener: Listener) -> None:
        assert listener.watch is not None
        for contact in listener.watch.events:
            body, other = (each if each.alive else each.survivor for each in (contact.body, contact.other))
            touch = (listener.hook, contact.body, contact.other)
            if contact.began and (body is None or other is None):  # destroyed by an earlier function
                self._untold.add(touch)
                continue
            if not contact.began and touch in self._untold:
                self._untold.remove(touch)
                continue
            phase, place = "start" if contact.began else "end", contact.position
            more = {"target": body, "other": other, "contact": contact, "phase": phase, "point": place}
            self._tell(listener.hook, "contact", **more)

    def _tell(self, hook: Hook, name: str, **more: Any) -> None:
        if hook not in self._off and not self._call(f"on_{name} ({hook.name})", hook, name, again=True, **more):
            self._off.add(hook)

    def reset(self) -> None:
        """Returns to the start of the run, with the camera and the timed events of then."""
        if self._start is None:
            return
        self._state.history.restore(self._start)
        # Nothing leads back to what hands made before it, and its identity may be that of something else from now on.
        self._state.clients.fleeting.clear()
        self._state.scene.camera = self._camera
        self._state.schedule.rewind()
        self._off.clear()
        self._state.notices.over()
        for hook in self._state.listeners.on_reset:
            self._call(f"on_reset ({hook.name})", hook, "reset")

    def _call(self, what: str, hook: Hook, name: str, again: bool = False, **more: Any) -> bool:
        """Calls one of the script's functions; False if it raised."""
        arguments = (Event(self._state.system, name, notices=self._state.notices, **more),) if hook.takes_event else ()
        return self._guard.call(what, hook.function, *arguments, hint=SWITCHED_OFF if again else GO_ON)


def _broken_things(broken: Broken) -> tuple[Any, ...]:
    """Something that broke, and its bodies."""
    constraint, bond, particle = broken.constraint, broken.bond, broken.particle
    if constraint is not None and constraint.alive:
        return (constraint, constraint.a, constraint.b)
    if bond is not None and bond.alive:
        return tuple(end.body for end in bond.ends)
    return (particle.body,) if particle is not None and particle.alive else ()
