# SPDX-License-Identifier: Apache-2.0
"""`iota verify`."""

from __future__ import annotations

import argparse
import difflib
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from iota.cli.failure import Failure
from iota.extras import how_to_get

if TYPE_CHECKING:
    from iota.verify.run import Case, Run

BAR = 24


def run(arguments: argparse.Namespace) -> None:
    """Runs the requested cases, writes page and figures, prints the table. Fails if a check failed."""
    try:
        from iota.verify.cases import CASES
    except ImportError as missing:
        raise Failure(f"verification needs SciPy ({missing}). {how_to_get('verify')}") from None
    names = [case.name for case in CASES]
    if arguments.list:
        for case in CASES:
            print(f"{case.name:{max(map(len, names))}}  {case.title}")
        return
    wanted = arguments.figure or names
    for name in wanted:
        if name not in names:
            near = difflib.get_close_matches(name, names, n=1)
            raise Failure(
                f"there is no verification {name!r}. " + (f"Did you mean {near[0]}?" if near else "Try: --list")
            )
    out = Path(arguments.out) if arguments.out else Path("docs") if arguments.scale == "full" else None

    done = [(case, run_case(case, arguments.scale)) for case in CASES if case.name in wanted]
    print_table(done)
    if out is not None:
        from iota.verify import report

        try:
            print(f"written: {report.write(out, done, names)}")
        except ImportError as missing:
            raise Failure(f"figures need Matplotlib ({missing}). {how_to_get('verify')}") from None
    failed = sum(not row.passed for _, case_run in done for row in case_run.rows)
    if failed:
        raise Failure(f"{failed} of the checks failed")


def run_case(case: Case, scale: Literal["quick", "full", "long"]) -> Run:
    """Runs one case, with a progress bar on a terminal."""
    from iota.verify.run import Run

    watched = sys.stderr.isatty()
    shown = -1

    def progress(share: float) -> None:
        nonlocal shown
        full = round(BAR * min(1.0, max(0.0, share)))
        if watched and full != shown:
            shown = full
            print(f"\r{case.name:18} [{'#' * full}{'.' * (BAR - full)}]", end="", file=sys.stderr, flush=True)

    case_run = Run(scale=scale, progress=progress)
    began = time.monotonic()
    progress(0)
    case.check(case_run)
    checks = [row for row in case_run.rows if row.expected]
    passed = sum(row.passed for row in checks)
    erase = f"\r{' ' * (BAR + 24)}\r" if watched else ""
    print(
        f"{erase}{case.name:18} {passed:3} of {len(checks):3} checks pass {time.monotonic() - began:7.1f} s",
        file=sys.stderr,
        flush=True,
    )
    return case_run


def print_table(done: list[tuple[Case, Run]]) -> None:
    rows = [row for _, case_run in done for row in case_run.rows]
    width = max((len(row.quantity) for row in rows), default=0)
    for case, case_run in done:
        print(f"\n{case.title}")
        for row in case_run.rows:
            mark = "" if not row.expected else "pass" if row.passed else "FAIL"
            within = f" ± {row.tolerance}" if row.tolerance else ""
            print(f"  {row.quantity:{width}}  {row.measured:>12}  {mark:4}  {row.expected}{within}".rstrip())
    print()
