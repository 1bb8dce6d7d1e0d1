#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Adds an ingredient, a joint, a shape and a client message to a copy of the sources, builds it, and runs their tests.

    tools/check_one_more.py

An ingredient shall cost a header, a source, a test and a line, and with a handle for users eight files besides its
tests: also the header and source of its view, its binder, its lines in system.h and its name in Python; a joint with a new type of row that row, a test, an example
in another, its line in a form and a line in each of four lists; a shape a struct, a header, a file of the page, an
example in two tests and a line each; a client message its entry in the schema, its handler and its sender
(docs/architecture.md, docs/bodies.md, protocol/README.md). The new files are in tests/one_more, the new lines below; no
other file is changed. The copy is build/one_more. The first run builds everything, a later one what has changed. Run
`make test` before: the copy uses its packages.
"""

from __future__ import annotations

import filecmp
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
COPY = ROOT / "build" / "one_more"
ADDED = ROOT / "tests" / "one_more"

OCTAHEDRON = """struct Octahedron {
  double radius = 0.5;
  friend bool operator==(const Octahedron&, const Octahedron&) = default;
};
"""
WAVE = """    {
      "name": "wave",
      "type": 16,
      "doc": "A greeting.",
      "fields": [{ "name": "hand", "type": "string", "max": 32 }, { "name": "times", "type": "u8" }]
    },
"""
WAVE_HANDLER = """    @handles(protocol.Wave, share=0.1)
    def _wave(self, client: Client, message: protocol.Wave) -> None:
        self._notice(client, "Wave", f"{message.hand}, {message.times} times")

"""
# File -> texts that are there once, and the text that is put in front of each.
LINES = {
    "src/ingredient/ingredient_list.h": {
        '#include "ingredient/bonds.h"': '#include "ingredient/balloons.h"\n',
        "    Strides>": "    Balloons,\n",
    },
    "include/iota/system.h": {
        "#include <iota/bodies.h>": "#include <iota/balloons.h>\n",
        ", Joints, Laws,": ", Balloons",
        "  Joints joints() {": "  Balloons balloons() { return Balloons(*core_); }\n",
        "  const Joints joints()": "  const Balloons balloons() const { return Balloons(*core_); }\n",
    },
    "python/iota/__init__.py": {
        "    Body,\n": "    Balloon,\n",
        '    "Body",\n': '    "Balloon",\n',
        "    Ellipsoid,\n": "    Octahedron,\n",
        '    "Ellipsoid",\n': '    "Octahedron",\n',
    },
    "src/solver/constraints/constraint_list.h": {
        '#include "solver/constraints/span.h"': '#include "solver/constraints/level.h"\n',
        ">;\n\ntemplate <class C>\nstruct CheckConstraint": ", Pool<LevelConstraint>",
    },
    "include/iota/kinds.h": {"};\n\n/// The coordinates that joints have": "  level,  ///< a point of a keeps the height of one of b\n"},
    "src/ingredient/constraint.h": {
        "  bool angle = false;": "  bool level = false;  ///< 1 row: the origins have the same height\n",
        "});\ninline const ConstraintKindInfo& info": '    {.name = "level", .level = true},\n',
    },
    "src/ingredient/pin_form.h": {
        "    if (kind.line && rubs(j.c))\n": """    if (kind.level) {
      solver::LevelConstraint row;
      j.sides(row, {a_origin}, {b_origin});
      j.add(row, 0, a_origin, 1), j.add(row, 0, b_origin, -1);
      out.hold(row);
    }
""",
    },
    "bindings/bind_constraints.cpp": {
        '  type.def(\n      "weld",': """  type.def(
      "level",
      [](SystemObject& self, const BodyHandle& a, const BodyHandle* b, VectorArgument at) {
        JointSpec spec;
        spec.kind = ConstraintKind::level;
        return make_joint(self, spec, a, b, at);
      },
      "a"_a, "b"_a.none() = nb::none(), nb::kw_only(), "at"_a, "A point of a keeps the height of a point of b.");
""",
    },
    "protocol/schema.json": {'    {\n      "name": "profile",': WAVE},
    "python/iota/world/inputs.py": {"    @handles(protocol.Key": WAVE_HANDLER},
    "web/src/ui/overlay.ts": {
        '        if (this.profiles_) this.page_.session.send': '        this.page_.session.send({ type: "wave", hand: "left", times: 2 });\n',
    },
    "include/iota/shapes.h": {"/// Their order is that of": OCTAHEDRON, ">;\n\nusing Matrix3": ", Octahedron"},
    "src/shape/shape_list.h": {'#include "shape/sphere.h"': '#include "shape/octahedron.h"\n'},
    "protocol/shapes.json": {"\n  ]": ',\n    { "name": "octahedron", "sizes": ["radius"] }'},
    "web/src/scene/shapes/shape_list.ts": {
        'import { sphere }': 'import { octahedron } from "./octahedron.ts";\n',
        "];\n\nconst byName": ", octahedron",
    },
    "tests/cpp/solver/constraints/constraint_list_test.cpp": {
        "/// Coordinates of all kinds between bodies,": """Example<LevelConstraint> example(Random& random, LevelConstraint c) {
  add_point(c, 0, 0, random.vec()), add_point(c, 0, 1, random.vec(), -1);
  return {c, two_bodies(random)};
}

