# SPDX-License-Identifier: Apache-2.0
"""The page docs/verification.md and its figures."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from iota.verify.run import Case, Picture, Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAGE, PICTURES = "verification.md", "verification"

HEAD = """# Verification

Results of the engine compared with independent solvers (SciPy: MINPACK's hybrid method for the equations of a step,
Dormand-Prince 8(5,3) at 1e-13 for the equations of motion) and exact answers. Every number and picture comes from a run
of

    iota verify                 # all of it, some minutes; writes this page and its figures
    iota verify --quick         # smaller sizes, seconds; writes nothing unless --out is given
    iota verify --figure orbit  # one of them

The same checks at the small sizes are tests (`tests/python/test_verification.py`). `make soak` runs `iota verify --long`, and
10 000 random scenes and ten million random edits, compared with a reference that only tracks labels (`soak/`; 400
scenes and a million edits are in `make test-all`, a tenth of both in `make test`): random graphs, joints, nails, springs, hands and edits every frame, masses over
six decades. A scene fails if it crashes, ends with a non-finite number or an invalid structure, reports a step with a
gap as solved, or violates the energy balance. A failing scene is reduced to the shortest script that still fails, and
printed with its seed and as calls; scenes that once failed are kept in `tests/cpp/soak/scenes`.
10 000 more scenes of each promise (energy, velocities, momenta, forces, conflicts, order of arguments; `scenes/promises.h`)
are measured from outside, from places and velocities alone, on trees and closed rings of bodies, nets and hinged boxes, with
lengths and masses over six decades; 400 are in `make test-all`, 40 in `make test`.
`make hostile` restores and replays damaged snapshots and recordings, whose checksums are right, under the address sanitizer: each
is refused and changes nothing, or makes a valid world. 1000 and 20 000 of them are in `make test-all`, a tenth in `make test`.
"""

STYLE: dict[str, Any] = {
    "font.size": 9,
    "axes.grid": True,
    "grid.linewidth": 0.4,
    "grid.color": "0.85",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 9,
    "legend.frameon": False,
    "svg.hashsalt": "iota",  # for reproducible files
    "svg.fonttype": "path",
}


def draw(picture: Picture, folder: Path) -> Path:
    """Writes one picture. Raises ImportError without Matplotlib."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with matplotlib.rc_context(STYLE):
        figure: Figure = Figure(figsize=picture.size, layout="constrained")
        FigureCanvasAgg(figure)
        picture.draw(figure)
        path = folder / f"{picture.name}.{'png' if picture.raster else 'svg'}"
        metadata = {"Software": None} if picture.raster else {"Date": None}
        figure.savefig(path, dpi=130, metadata=metadata, facecolor="white")
    return path


def table(run: Run) -> list[str]:
    lines = ["| quantity | expected | measured | tolerance | |", "|---|---|---|---|---|"]
    for row in run.rows:
        mark = "" if not row.expected else "pass" if row.passed else "**FAIL**"
        lines.append(f"| {row.quantity} | {row.expected} | {row.measured} | {row.tolerance} | {mark} |")
    return lines


def section(case: Case, run: Run, pictures: list[Path]) -> str:
    lines = [f"<!-- begin {case.name} -->", f"## {case.title}", ""]
    lines += [line for line in case.text[1:]] if len(case.text) > 1 else []
    if run.scale != "full":
        lines += ["", f"(A {run.scale} run, not the one that this page is meant to show.)"]
    lines += ["", *table(run), ""]
    for picture, path in zip(run.pictures, pictures, strict=True):
        lines += [f"![{picture.caption}]({PICTURES}/{path.name})", ""]
    text = "\n".join([*lines, f"<!-- end {case.name} -->"])
    return re.sub(r"\n{3,}", "\n\n", text)


def write(folder: Path, done: list[tuple[Case, Run]], order: list[str]) -> Path:
    """Writes the figures, and the sections of the given cases into the page; other sections do not change."""
    page, pictures = folder / PAGE, folder / PICTURES
    pictures.mkdir(parents=True, exist_ok=True)
    old = page.read_text() if page.is_file() else ""
    sections = {m[1]: m[0] for m in re.finditer(r"<!-- begin (\S+) -->.*?<!-- end \1 -->", old, re.DOTALL)}
    for case, run in done:
        sections[case.name] = section(case, run, [draw(picture, pictures) for picture in run.pictures])
    page.write_text("\n".join([HEAD, *(sections[name] + "\n" for name in order if name in sections)]))
    return page
