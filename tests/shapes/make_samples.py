# SPDX-License-Identifier: Apache-2.0
"""Writes samples.json: shapes from a nanometer to a thousand kilometers, and how far points are from them by the engine.

    .venv/bin/python tests/shapes/make_samples.py

tests/python/test_shapes.py checks that the engine still says so, web/test/shapes.test.ts that the page says the same: what
is drawn and picked is what acts. A new shape needs a line in `EXAMPLES`.
"""

from __future__ import annotations

import json
import random
from pathlib import Path

import iota
from iota import shapes

FILE = Path(__file__).with_name("samples.json")
SCALES = (1e-8, 1e-3, 1.0, 1e6)  # m
EXAMPLES = (
    lambda s: iota.Sphere(0.7 * s),
    lambda s: iota.Box((s, 2 * s, 3 * s)),
    lambda s: iota.Box((s, 2 * s, 3 * s), 0.3 * s),
    lambda s: iota.Cylinder(0.5 * s, 2 * s),
    lambda s: iota.Cylinder(s, 0.3 * s),
    lambda s: iota.Capsule(0.5 * s, 1.5 * s),
    lambda s: iota.Torus(s, 0.3 * s),
    lambda s: iota.Torus(s, 0.3 * s, 1.2 * s),
    lambda s: iota.Mesh.convex_hull([(0, 0, 0), (s, 0, 0), (0, 2 * s, 0), (0, 0, s), (s, 0, s), (0, 2 * s, s)]),
    lambda s: iota.Ellipsoid((s, 2 * s, 3 * s)),
    lambda s: iota.Ellipsoid((3 * s, 3 * s, s)),
    lambda s: iota.Cylinder(0.6 * s, 1.5 * s, 0.2 * s),
    lambda s: iota.HalfSpace((1, 2, -0.5)),
    lambda s: iota.Cone(0.6 * s, 1.5 * s),
    lambda s: iota.Cone(2 * s, 0.5 * s),
)


def samples() -> list[dict[str, object]]:
    """Each shape with its numbers, and points (x, y, z) with their distances, m."""
    made: list[dict[str, object]] = []
    for scale in SCALES:
        for number, example in enumerate(EXAMPLES):
            shape, dice = example(scale), random.Random(f"{scale} {number}")
            points = [[float(f"{dice.uniform(-2, 2) * scale:.6g}") for _ in range(3)] for _ in range(20)]
            sample: dict[str, object] = {"scale": scale, "kind": shape.kind, "sizes": list(shape.numbers)}
            if isinstance(shape, iota.Mesh):
                sample |= {name: shapes.to_json(shape)[name] for name in ("vertices", "triangles")}
            made.append(sample | {"points": points, "distances": [shape.distance(p) for p in points]})
    return made


if __name__ == "__main__":
    lines = "\n, ".join(json.dumps(sample) for sample in samples())
    FILE.write_text(f"[ {lines}\n]\n")
    print(f"wrote {FILE}")
