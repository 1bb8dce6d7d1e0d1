# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import ast
import time
from contextlib import suppress
from pathlib import Path

import pytest

import iota
from iota.world.callbacks import Hook
from iota.world.real_time import MAX_CATCH_UP, RealTime
from iota.world.schedule import Schedule


def names(schedule: Schedule, at: float) -> list[str]:
    return [task.hook.name for task in schedule.due(at)]


def hook(name: str) -> Hook:
    return Hook(lambda: None, False, name)


def test_events_come_in_order_of_time_then_of_asking() -> None:
    schedule = Schedule()
    for name, at in (("b", 2.0), ("a", 1.0), ("c", 2.0)):
        schedule.add(at, hook(name))
    assert names(schedule, 0.5) == []
    assert names(schedule, 5.0) == ["a", "b", "c"]
    assert names(schedule, 5.0) == []


def test_periodic_events_do_not_drift() -> None:
    schedule = Schedule()
    schedule.add(0.3, hook("tick"), period=0.1)
    times = [step for step in range(1, 1000) for _ in schedule.due(step * 0.01 + 1e-9)]
    assert times == list(range(30, 1000, 10))


def test_rewind_restores_only_settings_from_before_the_run() -> None:
    schedule = Schedule()
    schedule.add(1.0, hook("planned"))
    schedule.begin()
    schedule.add(2.0, hook("later"))
    assert names(schedule, 3.0) == ["planned", "later"]
    schedule.rewind()
    assert names(schedule, 3.0) == ["planned"]


def run_headless(world: iota.World, seconds: float) -> iota.types.RunSummary:
    from iota.world.options import RunOptions, use

    with use(RunOptions(headless=True)):
        return world.run(seconds)


def test_an_event_may_reset_the_world_again_and_again() -> None:
    world = iota.World(iota.System(), dt=0.01)
    seen: list[str] = []
    for moment, name in ((0.0, "first"), (0.02, "second")):
        world.at(moment)(lambda name=name: seen.append(name))
    world.at(0.05)(world.reset)
    for _ in range(18):
        world.step()
    # The step in which it resets is the first one of the next round; what is planned for its beginning comes with the second.
    assert seen == ["first", "second"] * 4
    assert world.system.time == pytest.approx(0.03)


def test_a_world_calls_its_timed_events_at_their_steps() -> None:
    system = iota.System()
    world = iota.World(system, dt=0.01)
    seen: list[tuple[str, float]] = []

    @world.at(0.05)
    def once() -> None:
        seen.append(("once", system.time))
        world.after(0.03)(lambda: seen.append(("after", system.time)))

    @world.every(0.1)
    def often(event: iota.Event) -> None:
        assert event.system is system and event.target is None
        seen.append(("often", system.time))

    steps: list[int] = []
    world.on_step(lambda: steps.append(system.step_count))
    summary = run_headless(world, 0.35)
    expected = [("once", 0.05), ("after", 0.08), ("often", 0.1), ("often", 0.2), ("often", 0.3)]
    assert seen == [(name, pytest.approx(at)) for name, at in expected]
    assert steps == list(range(35)) and summary.steps == 35


def test_an_event_that_raises_is_reported_and_the_world_goes_on(capsys: pytest.CaptureFixture[str]) -> None:
    world = iota.World(iota.System(), dt=0.01)
    seen: list[float] = []

    @world.every(0.02)
    def broken() -> None:
        seen.append(world.system.time)
        raise ZeroDivisionError("on purpose")

    @world.at(0.05)
    def broken_once() -> None:
        raise KeyError("once")

    assert run_headless(world, 0.2).steps == 20
    told = capsys.readouterr().err
    assert told.count("ZeroDivisionError: on purpose") == 1 and len(seen) == 1, "a periodic event is switched off"
    assert "KeyError: 'once'" in told
    assert "test_schedule.py" in told and "world/callbacks.py" not in told, "frames of iota itself are left out"


def test_an_on_step_that_raises_is_switched_off(capsys: pytest.CaptureFixture[str]) -> None:
    world = iota.World(iota.System(), dt=0.01)
    calls: list[int] = []

    @world.on_step
    def broken() -> None:
        calls.append(1)
        raise ValueError("on purpose")

    world.on_step(lambda: calls.append(2))
    run_headless(world, 0.05)
    assert calls == [1, 2, 2, 2, 2, 2]
    assert capsys.readouterr().err.count("ValueError: on purpose") == 1


def test_a_bond_that_fails_in_a_world_is_reported_and_the_world_goes_on(capsys: pytest.CaptureFixture[str]) -> None:
    system = iota.System()
    p, q = system.body().particle(), system.body().particle((1, 0, 0))
    bond = system.bond(p, q, lambda bond: 1 / 0)
    assert run_headless(iota.World(system, dt=0.01), 0.05).steps == 5
    assert not bond.active
    assert "bond 0 between particle 0 and particle 1 was switched off" in capsys.readouterr().err


