# SPDX-License-Identifier: Apache-2.0
"""`iota run --watch`: a world goes on where the one before it ended, as far as its script still starts it in the same way."""

from __future__ import annotations

import base64
import hashlib
import json
from collections import defaultdict
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from iota._core import Body, System
from iota.saving import replacing


@dataclass
class Part:
    """Bodies that hinges, constraints or bonds connect. start: digest of what they are and where they start.
    connections: digest of what connects them."""

    bodies: list[Body]
    start: str
    connections: str


class Keeper:
    """The state of a world in a file. Made when the world begins."""

    def __init__(self, file: Path, system: System) -> None:
        self._file, self._system = file, system
        self._start = hashlib.sha256(system.snapshot()).hexdigest()
        self._structure = system.structure_version
        self._parts = parts_of(system)

    def keep(self) -> None:
        """Writes the present state. Parts with new joins or breaks are not kept, since their script would not know of
        them."""
        system = self._system
        kept: dict[str, Any] = {"start": self._start, "parts": {}}
        if system.structure_version == self._structure:
            kept["whole"] = base64.b85encode(system.snapshot()).decode()
        for part, connections in zip(
            self._parts, connections_of(system, [part.bodies for part in self._parts]), strict=True
        ):
            if connections == part.connections:
                bodies = system.array(part.bodies)
                kept["parts"][part.start + connections] = [bodies.poses.tolist(), bodies.motions.tolist()]
        with suppress(OSError), replacing(self._file) as fresh:
            fresh.write_text(json.dumps(kept))

    def take(self) -> str:
        """Brings the kept state into the world, and removes the file. Returns a sentence for users, empty without a file."""
        try:
            kept = json.loads(self._file.read_text())
            self._file.unlink()
        except (OSError, ValueError):
            return ""
        system = self._system
        if kept["start"] == self._start and "whole" in kept:
            system.restore(base64.b85decode(kept["whole"]))
            return f"The world goes on at {system.time:.1f} s."
        found = [part for part in self._parts if part.start + part.connections in kept["parts"]]
        for part in found:
            bodies = system.array(part.bodies)
            bodies.poses, bodies.motions = kept["parts"][part.start + part.connections]
        count, all_bodies = sum(len(part.bodies) for part in found), sum(len(part.bodies) for part in self._parts)
        if count == 0:
            return "The world begins anew, since its parts start in another way."
        rest = "" if count == all_bodies else " The others start in another way, or were broken or joined."
        return f"{count} of {all_bodies} bodies go on where they were.{rest}"


def parts_of(system: System) -> list[Part]:
    """All bodies but those of sparks. `System.islands` would not do: it is empty before the first step, and does not join what
    only forces connect that a step holds constant."""
    root: dict[Body, Body] = {body: body for body in system.bodies if not body.is_spark}

    def find(body: Body) -> Body:
        while root[body] != body:
            root[body] = root[root[body]]
            body = root[body]
        return body

    def join(bodies: Iterable[Body]) -> None:
        known = [body for body in bodies if body in root]
        for other in known[1:]:
            root[find(other)] = find(known[0])

    for articulate in system.articulates:
        join(articulate.bodies)
    for bond in system.bonds:
        join(end.body for end in bond.ends)
    for constraint in system.constraints:
        join(body for body in (constraint.a, constraint.b) if body is not None)
    parts: dict[Body, list[Body]] = defaultdict(list)
    for body in root:
        parts[find(body)].append(body)
    found = list(parts.values())
    starts = (digest(map(description, bodies)) for bodies in found)
    return [Part(*part) for part in zip(found, starts, connections_of(system, found), strict=True)]


def description(body: Body) -> str:
    """The shapes, masses and places of a body as text."""
    solids = [(repr(solid.shape), *solid.position, *solid.orientation) for solid in body.solids]
    particles = [(particle.mass, *particle.position, *particle.velocity) for particle in body.particles]
    return repr((particles, solids))


def connections_of(system: System, parts: list[list[Body]]) -> list[str]:
    """A digest for each of these sets of bodies: of their kinds, and of the hinges, nails, bonds and constraints that hold
    them. Empty if one of the bodies is gone."""
    found: list[list[Any]] = [[] for _ in parts]
    place = {body: (part, index) for part, bodies in enumerate(parts) for index, body in enumerate(bodies)}

    def note(kind: str, bodies: Iterable[Body | None]) -> None:
        places = [place[body] for body in bodies if body in place]
        for part in {part for part, _ in places}:
            found[part].append((kind, sorted(index for other, index in places if other == part)))

    for body in place:
        if not body.alive:
            continue
        note(body.kind, [body])
        for particle in body.particles:
            note("nail" if particle.is_nailed else "hinge", [other.body for other in particle.ring])
    for bond in system.bonds:
        note(f"bond {bond.law.name}", [end.body for end in bond.ends])
    for constraint in system.constraints:
        if constraint.active:
            note(constraint.kind, [constraint.a, constraint.b])
    are_there = [all(body.alive for body in bodies) for bodies in parts]
    return [digest(map(repr, each)) if there else "" for each, there in zip(found, are_there, strict=True)]


def digest(texts: Iterable[str]) -> str:
    made = hashlib.sha256()
    for text in texts:
        made.update(text.encode() + b"\n")
    return made.hexdigest()
