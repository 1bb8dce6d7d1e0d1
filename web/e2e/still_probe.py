# SPDX-License-Identifier: Apache-2.0
"""A brass ball that cannot move, and nothing else, for browser tests."""

from __future__ import annotations

import iota
from iota import looks

world = iota.World(iota.System(), title="still", ground=0.0)
world.add_static(looks.sphere(0.1, "brass"), (0, 0.1, 0))
world.run()
