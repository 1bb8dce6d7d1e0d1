# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import pytest

import iota


def in_thread(function: Callable[[], Any]) -> BaseException | None:
    """What a function raises on another thread."""
    caught: list[BaseException] = []

    def run() -> None:
        try:
            function()
        except BaseException as error:
            caught.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join(10)
    return caught[0] if caught else None


def test_a_call_from_another_thread_names_the_rule(system: iota.System, chain: list[iota.Body]) -> None:
    particle = chain[0].particles[1]
    bond = system.bond(particle, chain[3].particles[1], "drag")
    uses: list[Callable[[], Any]] = [
        lambda: system.step(),
        lambda: system.positions,
        lambda: system.gravity,
        lambda: system.snapshot(),
        lambda: system.body(),
        lambda: particle.position,
        lambda: setattr(particle, "position", (0, 0, 0)),
        lambda: chain[0].particles,
        lambda: chain[0].alive,
        lambda: bond.active,
        lambda: particle.combine(chain[4].particles[0]),
        lambda: system.grip(chain[0]),
    ]
    for use in uses:
        error = in_thread(use)
        assert isinstance(error, iota.WrongThreadError) and isinstance(error, RuntimeError)
        assert "belongs to one thread" in str(error) and "world.call" in str(error)
    assert in_thread(lambda: repr(system)) is None and system.step_count == 0


def test_a_system_at_rest_can_be_taken_over(system: iota.System, chain: list[iota.Body]) -> None:
    def work() -> None:
        system.adopt()
        system.step()

    assert in_thread(work) is None
    with pytest.raises(iota.WrongThreadError):
        _ = system.time
    system.adopt()
    assert system.step_count == 1


def test_other_threads_run_during_a_step_but_cannot_take_the_system() -> None:
    """The step releases the interpreter lock; a bond's function is where the test catches it in the middle."""
    system = iota.System()
    p, q = system.body().particle(), system.body().particle((1, 0, 0))
    errors: list[BaseException | None] = []

    def force(bond: iota.types.BondState) -> tuple[float, float, float]:
        errors.append(in_thread(system.adopt))
        errors.append(in_thread(system.step))
        return (0, 0, 0)

    system.bond(p, q, force)
    system.step()
    assert isinstance(errors[0], RuntimeError) and "step is under way" in str(errors[0])
    assert isinstance(errors[1], iota.WrongThreadError)


def test_python_threads_run_while_a_long_step_is_under_way() -> None:
    system = iota.System()
    iota.builder.chain(links=3000, length=300, top=(0, 0, 0), direction=(1, 0, 0)).realize(system)
    count, stop = [0], threading.Event()

    def spin() -> None:
        while not stop.is_set():
            count[0] += 1

    thread = threading.Thread(target=spin)
    thread.start()
    system.step()
    before = count[0]
    for _ in range(20):
        system.step()
    during = count[0] - before
    stop.set()
    thread.join()
    assert during > 0


def test_a_running_world_owns_its_system_until_it_stops(
    system: iota.System, chain: list[iota.Body], run_world: Callable[[iota.World], str]
) -> None:
    world = iota.World(system)
    run_world(world)
    with pytest.raises(iota.WrongThreadError, match=r"world\.call"):
        _ = chain[0].particles
    assert world.call(lambda: len(chain[0].particles)) == 2
    with pytest.raises(KeyError, match="mine"):
        world.call(lambda: {}["mine"])
    with pytest.raises(RuntimeError, match="runs already"):
        world.start()
    world.stop()
    assert len(chain[0].particles) == 2, "ours again"
    assert world.call(lambda: 5) == 5


def test_calls_from_many_threads_are_all_served(
    system: iota.System, chain: list[iota.Body], run_world: Callable[[iota.World], str]
) -> None:
    world = iota.World(system)
    run_world(world)
    total = [0]

    def add() -> None:
        total[0] += 1

    threads = [threading.Thread(target=lambda: [world.call(add) for _ in range(20)]) for _ in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(20)
    assert total[0] == 100
