# SPDX-License-Identifier: Apache-2.0
"""The bodies of a thing as one rigid body, and apart again, each with what was its own."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import Any, Protocol

from iota._core import Body, Group, System

# Properties of a body: those of the first one count for all that become one.
OWN = ("name", "color", "material", "damping", "radius")


class Clothes(Protocol):
    """The looks of bodies."""

    def hand_over(self, former: Body, body: Body) -> None:
        """Gives a body the look of the one that it was."""


class Stiffness:
    """Makes bodies one with the first of them, which ends the others: what they were called, how they were drawn, of what they were, and whom they
    passed through, is kept here until they are apart. What the script changes of the one body meanwhile holds for all of them.
    """

    def __init__(self, root: Body, others: Sequence[Body]) -> None:
        members = [root, *others]
        system = root.system
        self.others = frozenset(others)
        self._own = {body: _own_of(body) for body in members}
        self._groups = {body: groups for body in members if (groups := _groups_of(system, body))}
        self._passing = _passing(system, members)
        for body in others:
            root.combine(body)
        self._whole, self._whole_passing = _own_of(root), _passing(system, [root])

    def changed(self, root: Body) -> tuple[set[str], bool]:
        """Names whatever the script has changed since: properties, and whether it lets the one body pass through others."""
        now, passing = _own_of(root), _passing(root.system, [root])
        return {key for key in OWN if now[key] != self._whole[key]}, passing != self._whole_passing

    def give_back(self, members: Mapping[Body, Body], visuals: Clothes, changed: tuple[set[str], bool]) -> None:
        """members: the bodies that are there again, by those that they were."""
        properties, has_other_passing = changed
        for former, body in members.items():
            own, now = self._own.get(former, {}), _own_of(body)
            for key in own:
                if key not in properties and own[key] != now[key]:
                    with suppress(ValueError):  # the radius of a shape
                        setattr(body, key, own[key])
            for group in self._groups.get(former, []):
                if group.alive:
                    group.add(body)
            if former != body:
                visuals.hand_over(former, body)
        if not has_other_passing and members.keys() >= self._own.keys():
            self._pass_as_before(members)

    def _pass_as_before(self, members: Mapping[Body, Body]) -> None:
        system = next(iter(members.values())).system
        wanted = {frozenset(members.get(body, body) for body in pair) for pair in self._passing}
        present = _passing(system, list(members.values()))
        for pair in present - wanted:
            system.allow_contacts(*pair)
        for pair in wanted - present:
            if all(body.alive for body in pair):
                system.ignore_contacts(*pair)


def _own_of(body: Body) -> dict[str, Any]:
    return {key: getattr(body, key) for key in OWN}


def _groups_of(system: System, body: Body) -> list[Group]:
    """Groups with all of its particles."""
    own = set(body.particles)
    return [group for group in system.groups if own <= set(group.particles)]


def _passing(system: System, bodies: Iterable[Body]) -> set[frozenset[Any]]:
    """The pairs of `ignore_contacts` with one of the bodies itself."""
    own = set(bodies)
    return {
        frozenset(pair)
        for pair in system.ignored_contacts
        if any(isinstance(side, Body) and side in own for side in pair)
    }
