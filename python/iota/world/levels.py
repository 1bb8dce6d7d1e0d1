# SPDX-License-Identifier: Apache-2.0
"""Complexity management: a step that takes a given time, whatever the world holds; richest where people look and touch."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from iota._core import Articulate, Body, StepReport, System, Vec3
from iota.arguments import SHORT, is_number
from iota.errors import StaleIdError
from iota.levels.arrays import HOLD, NEAR, REFUSED, SIGHT, Arrays
from iota.levels.arrivals import CATCH_UP, Arrivals
from iota.levels.choice import SPEND, Choice
from iota.levels.connections import Connections
from iota.levels.contact_share import ROOM, ContactShare
from iota.levels.level import Level, LevelChange, levels_of, refuse_no_function
from iota.levels.managed import Managed, is_hung
from iota.levels.step_time import SMOOTH, StepTime
from iota.levels.things import GONE, Things
from iota.world.callbacks import Guard
from iota.world.clients import Client, Clients
from iota.world.costs import Costs
from iota.world.parts import Part
from iota.world.scene import Scene

Floats = NDArray[np.float64]
Place = Sequence[float] | Vec3

PER_DECISION = 600  # things: with more, decisions are rarer
SHOWN_FOR, MOST_SHOWN, LINES = 0.5, 4000, 5  # s, bodies, changes that a page shows
JOINED = "joined"  # the reason of a change: two things have become one
LEAST_SLACK = 0.25  # m: so far viewers go at least before a thing is looked at again
# The budget that a world gives itself: when it begins, its share of the time that a step has, and after how many frames without need it ends.
TOO_SLOW, OWN_SHARE, OWN_REST = 0.95, 0.8, 600
LEAST_CORES = 0.5  # that a step is taken to have, however busy the machine is


class Levels(Part):
    """Manages complexity: `world.levels.budget_ms` is the processor time that a step may take; what matters least is simulated less,
    until it does. A world without a budget that is too slow for real time, and at which somebody looks, gives itself one: see
    `budget_ms`. Until then this does nothing and costs nothing.

        world.levels.budget_ms = 4
        world.levels.viewers = lambda: [walker.position]
        world.levels.pin(cradle)

    What is held, touches what is held, is pinned or within `reach` of a viewer is full, always. Each change of a level is an edit of the system, so
    that recordings, replays and snapshots have it; the clock decides about changes between steps, never inside one.
    """

    def __init__(self, system: System, scene: Scene, clients: Clients, guard: Guard, costs: Costs) -> None:
        self._system, self._scene, self._clients, self._guard = system, scene, clients, guard
        self._costs = costs
        self._budget: float | None = None
        self._may_give = True  # the world may give itself a budget
        self._is_own = False  # it has
        self._rest = 0  # frames in which its own budget reduced nothing
        self._cores = 1.0  # processor time of a step in its time, smoothed
        self._contacts = ContactShare(system)
        self._is_planning = self._is_over = False  # levels are being changed; the budget ends after that
        self._paced_ms: float | None = None  # a step may take, without a budget; None: as long as it takes
        self._viewers: Callable[[], Iterable[Place]] | None = None
        self._reach, self._sight = 3.0, SIGHT
        self._handled: dict[Managed, int] = {}  # by hands: full until this step
        self._version = -1  # of the structure after the latest changes of levels, which make and end no ties
        self._was_on = False  # there was a budget, so an undo may bring its levels back
        self._restructured: list[Managed] = []  # of a former budget: once stiff, or with a structure in their place
        self._is_restored = False  # a function of the script has made an undo or a reset within a change
        self._count, self._looked_at = -1, -HOLD  # articulates, and the step in which they were counted
        self._expected_step: int | None = None
        self._own_ms = 0.0
        self._time = StepTime()
        self._things = Things(system)
        self._connections = Connections(system, self._things)
        self._arrays = Arrays(system)
        self._arrivals = Arrivals(system, self._things, self._connections, self._arrays, scene._visuals)
        self._choice = Choice(
            system, self._things, self._connections, self._arrays, self._arrivals, self._time, self._change
        )
        self._seen: Floats = np.zeros((0, 3))
        self._changes: deque[LevelChange] = deque(maxlen=1000)
        self._groups: list[tuple[str, int, list[int]]] = []
        self._lines: list[str] = []
        self._shown_until = 0.0

    # --- for scripts ------------------------------------------------------------------------------------------------

    @property
    def budget_ms(self) -> float | None:
        """Processor time that a step may take, ms; None: all is full. Raises ValueError for numbers that are not above 0.

        A world without a budget that falls behind real time while somebody looks at it gives itself one, until it keeps up again
        in full. Of what is in sight it reduces only how often it is simulated, to an eighth at most; what is frozen then is small and
        slow and out of sight. `off()`, or None, forbids it."""
        return self._budget

    @budget_ms.setter
    def budget_ms(self, value: float | None) -> None:
        if value is None:
            self.off()
            return
        if not is_number(value):
            raise TypeError(f"budget_ms must be a number of ms or None, not {SHORT.repr(value)}")
        if not (math.isfinite(value) and value > 0):
            raise ValueError(f"budget_ms must be above 0, got {value:g}; None turns management off")
        if not isinstance(self._system, System):
            raise TypeError("complexity management needs a System; this world has a simulator of its own")
        self._give(float(value), is_own=False)

    def _give(self, ms: float, is_own: bool) -> None:
        self._budget, self._is_own, self._rest, self._is_over = ms, is_own, 0, False
        self._arrays.is_mild = is_own
        self._was_on = self._things.is_old = True

    @property
    def reach(self) -> float:
        """Distance from a viewer within which all is full, m."""
        return self._reach

    @reach.setter
    def reach(self, value: float) -> None:
        if not (is_number(value) and math.isfinite(value) and value >= 0):
            raise ValueError(f"reach must be a length of 0 or more, m, not {SHORT.repr(value)}")
        self._reach = float(value)

    @property
    def sight(self) -> float:
        """Distance from all viewers beyond which nobody sees whether a thing moves, m. What was frozen there has done what it would
        have done, about, when it comes into sight: it has fallen, or swung on. That begins at 1.1 times this distance. Nearer it stays where
        it is seen."""
        return self._sight

    @sight.setter
    def sight(self, value: float) -> None:
        if not (is_number(value) and math.isfinite(value) and value >= 0):
            raise ValueError(f"sight must be a length of 0 or more, m, not {SHORT.repr(value)}")
        self._sight = float(value)

    @property
    def viewers(self) -> Callable[[], Iterable[Place]] | None:
        """The places of eyes: a function that returns them, m. None: those of the users of all open pages, or, while none is
        open, the camera that the script gave to the world. What matters to one of them matters."""
        return self._viewers

    @viewers.setter
    def viewers(self, value: Callable[[], Iterable[Place]] | None) -> None:
        if not (value is None or callable(value)):
            raise TypeError(f"viewers must be a function that returns places, not {SHORT.repr(value)}")
        self._viewers = value

    def eyes(self) -> list[Place]:
        """The places of the eyes of the users of all open pages, m; while none is open, that of the camera that the script gave to the
        world. For a function of `viewers` that adds somebody: `lambda: [walker.position, *world.levels.eyes()]`."""
        found = [place for client in self._clients.by_id.values() if (place := _eye_of(client)) is not None]
        if not found and self._scene.camera is not None:
            found = [self._scene.camera.position]
        return found

    def manage(
        self,
        thing: Body | Articulate | Iterable[Body],
        levels: Sequence[str | Level] | None = None,
        significance: Callable[[Managed], float] | None = None,
        on_level: Callable[[Managed, Level], None] | None = None,
        name: str = "",
    ) -> Managed:
        """Says how a thing is managed: an articulate, or several that belong together, as the parts of an engine do, which joints hold, or the
        fish of a shoal: then all bodies that are given, and what is hinged to them, have one level. Without a call each articulate is a thing. levels: from "full" downwards, names of the standard ones ("full", "1/2", "1/4",
        "1/8", "stiff", "frozen") or `Level`s of one's own; None: all that it can have. significance: a function that returns a
        number, instead of visual angle times speed (rad^2/s) for the most interested viewer. on_level: is told each change.

            world.levels.manage(tower, levels=["full", "1/4", "frozen"])

        Raises ValueError for unknown levels, for a thing that is managed already, and for "stiff" of a thing with joints, which would
        end, of one body and of several articulates.
        """
        bodies = [thing] if isinstance(thing, Body) else list(thing)
        if not bodies or not all(isinstance(body, Body) for body in bodies):
            raise TypeError(f"manage takes a body, an articulate or bodies, not {SHORT.repr(thing)}")
        roots, members = [bodies[0]], list(bodies[0].articulate.bodies)
        known = set(members)
        for body in bodies:
            if body not in known:
                roots.append(body)
                members += body.articulate.bodies
                known.update(body.articulate.bodies)
        if any(body.system != self._system for body in bodies):
            raise ValueError("manage takes bodies of the world's own system; these are of another one")
        refuse_no_function("significance", significance)
        refuse_no_function("on_level", on_level)
        if not isinstance(name, str):
            raise TypeError(f"the name of a thing must be a text, not {SHORT.repr(name)}")
        before = list(dict.fromkeys(managed for root in roots if (managed := self._things.find(root)) is not None))
        if chosen_before := next((each for each in before if each.is_chosen), None):
            raise ValueError(
                f"{chosen_before.root!r} is managed already, as {chosen_before.name!r}: call manage once for all that belongs together"
            )
        if not any(body.particles for body in members):
            raise ValueError(f"{bodies[0]!r} has no particles, so it never moves, and costs nothing")
        chosen = None if levels is None else levels_of(levels)
        wants_stiff = not is_hung(members) if chosen is None else any(level.is_stiff for level in chosen)
        is_one = len(roots) == 1 and len(members) > 1
        is_jointed = is_one and wants_stiff and self._things.has_joints(members)
        can_be_stiff = is_one and not is_jointed
        if chosen is not None and wants_stiff and not can_be_stiff:
            raise ValueError(
                "a thing can be stiff if it is one articulate of several bodies, held together by hinges alone: joints would end when its bodies become one"
            )
        for managed in before:
            self._release(managed)
            self._things.remove(managed)
        made = self._things.add(roots[0], members, can_be_stiff, name, self._things.lined(), tuple(roots[1:]))
        made.levels = chosen or made.levels
        made.is_jointed = is_jointed
        self._things.unchecked.append(made)
        made.significance, made.on_level = significance, on_level
        made.is_chosen, made.is_pinned = True, any(each.is_pinned for each in before)
        return made

    def pin(self, thing: Body | Articulate | Managed) -> None:
        """A thing that is never reduced."""
        managed = thing if isinstance(thing, Managed) else self._things.find(thing)
        if managed is None:
            managed = self.manage(thing)  # type: ignore[arg-type]
            managed.is_chosen = False
        managed.is_pinned = True
        if managed.index:
            self._change(managed, 0, 0.0, 0.0, "pinned")
        self._things.is_old = True

    def off(self) -> None:
        """All is full again, and stays so, also where the world cannot keep up with real time. Another budget finds what `manage` and
        `pin` have said."""
        self._may_give = False
        self._pace_contacts(None)
        self._is_over = self._is_planning  # a function of a level may call this
        if self._budget is not None and not self._is_over:
            self._be_full()

    def _be_full(self) -> None:
        self._budget, self._is_own = None, False
        if self._paced_ms is None:
            self._contacts.be_exact()
        if self._expected_step not in (None, self._system.step_count):
            self._resync()
        for thing in self._things.all:
            self._release(thing)
        self._end_strides()
        known = dict.fromkeys([*self._restructured, *self._things.known])
        self._restructured = [thing for thing in known if thing._welded or thing._former][-GONE:]
        self._arrivals.clear()
        self._handled.clear()
        self._things.keep_chosen()
        self._count, self._looked_at = -1, self._arrays.now - HOLD
        self._expected_step = self._system.step_count

    def _end_strides(self) -> None:
        """Also those that an undo has brought back since things were looked at."""
        for articulate in self._system.articulates:
            if any(body.stride != 1 for body in articulate.bodies):
                articulate.stride = 1

    def _release(self, thing: Managed) -> None:
        if thing.index and thing.root.alive:
            self._change(thing, 0, 0.0, 0.0, "off")

    def _keep_pace(self, reached: float, ms: float) -> None:
        """With each frame of a world that is served in real time. reached: share of that; ms: real time that a step has. Gives the world
        a budget of its own if it is too slow, and takes it back when nothing had to be reduced for a while."""
        is_watched = bool(self._clients.by_id)
        self._pace_contacts(OWN_SHARE * ms if is_watched and self._may_give else None)
        if self._is_own:
            self._budget = OWN_SHARE * ms * max(self._cores, LEAST_CORES)
            needs = reached < TOO_SLOW or self._arrays.level.any() or self._system.contacts_share < 1
            self._rest = 0 if needs else self._rest + 1
            if self._rest > OWN_REST or not is_watched:
                self._be_full()
        elif self._may_give and self._budget is None and reached < TOO_SLOW and is_watched:
            if isinstance(self._system, System):
                self._give(OWN_SHARE * ms, is_own=True)

    def _pace_contacts(self, ms: float | None) -> None:
        """ms: that a step without a budget may take; None: as long as it takes, with all contacts as exact as the script wants them."""
        if isinstance(self._system, System):
            if ms is None and self._paced_ms is not None and self._budget is None:
                self._contacts.be_exact()
            self._paced_ms = ms

    @property
    def things(self) -> list[Managed]:
        """All things that are managed."""
        return list(self._things.all)

    @property
    def ms(self) -> float:
        """Processor time of a step, smoothed, ms."""
        return self._time.ms

    @property
    def own_ms(self) -> float:
        """Processor time that management itself takes of it, ms."""
        return self._own_ms

    @property
    def changes(self) -> list[LevelChange]:
        """The latest 1000 changes."""
        return list(self._changes)

    def counts(self) -> dict[str, int]:
        """How many things are at each level, by its name."""
        found: dict[str, int] = {}
        for thing in self._things.all:
            found[thing.level.name] = found.get(thing.level.name, 0) + 1
        return found

    def __str__(self) -> str:
        """A budget bar, and what was reduced: "[######....] 2.4 of 4 ms: 12 full, 30 1/8, 5 frozen"."""
        share = self._system.contacts_share if isinstance(self._system, System) else 1
        contacts = f", contacts {share:g} of their budget" if share < 1 else ""
        if self._budget is None:
            return f"no budget: all is full{contacts}"
        filled = min(10, round(10 * self._time.ms / self._budget))
        counts = ", ".join(f"{count} {name}" for name, count in self.counts().items())
        whose = " to keep up with real time" if self._is_own else ""
        return f"[{'#' * filled}{'.' * (10 - filled)}] {self._time.ms:.2g} of {self._budget:.3g} ms{whose}: {counts}{contacts}"

    @property
    def _shown_ms(self) -> float | None:
        """The time that pages show as the budget of a step, ms: without one, what a step may take while contacts are solved less exactly
        for it. None: neither."""
        if self._budget is None and isinstance(self._system, System) and self._system.contacts_share < 1:
            return self._paced_ms
        return self._budget

    def _shown(self) -> tuple[list[tuple[str, int, list[int]]], list[str]]:
        """For pages: each level with the number of its things and slots of their bodies, the best first, and the latest
        changes as lines. Found anew twice a second."""
        if time.perf_counter() < self._shown_until:
            return self._groups, self._lines
        self._shown_until = time.perf_counter() + SHOWN_FOR
        found: dict[str, tuple[float, int, list[int]]] = {}
        left = MOST_SHOWN
        for thing in self._things.all:
            level = thing.level
            _, count, slots = found.get(level.name, (0.0, 0, []))
            if left > 0 and thing.root.alive:
                bodies = [body.slot for body in thing.bodies][:left]
                left -= len(bodies)
                slots = slots + bodies
            found[level.name] = (level.quality, count + 1, slots)
        ordered = sorted(found.items(), key=lambda item: -item[1][0])
        self._groups = [(name, count, slots) for name, (_, count, slots) in ordered][:32]
        self._lines = [
            f"{change.time:.1f} s: {change.thing} {change.before} to {change.after}, {change.reason}"[:200]
            for change in list(self._changes)[-LINES:]
        ]
        return self._groups, self._lines

    # --- the loop ---------------------------------------------------------------------------------------------------

    def _step(self, dt: float) -> StepReport:
        """A step of the system, within the budget."""
        began, at = time.process_time(), time.perf_counter()
        self._is_planning = True
        try:
            with self._costs.of("levels"):
                self._plan()
            self._version = self._system.structure_version
        except StaleIdError:  # destroyed by the script since the last step, or within it
            self._things.is_old = True
            with suppress(StaleIdError), self._costs.of("levels"):
                self._plan()
        finally:
            self._is_planning = False
        if self._is_over:
            self._is_over = False
            self._be_full()
        planned = time.process_time()
        try:
            return self._system.step(dt)
        finally:
            ended = time.process_time()
            self._cores += SMOOTH * ((ended - began) / max(time.perf_counter() - at, 1e-9) - self._cores)
            self._expected_step = self._system.step_count
            self._own_ms += SMOOTH * (1e3 * (planned - began) - self._own_ms)
            self._time.take(1e3 * (ended - began), self._arrays.load.sum(), self._arrays.now)
            if self._budget is not None:  # a function of the script may have ended it
                # Levels fill the budget, so that half of it is never free.
                self._look_at_contacts(1e3 * (ended - began), self._budget, self._time.full)

    def _step_in_full(self, dt: float) -> StepReport:
        """A step of the system without a budget. An undo or a reset to a time with one brings strides, bodies that were one, structures and
        a share back."""
        if self._was_on and self._system.step_count != self._expected_step:
            for thing in self._restructured:
                thing._reread()
                self._release(thing)
            self._end_strides()
        self._expected_step = self._system.step_count + 1
        if self._paced_ms is None:
            if isinstance(self._system, System) and self._system.contacts_share != 1:
                self._contacts.be_exact()
            return self._system.step(dt)
        began, at = time.process_time(), time.perf_counter()
        try:
            return self._system.step(dt)
        finally:  # other programs hold up the one clock, several threads the other
            took = min(time.process_time() - began, time.perf_counter() - at)
            self._look_at_contacts(1e3 * took, self._paced_ms, ROOM)

    def _look_at_contacts(self, ms: float, limit: float, room: float) -> None:
        change = self._contacts.look(ms, limit, room)
        if change is not None:
            before, after = (f"{share:g} of their budget" for share in change)
            reason = "over budget" if change[1] < change[0] else "room again"
            self._changes.append(LevelChange(self._system.time, "contacts", before, after, 0.0, 0.0, reason))

    def _plan(self) -> None:
        assert self._budget is not None
        if self._version != self._system.structure_version:
            self._connections.forget()
        if self._is_restored or (self._expected_step != self._system.step_count and self._expected_step is not None):
            self._is_restored = False
            self._resync()
        count = self._system.articulate_count
        if count != self._count and self._arrays.now - self._looked_at >= HOLD:
            self._looked_at, self._count = self._arrays.now, count
            self._things.is_old = True
            self._things.add_all()
        is_new = self._things.is_old or self._arrays.now == 0
        if self._things.is_old:
            for thing in self._things.unchecked:
                if thing.root.alive:
                    self._connections.is_jointed_by_now(thing, thing.bodies)
            self._things.unchecked.clear()
            self._things.update(self._join)
            self._arrays.build(self._things.all)
        if not self._things.all:
            return
        seen = self._eyes()
        moved = np.inf
        if seen.shape == self._seen.shape:
            moved = float(np.linalg.norm(seen - self._seen, axis=1).max(initial=0.0))
        self._seen = seen
        arrays = self._arrays
        self._arrivals.ms_left = CATCH_UP
        slack = max((NEAR - 1) * self._reach, LEAST_SLACK)
        for part in arrays.due(np.inf if is_new else moved, slack):
            rows = slice(part, None, arrays.slices)
            arrays.look(rows, part, seen, self._reach, self._sight)
            come = [self._things.all[row] for row in arrays.come_into_sight(rows, self._system.time)]
            if moved <= slack:
                for thing in come:
                    self._arrivals.wait_for(thing)
            elif come:
                for thing in come:
                    self._arrivals.catch_up(thing)
                arrays.look(rows, part, seen, self._reach, self._sight)
            for near in np.nonzero(arrays.near[rows] & (arrays.level[rows] > 0))[0]:
                self._change(self._things.all[part + arrays.slices * int(near)], 0, 1.0, 0.0, "in reach")
            for seen_again in np.nonzero(arrays.level[rows] > arrays.lowest[rows])[0]:
                row = part + arrays.slices * int(seen_again)
                self._change(
                    self._things.all[row], int(arrays.lowest[row]), float(arrays.significance[row]), 0.0, "in sight"
                )
        self._free_held()
        self._follow_engine()
        for row, thing in arrays.own:
            if row % arrays.slices == self._arrays.now % arrays.slices:
                self._ask(row, thing)
        is_urgent = self._choice.is_urgent(self._budget)
        # Not both in one step, but for urgent ones: rare steps would have the worst of both.
        every = max(1 + len(self._things.all) // PER_DECISION, 2 if self._arrivals else 1)
        if is_urgent or self._arrays.now % every == 0:
            self._choice.decide(self._budget)
        if is_urgent or self._arrays.now % every != 0:
            self._arrivals.go_on(max(SPEND * self._budget, self._time.full * self._budget - self._time.ms))

    def _change(self, thing: Managed, index: int, significance: float, ms: float, reason: str) -> None:
        """One or several levels up or down; what fails stays at its level and is not managed any more."""
        if not thing.root.alive:
            self._things.is_old = True
            return
        before, after = thing.level, thing.levels[index]
        if index and not self._is_as_it_was(thing):
            self._things.is_old = True
            return
        if after.is_stiff and self._connections.is_jointed_by_now(thing, thing.bodies):
            return
        if before.stride == 0 and after.stride != 0 and reason != JOINED:
            self._arrivals.catch_up(thing)

        def change() -> None:
            if before.leave is not None:
                before.leave(thing)
            if before.structure is not None or after.structure is not None:
                thing._swap(self._scene, after, after.structure is not None and self._connections.is_held(thing, after))
                self._things.forget_roots()
            if not thing.root.alive or after not in thing.levels:
                return  # the script has destroyed it meanwhile, or taken what stood in for it apart
            was_stiff = bool(thing._welds)
            is_stiff = after.is_stiff or (was_stiff and after.stride == 0)  # frozen things cost nothing either way
            if is_stiff != was_stiff:
                thing._set_stiff(is_stiff, self._scene._visuals)
                self._arrays.find_points_of(thing)
            if before.structure is not None or after.structure is not None:
                thing._members = thing.bodies
            thing._set_stride(after.stride)
            if after.enter is not None:
                after.enter(thing)
            if thing.on_level is not None:
                thing.on_level(thing, after)

        thing.index = index
        functions = (before.leave, after.enter, thing.on_level, before.structure, after.structure)
        if all(function is None for function in functions):
            change()
        else:
            steps, undone = self._system.step_count, self._system.redo_count
            if not self._guard.call(f"The level {after.name!r}", change):
                self._give_up(thing)
            if self._system.step_count != steps or self._system.redo_count > undone:
                self._is_restored = True
        thing.index = min(thing.index, len(thing.levels) - 1)
        if before.structure is not None or after.structure is not None:
            self._things.is_old = True
        self._arrays.note(thing)
        self._changes.append(
            LevelChange(self._system.time, thing.name, before.name, after.name, significance, ms, reason)
        )

    def _join(self, thing: Managed) -> None:
        """It has become one with another thing: it is full."""
        self._arrays.take_missed(thing, self._system.time)
        if thing.index:
            self._change(thing, 0, 1.0, 0.0, JOINED)

    def _is_as_it_was(self, thing: Managed) -> bool:
        """Whether nothing was joined to it, or parted, since its level was decided last: see _living."""
        version = self._system.structure_version
        if version == thing._version:
            return True
        members, thing._version = thing._members, version
        thing._members = thing.bodies
        return thing._members == members

    def _give_up(self, thing: Managed) -> None:
        """A function of one of its levels has failed: it is full from now on, with its own bodies."""
        thing.is_pinned = self._things.is_old = True
        thing.index = 0
        if thing._stand_in is not None:
            thing._swap(self._scene, thing.levels[0])
        if thing.root.alive:
            thing._set_stride(1)

    # --- what is asked ------------------------------------------------------------------------------------------

    def _eyes(self) -> Floats:
        """The finite places of viewers. If the function of the script fails, the eyes of users count instead from then on."""
        found: list[list[float]] = []
        if self._viewers is not None:
            try:
                found = _places(self._viewers())
            except Exception as error:
                self._guard.failed("levels.viewers", error, "The eyes of users count instead.")
                self._viewers = None
        if self._viewers is None:
            found = _places(self.eyes())
        places = np.array(found, dtype=float).reshape(-1, 3)
        finite: Floats = places[np.isfinite(places).all(axis=1)]
        return finite

    def _free_held(self) -> None:
        """Makes full whatever hands hold and whatever touches that, for a while: it flies, or rocks between two touches."""
        for hold in self._clients.holds():
            body = hold.body
            if body is None:
                continue
            touched = {contact.other for each in body.articulate.bodies for contact in each.contacts}
            things = dict.fromkeys(self._things.find(each) for each in touched if each.kind in ("dynamic", "resting"))
            for thing, reason in (
                (self._things.find(body), "held"),
                *((each, "touched by what is held") for each in things),
            ):
                if thing is None:
                    continue
                self._handled[thing] = self._arrays.now + REFUSED
                if thing.index:
                    self._change(thing, 0, 1.0, 0.0, reason)
        self._handled = {thing: until for thing, until in self._handled.items() if until >= self._arrays.now}
        for thing in self._handled:
            self._arrays.keep_full(thing)

    def _follow_engine(self) -> None:
        """A thing that an edit, a force or something full has touched takes every step."""
        slices = self._arrays.slices
        part = self._arrays.now % slices
        for i in np.nonzero(self._arrays.runs[part::slices])[0]:
            thing = self._things.all[part + slices * int(i)]
            if thing.index and any(root.stride != thing.level.stride for root in thing._roots):
                self._arrays.refuse_strides(thing, self._arrays.now + REFUSED)
                if thing.level.stride == 0:
                    self._arrays.keep_awake(thing)
                self._change(thing, 0, 1.0, 0.0, "touched")

    def _ask(self, row: int, thing: Managed) -> None:
        def ask() -> None:
            assert thing.significance is not None
            value = float(thing.significance(thing))
            if not math.isfinite(value) or value < 0:
                raise ValueError(f"significance must be 0 or more, got {value}")
            self._arrays.significance[row] = value

        if not self._guard.call("A significance", ask, hint="Visual angle and speed count instead."):
            thing.significance = None
            self._things.is_old = True

    def _resync(self) -> None:
        """The system was restored or undone: its bodies tell the levels of their things."""
        self._arrivals.clear()
        self._handled.clear()
        for thing in self._things.all:
            thing._reread()
        self._things.revive()
        for thing in self._things.all:
            if thing.is_pinned and thing.index and thing.root.alive:
                self._change(thing, 0, 0.0, 0.0, "pinned")
        self._things.is_old = True


def _places(given: Iterable[Place]) -> list[list[float]]:
    try:
        return [list(Vec3(*place)) for place in given]
    except (TypeError, ValueError):
        raise TypeError(
            f"levels.viewers must return a list of places, (x, y, z) in m, not {SHORT.repr(given)}"
        ) from None


def _eye_of(client: Client) -> Place | None:
    """The place of its user's eyes, as its page has told, or until then the camera that it got."""
    if client.eye is not None or client.camera is None:
        return client.eye
    return client.camera.position
