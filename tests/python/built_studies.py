# SPDX-License-Identifier: Apache-2.0
"""Studies as they are built, for tests that only look at them: to build one takes up to half a second."""

from __future__ import annotations

import functools

import iota
from iota import studies


@functools.cache
def built(name: str) -> iota.World:
    """No test steps it or changes it."""
    world: iota.World = studies.module(name).build()
    return world
