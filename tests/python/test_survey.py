# SPDX-License-Identifier: Apache-2.0
"""Questions to visitors: what is kept of whom, and when."""

from __future__ import annotations

import csv
import multiprocessing
import os
from pathlib import Path
from typing import Any

import pytest

import iota
from iota import _protocol as protocol
from iota.world import survey

MOTION, PLAUSIBLE, SURE = "What was your impression of the motion?", "Was it plausible?", "How sure are you?"
QUESTIONS: dict[str, Any] = {MOTION: str, PLAUSIBLE: ["yes", "no"], SURE: (0, 10)}


class Hall:
    """A world and its visitors, without pages."""

    def __init__(self, file: Path, **more: Any) -> None:
        self.world = iota.World(iota.System(), title="a hall", ground=None)
        self.file = file
        self.survey = self.world.ask(QUESTIONS, file=file, **more)
        self.cards: list[tuple[int, str]] = []
        self.world._state.notices.show = lambda client, level, title, *rest: self.cards.append((client, title))

    def come(self, client: int) -> None:
        self.world._inputs.take([(client, protocol.Join("Ada", protocol.Role.HOST))], lambda ids: [])

    def widgets(self, client: int) -> dict[str, Any]:
        things = [thing for thing in self.world.drawings.things if getattr(thing, "client", 0) == client]
        return {thing.label: thing for thing in things}  # type: ignore[attr-defined]

    def give(self, client: int, label: str, value: float = 1, text: str = "") -> None:
        event = iota.Event(self.world.system, label, client, notices=self.world._state.notices)
        self.widgets(client)[label].take(value, text, event, self.world._guard)

    def rows(self) -> list[dict[str, str]]:
        with self.file.open(newline="") as lines:
            return list(csv.DictReader(lines))


@pytest.fixture
def hall(tmp_path: Path) -> Hall:
    return Hall(tmp_path / "answers.csv")


def test_answers_are_kept_once_a_visitor_agrees_and_sends_them(hall: Hall) -> None:
    hall.come(3)
    hall.give(3, MOTION, text="lovely, it swings")
    hall.give(3, PLAUSIBLE, 1)
    hall.give(3, SURE, 7)
    assert hall.rows() == []
    hall.give(3, "send my answers")
    assert hall.rows() == [] and hall.cards[-1] == (3, "Nothing was sent")
    hall.give(3, survey.AGREE, 1)
    hall.give(3, "send my answers")
    (row,) = hall.rows()
    assert (row[MOTION], row[PLAUSIBLE], row[SURE]) == ("lovely, it swings", "yes", "7")
    assert row["world"] == "a hall" and row["time"].endswith("+00:00") and len(row["visit"]) == 8
    assert "Ada" not in hall.file.read_text()
    assert hall.cards[-1] == (3, "Thank you") and hall.widgets(3) == {}
    assert hall.survey.answers == [{MOTION: "lovely, it swings", PLAUSIBLE: "yes", SURE: "7"}]


def test_each_visitor_has_questions_of_their_own_that_end_when_they_leave(hall: Hall) -> None:
    for client in (1, 2):
        hall.come(client)
    hall.give(1, survey.AGREE, 1)
    hall.give(1, MOTION, text="one")
    assert hall.widgets(2)[MOTION].value == ""
    hall.world._inputs.take([(2, protocol.Leave())], lambda ids: [])
    assert hall.widgets(2) == {} and hall.widgets(1) != {}
    hall.survey.destroy()
    assert hall.widgets(1) == {}
    hall.come(5)
    assert hall.widgets(5) == {}


def test_only_their_own_visitor_changes_them(hall: Hall) -> None:
    hall.come(1)
    event = iota.Event(hall.world.system, MOTION, 2, notices=hall.world._state.notices)
    hall.widgets(1)[MOTION].take(0, "not mine", event, hall.world._guard)
    assert hall.widgets(1)[MOTION].value == ""


def test_a_table_program_calculates_nothing_of_an_answer_and_a_row_is_one_line(hall: Hall) -> None:
    hall.come(1)
    hall.give(1, survey.AGREE, 1)
    hall.give(1, MOTION, text='=HYPERLINK("x")\n"quoted", and more' + "z" * 5000)
    hall.give(1, "send my answers")
    (row,) = hall.rows()
    assert row[MOTION].startswith("'=HYPERLINK") and len(row[MOTION]) <= survey.LONGEST + 1
    assert len(hall.file.read_text().splitlines()) == 2


