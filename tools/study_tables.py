#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes docs/study_figures.md: lines of each study in the thesis' three categories, and the cost of a step.

tools/study_tables.py [--check]     --check: only checks whether the lines in the page are those of the scripts
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import iota

ROOT = Path(__file__).resolve().parent.parent
STUDIES = ROOT / "python" / "iota" / "studies"
PAGE = ROOT / "docs" / "study_figures.md"
CATEGORIES = ("scene setup", "presentation", "behavior")
# Lines in the thesis, chapter 5: of two versions the interactive one.
THESIS = {
    "molecule": (10, 20, 10), "chain": (20, 20, 130), "ladder": (120, 100, 160), "cradle": (30, 60, 300),
    "shoal": (30, 40, 15), "soft-molecule": (10, 30, 10), "bucky": (10, 30, 20), "undersea": (50, 60, 150),
    "lab": (150, 160, 490),
}  # fmt: skip
WARM_UP, MEASURED, FRAMES = 4.0, 3.0, 60  # s, of a page until it is measured, and for which; frames before that
WINDOW = {"width": 1280, "height": 720}  # px
ASK = "(({ calls, triangles }) => [calls, triangles])(iota.page.viewer.renderer.info.render)"
# A browser without a graphics card draws so slowly that its page handles many messages between two frames.
LEAVE_DRAWING_OUT = """{ const gl = iota.page.viewer.renderer.getContext();
    for (const name of ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced", "clear"]) gl[name] = () => {};
    globalThis.frames = 0;
    iota.page.viewer.add({ draw() { globalThis.frames++; } }); }"""
# Helpers that one study uses are counted with it.
HELPERS = {"lab": ["_laboratory"], "playground": ["_scene"]}
SHOWS = re.compile(
    r"looks\.|\.draw|add_static|add_strut|camera|Camera|color|\.label\(|\.shape\(|visible|present|room\.|Furniture|_laboratory"
)
MAKES = re.compile(
    r"^(from|import) |System\(|World\(|\.body\(|\.bodies\.|\.particle\(|\.attachment\(|\.realize\(|\.bond\(|\.point\(|\.nail\("
    r"|\.revolute\(|\.on_surface\(|\.field\(|\.pair_force\(|\.group\(|builder\.|shapelib\.|^[A-Z_, ]+ = |^def build|^return world"
)


def categories(path: Path) -> Counter[str]:
    """Statements by their main purpose; their lines, without blank ones, comments and docstrings."""
    source = path.read_text()
    lines = source.splitlines()
    found: Counter[str] = Counter()

    def count(first: int, last: int) -> int:
        return sum(
            bool(text) and not text.startswith("#") for text in (line.strip() for line in lines[first - 1 : last])
        )

    def kind(text: str, where: str) -> str:
        if where == "presentation" or SHOWS.search(text):
            return "presentation"
        return "scene setup" if where == "scene setup" or MAKES.search(text) else "behavior"

    def visit(body: list[ast.stmt], where: str = "") -> None:
        for node in body:
            if (
                isinstance(node, ast.Expr)
                and isinstance(node.value, ast.Constant)
                and isinstance(node.value.value, str)
            ):
                continue  # a docstring
            inner = [part for name in ("body", "orelse", "finalbody") for part in getattr(node, name, [])]
            first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", []))])
            last = (inner[0].lineno - 1 if inner else node.end_lineno) or node.lineno
            if inner and isinstance(inner[0], ast.FunctionDef | ast.ClassDef) and inner[0].decorator_list:
                last = min(d.lineno for d in inner[0].decorator_list) - 1
            text = "\n".join(lines[first - 1 : last]).strip()
            now = "presentation" if "present" in getattr(node, "name", "") else where
            found[kind(text, now)] += count(first, last)
            visit(inner, now)

    everything = "presentation" if path.stem == "_laboratory" else ""
    visit(ast.parse(source).body, everything)
    return found


def names() -> list[str]:
    return sorted(path.stem.replace("_", "-") for path in STUDIES.glob("[a-z]*.py"))


def line_table() -> str:
    rows = ["| study | scene setup | presentation | behavior | all | thesis |", "|---|---|---|---|---|---|"]
    ours = theirs = 0
    for name in names():
        counts: Counter[str] = Counter()
        for stem in [name.replace("-", "_"), *HELPERS.get(name, [])]:
            counts += categories(STUDIES / f"{stem}.py")
        total = sum(counts.values())
        thesis = THESIS.get(name)
        if thesis:
            ours, theirs = ours + total, theirs + sum(thesis)
        told = f"{thesis[0]} + {thesis[1]} + {thesis[2]} = {sum(thesis)}" if thesis else ""
        rows.append(f"| {name} | {' | '.join(str(counts[c]) for c in CATEGORIES)} | {total} | {told} |")
    rows.append(f"| **those of the thesis** | | | | **{ours}** | **{theirs}** |")
    return "\n".join(rows)


def step_costs(build: object, seconds: float = 3.0) -> tuple[float, float, float]:
    """Processor time of a step of the world and of its simulator alone, ms, and of both for a simulated second, s."""
    world = build()  # type: ignore[operator]
    while world.system.time < 1:
        world.step()
    whole = engine = 0.0
    steps = round(seconds / world.dt)
    for step in range(steps):
        if step % 8 == 0:  # the next step without the script, and back
            before = world.system.snapshot()
            began = time.process_time()
            world.system.step(world.dt)
            engine += 8 * (time.process_time() - began)
            world.system.restore(before)
        began = time.process_time()
        world.step()
        whole += time.process_time() - began
    return 1000 * whole / steps, 1000 * engine / steps, whole / seconds


