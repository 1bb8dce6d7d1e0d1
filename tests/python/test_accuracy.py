# SPDX-License-Identifier: Apache-2.0
"""Mode accurate against exact solutions; budgets of steps; reports of islands."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import iota
from iota.verify import scenes
from iota.verify.reference import PlanarChain, still

TOLERANCES = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8]


def swing(links: int, seconds: float = 2.0, hz: int = 60, **settings: float | str) -> tuple[np.ndarray, float, float]:
    """Places of the masses of a string of 1 m links released level, largest error of energy, J, estimated error, m."""
    system = iota.System()
    for name, value in settings.items():
        setattr(system, name, value)
    rings = scenes.string_of_links(system, scenes.hanging_points((0, 0), np.ones(links), np.full(links, np.pi / 2)))
    start, worst, estimate = system.energy.total, 0.0, 0.0
    for _ in range(round(seconds * hz)):
        report = system.step(1 / hz)
        worst = max(worst, abs(report.energy.total - start))
        estimate += report.error / hz
        assert report.error <= system.tolerance
    return scenes.places(rings[1:])[:, :2], worst, estimate


@pytest.fixture(scope="module", params=[2, 3])
def pendulum(request: pytest.FixtureRequest) -> tuple[int, np.ndarray]:
    links = request.param
    chain = PlanarChain(np.ones(links), scenes.masses_of(links), still((0, 0)))
    return links, chain.places(np.array([0.0, 2.0]), np.full(links, np.pi / 2), np.zeros(links))[-1]


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_accurate_meets_its_tolerance(pendulum: tuple[int, np.ndarray], tolerance: float) -> None:
    links, truth = pendulum
    for hz in (30, 60, 240):
        found, _, estimate = swing(links, hz=hz, mode="accurate", tolerance=tolerance)
        assert np.abs(found - truth).max() < 2 * tolerance, f"{hz} Hz, two seconds"
        assert estimate < 2 * tolerance


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_accurate_keeps_energy_better_than_energy_keeping(pendulum: tuple[int, np.ndarray], tolerance: float) -> None:
    links, _ = pendulum
    kept = swing(links, mode="energy_keeping")[1]
    assert swing(links, mode="accurate", tolerance=tolerance)[1] < max(kept, 1e-12)


def linear_solves(mode: str, links: int, steps: int) -> float:
    system = iota.System()
    system.mode = mode  # type: ignore[assignment]
    scenes.string_of_links(system, scenes.level_points((0, 0), links, 0.1))
    total = 0
    for _ in range(steps):
        system.step(1 / 120)
        total += sum(island.iterations for island in system.islands())
    return total / steps


def test_accurate_takes_few_linear_solves_on_a_chain_of_64_links() -> None:
    assert linear_solves("accurate", 64, 120) < 20 * linear_solves("energy_keeping", 64, 120)


def test_tolerance_is_checked() -> None:
    system = iota.System()
    assert system.tolerance == 1e-4
    for wrong in (0.0, -1.0, 2.0, float("nan")):
        with pytest.raises(ValueError, match="tolerance must be between"):
            system.tolerance = wrong
    assert system.tolerance == 1e-4


def test_tolerance_and_budget_are_in_a_snapshot() -> None:
    system = iota.System()
    system.tolerance, system.budget_iterations, system.budget_seconds = 1e-6, 40, 0.5
    saved = system.snapshot()
    system.tolerance, system.budget_iterations, system.budget_seconds = 1e-3, 0, 0
    system.restore(saved)
    assert (system.tolerance, system.budget_iterations, system.budget_seconds) == (1e-6, 40, 0.5)


def hopeless(system: iota.System, at: float = 0.0) -> iota.Particle:
    """A chain of 1 m between nails 1.5 m apart; returns its end."""
    end = scenes.string_of_links(system, scenes.level_points((at, 2), 24, 1 / 24))[-1]
    end.nail((at + 1.5, 2, 0))
    return end


def drag_on(budget: int, steps: int = 20) -> tuple[list[iota.types.StepReport], list[list[int]], np.ndarray]:
    system = iota.System()
    system.budget_iterations = budget
    end = hopeless(system)
    reports, iterations = [], []
    for step in range(steps):
        end.nail((1.5 + 0.02 * step, 2, 0.3 * np.sin(step)))
        reports.append(system.step(1 / 60))
        iterations.append([island.iterations for island in system.islands()])
    return reports, iterations, system.positions


def test_a_budget_of_work_ends_a_hopeless_search_and_says_so() -> None:
    last_resort = 24  # iterations that it may take beyond the budget
    unlimited = drag_on(0)
    assert max(max(row) for row in unlimited[1]) > 60, "or the scene is no test"
    assert not any(report.cut_short for report in unlimited[0])
    reports, iterations, places = drag_on(10)
    assert max(max(row) for row in iterations) <= 10 + last_resort
    assert any(report.cut_short == 1 for report in reports)
    assert any("the budget of a step ended" in text for report in reports for text in report.warnings)
    assert np.isfinite(places).all()


def test_a_budget_of_work_is_repeatable() -> None:
    assert (drag_on(10)[2] == drag_on(10)[2]).all()


def test_a_budget_loses_nothing_after_the_conflict() -> None:
    system = iota.System(mode="robust")
    system.budget_iterations = 10
    end = hopeless(system)
    for _ in range(10):
        system.step(1 / 60)
    end.release()
    for _ in range(30):
        report = system.step(1 / 60)
    assert report.cut_short == 0
    assert report.unconverged == 0
    assert report.worst_gap < 1e-6
    assert len(system.bodies) == 24
    assert abs(report.energy.balance - system.energy.balance) < 1e-9 * abs(system.energy.total)


def test_a_budget_of_time_ends_a_hopeless_search() -> None:
    system = iota.System()
    system.budget_seconds = 1e-9
    hopeless(system)
    assert any(system.step(1 / 60).cut_short for _ in range(5))
    system.budget_seconds = 1e9
    assert system.step(1 / 60).cut_short == 0


def test_islands_report_cost_and_quality_of_each() -> None:
    system = iota.System()
    assert system.islands() == []
    scenes.string_of_links(system, scenes.level_points((0, 0), 8, 0.1))
    lost = hopeless(system, at=5.0)
    lone = system.body().particle((0, 5, 0))
    report = system.step(1 / 60)
    islands = system.islands()
    assert [len(island.bodies) for island in islands] == [8, 24]
    good, bad = islands
    assert (good.points, good.converged, good.cut_short, good.resting) == (9, True, False, False)
    assert good.gap < 1e-9
    assert good.iterations > 0
    assert good.substeps == 1
    assert lost.body in bad.bodies
    assert not bad.converged
    assert bad.gap > 0.01
    assert report.unconverged == 1
    assert lone.body not in good.bodies + bad.bodies, "free particles are in no island"
    assert "not converged" in repr(bad)


def tower(budget_contacts: float) -> tuple[iota.System, list[iota.Body]]:
    """Ten cubes of 0.2 m that fall 1 cm onto each other, in mode accurate."""
    system = iota.System(mode="accurate", gravity=(0, -9.81, 0))
    system.usual_material, system.budget_contacts = iota.Material(), budget_contacts
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    cube = iota.Box((0.2, 0.2, 0.2))
    return system, [system.body(shape=cube, density=1000, position=(0.01 * k, 0.1 + 0.21 * k, 0)) for k in range(10)]


def test_no_error_is_told_of_contacts_that_are_solved_one_by_one() -> None:
    exact, _ = tower(0)
    swept, cubes = tower(1)
    deepest, approximate = 0.0, 0
    for _ in range(60):
        exact.step(1 / 60)
        report = swept.step(1 / 60)
        approximate += report.approximate > 0
        assert np.isinf(report.error) == (report.approximate > 0)
        assert all(np.isinf(island.error) == island.approximate for island in swept.islands())
        heights = [cube.position[1] for cube in cubes]
        deepest = max(deepest, *(0.2 - (above - below) for below, above in itertools.pairwise(heights)))
    assert approximate > 50 and deepest > 1e-4  # from outside: it is far from exact
    assert exact.step(1 / 60).error <= exact.tolerance


def test_an_error_is_told_again_when_an_impact_is_over() -> None:
    system = iota.System(mode="accurate", gravity=(0, -9.81, 0))
    system.usual_material = iota.Material(restitution=0.8)
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    system.body(shape=iota.Sphere(0.1), density=1000, position=(0, 0.5, 0))
    errors = [system.step(1 / 60).error for _ in range(60)]
    assert np.isfinite(errors).sum() > 40 and max(e for e in errors if np.isfinite(e)) <= system.tolerance
