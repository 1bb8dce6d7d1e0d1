# SPDX-License-Identifier: Apache-2.0
"""Simultaneous equations: solve them by any solver, write a solver of your own.

    iota.solve(lambda x: [x[0] ** 2 - 2], [1.0]).x          # the square root of two
    iota.solve(problem, x0, method="kinsol")                # by SUNDIALS

Every solver, those of the script included, is known by its name: to `solve` and to `System.solver`, where it solves the
equations of each step.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from iota import _core

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Function = Callable[[NDArray[np.float64]], ArrayLike]
    MaybeFunction = Callable[[NDArray[np.float64]], ArrayLike | None]
    SolverFunction = Callable[[_core.Equations, NDArray[np.float64], float, int], ArrayLike]

_functions: dict[str, SolverFunction] = {}  # solvers of the script by name; the engine looks them up here


class Problem(ABC):
    """n equations f(x) = 0 in n unknowns; derive and give it to `solve`. Scale them so that 1 is a usual size.

    class Circle(iota.Problem):
        size = 2

        def evaluate(self, x):
            return [x[0] ** 2 + x[1] ** 2 - 1, x[0] - x[1]]
    """

    size: int

    @abstractmethod
    def evaluate(self, x: NDArray[np.float64]) -> ArrayLike:
        """f(x), n numbers. What is not finite makes the solver try a shorter step."""

    def jacobian(self, x: NDArray[np.float64]) -> ArrayLike | None:
        """(n, n): df_i/dx_j. None: the solver takes differences."""
        return None


@dataclass(frozen=True)
class Solution:
    """What a solver found. x: the best point, a root where `converged`. residual: largest |f_i| there, infinite where one
    is not finite. reason: why it ended. Not converged is a result, no exception."""

    x: NDArray[np.float64]
    converged: bool
    iterations: int
    evaluations: int
    residual: float
    reason: str


def solve(
    problem: Problem | Function,
    x0: Sequence[float] | NDArray[np.float64],
    jacobian: Function | None = None,
    *,
    method: str = "newton",
    tolerance: float = 1e-10,
    max_iterations: int = 200,
) -> Solution:
    """Solves f(x) = 0 from the guess x0; problem: a `Problem`, or f itself. tolerance: of the largest |f_i|.

    method: 'newton' (Newton-Raphson with line search; Dennis and Schnabel 1983), 'kinsol' (SUNDIALS) or a solver of the
    script, see `solver`. What the equations raise passes. Raises ValueError for shapes that do not match, a guess that
    is not finite, and methods that there are not.
    """
    evaluate: Function
    derivative: MaybeFunction | None = jacobian
    if isinstance(problem, Problem):
        if jacobian is not None:
            raise TypeError("a Problem has its Jacobian as a method; give either the Problem or functions")
        size, evaluate, derivative = problem.size, problem.evaluate, problem.jacobian
    elif callable(problem):
        size, evaluate = len(x0), problem
    else:
        raise TypeError(f"solve takes a Problem or a function of x, not {problem!r}")
    return Solution(*_core.solve_equations(size, evaluate, derivative, x0, method, tolerance, max_iterations))


def solver(name: str) -> Callable[[SolverFunction], SolverFunction]:
    """Decorator: makes a function a solver of that name, for `solve` and `System.solver`.

    The function is given the equations (`size`, `evaluate(x)`, `jacobian(x)`), the guess, the tolerance and the largest
    number of iterations, and returns its best x. Whether that is a root is measured afterwards.

        @iota.solver("picard")
        def picard(equations, x, tolerance, max_iterations):
            for _ in range(max_iterations):
                x = x - 0.1 * equations.evaluate(x)
            return x
    """

    def register(function: SolverFunction) -> SolverFunction:
        if not callable(function):
            raise TypeError(f"a solver is a function, not {function!r}")
        _core.register_solver(name)
        _functions[name] = function
        return function

    return register


def solver_names() -> list[str]:
    """Solvers that there are: built-in ones and those of the script."""
    return list(_core.solver_names())


__all__ = ["Problem", "Solution", "solve", "solver", "solver_names"]
