# SPDX-License-Identifier: Apache-2.0
"""Worlds that outlive their process: what comes back, and what happens to a journal on a bad disk, with damage, or with two owners."""

from __future__ import annotations

import errno
import json
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from amount import TRIES_ALL

import iota
from iota import _protocol as protocol
from iota.cli.main import main
from iota.film.journal import messages_of
from iota.journal import records, writer
from iota.journal.folder import BusyError, Folder
from iota.journal.reader import JournalError, find, find_all, recover
from iota.world import journal as journals

HERE = Path(__file__).parent
GOLDEN = HERE / "golden" / "journal"
KILLS = int(os.environ.get("IOTA_KILLS", "20" if TRIES_ALL else "6"))


@pytest.fixture(autouse=True)
def hand_over_each_step(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journals, "HAND_OVER", 0.0)


@dataclass
class Kept:
    """A chain on a nail and a ball, kept in a folder; `told` is what the terminal says when it begins."""

    world: iota.World
    chain: list[iota.Body]
    ball: iota.Body
    told: str = ""

    @property
    def system(self) -> iota.System:
        return self.world.system

    def steps(self, count: int) -> None:
        for _ in range(count):
            self.world.step()

    def end(self, killed: bool = True) -> None:
        """killed: after all was handed over; the records of an orderly end are taken off the file again."""
        journal = self.world._stepper.journal
        journal.hand_over()
        if journal._writer is not None:
            journal._writer.flush()
        path = journal._folder.files()[-1].path
        size = path.stat().st_size
        self.world.close()
        if killed:
            os.truncate(path, size)


Make = Callable[..., Kept]


