# SPDX-License-Identifier: Apache-2.0
"""What iota raises beside ValueError (bad numbers), TypeError (not a number at all) and OSError (files, ports)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from iota._core import Body, Bond, Constraint, Particle, StepReport


class StaleIdError(ValueError):
    """A handle was used whose body, particle, bond or grip is gone; the text says what became of it.

    survivor: the living handle of what absorbed it, None if it was destroyed.
    """

    def __init__(self, text: str, survivor: Body | Particle | None = None) -> None:
        super().__init__(text)
        self.survivor = survivor


class ForceError(RuntimeError):
    """A function of the script that gives forces raised; the step was finished and what the function is for switched off.

    report: of that step. `__cause__` is what the function raised.
    """

    def __init__(self, text: str, report: StepReport) -> None:
        super().__init__(text)
        self.report = report


class BondError(ForceError):
    """A bond's function raised, or its law gave no finite force; the step was finished and the bond switched off.

    bond: the handle. report: of that step. `__cause__` is what the function raised, if it did.
    """

    def __init__(self, text: str, report: StepReport, bond: Bond) -> None:
        super().__init__(text, report)
        self.bond = bond


class ConstraintError(ForceError):
    """The function of a constraint's surface raised, or gave no finite number; the step was finished without the
    constraint, which is switched off.

    constraint: the handle. report: of that step. `__cause__` is what the function raised, if it did.
    """

    def __init__(self, text: str, report: StepReport, constraint: Constraint) -> None:
        super().__init__(text, report)
        self.constraint = constraint


class ForceWarning(RuntimeWarning):
    """As ForceError, where `System.force_errors` is 'warn'."""


class WrongThreadError(RuntimeError):
    """A system, or a handle of it, was used outside the thread that owns it."""


class PageMissingError(RuntimeError):
    """The page that a World serves is not built."""
