# SPDX-License-Identifier: Apache-2.0
"""Finds the hinge to break and the ends to join for users' actions."""

from __future__ import annotations

from collections.abc import Iterable

from iota._core import Body, Particle

Pair = tuple[Particle, Particle]
SPEED = 1.2  # m/s, of ends that are drawn together


class Joins:
    """Joins that take time: the two particles are drawn together until they meet."""

    def __init__(self) -> None:
        self._pairs: list[Pair] = []

    def begin(self, end: Particle, own: Particle, shortest: float) -> None:
        """Draws `own` to `end` at a bounded speed, in no less than `shortest` s."""
        self._pairs = [pair for pair in self._pairs if _are_apart(pair)]
        self._pairs.append((end, own))
        end.combine(own, over=max(shortest, abs(end.position - own.position) / SPEED))

    def under_way(self, body: Body) -> Pair | None:
        """The pair begun last that still draws the body's part to another; separating the two calls it off."""
        # Particles that are drawn together are in one articulate before they have met. An undo or a reset ends that too.
        return next((p for p in reversed(self._pairs) if _are_apart(p) and body in p[0].body.articulate), None)


def loose_ends(bodies: Iterable[Body]) -> list[Particle]:
    """The particles without hinge and nail, except a solid's own four points."""
    return [p for body in bodies for p in _places(body) if len(p.ring) == 1 and not p.is_nailed]


def hinge_above(body: Body) -> Pair | None:
    """The hinge towards the nail, or towards the highest end of a part without nails: (particle above, particle of the
    body). None for the uppermost body."""
    part = body.articulate
    roots = [p for each in part for p in each.particles if p.is_nailed]
    roots = roots or [max(loose_ends(part) or body.particles, key=lambda p: p.position.y)]
    reached = {p.body for p in roots}
    waiting = list(reached)
    while waiting:
        each = waiting.pop()
        for above in each.particles:
            for own in above.ring:
                if own.body in reached:
                    continue
                if own.body == body:
                    return above, own
                reached.add(own.body)
                waiting.append(own.body)
    return None


def nearest_ends(body: Body) -> Pair | None:
    """The nearest pair of a loose end of another part and one of the body's part; None if there is none."""
    others = [other for other in body.system.bodies if other not in body.articulate]
    pairs = [(theirs, own) for theirs in loose_ends(others) for own in loose_ends(body.articulate)]
    return min(pairs, key=lambda pair: abs(pair[0].position - pair[1].position), default=None)


def _places(body: Body) -> list[Particle]:
    return body.attachments if body.solids else body.particles


def _are_apart(pair: Pair) -> bool:
    """Both are there, in one articulate, and have not met."""
    end, own = pair
    if not (end.alive and own.alive) or end.body == own.body or own in end.ring:
        return False
    return end.body.articulate == own.body.articulate