""",
    },
    "tests/cpp/shape/shape_test.cpp": {"          HalfSpace{{1, 2, -0.5}}": "          Octahedron{s},\n"},
    "tests/shapes/make_samples.py": {"    lambda s: iota.HalfSpace": "    lambda s: iota.Octahedron(s),\n"},
}  # fmt: skip


def with_lines(name: str, text: str) -> str:
    for place, added in LINES.get(name, {}).items():
        if text.count(place) != 1:
            sys.exit(
                f"{name}: {place!r} is there {text.count(place)} times, not once. See LINES in tools/check_one_more.py"
            )
        text = text.replace(place, added + place)
    return text


def make_copy() -> None:
    """The files that git knows or would, with the additions; a file that is the same keeps its time."""
    listed = ["git", "-C", ROOT, "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    names = subprocess.run(listed, check=True, capture_output=True, text=True).stdout.split("\0")
    sources = {name: ROOT / name for name in names if name and (ROOT / name).is_file()}
    sources |= {str(path.relative_to(ADDED)): path for path in ADDED.rglob("*") if path.is_file()}
    for name, source in sources.items():
        target = COPY / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if name in LINES:
            text = with_lines(name, source.read_text())
            if not target.is_file() or target.read_text() != text:
                target.write_text(text)
        elif not target.is_file() or not filecmp.cmp(source, target, shallow=False):
            shutil.copy(source, target)
    for packages in (".venv", "web/node_modules"):
        if not (ROOT / packages).is_dir():
            sys.exit(f"{packages} is missing. Run `make test` first")
        if not (COPY / packages).is_symlink():
            (COPY / packages).symlink_to(ROOT / packages)


def run(title: str, *command: str, folder: str = ".") -> None:
    print(f"{title} ...", flush=True)
    environment = os.environ | {"PYTHONPATH": str(COPY / "python")}
    done = subprocess.run(command, cwd=COPY / folder, env=environment, capture_output=True, text=True)
    if done.returncode:
        sys.exit(
            f"{done.stdout[-6000:]}\n{done.stderr[-2000:]}\n{title}: {' '.join(command)} failed in {COPY / folder}"
        )
    if tests := [line.strip() for line in done.stdout.splitlines() if "PASSED" in line or "passed" in line]:
        print("\n".join(tests))


def main() -> int:
    make_copy()
    jobs = str(len(os.sched_getaffinity(0)))
    tests = "Balloons.*:Level.*:Constraint.*:Constraints.*:PinForm.*:IngredientList.*:*EveryShape*:Shape.*:FollowingIsland.*:Archive.*"
    run("configuring", "cmake", "--preset", "release", "-DCMAKE_BUILD_TYPE=Debug")  # compiles in less time
    run("building", "cmake", "--build", "build", "--parallel", jobs, "--target", "everyday", "iota_tests")
    for module in (COPY / "build" / "python" / "iota").glob("_*.*"):
        link = COPY / "python" / "iota" / module.name
        link.unlink(missing_ok=True)
        link.symlink_to(module)
    run("tests of ingredients, joints and shapes", "build/iota_tests", "--gtest_brief=1", f"--gtest_filter={tests}")
    python, npx = ".venv/bin/python", ("../.venv/bin/npx", "--no-install")
    inputs = "tests/python/test_inputs.py::test_every_input_has_one_function"
    run("the message, from a page to its handler", python, "-m", "pytest", "-q", "tests/python/test_wave.py", inputs)
    run("the handle of the ingredient", python, "-m", "pytest", "-q", "tests/python/test_balloon.py")
    run("distances of shapes, by the engine", python, "tests/shapes/make_samples.py")
    run("messages of the page", python, "tools/generate_protocol.py", "--ts", "web/src/protocol/generated.ts")
    run("types of the page", *npx, "tsc", "--noEmit", folder="web")
    run("shapes of the page", *npx, "vitest", "run", "test/shapes.test.ts", folder="web")
    print("one more ingredient, joint, shape and message work by their own files and lines")
    return 0


if __name__ == "__main__":
    sys.exit(main())
