# SPDX-License-Identifier: Apache-2.0
"""Complexity management: a step that takes a given time, whatever the world holds; richest where people look and touch."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from iota._core import Articulate, Body, BodyArray, Particle, ParticleArray, Places, StepReport, System, Vec3
from iota._core import Part as Weld
from iota.arguments import SHORT, is_number
from iota.errors import StaleIdError
from iota.world.callbacks import Guard
from iota.world.catching_up import CatchUp
from iota.world.clients import Client, Clients
from iota.world.contact_share import ContactShare
from iota.world.costs import Costs
from iota.world.parts import Part
from iota.world.scene import Scene
from iota.world.stand_ins import StandIn, Structure
from iota.world.stiffness import Stiffness
from iota.world.ties import Tie, Ties
from iota.world.visuals import Visuals

Floats = NDArray[np.float64]
Place = Sequence[float] | Vec3

SLICES = (8, 64)  # steps in which each thing is looked at once: with few and with many things
PER_SLICE, PER_DECISION = 200, 600  # things: with more, it is looked less often, and decided less often
NEAR = 1.25  # of the reach: a viewer may come nearer before a thing is looked at again
HOLD, HOLD_URGENT = 30, 8  # steps between two changes of a thing
NEVER = 1 << 60  # steps
REFUSED = 240  # steps: after the engine has ended the strides of a thing, they save nothing for so long; after a hand it is full
FULL, AIM, LOW = 0.75, 0.05, 0.15  # of the budget: begin to reduce, at first; so much lower: aimed at, begin to restore
LEARNT, RARE, LEARN_EVERY = 2000, 0.998, 64  # steps; their quantile that the budget has to hold; steps
SPREADS = (1.15, 1.9)  # of a rare step, in usual ones: less is luck, more comes from other programs
LONGEST_STRIDE = 16  # steps, as in the engine
URGENT = 1.5  # times the budget
MOST, MOST_URGENT = 16, 128  # changes in a step
SPEND, SPEND_URGENT = (
    0.1,
    0.5,
)  # of the budget, and of a step: what changes may take before the rest waits for the next step
SMOOTH, SLOW = 0.15, 0.03  # of the newest step in the smoothed time, and in that of a unit of work
IDLE = 0.02  # rad/s: so much the picture of a thing at rest may move soon
SHOWN_FOR, MOST_SHOWN, LINES = 0.5, 4000, 5  # s, bodies, changes that a page shows
SIGHT = 30.0  # m: from so far, nobody sees whether a frozen thing moves
MISSED = 0.25  # s: a thing that was frozen for less has missed nothing; its last stride is over then
CATCH_UP = 2.0  # ms in a step, for what frozen things would have done, if it must be done at once
EARLY, LATE = 1.1, 0.9  # of the sight: nearer, it begins to be found; nearer, it is too late
GONE = 1000  # things that are remembered after their end
JOINED = "joined"  # the reason of a change: two things have become one
LEAST_SLACK = 0.25  # m: so far viewers go at least before a thing is looked at again
# The budget that a world gives itself: when it begins, its share of the time that a step has, and after how many frames without need it ends.
TOO_SLOW, OWN_SHARE, OWN_REST = 0.95, 0.8, 600
LEAST_CORES = 0.5  # that a step is taken to have, however busy the machine is
UNSEEN = 1 / SIGHT  # rad, rad/s: what is smaller, slower and out of sight may stand still without anybody's noticing it


@dataclass(frozen=True)
class Level:
    """A level of a thing. name: for reports. stride: see `Body.stride`. is_stiff: its bodies are one. quality: from 1, as good as
    full, to 0. share: of the full cost, as far as is known before it is tried. enter, leave: functions of the script for a
    level of its own, called with the thing. structure: a function that makes an `iota.builder.Structure` of the same mass, which stands
    in for the thing at this level:

        far = Level("far", share=0.1, quality=0.5, structure=lambda thing: ball_of(thing.mass, thing.position))

    It begins with the thing's center of mass, momentum and angular momentum, and gives its own back. See docs/complexity.md.
    """

    name: str
    stride: int = 1
    is_stiff: bool = False
    quality: float = 1.0
    share: float = 1.0
    enter: Callable[[Managed], None] | None = None
    leave: Callable[[Managed], None] | None = None
    structure: Callable[[Managed], Structure] | None = None

    def is_like(self, other: Level) -> bool:
        """Whether both do no more than take strides, of the same length."""
        functions = (self.enter, self.structure, other.enter, other.structure)
        is_plain = not (self.is_stiff or other.is_stiff) and all(function is None for function in functions)
        return is_plain and self.stride == other.stride

    def __post_init__(self) -> None:
        """Raises TypeError and ValueError for what is not a level."""
        if not isinstance(self.name, str) or not self.name:
            raise TypeError(f"the name of a level must be a text, not {SHORT.repr(self.name)}")
        what = f"level {self.name!r}"
        if not isinstance(self.stride, int) or not 0 <= self.stride <= LONGEST_STRIDE:
            raise ValueError(
                f"{what}: stride must be a number of steps, 1 to {LONGEST_STRIDE}, or 0 for frozen, not {SHORT.repr(self.stride)}"
            )
        for key, value in (("quality", self.quality), ("share", self.share)):
            if not (is_number(value) and 0 <= value <= 1):
                raise ValueError(f"{what}: {key} must be a number from 0 to 1, not {SHORT.repr(value)}")
        for key in ("enter", "leave", "structure"):
            _refuse_no_function(f"{what}: {key}", getattr(self, key))


def _refuse_no_function(what: str, value: object) -> None:
    if not (value is None or callable(value)):
        raise TypeError(f"{what} must be a function that takes the thing, not {SHORT.repr(value)}")


FULL_LEVEL = Level("full")
HALF, QUARTER, EIGHTH = (Level(f"1/{n}", n, quality=q, share=1 / n) for n, q in ((2, 0.97), (4, 0.92), (8, 0.85)))
STIFF = Level("stiff", is_stiff=True, quality=0.4, share=0.15)
FROZEN = Level("frozen", 0, quality=0.05, share=0.0)
STANDARD = (FULL_LEVEL, HALF, QUARTER, EIGHTH, STIFF, FROZEN)
BY_NAME = {level.name: level for level in STANDARD}


@dataclass(eq=False)
class _Coming:
    """Things that were frozen out of sight and soon are in it: what they would have done is found in pieces."""

    thing: Managed
    things: list[Managed] = field(default_factory=list)
    bodies: list[Body] = field(default_factory=list)
    found: CatchUp | None = None


@dataclass(eq=False)
class _Together:
    """A thing, and those that ties and contacts join with it, so that they are solved together: of many the first ones. is_all: nothing else that
    moves is. touching: those with contacts, so that strides save nothing."""

    things: list[Managed]
    touching: set[Managed] = field(default_factory=set)
    is_all: bool = True


@dataclass(frozen=True)
class LevelChange:
    """A change of the level of a thing. ms: what it was expected to save a step; negative: to cost. reason: why."""

    time: float
    thing: str
    before: str
    after: str
    significance: float
    ms: float
    reason: str


@dataclass(eq=False)
class Managed:
    """A thing whose level is managed: see `Levels.manage`. root: its first body. others: a body of each further articulate that
    belongs to it. middle: the particle from which its other points are least far; extent: how far the farthest was when it came under
    management, m."""

    name: str
    root: Body
    levels: tuple[Level, ...]
    size: float
    middle: Particle
    extent: float = 0.0
    others: tuple[Body, ...] = ()
    significance: Callable[[Managed], float] | None = None
    on_level: Callable[[Managed, Level], None] | None = None
    is_pinned: bool = False
    is_chosen: bool = False  # by a call of `manage`
    is_jointed: bool = field(default=False, repr=False)  # joints, bonds or angle springs hold it
    index: int = field(default=0, repr=False)
    _stand_in: StandIn | None = field(default=None, repr=False)
    _former: deque[StandIn] = field(default_factory=lambda: deque(maxlen=4), repr=False)  # that an undo may bring back
    _lines: list[tuple[Particle, Particle]] = field(default_factory=list, repr=False)  # that it lacks as one body
    _welded: deque[Stiffness] = field(default_factory=lambda: deque(maxlen=4), repr=False)  # to become stiff
    _members: list[Body] = field(default_factory=list, repr=False)  # its bodies when its level was decided last
    _version: int = field(default=-1, repr=False)  # of the structure then
    _middles: dict[Body, tuple[Particle, float]] = field(default_factory=dict, repr=False)  # by the roots of several

    @property
    def level(self) -> Level:
        """Its present level."""
        return self.levels[self.index]

    @property
    def bodies(self) -> list[Body]:
        """Its bodies that are left, of which there is one while it is stiff; those of the structure that stands in for it. Those of a thing that
        was stiff are others than before, but for the first one."""
        if self._stand_in is not None:
            stands: list[Body] = [body for body in self._stand_in.bodies if body.alive]
            return stands
        found: list[Body] = []
        for root in self._roots:
            if root not in found:
                found = [*found, *root.articulate.bodies]
        return found

    @property
    def _spots(self) -> list[tuple[Particle, float]]:
        """Particles by which it is looked at, and from each to the farthest point of its articulate at most, m. Of several articulates each has
        one, as loose ones go their own ways."""
        if self._stand_in is not None:
            return [(self.bodies[0].particles[0], 2 * max(self.extent, self.size))]
        if self.others:
            return [self._middle_of(root) for root in self._roots]
        if self.middle.alive:
            return [(self.middle, self.extent)]
        return [(self.root.particles[0], 2 * max(self.extent, self.size))]  # stiffness has ended the middle

    def _middle_of(self, root: Body) -> tuple[Particle, float]:
        known = self._middles.get(root)
        if known is None or not known[0].alive:
            _, middle, extent = _measured(root.articulate.bodies)
            self._middles[root] = known = middle, extent
        return known

    @property
    def _roots(self) -> list[Body]:
        if self._stand_in is not None:
            return self._stand_in.roots
        return [body for body in (self.root, *self.others) if body.alive]

    def _swap(self, scene: Scene, level: Level, is_held: bool = False) -> None:
        """To the structure of a level, or back to the thing's own bodies. is_held: joints hold it at the world."""
        if self._stand_in is not None:
            whole = self._stand_in.is_whole
            self._former.append(self._stand_in)
            if whole:
                stand_in, self._stand_in = self._stand_in, None
                stand_in.leave()
            else:
                self._keep_stand_in()
        if level.structure is not None:
            structure = level.structure(self)
            self._stand_in = StandIn(self.root.system, scene, self.bodies, structure, level.name, is_held)

    def _keep_stand_in(self) -> None:
        """Somebody has taken the stand-in apart: what is left of it is the thing from now on, at the level full."""
        assert self._stand_in is not None
        left = self._stand_in.roots
        self._stand_in.keep()
        self._stand_in = None
        if left:
            self.root, self.others = left[0], tuple(left[1:])
            self._measure()
            self.levels, self.index = self.levels[:1], 0

    def _measure(self) -> None:
        """Its size, its middle and its extent now."""
        self.size, self.middle, self.extent = _measured(self.bodies)
        self._middles.clear()

    @property
    def mass(self) -> float:
        """The sum of those of its bodies, kg."""
        return sum(body.mass for body in self.bodies)

    @property
    def position(self) -> Vec3:
        """Its center of mass, m."""
        total = Vec3()
        for body in self.bodies:
            total = total + body.center_of_mass * body.mass
        return total / self.mass

    def _lives(self) -> bool:
        """Whether something of it is left. If its root is gone, what has absorbed the root, or a body of another of its articulates,
        is its root. A stand-in that is gone takes the thing with it."""
        if self._stand_in is not None:
            if self._stand_in.is_there:
                return True
            self._keep_stand_in()
        if not self.root.alive:
            left = [self.root.survivor, *self.others]
            before, self.root = self.root, next((body for body in left if body is not None and body.alive), self.root)
            if self.others:  # an undo may bring the former root back
                self.others = (before, *(body for body in self.others if body not in (before, self.root)))
        return self.root.alive

    def _has(self, body: Body) -> bool:
        return any(root.articulate == body.articulate for root in self._roots)

    def _set_stride(self, stride: int) -> None:
        for root in self._roots:
            root.articulate.stride = stride

    @property
    def _welds(self) -> list[Weld]:
        """The parts of its first body that stiffness has made of other bodies. A script may have welded more."""
        if not self._welded:
            return []
        known = frozenset().union(*(each.others for each in self._welded))
        return [part for part in self.root.parts if part.origin in known]

    def _set_stiff(self, stiff: bool, visuals: Visuals) -> None:
        if not stiff:
            self._come_apart(visuals)
            return
        for p, q in self._lines:
            if p.alive and q.alive and p.body == q.body:
                self.root.system.cosmetic_bond(p, q)
        self._lines = []
        others = [body for body in self.bodies if body != self.root and len(body.parts) == 1]
        self._welded.append(Stiffness(self.root, others))

    def _come_apart(self, visuals: Visuals) -> None:
        welds = self._welds
        of_these = {part.origin for part in welds}
        known = next((each for each in reversed(self._welded) if of_these <= each.others), None)
        changed = known.changed(self.root) if known is not None else None
        members = {self.root: self.root}
        for part in reversed(welds):  # so that they are in their former order
            origin = part.origin
            created = part.separate().created_bodies
            if created:
                members[origin] = created[0]
        if known is not None and changed is not None:
            known.give_back(members, visuals, changed)


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
        self._catch_up_ms = 0.0  # left in this step
        self._change_until = 0.0  # s, of processor time
        self._coming: deque[_Coming] = deque()
        self._handled: dict[Managed, int] = {}  # by hands: full until this step
        self._places: Places | None = None  # made when it is asked
        self._ties: Ties | None = None  # None: to be found when they are needed
        self._version = -1  # of the structure after the latest changes of levels, which make and end no ties
        self._by_root: dict[Body, Managed] = {}  # empty: as of no time
        self._unchecked: list[Managed] = []  # for joints: all at once, as each look goes through all joints
        self._things: list[Managed] = []
        self._names: set[str] = set()  # theirs, and of some that were
        self._was_on = False  # there was a budget, so an undo may bring its levels back
        self._gone: deque[Managed] = deque(maxlen=GONE)  # destroyed or joined: an undo may bring them back
        self._restructured: list[Managed] = []  # of a former budget: once stiff, or with a structure in their place
        self._is_restored = False  # a function of the script has made an undo or a reset within a change
        self._arrays = _Arrays(system)
        self._is_old = False
        self._count, self._looked_at = -1, -HOLD  # articulates, and the step in which they were counted
        self._steps = 0
        self._expected_step: int | None = None
        self._ms = self._own_ms = self._ms_of_work = 0.0
        self._latest_ms: tuple[float, ...] = ()
        self._full = FULL
        self._ratios: deque[float] = deque(maxlen=LEARNT)  # of steps to the smoothed one
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
        self._was_on = self._is_old = True

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
        _refuse_no_function("significance", significance)
        _refuse_no_function("on_level", on_level)
        if not isinstance(name, str):
            raise TypeError(f"the name of a thing must be a text, not {SHORT.repr(name)}")
        before = list(dict.fromkeys(managed for root in roots if (managed := self._find(root)) is not None))
        if chosen_before := next((each for each in before if each.is_chosen), None):
            raise ValueError(
                f"{chosen_before.root!r} is managed already, as {chosen_before.name!r}: call manage once for all that belongs together"
            )
        if not any(body.particles for body in members):
            raise ValueError(f"{bodies[0]!r} has no particles, so it never moves, and costs nothing")
        chosen = None if levels is None else self._levels(levels)
        wants_stiff = not _is_hung(members) if chosen is None else any(level.is_stiff for level in chosen)
        is_one = len(roots) == 1 and len(members) > 1
        is_jointed = is_one and wants_stiff and self._has_joints(members)
        can_be_stiff = is_one and not is_jointed
        if chosen is not None and wants_stiff and not can_be_stiff:
            raise ValueError(
                "a thing can be stiff if it is one articulate of several bodies, held together by hinges alone: joints would end when its bodies become one"
            )
        for managed in before:
            self._release(managed)
            self._things.remove(managed)
            self._by_root = {}
        made = self._add(roots[0], members, can_be_stiff, name, self._lined(), tuple(roots[1:]))
        made.levels = chosen or made.levels
        made.is_jointed = is_jointed
        self._unchecked.append(made)
        made.significance, made.on_level = significance, on_level
        made.is_chosen, made.is_pinned = True, any(each.is_pinned for each in before)
        return made

    def pin(self, thing: Body | Articulate | Managed) -> None:
        """A thing that is never reduced."""
        managed = thing if isinstance(thing, Managed) else self._find(thing)
        if managed is None:
            managed = self.manage(thing)  # type: ignore[arg-type]
            managed.is_chosen = False
        managed.is_pinned = True
        if managed.index:
            self._change(managed, 0, 0.0, 0.0, "pinned")
        self._is_old = True

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
        for thing in self._things:
            self._release(thing)
        self._end_strides()
        known = dict.fromkeys([*self._restructured, *self._gone, *self._things])
        self._restructured = [thing for thing in known if thing._welded or thing._former][-GONE:]
        self._coming.clear()
        self._handled.clear()
        self._things = [thing for thing in self._things if thing.is_chosen or thing.is_pinned]
        self._by_root = {}
        self._names = {thing.name for thing in self._things}
        self._gone.clear()
        self._count, self._looked_at = -1, self._steps - HOLD
        self._expected_step = self._system.step_count
        self._is_old = True

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
        return list(self._things)

    @property
    def ms(self) -> float:
        """Processor time of a step, smoothed, ms."""
        return self._ms

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
        for thing in self._things:
            found[thing.level.name] = found.get(thing.level.name, 0) + 1
        return found

    def __str__(self) -> str:
        """A budget bar, and what was reduced: "[######....] 2.4 of 4 ms: 12 full, 30 1/8, 5 frozen"."""
        share = self._system.contacts_share if isinstance(self._system, System) else 1
        contacts = f", contacts {share:g} of their budget" if share < 1 else ""
        if self._budget is None:
            return f"no budget: all is full{contacts}"
        filled = min(10, round(10 * self._ms / self._budget))
        counts = ", ".join(f"{count} {name}" for name, count in self.counts().items())
        whose = " to keep up with real time" if self._is_own else ""
        return (
            f"[{'#' * filled}{'.' * (10 - filled)}] {self._ms:.2g} of {self._budget:.3g} ms{whose}: {counts}{contacts}"
        )

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
        for thing in self._things:
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
            self._is_old = True
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
            self._take_ms(1e3 * (ended - began))
            if self._budget is not None:  # a function of the script may have ended it
                self._look_at_contacts(1e3 * (ended - began), self._budget)

    def _step_in_full(self, dt: float) -> StepReport:
        """A step of the system without a budget. An undo or a reset to a time with one brings strides, bodies that were one, structures and
        a share back."""
        if self._was_on and self._system.step_count != self._expected_step:
            for thing in self._restructured:
                self._reread(thing)
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
            self._look_at_contacts(1e3 * took, self._paced_ms)

    def _look_at_contacts(self, ms: float, limit: float) -> None:
        change = self._contacts.look(ms, limit)
        if change is not None:
            before, after = (f"{share:g} of their budget" for share in change)
            reason = "over budget" if change[1] < change[0] else "room again"
            self._changes.append(LevelChange(self._system.time, "contacts", before, after, 0.0, 0.0, reason))

    def _take_ms(self, ms: float) -> None:
        """The median of three: a single step that another process has held up is no load."""
        self._learn(ms)
        self._latest_ms = (*self._latest_ms[-2:], ms)
        ms = sorted(self._latest_ms)[len(self._latest_ms) // 2]
        self._ms = ms if self._ms == 0 else self._ms + SMOOTH * (ms - self._ms)
        work = self._arrays.load.sum()
        if work > 0:
            now = ms / work
            self._ms_of_work = now if self._ms_of_work == 0 else self._ms_of_work + SLOW * (now - self._ms_of_work)

    def _learn(self, ms: float) -> None:
        """Rare steps are to be within the budget, too: the more steps differ, the lower is what a usual one may take."""
        if self._ms <= 0:
            return
        self._ratios.append(ms / self._ms)
        count = len(self._ratios)
        if self._steps % LEARN_EVERY == 0 and 4 * count >= LEARNT:
            rare = float(np.partition(np.array(self._ratios), int(RARE * count))[int(RARE * count)])
            self._full = 1 / min(max(rare, SPREADS[0]), SPREADS[1])

    def _plan(self) -> None:
        assert self._budget is not None
        if self._version != self._system.structure_version:
            self._ties = None
        if self._is_restored or (self._expected_step != self._system.step_count and self._expected_step is not None):
            self._is_restored = False
            self._resync()
        count = self._system.articulate_count
        if count != self._count and self._steps - self._looked_at >= HOLD:
            self._looked_at, self._count = self._steps, count
            self._is_old = True
            self._manage_all()
        is_new = self._is_old or self._steps == 0
        if self._is_old:
            for thing in self._unchecked:
                if thing.root.alive:
                    self._is_jointed_by_now(thing, thing.bodies)
            self._unchecked.clear()
            self._things = self._living()
            self._arrays.build(self._things)
            self._by_root = {}
            self._is_old = False
        if not self._things:
            return
        seen = self._eyes()
        moved = np.inf
        if seen.shape == self._seen.shape:
            moved = float(np.linalg.norm(seen - self._seen, axis=1).max(initial=0.0))
        self._seen = seen
        self._steps += 1
        arrays = self._arrays
        self._catch_up_ms = CATCH_UP
        slack = max((NEAR - 1) * self._reach, LEAST_SLACK)
        for part in arrays.due(self._steps, np.inf if is_new else moved, slack):
            rows = slice(part, None, arrays.slices)
            arrays.look(rows, part, seen, self._reach, self._sight)
            come = [self._things[row] for row in arrays.come_into_sight(rows, self._system.time)]
            if moved <= slack:
                for thing in come:
                    self._await(thing)
            elif come:
                for thing in come:
                    self._catch_up(thing)
                arrays.look(rows, part, seen, self._reach, self._sight)
            for near in np.nonzero(arrays.near[rows] & (arrays.level[rows] > 0))[0]:
                self._change(self._things[part + arrays.slices * int(near)], 0, 1.0, 0.0, "in reach")
            for seen_again in np.nonzero(arrays.level[rows] > arrays.lowest[rows])[0]:
                row = part + arrays.slices * int(seen_again)
                self._change(
                    self._things[row], int(arrays.lowest[row]), float(arrays.significance[row]), 0.0, "in sight"
                )
        self._free_held()
        self._follow_engine()
        for row, thing in arrays.own:
            if row % arrays.slices == self._steps % arrays.slices:
                self._ask(row, thing)
        is_urgent = self._ms > URGENT * self._budget
        # Not both in one step, but for urgent ones: rare steps would have the worst of both.
        every = max(1 + len(self._things) // PER_DECISION, 2 if self._coming else 1)
        if is_urgent or self._steps % every == 0:
            self._decide()
        if is_urgent or self._steps % every != 0:
            self._find_what_comes()

    def _decide(self) -> None:
        assert self._budget is not None
        arrays, budget = self._arrays, self._budget
        is_urgent = self._ms > URGENT * budget
        spend = SPEND_URGENT * self._ms if is_urgent else SPEND * budget
        self._change_until = time.process_time() + 1e-3 * spend
        waited = self._steps - arrays.changed
        if self._ms > self._full * budget:
            hold = HOLD_URGENT if is_urgent else HOLD
            free = (waited >= hold) & ~arrays.near & ~arrays.pinned & (arrays.level < arrays.lowest)
            self._reduce(
                np.nonzero(free)[0],
                self._ms - (self._full - AIM) * budget,
                max(MOST_URGENT if is_urgent else MOST, len(self._things) // 40),
            )
        elif self._ms < (self._full - LOW) * budget:
            free = (waited >= HOLD) & (arrays.level > 0)
            self._restore(np.nonzero(free)[0], (self._full - AIM) * budget - self._ms)

    def _reduce(self, rows: NDArray[np.intp], need: float, most: int) -> None:
        """The least loss of significance for each saved millisecond first."""
        arrays = self._arrays
        if not len(rows):
            return
        target = arrays.next_level(rows)
        here, there = arrays.share_now(rows), arrays.shares[rows, target]
        saved = self._ms_of_work * arrays.full_load[rows] * np.maximum(here - there, 0.0)
        lost = arrays.significance[rows] * (arrays.qualities[rows, arrays.level[rows]] - arrays.qualities[rows, target])
        worth = (target != arrays.level[rows]) & (saved > 1e-6 * need)
        rows, target, saved, lost = rows[worth], target[worth], saved[worth], lost[worth]
        order = np.argsort((lost + 1e-12) / saved, kind="stable")[:most]
        done = 0.0
        looked_at = set[Managed]()  # with others that are to be frozen with them
        for i in order:
            if done >= need or time.process_time() > self._change_until:
                break
            thing, significance = self._things[rows[i]], float(arrays.significance[rows[i]])
            if thing in looked_at:
                continue
            if thing.levels[target[i]].stride == 0:
                done += self._freeze(thing, significance, looked_at)
                continue
            tied = self._tied_to(thing)
            if any(not arrays.is_free(each) for each in tied):
                continue
            self._change(thing, int(target[i]), significance, float(saved[i]), "over budget")
            done += float(saved[i])
            for each in tied:  # of what is solved together the shortest stride counts
                index = next((k for k, level in enumerate(each.levels) if level.is_like(thing.level)), None)
                if index is not None and index > each.index:
                    self._change(each, index, significance, 0.0, "over budget")
        self._ms -= done

    def _freeze(self, thing: Managed, significance: float, looked_at: set[Managed]) -> float:
        """Freezes it with all that is solved with it, as one that is not frozen would wake the others; or nothing. Returns the ms that are
        saved."""
        together = self._solved_with(thing)
        looked_at.update(together.things)
        indices = {each: _frozen_level(each) for each in together.things}
        is_free = all(index is not None and self._arrays.may_have(each, index) for each, index in indices.items())
        if not (together.is_all and is_free):
            return 0.0
        for each in together.touching:
            self._arrays.refuse_strides(each, NEVER)
        sum_saved = 0.0
        for each, index in indices.items():
            if index is not None and index > each.index:
                saved = self._ms_of_work * self._arrays.saved_at(each, index)
                self._change(each, index, significance, saved, "over budget")
                sum_saved += saved
        return sum_saved

    def _solved_with(self, thing: Managed) -> _Together:
        found = _Together([thing])
        for each in found.things:  # which grow
            others = {contact.other for body in each.bodies for contact in body.contacts}
            touched = [
                self._find(other) for other in others if other.kind in ("dynamic", "resting") and not each._has(other)
            ]
            mates = dict.fromkeys([*self._tied_to(each), *(mate for mate in touched if mate is not None)])
            if touched:
                found.touching.add(each)
            if None in touched or len(found.things) > MOST_URGENT:
                found.is_all = False
                break
            found.things += [mate for mate in mates if mate not in found.things]
        return found

    def _restore(self, rows: NDArray[np.intp], room: float) -> None:
        """The most significance for each millisecond first: many things at strides rather than few in full."""
        arrays = self._arrays
        if not len(rows):
            return
        unit = self._ms_of_work * arrays.full_load[rows]
        at, target, gain, cost = arrays.steps_up(rows, unit)
        order = np.argsort(-(gain + 1e-12) / (cost + 1e-9), kind="stable")
        order = order[np.cumsum(cost[order]) <= room]
        best: dict[int, int] = {}  # of rows, in order
        for i in order:
            best[int(at[i])] = int(target[i])
        here = arrays.share_now(rows)
        for i in list(best)[: max(MOST, len(self._things) // 60)]:
            row, index = int(rows[i]), best[i]
            if (
                room < CATCH_UP and arrays.missed(row, self._system.time) > MISSED
            ):  # first what it would have done, in pieces
                self._await(self._things[row])
                continue
            thing = self._things[row]
            if thing.index != arrays.level[row]:
                continue  # with another one
            if thing.level.stride == 0 and thing.levels[index].stride != 0:
                room -= self._unfreeze(thing, index, float(arrays.significance[row]), room)
            else:
                ms = float(unit[i] * max(arrays.shares[row, index] - here[i], 0.0))
                room -= ms
                self._change(thing, index, float(arrays.significance[row]), -ms, "time is left")
                self._ms += ms
            if time.process_time() > self._change_until:
                break

    def _unfreeze(self, thing: Managed, index: int, significance: float, room: float) -> float:
        """Brings a thing to a level with all that is solved with it, as that wakes, too: if there is room for them. Returns the ms that it costs."""
        together = self._solved_with(thing)
        level, unit = thing.levels[index], self._ms_of_work
        targets = {thing: index}
        for each in together.things:
            if each.level.stride == 0:
                alike = (k for k, other in enumerate(each.levels) if other.is_like(level))
                targets.setdefault(each, next(alike, 0))
        costs = {each: -unit * self._arrays.saved_at(each, target) for each, target in targets.items()}
        cost = sum(costs.values())
        if len(targets) > 1 and cost > room:
            return 0.0
        for each, target in targets.items():
            self._change(each, target, significance, -costs[each], "time is left")
            if each in together.touching:
                self._arrays.refuse_strides(each, self._steps + REFUSED)
        self._ms += cost
        return cost

    def _change(self, thing: Managed, index: int, significance: float, ms: float, reason: str) -> None:
        """One or several levels up or down; what fails stays at its level and is not managed any more."""
        if not thing.root.alive:
            self._is_old = True
            return
        before, after = thing.level, thing.levels[index]
        if index and not self._is_as_it_was(thing):
            self._is_old = True
            return
        if after.is_stiff and self._is_jointed_by_now(thing, thing.bodies):
            return
        if before.stride == 0 and after.stride != 0 and reason != JOINED:
            self._catch_up(thing)

        def change() -> None:
            if before.leave is not None:
                before.leave(thing)
            if before.structure is not None or after.structure is not None:
                thing._swap(self._scene, after, after.structure is not None and self._is_held(thing, after))
                self._by_root = {}
            if not thing.root.alive or after not in thing.levels:
                return  # the script has destroyed it meanwhile, or taken what stood in for it apart
            was_stiff = bool(thing._welds)
            is_stiff = after.is_stiff or (was_stiff and after.stride == 0)  # frozen things cost nothing either way
            if is_stiff != was_stiff:
                self._set_stiff(thing, is_stiff)
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
            self._is_old = True
        self._arrays.note(thing, self._steps)
        self._changes.append(
            LevelChange(self._system.time, thing.name, before.name, after.name, significance, ms, reason)
        )

    def _set_stiff(self, thing: Managed, is_stiff: bool) -> None:
        thing._set_stiff(is_stiff, self._scene._visuals)
        thing._members = thing.bodies
        if not is_stiff and not thing.middle.alive:
            thing._measure()
        self._arrays.find_points_of(thing)

    def _is_as_it_was(self, thing: Managed) -> bool:
        """Whether nothing was joined to it, or parted, since its level was decided last: see _living."""
        version = self._system.structure_version
        if version == thing._version:
            return True
        members, thing._version = thing._members, version
        thing._members = thing.bodies
        return thing._members == members

    def _catch_up(self, thing: Managed) -> None:
        """A thing that was frozen out of sight has done what it would have done, unless this step has had enough of that. So have all that
        joints tie to it, if all of that was."""
        coming = self._coming_of(thing)
        if coming is None:
            if not self._arrays.has_missed(thing):
                return
            coming = _Coming(thing)
        else:
            self._coming.remove(coming)
        if self._catch_up_ms <= 0:
            self._begin(coming, is_late=True)
            return
        began = time.process_time()
        if self._begin(coming) and coming.found is not None:
            coming.found.go_on()
            self._end(coming)
        self._catch_up_ms -= 1e3 * (time.process_time() - began)

    def _begin(self, coming: _Coming, is_late: bool = False) -> bool:
        """Copies what comes, once. False if it has missed nothing, or goes on from where it was."""
        if coming.found is not None:
            return True
        thing = coming.thing
        if not thing.root.alive or thing.level.stride != 0 or not self._arrays.has_missed(thing):
            return False
        if thing._welds and not is_late:  # frozen, it costs nothing apart
            self._set_stiff(thing, False)
        coming.things, coming.bodies, ties = [thing], thing.bodies, list[Tie]()
        if self._is_jointed_by_now(thing, coming.bodies):
            coming.bodies, ties = self._all_ties().around(coming.bodies)
            found = (self._thing_of_root(body) for body in coming.bodies)
            coming.things = list(dict.fromkeys(each for each in found if each is not None))
        seconds = min((self._arrays.take_missed(each, self._system.time) for each in coming.things), default=0.0)
        if is_late or (thing.is_jointed and any(body.stride != 0 for body in coming.bodies)):
            return False
        if not (seconds > MISSED and all(each._stand_in is None for each in coming.things)):
            return False
        self._places = self._places or Places(self._system)
        coming.found = CatchUp(self._system, coming.bodies, seconds, ties, self._places)
        return True

    def _end(self, coming: _Coming) -> None:
        """Puts a thing where it would have come."""
        is_whole = all(body.alive and body.stride == 0 for body in coming.bodies)
        if is_whole and coming.found is not None and coming.found.finish():
            for each in coming.things:
                each._set_stride(each.level.stride)

    def _await(self, thing: Managed) -> None:
        if self._coming_of(thing) is None:
            self._coming.append(_Coming(thing))

    def _coming_of(self, thing: Managed) -> _Coming | None:
        return next((each for each in self._coming if thing is each.thing or thing in each.things), None)

    def _find_what_comes(self) -> None:
        """In what is left of the time of a step, and at least a small part of it."""
        assert self._budget is not None
        left = max(SPEND * self._budget, self._full * self._budget - self._ms)
        until = time.process_time() + 1e-3 * left
        while self._coming:
            coming = self._coming[0]
            is_late = coming.found is None and self._arrays.is_seen(coming.thing)
            if self._begin(coming, is_late) and coming.found is not None:
                if not coming.found.go_on(until):
                    return
                self._end(coming)
            self._coming.popleft()
            if time.process_time() > until:
                return

    def _tied_to(self, thing: Managed) -> list[Managed]:
        """The other things that joints, bonds and angle springs tie to it."""
        if not thing.is_jointed:
            return []
        bodies, _ = self._all_ties().around(thing.bodies)
        found = dict.fromkeys(each for body in bodies if (each := self._thing_of_root(body)) is not None)
        return [each for each in found if each is not thing]

    def _thing_of_root(self, body: Body) -> Managed | None:
        if not self._by_root:
            self._by_root = {root: thing for thing in self._things for root in thing._roots}
        return self._by_root.get(body)

    def _all_ties(self) -> Ties:
        if self._ties is None:
            self._ties = Ties(self._system)
        return self._ties

    def _is_jointed_by_now(self, thing: Managed, bodies: list[Body]) -> bool:
        """The script may have made joints since it came under management. Such a thing is never stiff, as they would end."""
        if not thing.is_jointed and self._all_ties().hold(bodies):
            level = thing.level
            thing.is_jointed = self._is_old = True
            thing.levels = tuple(each for each in thing.levels if not each.is_stiff or each is level)
            thing.index = thing.levels.index(level)
        return thing.is_jointed

    def _is_held(self, thing: Managed, level: Level) -> bool:
        """Whether joints hold it at the world. Raises ValueError if something holds it to what goes on without it."""
        is_held, tie = self._all_ties().beyond(thing.bodies)
        if tie is not None:
            raise ValueError(
                f"a structure cannot stand in for {thing.name!r} at level {level.name!r}, as {tie!r} ties it to something else that"
                " moves: manage both as one thing, with `manage([...])`, or give it the level 'frozen' instead"
            )
        return is_held

    def _give_up(self, thing: Managed) -> None:
        """A function of one of its levels has failed: it is full from now on, with its own bodies."""
        thing.is_pinned = self._is_old = True
        thing.index = 0
        if thing._stand_in is not None:
            thing._swap(self._scene, thing.levels[0])
        if thing.root.alive:
            thing._set_stride(1)

    # --- things -----------------------------------------------------------------------------------------------------

    def _living(self) -> list[Managed]:
        """The things of which something is left. Of those that were joined the first one is kept, full, with what the others were
        managed for."""
        first_of: dict[int, Managed] = {}  # by the numbers of articulates
        joined: list[tuple[Managed, Managed]] = []
        for thing in self._things:
            if not thing._lives():
                continue
            if thing._stand_in is not None and not thing._stand_in.is_whole:
                thing._keep_stand_in()
            numbers = [root.articulate.number for root in thing._roots]
            first = next((first_of[number] for number in numbers if number in first_of), thing)
            if first is not thing:
                joined.append((first, thing))
            for number in numbers:
                other = first_of.setdefault(number, first)
                if other is not first:
                    joined.append((first, other))
                    first_of = {key: first if each is other else each for key, each in first_of.items()}
        gone = {thing for _, thing in joined}
        self._gone.extend(thing for thing in self._things if thing in gone or not thing._lives())
        for first, other in joined:
            first.is_pinned = first.is_pinned or other.is_pinned
            for thing in (first, other):
                self._arrays.take_missed(thing, self._system.time)
                if thing.index:
                    self._change(thing, 0, 1.0, 0.0, JOINED)
            if other.is_jointed:
                first.is_jointed = True
                first.levels = tuple(level for level in first.levels if not level.is_stiff)
        for first, _ in joined:
            if first not in gone and first._lives():
                first._measure()
        return [thing for thing in self._things if thing not in gone and thing._lives()]

    def _manage_all(self) -> None:
        """Also what was made, or parted, since this was called last."""
        jointed, lined = self._jointed(), self._lined()
        known = {root.articulate.number for thing in self._things if thing._lives() for root in thing._roots}
        for articulate in self._system.articulates:
            if articulate.number in known:
                continue
            members = articulate.bodies
            moving = [body for body in members if body.kind in ("dynamic", "resting")]
            if moving and not moving[0].is_spark and any(len(body.particles) > 1 for body in moving):
                is_jointed = any(body in jointed for body in members)
                made = self._add(moving[0], members, len(members) > 1 and not is_jointed, "", lined)
                made.is_jointed = is_jointed
                self._reread(made)  # a part of something that had a stride has it, too

    def _add(
        self,
        root: Body,
        members: list[Body],
        can_be_stiff: bool,
        name: str,
        lined: set[Body],
        others: tuple[Body, ...] = (),
    ) -> Managed:
        """lined: bodies with lines of their own."""
        size, middle, extent = _measured(members)
        stiff = replace(STIFF, share=min(1.0, 1.2 / len(members)))
        # A thing that hangs saves little by stiffness, and loses its swing: strides of 8 cost less.
        has_stiff = can_be_stiff and not _is_hung(members)
        levels = tuple(stiff if level is STIFF else level for level in STANDARD if has_stiff or level is not STIFF)
        lines: list[tuple[Particle, Particle]] = []
        if can_be_stiff:  # as they are drawn now
            plain = [body for body in members if not body.solids and body not in lined]
            lines = [pair for body in plain for pair in pairwise(body.particles)]
        made = Managed(
            name or self._name_of(root, members),
            root,
            levels,
            size,
            middle,
            extent,
            others,
            _lines=lines,
        )
        made._members = made.bodies
        self._names.add(made.name)
        self._things.append(made)
        if self._by_root:
            self._by_root.update(dict.fromkeys(made._roots, made))
        self._is_old = True
        return made

    def _name_of(self, root: Body, members: list[Body]) -> str:
        """Reports call it so: "8 rods 'rope 4'", or without a name of its bodies "8 rods from rod 17"."""
        words = {_word_for(body) for body in members}
        word = words.pop() if len(words) == 1 else "body"
        plural = "bodies" if word == "body" else "boxes" if word == "box" else f"{word}s"
        kind = word if len(members) == 1 else f"{len(members)} {plural}"
        name = next((body.name for body in (root, *members) if body.name), "")
        if not name:
            return f"{kind} {root.slot}" if len(members) == 1 else f"{kind} from {_word_for(root)} {root.slot}"
        called = f"{kind} {name!r}"
        return called if called not in self._names else f"{kind} {f'{name} {root.slot}'!r}"

    @staticmethod
    def _levels(given: Sequence[str | Level]) -> tuple[Level, ...]:
        levels: list[Level] = []
        for level in [given] if isinstance(given, str) else given:
            if isinstance(level, str) and level not in BY_NAME:
                raise ValueError(
                    f"no level is called {level!r}; there are {', '.join(map(repr, BY_NAME))}, or a Level of one's own"
                )
            if not isinstance(level, str | Level):
                raise TypeError(f"levels are names or of the type Level, not {SHORT.repr(level)}")
            levels.append(BY_NAME[level] if isinstance(level, str) else level)
        if not levels or levels[0] != FULL_LEVEL:
            raise ValueError("levels begin with 'full', at which a thing is as without management")
        names = [level.name for level in levels]
        if twice := next((each for each in names if names.count(each) > 1), None):
            raise ValueError(f"there are two levels {twice!r}: reports tell them by their names")
        return tuple(levels)

    def _lined(self) -> set[Body]:
        return {p.body for p, _ in self._system.cosmetic_lines}

    def _jointed(self) -> set[Body]:
        """Bodies that joints, bonds and angle springs refer to."""
        system = self._system
        found = {body for joint in system.constraints for body in (joint.a, joint.b) if body is not None}
        found |= {end.body for spring in system.angle_springs for end in spring.ends}
        return found | {end.body for bond in system.bonds for end in bond.ends}

    def _has_joints(self, members: list[Body]) -> bool:
        jointed = self._jointed()
        return any(body in jointed for body in members)

    def _find(self, thing: Body | Articulate) -> Managed | None:
        members = thing.articulate.bodies if isinstance(thing, Body) else thing.bodies
        return next((each for body in members if (each := self._thing_of_root(body)) is not None), None)

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
            things = dict.fromkeys(self._find(each) for each in touched if each.kind in ("dynamic", "resting"))
            for thing, reason in ((self._find(body), "held"), *((each, "touched by what is held") for each in things)):
                if thing is None:
                    continue
                self._handled[thing] = self._steps + REFUSED
                if thing.index:
                    self._change(thing, 0, 1.0, 0.0, reason)
        self._handled = {thing: until for thing, until in self._handled.items() if until >= self._steps}
        for thing in self._handled:
            self._arrays.keep_full(thing)

    def _follow_engine(self) -> None:
        """A thing that an edit, a force or something full has touched takes every step."""
        slices = self._arrays.slices
        part = self._steps % slices
        for i in np.nonzero(self._arrays.runs[part::slices])[0]:
            thing = self._things[part + slices * int(i)]
            if thing.index and any(root.stride != thing.level.stride for root in thing._roots):
                self._arrays.refuse_strides(thing, self._steps + REFUSED)
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
            self._is_old = True

    def _resync(self) -> None:
        """The system was restored or undone: its bodies tell the levels of their things."""
        self._coming.clear()
        self._handled.clear()
        for thing in self._things:
            self._reread(thing)
        for thing in self._revived():
            self._reread(thing)
        for thing in self._things:
            if thing.is_pinned and thing.index and thing.root.alive:
                self._change(thing, 0, 0.0, 0.0, "pinned")
        self._is_old = True

    def _revived(self) -> list[Managed]:
        """Things that were destroyed or joined to others, and are there again: they are managed again."""
        known = {root.articulate.number for thing in self._things if thing._lives() for root in thing._roots}
        found = []
        for thing in list(self._gone):
            bodies = [body for body in (thing.root, *thing._members) if body.alive]
            root = next((body for body in bodies if body.articulate.number not in known), None)
            if root is not None:
                thing.root, thing.others = root, tuple(body for body in thing.others if body.alive)
                thing._measure()
                known.update(each.articulate.number for each in thing._roots)
                self._gone.remove(thing)
                found.append(thing)
        self._things += found
        self._by_root = {}
        return found

    @staticmethod
    def _reread(thing: Managed) -> None:
        if thing._stand_in is not None:
            thing._former.append(thing._stand_in)
        thing._stand_in = next((each for each in thing._former if each.is_whole), None)
        if not thing._lives():
            return
        if thing._stand_in is not None:
            thing.index = next((i for i, level in enumerate(thing.levels) if level.structure is not None), 0)
            return
        stride, is_stiff = thing.root.stride, bool(thing._welds)
        fitting = [
            i
            for i, level in enumerate(thing.levels)
            if level.enter is None
            and level.structure is None
            and level.stride == stride
            and (level.is_stiff == is_stiff or stride == 0)
        ]
        thing.index = fitting[0] if fitting else 0


def _places(given: Iterable[Place]) -> list[list[float]]:
    try:
        return [list(Vec3(*place)) for place in given]
    except (TypeError, ValueError):
        raise TypeError(
            f"levels.viewers must return a list of places, (x, y, z) in m, not {SHORT.repr(given)}"
        ) from None


def _is_hung(bodies: list[Body]) -> bool:
    return any(p.is_nailed for body in bodies for p in body.particles)


def _measured(bodies: list[Body]) -> tuple[float, Particle, float]:
    """The size of bodies, m, the particle in their middle, and the distance of their farthest point from it, m."""
    points = [p for body in bodies for p in body.particles]
    places = np.array([list(p.position) for p in points])
    thick = max(body.radius for body in bodies)
    size = float(np.linalg.norm(np.ptp(places, axis=0))) + thick
    center = (places.min(axis=0) + places.max(axis=0)) / 2
    middle = int(np.linalg.norm(places - center, axis=1).argmin())
    extent = float(np.linalg.norm(places - places[middle], axis=1).max()) + thick
    return max(size, 1e-6), points[middle], extent


def _frozen_level(thing: Managed) -> int | None:
    """Index of the level at which it is frozen, and no more than that; None if there is none."""
    return next((i for i, level in enumerate(thing.levels) if level.is_like(FROZEN)), None)


def _last_that_moves(levels: Sequence[Level]) -> int:
    """Index of the last one at which all of a thing moves, as far as those before it do."""
    stopped = (i for i, level in enumerate(levels) if level.is_stiff or level.stride == 0)
    return next(stopped, len(levels)) - 1


def _lengths(vectors: Floats) -> Floats:
    result: Floats = np.sqrt(np.einsum("...i,...i", vectors, vectors))
    return result


def _word_for(body: Body) -> str:
    """The word for its shape."""
    if body.solids:
        return "body" if len(body.solids) > 1 else type(body.solids[0].shape).__name__.lower()
    return {1: "particle", 2: "rod"}.get(len(body.particles), "body")


def _eye_of(client: Client) -> Place | None:
    """The place of its user's eyes, as its page has told, or until then the camera that it got."""
    if client.eye is not None or client.camera is None:
        return client.eye
    return client.camera.position


class _Spots:
    """The middles of the articulates of things, which say where these are."""

    def __init__(self, system: System, things: list[Managed]) -> None:
        spots = [thing._spots for thing in things]
        counts = [len(each) for each in spots]
        self._starts = np.cumsum([0, *counts[:-1]])
        self._middles: ParticleArray = system.array([middle for each in spots for middle, _ in each])
        self._extents = np.array([extent for each in spots for _, extent in each])
        halves = np.repeat([0.5 * thing.size for thing in things], counts)
        self._halves = np.where(np.repeat(counts, counts) > 1, self._extents, halves)
        self._has_several = len(self._extents) > len(things)

    def speeds(self) -> Floats:
        """The speed of the fastest middle of each thing, m/s."""
        speeds = _lengths(self._middles.velocities)
        return np.maximum.reduceat(speeds, self._starts) if self._has_several else speeds

    def distances(self, eyes: Floats) -> tuple[Floats, Floats]:
        """From the nearest viewer to the nearest point that each thing may have, and to about where its picture is, m."""
        distance = _lengths(self._middles.positions[:, None, :] - eyes[None, :, :]).min(axis=1)
        gap, seen = distance - self._extents, np.maximum(distance - self._halves, 1e-3)
        if self._has_several:
            gap, seen = np.minimum.reduceat(gap, self._starts), np.minimum.reduceat(seen, self._starts)
        return gap, seen


class _Arrays:
    """The numbers that decisions are made of, with a row for each thing."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._row: dict[Managed, int] = {}
        self.significance, self.load, self.full_load = np.zeros(0), np.zeros(0), np.zeros(0)
        self.changed = np.zeros(0, dtype=int)
        self._refused = np.zeros(0, dtype=int)  # until this step
        self._now = 0  # step
        self.since = np.zeros(0)  # s: it has been frozen and out of sight; nan: it is not
        self.is_mild = False  # nothing in sight is stopped
        self.build([])

    def build(self, things: list[Managed]) -> None:
        before = [
            (key, row, self.significance, self.load, self.full_load, self.changed) for key, row in self._row.items()
        ]
        count, width = len(things), max((len(thing.levels) for thing in things), default=1)
        self.slices = min(max(SLICES[0], count // PER_SLICE), SLICES[1])
        self._row = {thing: row for row, thing in enumerate(things)}
        self.own = [(row, thing) for row, thing in enumerate(things) if thing.significance is not None]
        self._asked = np.array([thing.significance is not None for thing in things], dtype=bool)
        self.level = np.array([thing.index for thing in things], dtype=int)
        self._last = np.array([len(thing.levels) - 1 for thing in things], dtype=int)
        self._mildest = np.array([_last_that_moves(thing.levels) for thing in things], dtype=int)
        self.lowest = (self._mildest if self.is_mild else self._last).copy()  # level that it may have now
        self.pinned = np.array([thing.is_pinned for thing in things], dtype=bool)
        self.size = np.array([thing.size for thing in things], dtype=float)
        self.qualities, self.shares = np.zeros((count, width)), np.zeros((count, width))
        self.strides = np.ones((count, width), dtype=int)
        for row, thing in enumerate(things):
            for i, level in enumerate(thing.levels):
                self.qualities[row, i], self.shares[row, i], self.strides[row, i] = (
                    level.quality,
                    level.share,
                    level.stride,
                )
        self.stride = np.array([thing.level.stride for thing in things], dtype=int)  # at its level
        self.near, self.is_far, self.is_near = (np.zeros(count, dtype=bool) for _ in range(3))
        self.significance, self.load, self.full_load = np.zeros(count), np.zeros(count), np.zeros(count)
        self.touches, self.runs = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        self.changed = np.full(count, -HOLD, dtype=int)
        since, self.since = self.since, np.full(count, np.nan)
        refused, self._refused = self._refused, np.zeros(count, dtype=int)
        for key, former, significance, load, full_load, changed in before:
            row = self._row.get(key, -1)
            if row >= 0:
                self.significance[row], self.load[row] = significance[former], load[former]
                self.full_load[row], self.changed[row] = full_load[former], changed[former]
                self.since[row], self._refused[row] = since[former], refused[former]
        self._way = np.zeros(self.slices)  # m: of the viewers, since its things were looked at
        self._roots: list[BodyArray | None] = [None] * self.slices
        self._starts = [np.zeros(0, dtype=int)] * self.slices
        self._spots: list[_Spots | None] = [None] * self.slices
        self._is_old = np.ones(self.slices, dtype=bool)
        self._things = things

    def _find_points(self, part: int) -> None:
        """The bodies and particles by which things of a slice are looked at."""
        things = self._things[part :: self.slices]
        roots = [thing._roots for thing in things]
        if not all(roots):
            raise StaleIdError("a thing was destroyed since the last step")
        self._roots[part] = self._system.array([root for each in roots for root in each]) if roots else None
        self._starts[part] = np.cumsum([0, *(len(each) for each in roots[:-1])])
        self._spots[part] = _Spots(self._system, things) if things else None
        self._is_old[part] = False

    def note(self, thing: Managed, step: int) -> None:
        row = self._row.get(thing)
        if row is not None:
            self.level[row], self.changed[row] = thing.index, step
            self.stride[row] = thing.level.stride
            if self.stride[row] != 0:  # what was frozen together may part
                self._refused[row] = min(self._refused[row], step + REFUSED)
            self.load[row] = self.full_load[row] * self.shares[row, thing.index]
            self.touches[row] = self.runs[row] = False

    def refuse_strides(self, thing: Managed, until: int) -> None:
        """Strides of a thing that something full touches, or that the script edits in each step, save nothing until this step."""
        if (row := self._row.get(thing)) is not None:
            self._refused[row] = until

    def find_points_of(self, thing: Managed) -> None:
        """Its bodies have become one, or come apart: its middle may be another particle."""
        if (row := self._row.get(thing)) is not None:
            self._is_old[row % self.slices] = True

    def keep_full(self, thing: Managed) -> None:
        """In this step it may not be reduced."""
        if (row := self._row.get(thing)) is not None:
            self.near[row] = True

    def is_free(self, thing: Managed) -> bool:
        """Whether it may be reduced."""
        row = self._row.get(thing)
        return row is not None and not self.near[row] and not self.pinned[row]

    def may_have(self, thing: Managed, index: int) -> bool:
        """Whether it may be reduced to a level."""
        return self.is_free(thing) and index <= self.lowest[self._row[thing]]

    def saved_at(self, thing: Managed, index: int) -> float:
        """The work that another level of a thing is expected to save; negative: to cost."""
        row = self._row.get(thing)
        if row is None or index >= self.shares.shape[1]:
            return 0.0
        rows = np.array([row])
        return float(self.full_load[row] * (self.share_now(rows)[0] - self._shares_of(rows)[0, index]))

    def is_seen(self, thing: Managed) -> bool:
        """Whether it has been in sight for some time."""
        row = self._row.get(thing)
        return row is not None and bool(self.is_near[row])

    def come_into_sight(self, rows: slice, now: float) -> NDArray[np.intp]:
        """The frozen things that have. Notes those that are out of sight."""
        since = self.since[rows]  # a view
        is_frozen, is_missed, is_far = self.stride[rows] == 0, np.isfinite(since), self.is_far[rows]
        since[is_frozen & is_far & ~is_missed] = now
        come: NDArray[np.intp] = rows.start + rows.step * np.nonzero(is_frozen & ~is_far & is_missed)[0]
        return come

    def missed(self, row: int, now: float) -> float:
        """For how long it has been frozen out of sight, s."""
        seconds = now - float(self.since[row])
        return seconds if math.isfinite(seconds) else 0.0

    def has_missed(self, thing: Managed) -> bool:
        """Whether it has been frozen out of sight."""
        row = self._row.get(thing)
        return row is not None and bool(np.isfinite(self.since[row]))

    def take_missed(self, thing: Managed, now: float) -> float:
        """For how long that was, s; it begins anew."""
        row = self._row.get(thing)
        if row is None:
            return 0.0
        seconds = self.missed(row, now)
        self.since[row] = np.nan
        return seconds

    def due(self, step: int, moved: float, slack: float) -> list[int]:
        """The slices that are to be looked at: one in each step, and those since whose last look the viewers may have come nearer than
        the slack, m."""
        self._now = step
        self._way += moved
        is_due = self._way > slack
        is_due[step % self.slices] = True
        self._way[is_due] = 0.0
        return [int(part) for part in np.nonzero(is_due)[0]]

    def look(self, rows: slice, part: int, eyes: Floats, reach: float, sight: float) -> None:
        """Reads some things, and what they mean to the viewers."""
        if self._is_old[part]:
            self._find_points(part)
        roots, spots = self._roots[part], self._spots[part]
        if roots is None or spots is None:
            return
        speeds = spots.speeds()
        work, steps = roots.work.T
        size = self.size[rows]
        load = np.where(steps > 0, work / np.maximum(steps, 1), 0.0)
        takes_each = steps == 1
        starts = self._starts[part]
        if len(load) > len(size):  # things of several articulates
            of_roots = _lengths(roots.velocities)
            speeds = np.maximum(speeds, np.maximum.reduceat(of_roots, starts))
            load, takes_each = np.add.reduceat(load, starts), np.logical_or.reduceat(takes_each, starts)
        self.load[rows] = load
        at_full = (self.level[rows] == 0) & (load > 0)
        full = self.full_load[rows]
        self.full_load[rows] = np.where(at_full, np.where(full > 0, full + 0.3 * (load - full), load), full)
        stride = self.stride[rows]
        self.touches[rows] = (stride > 1) & takes_each
        self.runs[rows] = (stride != 1) & takes_each
        if len(eyes):
            gap, distance = spots.distances(eyes)
            self.near[rows] = gap <= NEAR * reach
            self.is_far[rows] = gap > EARLY * sight
            self.is_near[rows] = gap < LATE * sight
            seen = np.minimum(size / distance, math.pi) * (speeds / distance + IDLE)
            if self.is_mild:
                is_unseen = self.is_far[rows] & (np.maximum(size, speeds) < UNSEEN * distance)
                self.lowest[rows] = np.where(is_unseen, self._last[rows], self._mildest[rows])
        else:
            seen = speeds + IDLE
            self.near[rows], self.is_far[rows], self.is_near[rows] = False, True, False
        self.significance[rows] = np.where(self._asked[rows], self.significance[rows], seen) if self.own else seen

    def _shares_of(self, rows: NDArray[np.intp]) -> Floats:
        """Shares of the full cost, as far as they are known: strides save nothing for what touches something."""
        takes_each = self.touches[rows] | (self._refused[rows] > self._now)
        result: Floats = np.where(takes_each[:, None] & (self.strides[rows] > 1), 1.0, self.shares[rows])
        return result

    def share_now(self, rows: NDArray[np.intp]) -> Floats:
        """The share of the full cost at the present level."""
        result: Floats = self._shares_of(rows)[np.arange(len(rows)), self.level[rows]]
        return result

    def next_level(self, rows: NDArray[np.intp]) -> NDArray[np.intp]:
        """The next one that is expected to cost less; the present one if there is none."""
        index = np.arange(self.shares.shape[1])
        is_less = (index > self.level[rows, None]) & (index <= self.lowest[rows, None])
        is_less &= self._shares_of(rows) < 0.9 * self.share_now(rows)[:, None]
        target: NDArray[np.intp] = np.where(is_less.any(axis=1), is_less.argmax(axis=1), self.level[rows])
        return target

    def steps_up(
        self, rows: NDArray[np.intp], unit: Floats
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], Floats, Floats]:
        """The ways up of things, in steps of which each gains the most significance for its cost; unit: ms that each costs at full. For each
        step the place of its thing in `rows`, the level it leads to, what it gains, and what it costs, ms."""
        places = np.arange(len(rows))
        level, share, shares = self.level[rows], self.share_now(rows), self._shares_of(rows)
        found = []
        while len(places):
            row = rows[places]
            gain = self.qualities[row] - self.qualities[row, level][:, None]
            cost = np.maximum(shares[places] - share[:, None], 0.0)
            worth = np.where(np.arange(gain.shape[1]) < level[:, None], gain / (cost + 1e-9), -np.inf)
            target = worth.argmax(axis=1)
            goes = np.isfinite(worth[np.arange(len(row)), target])
            places, row, level, target = places[goes], row[goes], level[goes], target[goes]
            here = np.arange(len(goes))[goes]
            found.append(
                (places, target, self.significance[row] * gain[here, target], unit[places] * cost[here, target])
            )
            level, share = target, shares[places, target]
        at, targets, gains, costs = (np.concatenate(each) for each in zip(*found, strict=True))
        return at, targets, gains, costs
