# SPDX-License-Identifier: Apache-2.0
"""Which hinges and ends users mean when they break and join what hangs together."""

from __future__ import annotations

from collections.abc import Iterable

from iota._core import Body, Particle

Pair = tuple[Particle, Particle]


def loose_ends(bodies: Iterable[Body]) -> list[Particle]:
    """The particles that nothing is hinged to and no nail holds, apart from a solid's own four points."""
    return [p for body in bodies for p in _places(body) if len(p.ring) == 1 and not p.is_nailed]


def hinge_above(body: Body) -> Pair | None:
    """The hinge towards the nail, or towards the highest end of a part that has none: (the one above, the body's own). None
    for the uppermost."""
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
    """The loose end elsewhere and the one of the body's part that are nearest to each other; None without any."""
    others = [other for other in body.system.bodies if other not in body.articulate]
    pairs = [(theirs, own) for theirs in loose_ends(others) for own in loose_ends(body.articulate)]
    return min(pairs, key=lambda pair: abs(pair[0].position - pair[1].position), default=None)


def _places(body: Body) -> list[Particle]:
    return body.attachments if body.solids else body.particles
