# SPDX-License-Identifier: Apache-2.0
"""Forces that a script adds to a World with one call."""

from iota.forces.floor import floor

__all__ = ["floor"]
