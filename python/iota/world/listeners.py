# SPDX-License-Identifier: Apache-2.0
"""The script's functions for events of users (on a body, on any body, on empty space, by a key) and of the
simulation."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from iota._core import Body, Constraint, ContactWatch, Group, Particle
from iota.simulator import SimulatedBody
from iota.world.callbacks import Hook, twice

KINDS = (
    "click",
    "press",
    "release",
    "drag",
    "hover",
    "pointer",
    "key",
    "join",
    "leave",
    "frame",
    "stop",
    "break",
    "contact",
)


@dataclass(frozen=True)
class Members:
    """The bodies with a particle in a group, at present."""

    group: Group

    def __contains__(self, body: object) -> bool:
        return (
            isinstance(body, Body)
            and body.alive
            and self.group.alive
            and any(particle in self.group for particle in body.particles)
        )


Bodies = frozenset[Any] | Members | None


@dataclass(frozen=True, eq=False)
class Listener:
    """A function and its events. bodies: None for any body, empty for empty space. takes_over: replaces the default
    reaction. on_release: for the release of a key. watch, wanted: of contacts, with what it was made of."""

    kind: str
    hook: Hook
    bodies: Bodies = None
    key: str | None = None
    on_release: bool = False
    takes_over: bool = False
    watch: ContactWatch | None = None
    wanted: tuple[Any, ...] = ()

    def is_same_as(self, other: Listener) -> bool:
        """Whether both call one function for the same events."""
        mine, theirs = (
            (each.hook.function, each.bodies, each.key, each.on_release, each.wanted) for each in (self, other)
        )
        return self.kind == other.kind and mine == theirs

    def hears(self, body: Any) -> bool:
        if self.kind in ("join", "leave", "frame", "pointer", "contact"):
            return True
        if body is None:
            return self.bodies == frozenset()
        if self.bodies is None:
            return True
        if isinstance(self.bodies, Members):
            return body in self.bodies
        # An absorbed body is represented by its survivor.
        return body in self.bodies or any(isinstance(each, Body) and each.survivor == body for each in self.bodies)


def things_of(target: Any) -> Bodies:
    """The bodies and constraints of a target of simulation events. Raises TypeError for other targets."""
    if target == "anything" or isinstance(target, Body | SimulatedBody | Particle | Group):
        return bodies_of(target)
    if isinstance(target, Constraint):
        return frozenset([target])
    if isinstance(target, Iterable) and not isinstance(target, str):
        found = [things_of(each) for each in target]
        if found and all(isinstance(each, frozenset) and each for each in found):
            return frozenset().union(*found)  # type: ignore[arg-type]
    raise TypeError(f"must be a body, a constraint, several, a group, or 'anything', not {target!r}")


def parties_of(target: Any) -> tuple[Body | Group, ...] | None:
    """The bodies and groups of a side of contacts; None for any body. Raises TypeError for other targets."""
    if target == "anything":
        return None
    if isinstance(target, Body | Group):
        return (target,)
    if isinstance(target, Particle):
        return (target.body,)
    if isinstance(target, Iterable) and not isinstance(target, str):
        found = [parties_of(each) for each in target]
        if found and all(found):
            return tuple(party for each in found for party in each or ())
    raise TypeError(f"must be a body, a group, several, or 'anything', not {target!r}")


def bodies_of(target: Any) -> Bodies:
    """The bodies of a target. Raises TypeError for other targets."""
    if target == "anything":
        return None
    if target == "nothing":
        return frozenset()
    if isinstance(target, Body | SimulatedBody):
        return frozenset([target])
    if isinstance(target, Particle):
        return frozenset([target.body])
    if isinstance(target, Group):
        return Members(target)
    if isinstance(target, Iterable) and not isinstance(target, str):
        found = [bodies_of(each) for each in target]
        if found and all(isinstance(each, frozenset) and each for each in found):
            return frozenset().union(*found)  # type: ignore[arg-type]
    raise TypeError(f"must be a body, bodies, a group, 'anything' or 'nothing', not {target!r}")


class Listeners:
    """All listeners of a world. version: rises when what pages have to send may have changed."""

    def __init__(self) -> None:
        self._by_kind: dict[str, list[Listener]] = {kind: [] for kind in KINDS}
        self.on_step: list[Hook] = []
        self.on_reset: list[Hook] = []
        self.version = 0

    def add(self, listener: Listener) -> None:
        """Raises ValueError for a function that is registered for the same events already."""
        if any(each.is_same_as(listener) for each in self._by_kind[listener.kind]):
            raise twice(listener.hook, f"on_{listener.kind}")
        self._by_kind[listener.kind].append(listener)
        self.version += 1

    def remove(self, function: Callable[..., Any]) -> bool:
        """Removes a function from all events; False if it is not known."""
        before = self._count()
        for each in self._by_kind["contact"]:
            if each.watch is not None and each.hook.function == function:
                each.watch.end()
        for kind, listeners in self._by_kind.items():
            self._by_kind[kind] = [each for each in listeners if each.hook.function != function]
        self.on_step = [each for each in self.on_step if each.function != function]
        self.on_reset = [each for each in self.on_reset if each.function != function]
        self.version += 1
        return self._count() < before

    def _count(self) -> int:
        return sum(map(len, self._by_kind.values())) + len(self.on_step) + len(self.on_reset)

    def of(self, kind: str, body: Any = None) -> Iterator[Listener]:
        """The listeners for a kind and a body; None: no hit, or an event without a body."""
        return iter([each for each in self._by_kind[kind] if each.hears(body)])

    def of_any(self, kind: str, things: Iterable[Any]) -> Iterator[Listener]:
        """The listeners for a kind and at least one of some bodies and constraints."""
        told = [each for each in things if each is not None]
        return iter([each for each in self._by_kind[kind] if each.bodies is None or any(map(each.hears, told))])

    def of_key(self, key: str, released: bool) -> Iterator[Listener]:
        listeners = self._by_kind["key"]
        return iter([each for each in listeners if each.key == key and each.on_release == released])

    def has(self, kind: str) -> bool:
        return bool(self._by_kind[kind])

    @property
    def keys(self) -> list[str]:
        """In the order of registration."""
        return list(dict.fromkeys(each.key for each in self._by_kind["key"] if each.key is not None))
