# SPDX-License-Identifier: Apache-2.0
"""The contacts and ties that join things with each other, so that they are solved together."""

from __future__ import annotations

from dataclasses import dataclass, field

from iota._core import Body, System
from iota.levels.level import Level
from iota.levels.managed import Managed
from iota.levels.things import Things
from iota.levels.ties import Ties

MOST_TOGETHER = 128  # things


@dataclass(eq=False)
class Together:
    """A thing, and those that ties and contacts join with it, so that they are solved together: of many the first ones. is_all: nothing else that
    moves is. touching: those with contacts, so that strides save nothing."""

    things: list[Managed]
    touching: set[Managed] = field(default_factory=set)
    is_all: bool = True


class Connections:
    """The things that ties and contacts join with a thing."""

    def __init__(self, system: System, things: Things) -> None:
        self._system, self._things = system, things
        self._ties: Ties | None = None  # None: to be found when they are needed

    def forget(self) -> None:
        """The structure has changed."""
        self._ties = None

    def solved_with(self, thing: Managed) -> Together:
        """The things that contacts and ties lead to, from thing to thing."""
        found = Together([thing])
        for each in found.things:  # which grow
            others = {contact.other for body in each.bodies for contact in body.contacts}
            touched = [
                self._things.find(other)
                for other in others
                if other.kind in ("dynamic", "resting") and not each._has(other)
            ]
            mates = dict.fromkeys([*self.tied_to(each), *(mate for mate in touched if mate is not None)])
            if touched:
                found.touching.add(each)
            if None in touched or len(found.things) > MOST_TOGETHER:
                found.is_all = False
                break
            found.things += [mate for mate in mates if mate not in found.things]
        return found

    def tied_to(self, thing: Managed) -> list[Managed]:
        """The other things that joints, bonds and angle springs tie to it."""
        if not thing.is_jointed:
            return []
        bodies, _ = self.all_ties().around(thing.bodies)
        found = dict.fromkeys(each for body in bodies if (each := self._things.of_root(body)) is not None)
        return [each for each in found if each is not thing]

    def all_ties(self) -> Ties:
        """The ties of the system now."""
        if self._ties is None:
            self._ties = Ties(self._system)
        return self._ties

    def is_jointed_by_now(self, thing: Managed, bodies: list[Body]) -> bool:
        """The script may have made joints since it came under management. Such a thing is never stiff, as they would end."""
        if not thing.is_jointed and self.all_ties().hold(bodies):
            level = thing.level
            thing.is_jointed = self._things.is_old = True
            thing.levels = tuple(each for each in thing.levels if not each.is_stiff or each is level)
            thing.index = thing.levels.index(level)
        return thing.is_jointed

    def is_held(self, thing: Managed, level: Level) -> bool:
        """Whether joints hold it at the world. Raises ValueError if something holds it to what goes on without it."""
        is_held, tie = self.all_ties().beyond(thing.bodies)
        if tie is not None:
            raise ValueError(
                f"a structure cannot stand in for {thing.name!r} at level {level.name!r}, as {tie!r} ties it to something else that"
                " moves: manage both as one thing, with `manage([...])`, or give it the level 'frozen' instead"
            )
        return is_held
