# SPDX-License-Identifier: Apache-2.0
"""The studies that another system repeats to the last bit: those without functions of forces, of which it has none."""

from __future__ import annotations

from iota import studies

REPEATABLE = sorted(set(studies.names()) - {"appendix-e2", "evacuation", "shoal", "undersea"})
