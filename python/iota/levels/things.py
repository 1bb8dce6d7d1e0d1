# SPDX-License-Identifier: Apache-2.0
"""The things that are managed."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

from iota._core import Articulate, Body, Particle, System
from iota.levels.level import STANDARD, STIFF
from iota.levels.managed import Managed, is_hung, measured

GONE = 1000  # things that are remembered after their end


class Things:
    """Lists the things, and names them."""

    def __init__(self, system: System) -> None:
        self._system = system
        self.all: list[Managed] = []
        self.is_old = False  # what is known of them, row by row
        self.unchecked: list[Managed] = []  # for joints: all at once, as each look goes through all joints
        self._by_root: dict[Body, Managed] = {}  # empty: as of no time
        self._names: set[str] = set()  # theirs, and of some that were
        self._gone: deque[Managed] = deque(maxlen=GONE)  # destroyed or joined: an undo may bring them back

    def forget_roots(self) -> None:
        """A thing has come or gone, or has other bodies."""
        self._by_root = {}

    def keep_chosen(self) -> None:
        """The things of which a script has said something."""
        self.all = [thing for thing in self.all if thing.is_chosen or thing.is_pinned]
        self._by_root = {}
        self._names = {thing.name for thing in self.all}
        self._gone.clear()
        self.is_old = True

    @property
    def known(self) -> dict[Managed, None]:
        """Also those that were."""
        return dict.fromkeys([*self._gone, *self.all])

    def remove(self, thing: Managed) -> None:
        """It is managed no more."""
        self.all.remove(thing)
        self._by_root = {}

    def find(self, thing: Body | Articulate) -> Managed | None:
        """The thing that a body or an articulate belongs to."""
        members = thing.articulate.bodies if isinstance(thing, Body) else thing.bodies
        return next((each for body in members if (each := self.of_root(body)) is not None), None)

    def of_root(self, body: Body) -> Managed | None:
        """The thing of which it is the first body, or that of one of its articulates."""
        if not self._by_root:
            self._by_root = {root: thing for thing in self.all for root in thing._roots}
        return self._by_root.get(body)

    def update(self, join: Callable[[Managed], None]) -> None:
        """Keeps the things of which something is left. Of those that were joined the first one is kept, full, with what the others were
        managed for. join: makes one full."""
        first_of: dict[int, Managed] = {}  # by the numbers of articulates
        joined: list[tuple[Managed, Managed]] = []
        for thing in self.all:
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
        self._gone.extend(thing for thing in self.all if thing in gone or not thing._lives())
        for first, other in joined:
            first.is_pinned = first.is_pinned or other.is_pinned
            for thing in (first, other):
                join(thing)
            if other.is_jointed:
                first.is_jointed = True
                first.levels = tuple(level for level in first.levels if not level.is_stiff)
        for first, _ in joined:
            if first not in gone and first._lives():
                first._measure()
        self.all = [thing for thing in self.all if thing not in gone and thing._lives()]
        self._by_root = {}
        self.is_old = False

    def add_all(self) -> None:
        """Also what was made, or parted, since this was called last."""
        jointed, lined = self.jointed(), self.lined()
        known = {root.articulate.number for thing in self.all if thing._lives() for root in thing._roots}
        for articulate in self._system.articulates:
            if articulate.number in known:
                continue
            members = articulate.bodies
            moving = [body for body in members if body.kind in ("dynamic", "resting")]
            if moving and not moving[0].is_spark and any(len(body.particles) > 1 for body in moving):
                is_jointed = any(body in jointed for body in members)
                made = self.add(moving[0], members, len(members) > 1 and not is_jointed, "", lined)
                made.is_jointed = is_jointed
                made._reread()  # a part of something that had a stride has it, too

    def add(
        self,
        root: Body,
        members: list[Body],
        can_be_stiff: bool,
        name: str,
        lined: set[Body],
        others: tuple[Body, ...] = (),
    ) -> Managed:
        """lined: bodies with lines of their own."""
        size, middle, extent = measured(members)
        stiff = replace(STIFF, share=min(1.0, 1.2 / len(members)))
        # A thing that hangs saves little by stiffness, and loses its swing: strides of 8 cost less.
        has_stiff = can_be_stiff and not is_hung(members)
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
        self.all.append(made)
        if self._by_root:
            self._by_root.update(dict.fromkeys(made._roots, made))
        self.is_old = True
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

    def lined(self) -> set[Body]:
        """Bodies with lines of their own."""
        return {p.body for p, _ in self._system.cosmetic_lines}

    def jointed(self) -> set[Body]:
        """Bodies that joints, bonds and angle springs refer to."""
        system = self._system
        found = {body for joint in system.constraints for body in (joint.a, joint.b) if body is not None}
        found |= {end.body for spring in system.angle_springs for end in spring.ends}
        return found | {end.body for bond in system.bonds for end in bond.ends}

    def has_joints(self, members: list[Body]) -> bool:
        """Whether one of them has."""
        jointed = self.jointed()
        return any(body in jointed for body in members)

    def revive(self) -> None:
        """Things that were destroyed or joined to others, and are there again: they are managed again."""
        known = {root.articulate.number for thing in self.all if thing._lives() for root in thing._roots}
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
        self.all += found
        self._by_root = {}
        for thing in found:
            thing._reread()


def _word_for(body: Body) -> str:
    """The word for its shape."""
    if body.solids:
        return "body" if len(body.solids) > 1 else type(body.solids[0].shape).__name__.lower()
    return {1: "particle", 2: "rod"}.get(len(body.particles), "body")
