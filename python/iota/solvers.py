# SPDX-License-Identifier: Apache-2.0
"""Simultaneous equations: solve them with any solver, or write your own solver.

    iota.solve(lambda x: [x[0] ** 2 - 2], [1.0]).x          # the square root of two
    iota.solve(problem, x0, method="kinsol")                # by SUNDIALS

Every solver, including those of the script, has a name, for `solve` and for `System.solver`, which chooses the solver
of the equations of each step.
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

_functions: dict[str, SolverFunction] = {}  # solvers of the script by name; the engine finds them here


class Problem(ABC):
    """n equations f(x) = 0 in n unknowns; derive and pass it to `solve`. Scale them so that 1 is a typical size.

    class Circle(iota.Problem):
        size = 2

        def evaluate(self, x):
            return [x[0] ** 2 + x[1] ** 2 - 1, x[0] - x[1]]
    """

    size: int

    @abstractmethod
    def evaluate(self, x: NDArray[np.float64]) -> ArrayLike:
        """f(x), n numbers. After a value that is not finite the solver tries a shorter step."""

    def jacobian(self, x: NDArray[np.float64]) -> ArrayLike | None:
        """(n, n): df_i/dx_j. None: the solver uses finite differences."""
        return None


@dataclass(frozen=True)
class Solution:
    """Result of a solver. x: the best point, a root if `converged`. residual: largest |f_i| there, infinite if one is
    not finite. reason: why it ended. Non-convergence is a result, not an exception."""

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
    script, see `solver`. Exceptions of the equations propagate. Raises ValueError for shapes that do not match, a guess
    that is not finite, and unknown methods.
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

    The function takes the equations (`size`, `evaluate(x)`, `jacobian(x)`), the guess, the tolerance and the largest
    number of iterations, and returns its best x. The residual is measured afterwards.

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
    """The names of all solvers: built-in ones and those of the script."""
    return list(_core.solver_names())


__all__ = ["Problem", "Solution", "solve", "solver", "solver_names"]