@pytest.fixture
def make(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Iterator[Make]:
    made: list[Kept] = []

    def make(
        change: Callable[[Kept], None] = lambda kept: None, begins: bool = True, folder: str = "kept", **options: bool
    ) -> Kept:
        system = iota.System()
        chain = iota.builder.chain(links=4, length=1, top=(0, 2, 0), direction=(1, 0, 0)).realize(system).bodies
        kept = Kept(iota.World(system, title="kept"), chain, system.body(shape=iota.Sphere(0.1), position=(1, 1, 0)))
        change(kept)
        kept.world.keep(tmp_path / folder, **options)
        made.append(kept)
        if begins:
            capsys.readouterr()
            kept.world._begin()
            kept.told = capsys.readouterr().err.strip()
        return kept

    yield make
    for kept in made:
        kept.world.close()


def damage(path: Path, place: int, data: bytes = b"\xff") -> None:
    content = bytearray(path.read_bytes())
    for offset, byte in enumerate(data):
        content[place + offset] ^= byte
    path.write_bytes(content)


def files(folder: Path) -> list[str]:
    return sorted(entry.name for entry in folder.glob("*.journal"))


def place_of(data: bytes, kind: str, last: bool = False) -> int:
    """Where a record of a kind begins."""
    head = records.MARK + kind.encode() + b"\0"
    return data.rindex(head) if last else data.index(head)


# --- what comes back -----------------------------------------------------------------------------------------------------


def test_a_killed_world_goes_on_to_the_last_bit(make: Make) -> None:
    first = make()
    assert first.told == ""
    first.steps(25)
    first.chain[1].particles[0].separate(first.chain[0].particles[1])
    first.steps(25)
    end, when = first.system.state_hash(), first.system.time
    first.end()
    second = make()
    assert second.system.state_hash() == end
    assert second.told == (
        f"iota: goes on where it was: t = {when:.2f} s, 0 people, lost at most 0.2 s (r on the page resets it)"
    )
    second.steps(5)
    assert second.system.validate() == []
    second.world.reset()
    assert second.system.time == 0 and second.system.articulate_count == 2, "a chain and a ball"


def test_an_orderly_end_loses_nothing(make: Make) -> None:
    first = make()
    first.steps(10)
    end = first.system.state_hash()
    first.end(killed=False)
    second = make()
    assert "nothing was lost" in second.told and second.system.state_hash() == end


def test_undo_and_redo_reach_across_the_end_of_a_process(make: Make) -> None:
    first = make()
    for x in (3, 4, 5):
        with first.system.edit():
            first.system.body(shape=iota.Sphere(0.1), position=(x, 1, 0))
        first.steps(4)
    first.world.undo()
    first.steps(1)
    count = len(first.system.bodies)
    first.end()
    second = make()
    assert len(second.system.bodies) == count
    assert second.world.redo() and len(second.system.bodies) == count + 1
    second.steps(2)
    second.end()
    third = make()
    for left in (count, count - 1, count - 2):
        assert third.world.undo() and len(third.system.bodies) == left


@pytest.mark.parametrize("kept_states", [2, 4])
def test_undo_reaches_as_far_back_as_its_states_fit_into_the_file_of_a_process(
    make: Make, monkeypatch: pytest.MonkeyPatch, kept_states: int
) -> None:
    def edit(kept: Kept) -> None:
        for x in range(6):
            with kept.system.edit():
                kept.system.body(shape=iota.Sphere(0.1), position=(x, 3, 0))
            kept.steps(1)

    other = make(folder="other")
    edit(other)
    undo, _ = other.world._stepper.journal._log.history(set())
    largest = max(len(state) for _, state in undo if state is not None)
    other.end()
    monkeypatch.setattr(journals, "MOST_HISTORY", round((kept_states + 0.9) * largest))
    first = make()
    edit(first)
    first.end()
    second = make()  # writes a file of its own
    second.steps(2)
    second.end()
    third = make()
    reached = sum(third.world.undo() for _ in range(8))
    assert kept_states <= reached <= kept_states + 1  # earlier states are smaller


def test_rewind_reaches_into_the_run_before(make: Make) -> None:
    def offer(kept: Kept) -> None:
        kept.world.offer("rewind")

    first = make(offer)
    heights = {}
    for _ in range(42):
        first.steps(10)
        heights[round(first.system.time, 2)] = first.ball.position.y
        first.world._stepper.journal._writer.flush()
    first.end()
    second = make(offer)
    second.world._inputs.frame()
    for _ in range(3):
        now = second.system.time
        second.world.controls.act("rewind")
        second.world._inputs.frame()
        assert now - 2.1 < second.system.time <= now - 1
    assert second.ball.position.y > 0.9 > heights[3.5], "it had just begun to fall"


def test_controls_clock_and_state_of_the_script_come_back(make: Make) -> None:
    def controls(kept: Kept) -> None:
        world = kept.world
        slider = world.controls.slider("gravity", 0, 20, 9.81)
        world.controls.slider("gravity", 0, 2, 1)
        choice, check = world.controls.choice("style", ["a", "b"]), world.controls.checkbox("on")
        text = world.controls.text("name")
        kept.widgets = [slider, choice, check, text]  # type: ignore[attr-defined]

    first = make(controls)
    slider, choice, check, text = first.widgets  # type: ignore[attr-defined]
    first.world.keep_state("score", 3)
    first.world.keep_state("team", {"of": [first.ball, first.chain[0].particles[1], None, 1.5, "x", True]})
    first.steps(2)
    slider.value, choice.value, check.value, text.value = 5.0, "b", True, "Ada"
    first.world.clock.speed, first.world.clock.paused = 0.5, True
    first.steps(1)
    first.world._stepper.check_journal()
    first.end()
    second = make(controls)
    assert [widget.value for widget in second.widgets] == [5.0, "b", True, "Ada"]  # type: ignore[attr-defined]
    assert second.world.clock.speed == 0.5 and second.world.clock.paused
    assert second.world.kept_state("score") == 3 and second.world.kept_state("none", 7) == 7
    team = second.world.kept_state("team")["of"]
    assert team == [second.ball, second.chain[0].particles[1], None, 1.5, "x", True]
    with pytest.raises(TypeError, match="'it' must be of numbers, texts"):
        second.world.keep_state("it", object())


def test_what_is_kept_in_a_world_without_a_journal_lasts_as_long_as_the_world() -> None:
    world = iota.World(iota.System())
    assert world.kept_state("score", 0) == 0
    world.keep_state("score", 4)
    assert world.kept_state("score") == 4


def test_edits_of_a_paused_world_and_a_reset_are_kept(make: Make) -> None:
    first = make()
    first.steps(20)
    first.world.reset()
    first.world.clock.paused = True
    first.ball.position = (7, 1, 0)
    first.world._stepper.check_journal()
    first.end()
    second = make()
    assert second.system.time == 0 and abs(second.ball.position.x - 7) < 1e-12 and second.world.clock.paused


def test_hands_of_those_who_were_there_are_gone_and_their_names_are_told(make: Make, tmp_path: Path) -> None:
    first = make()
    inputs = first.world._inputs
    join = protocol.Join("Ada", protocol.Role.ACTOR)
    inputs.take([(1, join), (1, protocol.GrabStart(1, 7, (0, 0, 0), (3, 3, 0), "mouse"))], lambda ids: [first.ball])
    first.steps(10)
    assert first.world.users.held() == first.ball
    first.end()
    told = find(Folder(tmp_path / "kept"))
    assert told is not None and told.world["people"] == [["Ada", "guest"]]
    second = make()
    assert "1 person" in second.told
    height = second.ball.position.y
    second.system.step(1 / 120, 60)
    assert second.ball.position.y < height - 0.5, "nobody holds it up"


def test_timed_events_go_on_from_the_time_of_the_world(make: Make) -> None:
    ran: list[float] = []

    def timed(kept: Kept) -> None:
        kept.world.at(0.05)(lambda: ran.append(0.05))
        kept.world.every(0.1)(lambda: ran.append(round(kept.system.time, 2)))

    first = make(timed)
    first.steps(30)
    assert ran == [0.05, 0.1, 0.2]
    first.end()
    ran.clear()
    make(timed).steps(15)
    assert ran == [0.3]


# --- functions of the script ----------------------------------------------------------------------------------------------


def test_functions_of_the_start_are_taken_and_those_given_later_are_found_by_name(make: Make) -> None:
    def pull(kept: Kept) -> None:
        kept.system.bond(kept.ball.particles[0], kept.chain[0].particles[0], lambda bond: (1.0, 0.0, 0.0))

    def rise(bond: iota.types.BondState) -> tuple[float, float, float]:
        return (0.0, 3.0, 0.0)

    first = make(pull)
    first.steps(3)
    first.system.bond(first.chain[3].particles[1], first.ball.particles[0], rise)
    first.steps(5)
    end = first.system.state_hash()
    first.end()
    second = make(pull)
    assert second.system.state_hash() == end and "no function" not in second.told
    second.steps(3)
    assert all(bond.active for bond in second.system.bonds)


def test_a_function_that_was_given_up_before_the_end_is_found_for_what_is_repeated(make: Make) -> None:
    def rise(bond: iota.types.BondState) -> tuple[float, float, float]:
        return (0.0, 3.0, 0.0)

    first = make()
    journal = first.world._stepper.journal
    assert journal is not None
    bond = first.system.bond(first.chain[3].particles[1], first.ball.particles[0], rise)
    first.steps(3)
    journal.hand_over()
    bond.destroy()
    first.steps(3)
    journal.hand_over()
    end = first.system.state_hash()
    first.end()
    second = make()
    assert "could not be repeated" not in second.told and "no function" not in second.told
    assert second.system.state_hash() == end


def test_a_function_that_cannot_be_found_is_named_in_one_line(make: Make) -> None:
    first = make()
    first.steps(3)

    def attach(strength: float) -> None:
        def pull(bond: iota.types.BondState) -> tuple[float, float, float]:
            return (0.0, strength, 0.0)

        first.system.bond(first.chain[3].particles[1], first.ball.particles[0], pull)

    attach(1.0)
    attach(2.0)
    first.steps(1)
    first.end()
    second = make()
    (line,) = second.told.splitlines()
    assert "the script has no function" in line and "attach.<locals>.pull" in line and "switched off" in line


def pulled_by(strength: list[float]) -> Callable[[Kept], None]:
    """Binds the ball by a function that gives something else as soon as the number has changed."""

    def pull(kept: Kept) -> None:
        kept.system.bond(kept.ball.particles[0], kept.chain[0].particles[0], lambda bond: (strength[0], 0.0, 0.0))

    return pull


def test_where_a_function_gives_something_else_the_world_goes_on_from_a_snapshot(make: Make) -> None:
    strength = [0.0]
    pull = pulled_by(strength)
    first = make(pull)
    for _ in range(20):
        strength[0] += 1
        first.steps(1)
        time.sleep(0.01)
    journal = first.world._stepper.journal
    journal._quick_at = 0.0
    journal.hand_over()
    strength[0] += 1
    first.steps(2)
    x = first.ball.position.x
    first.end()
    strength[0] = 0.0
    second = make(pull)
    assert "could not be repeated to the same state" in second.told
    lost = first.system.time - second.system.time
    assert 0 < lost < 0.15, "snapshots come more often than that"
    assert abs(second.ball.position.x - x) < 0.1


def test_an_orderly_end_loses_nothing_even_if_a_function_gives_something_else(make: Make) -> None:
    strength = [0.0]
    pull = pulled_by(strength)
    first = make(pull)
    for _ in range(20):
        strength[0] += 1
        first.steps(1)
    state = first.system.state_hash()
    first.end(killed=False)
    strength[0] = 0.0
    second = make(pull)
    assert second.system.state_hash() == state and "could not" not in second.told


# --- another script -------------------------------------------------------------------------------------------------------


def test_a_script_that_starts_other_bodies_begins_anew_and_the_world_before_is_put_aside(
    make: Make, tmp_path: Path
) -> None:
    first = make()
    first.world.keep_state("score", 3)
    first.steps(5)
    first.end()
    second = make(lambda kept: kept.system.body().particle((9, 9, 9)))
    assert second.told.startswith("iota: begins anew: its script starts other bodies") and second.system.time == 0
    assert second.world.kept_state("score") is None
    second.end()
    assert files(tmp_path / "kept" / "aside-1") == ["000001-000001.journal"]
    shutil.copytree(tmp_path / "kept" / "aside-1", tmp_path / "old")
    assert "goes on" in make(folder="old").told, "what was put aside can be kept again"


def test_another_place_at_the_start_does_not_matter_but_is_told(make: Make) -> None:
    first = make()
    first.steps(5)
    end = first.system.state_hash()
    first.end()
    second = make(lambda kept: setattr(kept.ball, "position", (1, 5, 0)))
    assert second.system.state_hash() == end
    assert "its script starts in another way now, which a reset shows" in second.told
    second.world.reset()
    assert second.ball.position.y == 5


def test_fresh_begins_anew_and_removes_nothing(make: Make, tmp_path: Path) -> None:
    first = make()
    first.steps(5)
    first.end()
    second = make(fresh=True)
    assert second.told == f"iota: begins anew; the world before is in {tmp_path / 'kept' / 'aside-1'}"
    assert second.system.time == 0
    second.end()
    assert files(tmp_path / "kept") == ["000002-000001.journal"]


# --- faults ---------------------------------------------------------------------------------------------------------------


def test_no_kill_at_any_time_loses_a_world(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(HERE / "kept_worlds.py"), str(tmp_path / "kept"), str(KILLS), "7"],
        capture_output=True,
        text=True,
        check=True,
    )
    told = json.loads(done.stdout)
    print(told)
    assert told["back"] == KILLS and told["worlds_lost"] == told["wrong"] == 0
    # Hand-overs are 0.1 s apart; the rest is the time until the thread that writes has a processor, on a busy machine. With few kills
    # the median is above 0.1 s now and then.
    assert told["lost_median"] <= 0.2 and told["lost_most"] <= 0.4


