# SPDX-License-Identifier: Apache-2.0
"""Another simulator in the place of System, in a real World with the real server."""

from __future__ import annotations

import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from page_client import PageClient

import iota
from iota._protocol import BodyKind

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "python" / "explicit_particles.py"
Runner = Callable[[iota.World], str]


@pytest.fixture
def example() -> dict[str, Any]:
    return runpy.run_path(str(EXAMPLE))


def test_the_built_in_system_counts_as_a_simulator() -> None:
    assert isinstance(iota.System(), iota.Simulator)


def test_the_explicit_one_keeps_the_energy_of_a_swinging_pendulum(example: dict[str, Any]) -> None:
    pendulum = example["ParticleSimulator"](
        [(0, 0, 0), (0.5, 0, 0)], 1.0, [(0, 1)], stiffness=1e4, damping=0.0, fixed=[0], drag=0.0
    )
    start = pendulum.energy.total
    for _ in range(500):
        report = pendulum.step(1 / 100)
        assert abs(report.energy.total - start) < 0.01 * 9.81 * 0.5, "symplectic: no drift"
    assert report.time == pytest.approx(5)


def test_a_page_shows_drags_cuts_pauses_and_resets_it(example: dict[str, Any], run_world: Runner) -> None:
    world = example["build"](n=8)
    cloth: Any = world.system
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.places) == 64 and page.parts() == 1)
        assert [body["kind"] for body in page.entities["body"].values()].count(BodyKind.STATIC) == 2
        page.wait_for(lambda: page.places[60][1] < 1.0)  # the free edge falls
        page.send("grab_start", hold=1, body=page.body(60), local_point=(0, 0, 0), target=(0, 1, 2))
        page.wait_for(lambda: page.places[60][2] > 1.2)
        (hold,) = page.last["poses"]["holds"]
        assert hold["client"] == page.id and hold["body"] == 60 and hold["force"] > 0
        assert world.call(lambda: world.users.held(page.id)) is cloth.bodies[60]
        page.send("action", name="cut", body=page.body(60))
        page.wait_for(lambda: page.parts() == 2)
        page.wait_for(lambda: [e for e in page.effects if e["kind"] == "break"])
        page.send("grab_end", hold=1)
        page.wait_for(lambda: not page.last["poses"]["holds"])
        page.send("control", command=0, value=0)
        page.wait_for(lambda: page.last["world_state"]["paused"])
        page.send("control", command=3, value=0)
        page.wait_for(lambda: page.parts() == 1)
        assert [n for n in page.notices if "slow motion" not in n["text"]] == []
        assert world.call(lambda: cloth.time) == 0


class Minimal(iota.Simulator):
    """The least that a World runs: one body on a circle."""

    def __init__(self) -> None:
        self._body = iota.SimulatedBody(self, 7)
        self.warnings: list[str] = []

    @property
    def bodies(self) -> Any:
        return [self._body]

    def step(self, dt: float) -> iota.types.StepReport:
        self.time += dt
        return iota.types.StepReport(step=1, time=self.time, dt=dt, warnings=self.warnings)

    def poses(self) -> Any:
        return [7], np.array([[np.cos(self.time), np.sin(self.time), 0, 0, 0, 0, 1]])

    def snapshot(self) -> float:
        return self.time

    def restore(self, snapshot: float) -> None:
        self.time = snapshot


def test_five_members_are_enough(run_world: Runner) -> None:
    simulator = Minimal()
    world = iota.World(simulator)
    with PageClient(run_world(world)) as page:
        simulator.warnings = ["a warning of its own"]  # told once, to those who are there
        page.wait_for(lambda: 7 in page.places and page.places[7][1] > 0.2)
        assert np.hypot(*page.places[7][:2]) == pytest.approx(1, abs=1e-3)
        page.wait_for(lambda: [n for n in page.notices if n["text"] == "a warning of its own"])
        page.send("grab_start", hold=1, body=page.body(7), local_point=(0, 0, 0), target=(0, 0, 0))
        page.wait_for(lambda: [n for n in page.notices if "Minimal has no hands" in n["text"]])


def test_a_headless_run_sums_it_up() -> None:
    from iota.world.options import RunOptions, use

    with use(RunOptions(headless=True, seconds=0.5)) as options:
        iota.World(Minimal()).run()
    assert options.summary is not None and options.summary.steps == 60


def test_wrong_shapes_of_poses_are_refused(run_world: Runner) -> None:
    class Wrong(Minimal):
        def poses(self) -> Any:
            return [7], np.zeros((1, 6))

    with pytest.raises(ValueError, match=r"\(n, 7\)"):
        iota.World(Wrong()).serve(port=0)


def test_a_class_without_the_members_is_refused() -> None:
    class Empty(iota.Simulator):
        pass

    with pytest.raises(TypeError, match="abstract"):
        Empty()  # type: ignore[abstract]