@dataclass
class PageCost:
    """The cost of a frame of the page: processor time of its script, which includes submitting the drawing, ms; draw calls, and
    triangles with shadows."""

    script: float
    calls: int
    triangles: int


def page_costs(browser: Any, build: Callable[[], iota.World]) -> PageCost:
    """While the world runs. Processor time, because a shared machine lets a page wait."""
    world = build()
    page = browser.new_page(viewport=WINDOW)
    try:
        page.goto(world.start(port=0))
        time.sleep(WARM_UP)
        calls, triangles = page.evaluate(ASK)
        page.evaluate(LEAVE_DRAWING_OUT)
        session = page.context.new_cdp_session(page)
        session.send("Performance.enable", {"timeDomain": "threadTicks"})

        def spent() -> tuple[int, float]:
            """Frames, and seconds of the script's thread."""
            metrics = {metric["name"]: metric["value"] for metric in session.send("Performance.getMetrics")["metrics"]}
            return page.evaluate("frames"), metrics["TaskDuration"]

        while page.evaluate("frames") < FRAMES:  # until what was submitted before is drawn
            time.sleep(0.2)
        began = spent()
        time.sleep(MEASURED)
        frames, seconds = (after - before for after, before in zip(spent(), began, strict=True))
        return PageCost(1000 * seconds / frames, calls, triangles)
    finally:
        page.close()
        world.stop()


def time_table() -> str:
    from playwright.sync_api import sync_playwright

    from iota import studies
    from iota.film.browser import FLAGS, find_browser

    rows = [
        "| study | step, ms | simulator alone, ms | share of real time | page, ms | draw calls | triangles |",
        "|---|---|---|---|---|---|---|",
    ]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=find_browser(), args=list(FLAGS))
        for number, name in enumerate(names(), 1):
            print(f"[{number}/{len(names())}] {name}", flush=True)
            build = studies.module(name).build
            whole, engine, share = step_costs(build)
            page = page_costs(browser, build)
            rows.append(
                f"| {name} | {whole:.2f} | {min(engine, whole):.2f} | {100 * share:.0f} % | {page.script:.1f} "
                f"| {page.calls} | {page.triangles} |"
            )
        browser.close()
    return "\n".join(rows)


def ladder_table() -> str:
    """G1: one ladder of six against one of three and one of four (Figs 5.26-5.28), and the cradle."""
    import iota
    from iota.studies import cradle, ladder

    def ladders(*counts: int) -> iota.World:
        world = iota.World(iota.System(damping=0.25), dt=1 / 240)
        for number, count in enumerate(counts):
            made = ladder.Ladder(world, count, ladder.TOP + (0, 0, number))
            world.every(4.0, start=0.6)(made.tip)
        return world

    rows = ["| | step, ms | simulator alone, ms | script and restructuring |", "|---|---|---|---|"]
    for what, build in {
        "one ladder of six": lambda: ladders(6),
        "one of three and one of four": lambda: ladders(3, 4),
        "one of twelve": lambda: ladders(12),
        "the cradle, two groups": cradle.build,
    }.items():
        whole, engine, _ = min(step_costs(build, 6.0) for _ in range(3))
        rest = max(0.0, 1 - engine / whole)
        rows.append(f"| {what} | {whole:.2f} | {min(engine, whole):.2f} | {100 * rest:.0f} % |")
    return "\n".join(rows)


TEXT = """# Studies in figures

Written by `tools/study_tables.py`.

## Lines

Statements by what they mostly do, counted by the formatter's lines without blank ones, comments and docstrings; helpers that one study uses are
counted with it. Chapter 5 of the thesis gives the last column in the same order; of two versions the interactive one.

{lines}

## What a step and a frame cost

Processor times on a shared and busy machine, where they are two to three times those of a free core: compare rows. Simulator alone: every eighth step taken once more
without the script. The page: of a frame of its script, which receives the poses and submits the drawing, with WebGL's drawing calls left out, since a
browser without a graphics card draws by the processor. Draw calls and triangles, shadows counted, are those of a frame in a window of 1280x720.
`iota profile` tells where the time of a frame goes on a machine of yours.

{times}

## Articulates

The thesis (Figs 5.26-5.28) compares the ladder, which is nearly all physics, with the cradle, which is nearly all script, and one ladder of six blocks (ten
unknown forces) with one of three and one of four (four and six), solved one after the other.

{ladders}

Solved as one dense matrix, six blocks would cost far more than three and four. Here each block adds the same: the factorization follows the tree
of articulates in O(n), so parting a ladder gains nothing: the simulator takes as long for seven blocks in two ladders as for six in one,
or a little longer. What remains of a step is the script: looking at each pair, and restructurings: a pair of flat faces
locks and parts again some thirty times a second while the ladder swings.
"""


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--check", action="store_true")
    lines = line_table()
    if parser.parse_args().check:
        if PAGE.is_file() and lines in PAGE.read_text():
            return 0
        print("docs/study_figures.md is older than the studies: run tools/study_tables.py", file=sys.stderr)
        return 1
    PAGE.write_text(TEXT.format(lines=lines, times=time_table(), ladders=ladder_table()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