def run_and_copy(make: Make, steps: int = 12) -> tuple[dict[float, int], bytes]:
    """The states of a run by their times, and the file that it left."""
    kept = make()
    states = {0.0: kept.system.state_hash()}
    for number in range(steps):
        if number == 4:
            with kept.system.edit():
                kept.system.body(shape=iota.Sphere(0.1), position=(3, 1, 0))
        kept.steps(1)
        states[kept.system.time] = kept.system.state_hash()
    path = kept.world._stepper.journal._folder.path / "000001-000001.journal"
    kept.end()
    return states, path.read_bytes()


def come_back(folder: Path, data: bytes) -> iota.System | None:
    """None for a journal that tells that it cannot be read."""
    (folder / "000001-000001.journal").write_bytes(data)
    try:
        found = find(Folder(folder))
    except JournalError:
        return None
    assert found is not None
    system = iota.System()
    recovered = recover(system, found)
    assert recovered.time == system.time and recovered.is_equal
    return system


def test_a_file_that_ends_anywhere_leads_to_the_latest_whole_state(make: Make, tmp_path: Path) -> None:
    states, data = run_and_copy(make)
    folder = tmp_path / "torn"
    folder.mkdir()
    before, seen = -1.0, set()
    begin = place_of(data, "C")
    for size in [*range(0, begin, 997), *range(begin, len(data), 41)]:
        system = come_back(folder, data[:size])
        if system is not None:
            assert system.state_hash() == states[system.time] and system.time >= before
            before = system.time
            seen.add(before)
    assert len(seen) == len(states) - 1, "all but the last, whose record is whole at the very end"