class Watch:
    """A clock that passes while somebody sleeps, and a microsecond a look."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 100.0
        monkeypatch.setattr("iota.world.real_time.time", self)

    def perf_counter(self) -> float:
        self.now += 1e-6
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def watch(monkeypatch: pytest.MonkeyPatch) -> Watch:
    return Watch(monkeypatch)


def test_the_clock_takes_as_many_steps_as_time_has_passed(watch: Watch) -> None:
    pace = RealTime(iota.World(iota.System(), dt=0.01).clock)
    taken, frames = 0, 0
    while watch.now < 100.995:
        taken += pace.due()
        frames += pace.frame_due()
        pace.sleep()
    assert taken == 99
    assert 59 <= frames <= 61


def test_frames_of_a_world_in_which_nothing_happens_are_rare_until_something_does(watch: Watch) -> None:
    pace = RealTime(iota.World(iota.System(), dt=0.5).clock)
    frames, wakes, begin = 0, 0, watch.now
    while watch.now < begin + 10:
        pace.due()
        frames += pace.frame_due(has_news=False)
        pace.sleep(watch.sleep)
        wakes += 1
    assert 95 <= frames <= 101 and wakes <= 130
    assert not pace.frame_due(has_news=False)
    watch.sleep(1 / 60)
    assert pace.frame_due(), "with news it is sent as soon as ever"


def test_short_steps_are_taken_two_at_a_time_and_long_ones_alone(watch: Watch) -> None:
    for per_second, wakes in ((30, 30), (60, 60), (120, 60), (1000, 500)):
        pace = RealTime(iota.World(iota.System(), dt=1 / per_second).clock)
        taken, woken, begin = 0, 0, watch.now
        while watch.now < begin + 1:
            steps = pace.due()
            taken, woken = taken + steps, woken + (steps > 0)
            pace.frame_due()
            pace.sleep()
        assert taken == pytest.approx(per_second, abs=4) and woken == pytest.approx(wakes, rel=0.1)


def test_the_clock_lets_time_go_that_cannot_be_caught_up(watch: Watch) -> None:
    clock = iota.World(iota.System(), dt=0.001).clock
    pace = RealTime(clock)
    watch.sleep(0.05)
    assert pace.due() == MAX_CATCH_UP
    assert pace.due() == 0, "no debt is left"
    assert clock.reached_speed < 1


def test_the_clock_rests_while_paused(watch: Watch) -> None:
    clock = iota.World(iota.System(), dt=0.001).clock
    pace = RealTime(clock)
    watch.sleep(0.02)
    clock.paused = True
    assert pace.due() == 0
    clock.paused = False
    assert pace.due() == 0
    watch.sleep(0.0015)
    assert pace.due() == 1


def test_the_length_of_a_step_is_in_one_place() -> None:
    world = iota.World(iota.System(), dt=0.01)
    world.at(0.05)(lambda: setattr(world, "dt", 0.025))
    summary = run_headless(world, 0.2)
    assert (summary.steps, summary.dt_s) == (5 + 6, 0.025) and summary.simulated_s == pytest.approx(0.2)
    for bad in (0, -1, 1.5, float("nan")):
        with pytest.raises(ValueError, match="dt must be above 0 and at most 1 s"):
            world.dt = bad
    assert world.dt == 0.025


@pytest.mark.parametrize("stream", ["closed", "full", "none"])
def test_a_world_goes_on_where_stderr_cannot_be_written(stream: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with suppress(OSError), open("/dev/full", "w") as full:
        if stream == "closed":
            full.close()
        monkeypatch.setattr("sys.stderr", None if stream == "none" else full)
        run_a_world_that_fails_and_dawdles()


def run_a_world_that_fails_and_dawdles() -> None:
    world = iota.World(iota.System(), dt=0.01)
    world.at(0.01)(lambda: 1 / 0)
    world.at(0.02)(lambda: time.sleep(0.6))  # told to be slow
    assert run_headless(world, 0.05).steps == 5


def test_parts_of_a_world_do_not_import_each_other_in_a_circle() -> None:
    folder = Path(iota.__file__).parent / "world"
    uses = {
        path.stem: {
            name
            for node in ast.walk(ast.parse(path.read_text()))
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("iota.world")
            for name in ([node.module.split(".")[2]] if node.module.count(".") > 1 else [a.name for a in node.names])  # type: ignore[union-attr]
        }
        for path in folder.glob("*.py")
        if path.stem != "__init__"
    }
    assert {"world", "state", "inputs", "publisher"} <= uses.keys()
    left = dict(uses)
    while left:
        free = [name for name, used in left.items() if not used & left.keys()]
        assert free, f"a circle: { {name: used & left.keys() for name, used in left.items()} }"
        for name in free:
            del left[name]


def test_a_function_that_was_switched_off_is_called_again_after_a_reset() -> None:
    world = iota.World(iota.System())
    calls: list[str] = []

    @world.on_step
    def fail() -> None:
        calls.append("step")
        raise ZeroDivisionError

    for _ in range(3):
        world.step()
    assert calls == ["step"]
    world.reset()
    for _ in range(3):
        world.step()
    assert calls == ["step", "step"]
