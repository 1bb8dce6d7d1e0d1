# SPDX-License-Identifier: Apache-2.0
"""Equations of the script, and solvers of the script."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import iota

METHODS = [name for name in ("newton", "kinsol") if name in iota.solver_names()]


class Rosenbrock(iota.Problem):
    size = 2

    def __init__(self) -> None:
        self.asked = 0

    def evaluate(self, x: Any) -> Any:
        return [10 * (x[1] - x[0] ** 2), 1 - x[0]]

    def jacobian(self, x: Any) -> Any:
        self.asked += 1
        return [[-20 * x[0], 10], [-1, 0]]


def test_this_build_has_a_second_solver() -> None:
    assert METHODS == ["newton", "kinsol"], "run tools/fetch_sundials.sh .venv/sundials and build again"


@pytest.mark.parametrize("method", METHODS)
def test_a_problem_is_solved_with_its_own_jacobian(method: str) -> None:
    problem = Rosenbrock()
    solution = iota.solve(problem, [-1.2, 1], method=method)
    assert solution.converged
    assert solution.x == pytest.approx([1, 1], abs=1e-9)
    assert solution.residual <= 1e-10
    assert problem.asked >= solution.iterations > 0


@pytest.mark.parametrize("method", METHODS)
def test_a_function_is_enough(method: str) -> None:
    solution = iota.solve(lambda x: np.cos(x) - x, [1.0, 0.3], method=method)
    assert solution.converged
    assert solution.x == pytest.approx([0.7390851332151607] * 2, abs=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_every_solver_solves_broydens_tridiagonal_equations(method: str) -> None:
    """(More, Garbow and Hillstrom 1981, problem 30.)"""

    def f(x: Any) -> Any:
        padded = np.concatenate([[0], x, [0]])
        return (3 - 2 * x) * x - padded[:-2] - 2 * padded[2:] + 1

    solution = iota.solve(f, -np.ones(30), method=method)
    assert solution.converged
    assert np.abs(f(solution.x)).max() < 1e-10


@pytest.mark.parametrize("method", METHODS)
def test_errors_of_the_equations_reach_the_caller(method: str) -> None:
    def f(x: Any) -> Any:
        raise ZeroDivisionError("by hand")

    with pytest.raises(ZeroDivisionError, match="by hand"):
        iota.solve(f, [1.0], method=method)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("f", "jacobian", "words"),
    [
        (lambda x: [1, 2, 3], None, r"evaluate\(x\) must be numbers of shape \(2,\), not \(3,\)"),
        (lambda x: 1.0, None, r"evaluate\(x\) .* not \(\)"),
        (lambda x: x, lambda x: [1, 2], r"jacobian\(x\) must be numbers of shape \(2, 2\), not \(2,\)"),
        (lambda x: ["a", "b"], None, "could not convert"),
    ],
)
def test_wrong_shapes_are_refused_with_the_right_ones(method: str, f: Any, jacobian: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        iota.solve(f, [1.0, 2.0], jacobian, method=method)


@pytest.mark.parametrize("method", METHODS)
def test_no_root_is_a_result(method: str) -> None:
    solution = iota.solve(lambda x: x**2 + 1, [3.0], method=method)
    assert not solution.converged
    assert solution.residual >= 1
    assert solution.reason


@pytest.mark.parametrize("method", METHODS)
def test_nan_everywhere_is_a_result(method: str) -> None:
    solution = iota.solve(lambda x: x * math.nan, [3.0], method=method)
    assert not solution.converged
    assert solution.residual == math.inf


@pytest.mark.parametrize(
    ("arguments", "options", "error"),
    [
        ((lambda x: x, [math.nan]), {}, ValueError),
        ((lambda x: x, [[1.0]]), {}, ValueError),
        ((lambda x: x, 1.0), {}, TypeError),
        ((3, [1.0]), {}, TypeError),
        ((lambda x: x, [1.0]), {"method": "nwton"}, ValueError),
        ((lambda x: x, [1.0]), {"method": "direct"}, ValueError),
        ((lambda x: x, [1.0]), {"tolerance": 0}, ValueError),
        ((lambda x: x, [1.0]), {"tolerance": math.nan}, ValueError),
        ((lambda x: x, [1.0]), {"max_iterations": 0}, ValueError),
        ((Rosenbrock(), [1.0]), {}, ValueError),
        ((Rosenbrock(), [1.0, 1.0], lambda x: x), {}, TypeError),
    ],
)
def test_bad_requests_are_refused(arguments: Any, options: Any, error: Any) -> None:
    with pytest.raises(error):
        iota.solve(*arguments, **options)


def test_a_solver_of_the_script_is_known_by_its_name() -> None:
    @iota.solver("bisection")
    def bisection(equations: Any, x: Any, tolerance: float, max_iterations: int) -> Any:
        low, high = 0.0, 2.0
        for _ in range(max_iterations):
            middle = (low + high) / 2
            if abs(value := equations.evaluate([middle])[0]) <= tolerance:
                break
            low, high = (low, middle) if value > 0 else (middle, high)
        return [middle]

    assert "bisection" in iota.solver_names()
    solution = iota.solve(lambda x: x**2 - 2, [1.0], method="bisection")
    assert solution.converged
    assert solution.x[0] == pytest.approx(math.sqrt(2), abs=1e-9)
    assert not iota.solve(lambda x: x * 0 + 1, [1.0], method="bisection").converged, "its word is checked"


def test_equations_are_good_only_while_the_solver_is_asked() -> None:
    kept = []

    @iota.solver("thief")
    def thief(equations: Any, x: Any, tolerance: float, max_iterations: int) -> Any:
        kept.append(equations)
        assert equations.size == 1
        assert equations.jacobian(x) == pytest.approx(np.array([[2.0]]), abs=1e-6)
        return x

    iota.solve(lambda x: 2 * x, [0.0], method="thief")
    with pytest.raises(RuntimeError, match="valid only during"):
        kept[0].evaluate([0.0])


def test_a_solver_of_the_script_may_raise_or_return_nonsense() -> None:
    @iota.solver("lazy")
    def lazy(equations: Any, x: Any, tolerance: float, max_iterations: int) -> Any:
        return None if x[0] > 0 else 1 / 0

    with pytest.raises(ZeroDivisionError):
        iota.solve(lambda x: x, [0.0], method="lazy")
    with pytest.raises((ValueError, TypeError)):
        iota.solve(lambda x: x, [1.0], method="lazy")
    for name in ("", "direct", "x" * 40):
        with pytest.raises(ValueError, match=r"name|direct"):
            iota.solver(name)(lazy)


# --- the equations of a step --------------------------------------------------------------------------------------------


def swing(solver: str, steps: int = 40) -> tuple[Any, list[str]]:
    system = iota.System()
    iota.builder.chain(links=5, length=0.5, top=(0, 1, 0), direction=(1, 0.2, 0)).realize(system)
    system.solver = solver
    assert system.solver == solver
    warnings = [warning for _ in range(steps) for warning in system.step(1 / 120).warnings]
    return system.positions, warnings


@pytest.mark.parametrize("solver", METHODS)
def test_a_chain_swings_alike_whoever_solves_its_steps(solver: str) -> None:
    direct, _ = swing("direct")
    other, warnings = swing(solver)
    assert warnings == []
    assert np.abs(other - direct).max() < 1e-7


def test_a_solver_of_the_script_solves_steps() -> None:
    asked = []

    @iota.solver("plain newton")
    def plain_newton(equations: Any, x: Any, tolerance: float, max_iterations: int) -> Any:
        asked.append(equations.size)
        for _ in range(max_iterations):
            f = equations.evaluate(x)
            if np.abs(f).max() <= tolerance:
                break
            x = x - np.linalg.solve(equations.jacobian(x), f)
        return x

    direct, _ = swing("direct")
    other, warnings = swing("plain newton")
    assert warnings == []
    assert len(asked) >= 40 and set(asked) == {6 * 3 + 5 + 3}, "six points, five lengths, one nail"
    assert np.abs(other - direct).max() < 1e-7


def test_a_solver_of_the_script_that_raises_in_a_step_is_replaced_and_named() -> None:
    @iota.solver("moody")
    def moody(equations: Any, x: Any, tolerance: float, max_iterations: int) -> Any:
        raise KeyError("not now")

    direct, _ = swing("direct", 5)
    other, warnings = swing("moody", 5)
    assert len(warnings) == 5 and "the solver moody found no root" in warnings[0]
    assert "it raised KeyError: 'not now'" in warnings[0]
    assert (other == direct).all()


def test_an_unknown_solver_of_a_system_is_refused(system: iota.System) -> None:
    for name in ("", "nwton", "x" * 50):
        with pytest.raises(ValueError, match=r"solver"):
            system.solver = name
    assert system.solver == "direct"


def test_a_diagnosis_names_redundant_constraints(system: iota.System) -> None:
    def rod(a: Any, b: Any) -> iota.Body:
        body = system.body()
        body.particle(a)
        body.particle(b)
        return body

    left, right = rod((0, 0), (0.3, 1)), rod((1, 0), (1.3, 1))
    left.particles[0].nail()
    right.particles[0].nail()
    couplers = [rod((0.3, 1), (1.3, 1)) for _ in range(2)]
    for coupler in couplers:
        left.particles[1].combine(coupler.particles[0])
        right.particles[1].combine(coupler.particles[1])
    diagnosis = system.diagnose(left)
    assert (diagnosis.redundancy, diagnosis.rank, diagnosis.rows) == (1, 9, 10)
    assert diagnosis.degrees_of_freedom == 3, "points 2 and 4 on circles, coupled: one in the plane, two out of it"
    assert len(diagnosis.singular_values) == 10
    assert f"body {couplers[0].slot}" in diagnosis.findings[1] and f"body {couplers[1].slot}" in diagnosis.findings[1]
    assert "rank 9 of 10" in repr(diagnosis)
    with pytest.raises(ValueError, match="another system"):
        iota.System().diagnose(left)
