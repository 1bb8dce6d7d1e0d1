# SPDX-License-Identifier: Apache-2.0
"""The exceptions of iota besides ValueError (bad values), TypeError (wrong types) and OSError (files, ports)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from iota._core import Body, Bond, Constraint, Particle, StepReport


class StaleIdError(ValueError):
    """The body, particle, bond or grip of a handle no longer exists; the text says what became of it.

    survivor: the handle of the object that absorbed it, None if it was destroyed.
    """

    def __init__(self, text: str, survivor: Body | Particle | None = None) -> None:
        super().__init__(text)
        self.survivor = survivor


class ForceError(RuntimeError):
    """A force function of the script raised; the step was completed, and the law or field was switched off.

    report: of that step. `__cause__` is the function's exception.
    """

    def __init__(self, text: str, report: StepReport) -> None:
        super().__init__(text)
        self.report = report


class BondError(ForceError):
    """A bond's function raised, or its law gave no finite force; the step was completed and the bond switched off.

    bond: the handle. report: of that step. `__cause__` is the function's exception, if any.
    """

    def __init__(self, text: str, report: StepReport, bond: Bond) -> None:
        super().__init__(text, report)
        self.bond = bond


class ConstraintError(ForceError):
    """The function of a constraint's surface raised, or returned no finite number; the step was completed without the
    constraint, which is switched off.

    constraint: the handle. report: of that step. `__cause__` is the function's exception, if any.
    """

    def __init__(self, text: str, report: StepReport, constraint: Constraint) -> None:
        super().__init__(text, report)
        self.constraint = constraint


class ForceWarning(RuntimeWarning):
    """As ForceError, if `System.force_errors` is 'warn'."""


class WrongThreadError(RuntimeError):
    """A system, or a handle of it, was used outside the thread that owns it."""


class PageMissingError(RuntimeError):
    """The page that a World serves is not built."""