def test_a_visitor_hears_that_an_answer_was_cut(hall: Hall) -> None:
    hall.come(1)
    told: list[str] = []
    hall.world._state.notices.show = lambda client, level, title, text, *rest: told.append(text)
    for count, words in (
        (survey.LONGEST, ""),
        (survey.LONGEST + 1, f" Of {MOTION!r} the first {survey.LONGEST} characters."),
    ):
        hall.come(count)
        hall.give(count, survey.AGREE, 1)
        hall.give(count, MOTION, text="z" * count)
        hall.give(count, "send my answers")
        assert told[-1] == "Your answers are kept." + words


def test_another_run_adds_rows_and_other_questions_are_refused(hall: Hall) -> None:
    again = Hall(hall.file)
    for each in (hall, again):
        each.come(1)
        each.give(1, survey.AGREE, 1)
        each.give(1, PLAUSIBLE, 2)
        each.give(1, "send my answers")
    assert [row[PLAUSIBLE] for row in hall.rows()] == ["no", "no"]
    with pytest.raises(ValueError, match="has answers to other questions"):
        again.world.ask({"Another?": str}, file=hall.file)


def write(file: Path, count: int) -> None:
    for number in range(count):
        survey.append(file, ["a", "b"], [str(number), "x" * 3000])


def test_rows_of_several_processes_do_not_mix(tmp_path: Path) -> None:
    file = tmp_path / "answers.csv"
    processes = [multiprocessing.get_context("fork").Process(target=write, args=(file, 40)) for _ in range(4)]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    with file.open(newline="") as lines:
        rows = list(csv.reader(lines))
    assert rows[0] == ["a", "b"] and len(rows) == 161
    assert all(len(row) == 2 and len(row[1]) == 3000 for row in rows[1:])


def test_a_disk_that_is_full_loses_no_earlier_row_and_the_visitor_is_told(
    hall: Hall, monkeypatch: pytest.MonkeyPatch
) -> None:
    hall.come(1)
    hall.give(1, survey.AGREE, 1)
    hall.give(1, PLAUSIBLE, 1)
    real = os.write
    monkeypatch.setattr(os, "write", lambda handle, data: real(handle, data[: len(data) // 2]))
    hall.give(1, "send my answers")
    monkeypatch.undo()
    assert hall.cards[-1] == (1, "Your answers could not be kept") and hall.rows() == []
    hall.give(1, "send my answers")
    assert [row[PLAUSIBLE] for row in hall.rows()] == ["yes"]


def test_a_slider_that_nobody_has_moved_is_no_answer(hall: Hall) -> None:
    hall.come(1)
    assert hall.cards[-1] == (1, "May we ask you something?")
    hall.give(1, survey.AGREE, 1)
    assert hall.cards[-1] == (1, "What is kept")
    hall.give(1, "send my answers")
    assert hall.cards[-1] == (1, "Nothing was sent") and hall.rows() == []
    hall.give(1, PLAUSIBLE, 1)
    hall.give(1, "send my answers")
    assert hall.rows()[0][SURE] == ""


def test_a_function_is_told_of_each_answer(tmp_path: Path) -> None:
    told: list[int] = []
    hall = Hall(tmp_path / "answers.csv", on_answer=lambda event: told.append(event.client))
    hall.come(4)
    hall.give(4, survey.AGREE, 1)
    hall.give(4, PLAUSIBLE, 1)
    hall.give(4, "send my answers")
    assert told == [4]


@pytest.mark.parametrize(
    ("questions", "words"),
    [
        ({}, "questions must be a dict"),
        (["Why?"], "questions must be a dict"),
        ({"": str}, "a question must be a text"),
        ({"time": str}, "a question must be a text other than time"),
        ({"Why?": ["one"]}, "a list of two choices or more"),
        ({"Why?": (2, 1)}, "a range"),
        ({"Why?": int}, "the answer is str"),
    ],
)
def test_bad_questions_are_refused_in_words(tmp_path: Path, questions: Any, words: str) -> None:
    world = iota.World(iota.System(), ground=None)
    with pytest.raises((TypeError, ValueError), match=words):
        world.ask(questions, file=tmp_path / "answers.csv")
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_cannot_be_written_is_told_at_once(tmp_path: Path) -> None:
    world = iota.World(iota.System(), ground=None)
    with pytest.raises(OSError, match="cannot be written"):
        world.ask({"Why?": str}, file=tmp_path / "no" / "answers.csv")
