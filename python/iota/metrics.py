# SPDX-License-Identifier: Apache-2.0
"""Figures in the text format of Prometheus."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

CONTENT_TYPE = "text/plain; version=0.0.4; charset=utf-8"
_BEGAN = time.time()


@dataclass
class Metric:
    """Values with labels. name: with its unit at the end, a counter's with _total."""

    name: str
    kind: Literal["gauge", "counter"]
    help: str
    values: Sequence[tuple[Mapping[str, str], float]]


def one(name: str, kind: Literal["gauge", "counter"], help: str, value: float) -> Metric:
    """A metric with one value and no labels."""
    return Metric(name, kind, help, [({}, value)])


def text_of(metrics: Iterable[Metric]) -> str:
    lines = []
    for metric in metrics:
        lines += [f"# HELP {metric.name} {metric.help}", f"# TYPE {metric.name} {metric.kind}"]
        for labels, value in metric.values:
            inside = ",".join(f'{name}="{_escaped(each)}"' for name, each in labels.items())
            lines.append(f"{metric.name}{'{' + inside + '}' if inside else ''} {float(value):.12g}")
    return "\n".join(lines) + "\n"


def of_process() -> list[Metric]:
    """The metrics of this process, under the names that all clients of Prometheus use. Memory on Linux only."""
    found = [
        one("process_cpu_seconds_total", "counter", "Processor time.", time.process_time()),
        one("process_start_time_seconds", "gauge", "Start, since 1970.", _BEGAN),
    ]
    with suppress(OSError, ValueError, IndexError):
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        found.append(one("process_resident_memory_bytes", "gauge", "Memory.", pages * os.sysconf("SC_PAGE_SIZE")))
    return found


def _escaped(text: str) -> str:
    return text.replace("\\", r"\\").replace('"', r"\"").replace("\n", r"\n")
