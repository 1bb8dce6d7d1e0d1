# SPDX-License-Identifier: Apache-2.0
"""Plots of the command line, by Matplotlib, and those of `iota sweep --plot`."""

from __future__ import annotations

import importlib.util
import itertools
import math
from collections import defaultdict
from pathlib import Path
from typing import Any

from iota.cli.failure import Failure
from iota.extras import how_to_get
from iota.saving import replacing
from iota.sweeping import ERROR, Row

ENDINGS = (".png", ".svg", ".pdf")
COLORS = ("#2f9d92", "#e8452c", "#3f7fd0", "#f2a324", "#8d6fd1", "#4c9a52")
MOST_PLOTS = 12
EVEN = 0.05  # of a logarithmic step, by which steps may differ


def check(file: Path) -> None:
    """Raises Failure, before any work, for another kind of file and without Matplotlib."""
    if file.suffix.lower() not in ENDINGS:
        raise Failure(f"a plot ends in {', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}, not in {file.suffix or 'nothing'}")
    if importlib.util.find_spec("matplotlib") is None:
        raise Failure(f"plots need Matplotlib. {how_to_get('verify')}")


def save(figure: Any, file: Path) -> None:
    """figure: of Matplotlib. Raises Failure."""
    try:
        with replacing(file) as fresh:
            figure.savefig(fresh, dpi=150)
    except OSError as error:
        raise Failure(str(error)) from None


def draw(rows: list[Row], arguments: list[str], title: str, file: Path) -> None:
    """Each result over the argument with the most values; a line for each value of another one with few, if there is one. The
    mean of runs that differ in other arguments only, such as seeds, with a band from the least to the greatest."""
    from matplotlib.figure import Figure

    whole = [row for row in rows if not row[ERROR]]
    results = [
        name for name in (whole[0] if whole else {}) if name not in (*arguments, ERROR) and is_of_numbers(whole, name)
    ]
    along = most_varied([name for name in arguments if is_of_numbers(rows, name)], rows)
    if not results or along is None:
        raise Failure(
            f"there is nothing to plot: of {len(rows)} runs, {len(whole)} have results, and a plot needs numbers"
        )
    by = line_argument([name for name in arguments if name != along], rows)
    results = results[:MOST_PLOTS]
    columns = math.ceil(math.sqrt(len(results)))
    figure = Figure(figsize=(5 * columns, 3.6 * math.ceil(len(results) / columns)), layout="constrained")
    for place, (axes, result) in enumerate(zip(panels(figure, len(results), columns), results, strict=True)):
        for number, (value, line) in enumerate(lines(whole, along, by, result).items()):
            color, label = COLORS[number % len(COLORS)], None if by is None else f"{by} = {value}"
            axes.plot(line["x"], line["mean"], "o-", ms=3, lw=1.4, color=color, label=label)
            axes.fill_between(line["x"], line["least"], line["most"], color=color, alpha=0.18, lw=0)
        if is_logarithmic(sorted({row[along] for row in rows})):
            axes.set_xscale("log")
        axes.set(xlabel=along, ylabel=result)
        axes.grid(alpha=0.25)
        if by is not None and place == 0:
            axes.legend(frameon=False, fontsize="small")
    figure.suptitle(title)
    save(figure, file)


def panels(figure: Any, count: int, columns: int) -> list[Any]:
    grid = figure.subplots(math.ceil(count / columns), columns, squeeze=False)
    flat = [axes for row in grid for axes in row]
    for axes in flat[count:]:
        axes.remove()
    return flat[:count]


def lines(rows: list[Row], along: str, by: str | None, result: str) -> dict[Any, dict[str, list[float]]]:
    """By the value of `by`: places, and there the mean, the least and the greatest result."""
    found: dict[Any, dict[float, list[float]]] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        found[None if by is None else row[by]][row[along]].append(row[result])
    return {
        value: {
            "x": sorted(at),
            "mean": [sum(at[x]) / len(at[x]) for x in sorted(at)],
            "least": [min(at[x]) for x in sorted(at)],
            "most": [max(at[x]) for x in sorted(at)],
        }
        for value, at in found.items()
    }


def is_of_numbers(rows: list[Row], name: str) -> bool:
    return all(isinstance(row[name], int | float) and not isinstance(row[name], bool) for row in rows)


def most_varied(names: list[str], rows: list[Row]) -> str | None:
    """The first one of equals; seeds only if there is no other."""
    counts = {name: len({row[name] for row in rows}) for name in names}
    return max(counts, key=lambda name: (name != "seed", counts[name]), default=None)


def line_argument(names: list[str], rows: list[Row]) -> str | None:
    counts = {name: len({row[name] for row in rows}) for name in names if name != "seed"}
    few = {name: count for name, count in counts.items() if 1 < count <= len(COLORS)}
    return max(few, key=lambda name: few[name], default=None)


def is_logarithmic(values: list[float]) -> bool:
    """Whether they are more even in their logarithms than in themselves."""
    if len(values) < 3 or values[0] <= 0:
        return False
    steps = [math.log(b / a) for a, b in itertools.pairwise(values)]
    return max(steps) - min(steps) < EVEN * max(steps) and values[-1] > 3 * values[0]