def test_any_byte_that_is_flipped_leads_to_a_true_state(make: Make, tmp_path: Path) -> None:
    states, data = run_and_copy(make)
    folder = tmp_path / "flipped"
    folder.mkdir()
    refused = 0
    for place in [*range(0, 60), *range(60, len(data), len(data) // 150)]:
        bad = bytearray(data)
        bad[place] ^= 0x40
        system = come_back(folder, bytes(bad))
        refused += system is None
        assert system is None or system.state_hash() == states[system.time], place
    # The only snapshot of this file, and its first line: a second generation bridges them, see below.
    assert refused < 200


def test_a_damaged_snapshot_is_bridged_by_the_generation_before(
    make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = make()
    first.steps(5)
    monkeypatch.setattr(journals, "GENERATION", (0.0, 0.0))
    first.steps(1)
    first.world._stepper.journal.hand_over()
    monkeypatch.undo()
    monkeypatch.setattr(journals, "HAND_OVER", 0.0)
    first.steps(5)
    end = first.system.state_hash()
    first.end()
    assert files(tmp_path / "kept") == ["000001-000001.journal", "000001-000002.journal"]
    newest = tmp_path / "kept" / "000001-000002.journal"
    damage(newest, place_of(newest.read_bytes(), "S") + records.HEAD.size + 500)
    second = make()
    assert second.system.state_hash() == end
    assert "damaged: 000001-000002.journal: record" in second.told and "(S)" in second.told
    second.end()
    assert files(tmp_path / "kept" / "aside-1") == ["000001-000001.journal", "000001-000002.journal"]


def test_a_bridged_snapshot_leads_to_the_last_bit_also_where_it_made_islands_anew(make: Make, tmp_path: Path) -> None:
    def long_chain(kept: Kept) -> None:
        options = {"links": 60, "length": 6, "top": (0, 9, 0), "direction": (0.8, -0.6, 0)}
        kept.chain = iota.builder.chain(**options).realize(kept.system).bodies

    first = make(long_chain)
    first.steps(4)
    first.chain[40].particles[0].separate(first.chain[39].particles[1])  # the island follows, in an order of its own
    first.steps(4)
    first.world._stepper.journal._is_exact = False  # so that a snapshot follows
    first.steps(30)
    end = first.system.state_hash()
    first.end()
    path = tmp_path / "kept" / "000001-000001.journal"
    damage(path, place_of(path.read_bytes(), "S", last=True) + records.HEAD.size + 500)
    second = make(long_chain)
    assert second.system.state_hash() == end and "damaged" in second.told and "repeated" not in second.told


def test_damage_without_a_way_round_is_told_with_what_it_costs(make: Make, tmp_path: Path) -> None:
    first = make()
    first.steps(5)
    end = first.system.state_hash()
    first.end()
    second = make()
    second.steps(5)
    second.end()
    newest = tmp_path / "kept" / "000002-000001.journal"
    damage(newest, place_of(newest.read_bytes(), "S") + 9)  # its number, so that its head is not whole
    third = make()
    assert third.system.state_hash() == end
    assert "damaged: 000002-000001.journal: bytes that are no record, and a later run is lost" in third.told


def test_two_generations_are_kept(make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journals, "GENERATION", (0.0, 0.0))
    first = make()
    first.steps(6)
    first.end()
    assert len(files(tmp_path / "kept")) == 2 and "000001-000001.journal" not in files(tmp_path / "kept")


def test_a_second_process_is_refused_in_one_line(make: Make, tmp_path: Path) -> None:
    make().steps(1)
    with pytest.raises(BusyError, match=rf"kept is the journal of a world that runs \(process {os.getpid()}\)"):
        make()


def test_a_process_that_was_believed_dead_cannot_write(
    make: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first = make()
    first.steps(3)
    first.world._stepper.journal._writer.flush()
    (tmp_path / "kept" / "lock").unlink()  # as if the system had let go of it
    second = make()
    second.steps(4)
    second.world._stepper.journal._writer.flush()
    before = {path: path.read_bytes() for path in (tmp_path / "kept").glob("*.journal")}
    first.steps(5)
    first.world._stepper.journal._writer.flush()
    assert {path: path.read_bytes() for path in before} == before
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "another process has taken over" in line
    first.world.close()
    end = second.system.state_hash()
    second.end()
    assert make().system.state_hash() == end


def test_the_newest_is_found_by_its_number_though_the_clock_was_set_back(make: Make, tmp_path: Path) -> None:
    first = make()
    first.steps(3)
    first.end()
    second = make()
    second.steps(3)
    end = second.system.state_hash()
    second.end()
    for age, name in enumerate(files(tmp_path / "kept")):
        os.utime(tmp_path / "kept" / name, (1e9 - 1e6 * age,) * 2)
    assert make().system.state_hash() == end


def test_a_disk_that_is_full_for_a_while_is_told_once_and_the_journal_goes_on(
    make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    first = make()
    first.steps(3)
    flush = first.world._stepper.journal._writer.flush
    flush()
    good = (tmp_path / "kept" / "000001-000001.journal").read_bytes()

    def full(file: int, data: bytes) -> None:
        os.write(file, data[: len(data) // 2])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as disk:
        disk.setattr(writer, "write_all", full)
        disk.setattr(writer, "RETRY_TIME", 0.0)
        for _ in range(4):
            first.steps(1)
            flush()
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert line.startswith(f"iota: the journal in {tmp_path / 'kept'} cannot be written: No space left on device.")
    assert (tmp_path / "kept" / "000001-000001.journal").read_bytes().startswith(good)
    assert not list((tmp_path / "kept").glob("*.part"))
    first.steps(2)
    flush()
    first.steps(2)
    assert "is written again" in capsys.readouterr().err
    end = first.system.state_hash()
    first.end()
    assert make().system.state_hash() == end


def test_what_is_handed_over_is_on_the_disk_at_once_and_the_rest_of_a_burst_by_one_more_sync(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, synced, fdatasync = make(), threading.Semaphore(0), os.fdatasync
    monkeypatch.setattr(os, "fdatasync", lambda file: (fdatasync(file), synced.release()))
    monkeypatch.setattr(writer, "SYNC_TIME", 60.0)
    first.steps(1)
    assert synced.acquire(timeout=20), "it waits for no clock"
    first.steps(20)
    first.world._stepper.journal._writer.flush()
    assert not synced.acquire(blocking=False)
    first.end(killed=False)
    assert synced.acquire(blocking=False) and not synced.acquire(blocking=False)


def test_a_world_begins_when_its_first_state_is_on_the_disk_unless_the_disk_hangs(
    make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fsync, hangs = os.fsync, threading.Event()
    monkeypatch.setattr(journals, "FIRST", 20.0)
    monkeypatch.setattr(os, "fsync", lambda file: (time.sleep(0.3), fsync(file)))
    make()
    assert files(tmp_path / "kept"), "nothing is lost, whenever it is killed"
    monkeypatch.setattr(os, "fsync", lambda file: (hangs.wait(), fsync(file)))
    monkeypatch.setattr(journals, "FIRST", 0.1)
    second = make(folder="hanging")
    second.steps(3)
    assert not files(tmp_path / "hanging") and second.system.time > 0
    hangs.set()


def test_an_error_at_any_call_of_the_disk_leaves_a_journal_that_leads_to_a_true_state(
    make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_all = writer.write_all
    monkeypatch.setattr(writer, "RETRY_TIME", 0.0)
    monkeypatch.setattr(writer, "SYNC_TIME", 0.0)
    calls = 0
    for failing in range(1, 40):
        with monkeypatch.context() as disk:
            count = 0

            def fails(write: Callable[..., Any]) -> Callable[..., Any]:
                def call(*given: Any) -> Any:
                    nonlocal count
                    count += 1
                    if count == failing:  # noqa: B023
                        if write is write_all:  # a torn record
                            os.write(given[0], given[1][: len(given[1]) // 2])
                        reason = (errno.ENOSPC, errno.EIO)[failing % 2]  # noqa: B023
                        raise OSError(reason, os.strerror(reason))
                    return write(*given)

                return call

            for owner, name in ((writer, "write_all"), (os, "fsync"), (os, "fdatasync"), (Path, "rename")):
                disk.setattr(owner, name, fails(getattr(owner, name)))
            kept = make(folder=str(failing))
            states = {0.0: kept.system.state_hash()}
            for number in range(6):
                disk.setattr(journals, "GENERATION", (0.0, 0.0) if number in (2, 4) else (10.0, 60.0))
                kept.steps(1)
                states[kept.system.time] = kept.system.state_hash()
                kept.world._stepper.journal._writer.flush()
            kept.end(killed=False)
            calls = max(calls, count)
        found = find(Folder(tmp_path / str(failing)))
        assert found is not None, failing
        system = iota.System()
        assert recover(system, found).is_equal and system.state_hash() == states[system.time], failing
        assert system.time > 0.03, "it was written again after the error"
    assert 20 < calls < 39, "each call has failed once"


def test_a_disk_that_is_too_slow_takes_no_memory_and_the_journal_goes_on_when_it_has_caught_up(
    make: Make, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    first = make()
    waiting = threading.Event()
    write_all = writer.write_all
    monkeypatch.setattr(writer, "MOST_WAITING", 10)
    monkeypatch.setattr(writer, "write_all", lambda file, data: (waiting.wait(10), write_all(file, data)))
    first.steps(30)
    assert len(first.world._stepper.journal._writer._waiting) <= 10
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "is too slow" in line
    waiting.set()
    end = first.system.state_hash()  # the end waits until the disk has caught up
    first.end()
    assert make().system.state_hash() == end


def test_an_error_in_the_journal_itself_does_not_end_the_world(
    make: Make, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    first = make()
    first.steps(2)
    monkeypatch.setattr(writer.Writer, "put", lambda *_, **named: 1 / 0)
    first.steps(3)
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "this world is no longer kept in" in line and "ZeroDivisionError" in line
    assert abs(first.system.time - 5 / 120) < 1e-9


def test_steps_and_controls_of_a_running_world_are_in_its_file_within_a_fifth_of_a_second(
    make: Make, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """In real time, with the usual pace of the thread that writes, which nobody wakes."""
    monkeypatch.setattr(journals, "HAND_OVER", 0.1)
    first = make(lambda kept: setattr(kept, "slider", kept.world.controls.slider("gain", 0, 9, 0)))

    def run(seconds: float) -> None:
        end = time.perf_counter() + seconds
        while time.perf_counter() < end:
            first.steps(1)
            time.sleep(1 / 120)

    def in_file() -> tuple[float, float]:
        found = find(Folder(tmp_path / "kept"))
        assert found is not None
        return found.end, found.world["controls"]["Slider gain 1"]

    late = 0
    for value in range(1, 5):
        run(0.35)
        first.slider.value = value  # type: ignore[attr-defined]
        when = first.system.time
        run(0.2)
        end, kept_value = in_file()
        late += end < when or kept_value != value
    assert late <= 1, "unless the machine was busy for a moment"


UNSHARE = ["unshare", "--map-root-user", "--mount", "sh", "-c"]
DISKS = {
    "read-only": ('mount --bind "$0" "$0" && mount -o remount,ro,bind "$0"', "Read-only file system"),
    "full": ('mount -t tmpfs -o size=16k none "$0"', "No space left on device"),
}
SCRIPT = """
import iota
from iota.world import journal
system = iota.System()
chain = iota.builder.chain(links=20, length=1).realize(system)
world = iota.World(system)
world.keep({folder!r})
for _ in range(60):
    world.step()
world.close()
print("went on to", round(system.time, 2))
"""


@pytest.mark.parametrize("disk", DISKS)
def test_a_world_on_a_disk_that_takes_nothing_says_so_in_one_line_and_goes_on(disk: str, tmp_path: Path) -> None:
    mount, reason = DISKS[disk]
    if shutil.which("unshare") is None or subprocess.run([*UNSHARE, mount, tmp_path]).returncode != 0:
        pytest.skip("this machine lets nobody mount")
    script = SCRIPT.format(folder=str(tmp_path))
    done = subprocess.run(
        [*UNSHARE, f'{mount} && exec "$@"', tmp_path, sys.executable, "-c", script],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0 and done.stdout == "went on to 0.5\n", done.stderr
    (line,) = done.stderr.strip().splitlines()
    assert line.startswith(f"iota: the journal in {tmp_path} cannot be written: ") and reason in line


def test_a_folder_that_cannot_be_made_is_an_error_at_once(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match=r"the journal's folder .*kept cannot be made: Not a directory"):
        iota.World(iota.System()).keep(tmp_path / "file" / "kept")


# --- the format -----------------------------------------------------------------------------------------------------------


def test_a_journal_of_each_format_can_be_read() -> None:
    """Each change of the format adds a folder: 1, 2 ..."""
    assert sorted(path.name for path in GOLDEN.iterdir()) == [str(number) for number in range(1, records.FORMAT + 1)]
    for path in GOLDEN.iterdir():
        found = find(Folder(path))
        assert found is not None and found.damage == []
        assert found.header["title"] == "kept" and found.header["format"] == int(path.name)
        assert found.world["people"] == [["Ada", "guest"]] and found.world["state"] == {"score": 3}
        assert len(found.pieces) == 5 and len(found.undo) == 1 and not found.is_orderly
        assert abs(found.end - 10 / 120) < 1e-12


def test_a_journal_of_a_newer_format_is_not_overwritten_and_is_told(make: Make, tmp_path: Path) -> None:
    folder = tmp_path / "kept"
    folder.mkdir()
    (folder / "000004-000001.journal").write_bytes(b"iota journal 9\nijH")
    kept = make()
    assert "begins anew" in kept.told and "000004-000001.journal is of another version of Iota" in kept.told
    kept.end()
    assert files(folder) == ["000005-000001.journal"] and files(folder / "aside-1") == ["000004-000001.journal"]


def test_a_snapshot_of_another_version_is_told_and_put_aside(make: Make, tmp_path: Path) -> None:
    kept = make()
    kept.steps(2)
    kept.end()
    path = tmp_path / "kept" / "000001-000001.journal"
    content = b"".join(
        records.pack(r.kind, r.number, b"IOTAXXXX" + r.content[8:] if r.kind == "S" else r.content)
        for r in records.unpack(path.read_bytes())
        if r.content is not None
    )
    path.write_bytes(records.MAGIC + content)
    again = make()
    assert "begins anew" in again.told and "does not start as one of this version of Iota" in again.told
    again.end()
    assert files(tmp_path / "kept" / "aside-1") == ["000001-000001.journal"]


# --- the command line -----------------------------------------------------------------------------------------------------


def test_info_tells_of_a_journal(make: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept = make(lambda kept: kept.world.controls.slider("gravity", 0, 20, 9.81))
    kept.world.keep_state("score", 3)
    kept.world.keep_state("title", "\x1b[31m")
    kept.steps(12)
    kept.end()
    capsys.readouterr()
    assert main(["info", str(tmp_path / "kept")]) == 0
    told = capsys.readouterr().out
    for text in (
        "the world 'kept'",
        "0.10 s",
        r"title = \x1b[31m",
        "it runs, or was killed",
        "gravity",
        "score = 3",
        "5 in the latest",
    ):
        assert text in told, text
    assert main(["info", str(tmp_path / "kept"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["state"] == {"score": 3, "title": "\x1b[31m"}
    assert main(["info", str(tmp_path / "none")]) == 1
    assert capsys.readouterr().err.startswith("iota: there is no journal in ")


def test_play_shows_the_end_of_a_journal(make: Make, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept = make()
    for _ in range(3):  # with a jump to the start between
        kept.steps(30)
        kept.world.reset()
    kept.end()
    page = tmp_path / "page.html"
    assert main(["play", str(tmp_path / "kept"), "-o", str(page), "--no-open"]) == 0
    assert page.stat().st_size > 100_000 and "stands still" not in capsys.readouterr().err
    times = [at for at, _ in messages_of(find_all(Folder(tmp_path / "kept")))[0]]
    assert times == sorted(times) and len(times) > 60


def test_the_command_line_keeps_a_study_and_goes_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = ["run", "chain", "--headless", "--seconds", "0.5", "--keep", str(tmp_path / "kept")]
    assert main(run) == 0 and "goes on" not in capsys.readouterr().err
    assert main(run) == 0 and "goes on where it was: t = 0.50 s" in capsys.readouterr().err
    assert main([*run, "--fresh"]) == 0 and "begins anew" in capsys.readouterr().err
    assert main(["run", "chain", "--fresh"]) == 1 and "--fresh begins a kept world anew" in capsys.readouterr().err
    script = tmp_path / "script.py"
    script.write_text("import iota\nworld = iota.World(iota.System())\nworld.keep('mine')\nworld.run()\n")
    assert main(["run", str(script), "--headless", "--seconds", "0.1", "--keep", str(tmp_path / "other")]) == 0
    assert files(tmp_path / "other") and not Path("mine").exists(), "the command line wins"
    folder = Folder(tmp_path / "kept")
    folder.lock()
    assert main(run) == 1 and "is the journal of a world that runs" in capsys.readouterr().err
    folder.unlock()
