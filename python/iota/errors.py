# SPDX-License-Identifier: Apache-2.0
"""What iota raises beside ValueError (bad numbers), TypeError (not a number at all) and OSError (files, ports)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from iota._core import Body, Bond, Particle, StepReport


class StaleIdError(ValueError):
    """A handle was used whose body, particle, bond or grip is gone; the text says what became of it.

    survivor: the living handle of what absorbed it, None if it was destroyed.
    """

    def __init__(self, text: str, survivor: Body | Particle | None = None) -> None:
        super().__init__(text)
        self.survivor = survivor


class BondError(RuntimeError):
    """The function of a bond raised, or returned no finite force; the step was finished and the bond switched off.

    bond: the handle. report: of that step. `__cause__` is what the function raised.
    """

    def __init__(self, text: str, bond: Bond, report: StepReport) -> None:
        super().__init__(text)
        self.bond = bond
        self.report = report


class WrongThreadError(RuntimeError):
    """A system, or a handle of it, was used outside the thread that owns it."""


class PageMissingError(RuntimeError):
    """The page that a World serves is not built."""
