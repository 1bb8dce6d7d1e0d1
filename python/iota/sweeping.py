# SPDX-License-Identifier: Apache-2.0
"""One function for many values of its arguments, on all cores: `iota.sweep`, `iota sweep`."""

from __future__ import annotations

import csv
import importlib
import importlib.util
import inspect
import io
import itertools
import os
import pickle
import queue
import runpy
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from iota import _core
from iota._core import StepReport, System
from iota.arguments import SHORT
from iota.extras import how_to_get
from iota.machines import ray_at
from iota.saving import replacing

__all__ = ["step_all", "sweep"]

ERROR = "error"  # the last column: why a run has no results
QUEUED = 4  # tasks for each core of a Ray cluster, so that none waits for this process
TRIES = 2  # of a run whose process dies
SCRIPT = "__iota__"  # run name of a script of which only functions are called
GUARD = "put the call under `if __name__ == '__main__':`"

is_worker = False  # this is a process of a sweep

Inputs = dict[str, Any]
Row = dict[str, Any]
Progress = Callable[[int, int, int], None]  # done, all, failed


def step_all(systems: Sequence[System], dt: float = 1 / 120, count: int = 1, threads: int = 0) -> list[StepReport]:
    """Steps many systems at once, on several cores: each as `System.step(dt, count)`, with the same bits. Returns their
    reports.

        systems = [make(stiffness) for stiffness in range(100)]
        for _ in range(1000):
            iota.step_all(systems, 1 / 240, count=10)

    systems: each once; those of `System(threads=1)` are fastest. dt: s. threads: 0 for all cores. Functions of the script are
    called one after another. If forces of a system fail, all are stepped, and the first error is raised. Raises ValueError
    for a system that is there twice, WrongThreadError for one of another thread; then nothing has moved.
    """
    return _core.step_all(list(systems), dt, count, threads)


def sweep(
    function: Callable[..., Any],
    grid: Mapping[str, Iterable[Any]] | Sequence[Mapping[str, Any]],
    file: str | Path | None = None,
    processes: int | None = None,
    progress: Progress | None = None,
    ray: str | None = None,
) -> list[Row]:
    """Calls a function for each combination of values, in processes of their own, and returns the results as rows.

        def swing(length, seed):
            ...
            return {"period": period, "loss": loss}

        if __name__ == "__main__":
            rows = iota.sweep(swing, {"length": [0.5, 1, 2], "seed": range(10)}, file="swing.csv")

    function: at the top level of a module or script; it returns numbers or texts by name, or one number. grid: values by
    argument, the last one changes fastest; or a list of arguments by name. file: a CSV file, to which each result is
    added at once; the next call with it goes on where this one was stopped, and tries again what failed. processes: None
    for one a core, 0 for none but this one. progress: called as progress(done, all, failed). A file that ends in .parquet is
    written at the end, with pyarrow, and the CSV file beside it as above. ray: the address of a Ray cluster on whose machines the
    function is called instead, "auto": that of this machine; its module or script is at the same path on all.

    A row has the arguments, the results and `error`: empty, or why there are none; a run that raises, or whose process
    dies twice, is such a row. Rows are in the order of the grid, and the same for any number of processes if the
    function gives the same for the same arguments. Raises ValueError for a file of another sweep, TypeError for a
    function that another process cannot find, OSError for a file that cannot be written, ConnectionError without a Ray
    cluster at `ray`.
    """
    runs = combinations(grid)
    path = None if file is None else Path(file)
    is_parquet = path is not None and path.suffix.lower() == ".parquet"
    if is_parquet:
        check_parquet()
    table = Table(path.with_suffix(".csv") if path is not None and is_parquet else path, runs)
    workers = min(os.cpu_count() or 1 if processes is None else processes, table.left)
    if processes is not None and processes < 0:
        raise ValueError(f"processes must be 0 or more, not {processes}")
    tell = progress or (lambda done, all, failed: None)
    tell(table.done, len(runs), table.failed)
    if ray is not None:
        if processes is not None:
            raise ValueError("a sweep is on processes of this machine or on Ray: give processes or ray, not both")
        results = call_by_ray(function, table.waiting(), ray)
    elif processes == 0:
        results = call_here(function, table.waiting())
    else:
        results = call_there(function, table.waiting(), workers)
    for number, result, error in results:
        table.add(number, result, error)
        tell(table.done, len(runs), table.failed)
    rows = table.finish()
    if path is not None and is_parquet:
        write_parquet(path, rows)
    return rows


def check_parquet() -> None:
    """Raises ValueError without pyarrow, before hours of work."""
    if importlib.util.find_spec("pyarrow") is None:
        raise ValueError(f"tables in Parquet need pyarrow. {how_to_get('sweep')}; or name a file that ends in .csv")


def write_parquet(path: Path, rows: list[Row]) -> None:
    """A column whose values have several types is one of texts. Raises OSError."""
    import pyarrow
    from pyarrow import parquet

    columns = {}
    for name in rows[0]:
        values = [row[name] for row in rows]
        try:
            columns[name] = pyarrow.array(values)
        except (pyarrow.ArrowInvalid, pyarrow.ArrowTypeError):
            columns[name] = pyarrow.array([None if value is None else text_of(value) for value in values])
    with replacing(path) as fresh:
        parquet.write_table(pyarrow.table(columns), fresh)


def combinations(grid: Mapping[str, Iterable[Any]] | Sequence[Mapping[str, Any]]) -> list[Inputs]:
    if isinstance(grid, Mapping):
        values = [list(each) for each in grid.values()]
        runs = [dict(zip(grid, each, strict=True)) for each in itertools.product(*values)]
    else:
        runs = [dict(each) for each in grid]
    if not runs or not runs[0]:
        raise ValueError("a sweep needs values: grid has none")
    if any(run.keys() != runs[0].keys() for run in runs):
        raise ValueError("all runs of a sweep need the same arguments")
    if ERROR in runs[0]:
        raise ValueError(f"an argument cannot be called {ERROR!r}, which is a column of the table")
    return runs


def text_of(value: Any) -> str:
    """Makes the text of a cell; numbers have all digits."""
    return value if isinstance(value, str) else repr(value.item() if hasattr(value, "item") else value)


def value_of(text: str) -> Any:
    """Reads a cell: a number if it is one."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return {"True": True, "False": False, "None": None}.get(text, text)


class Table:
    """The results so far. left: runs without one."""

    def __init__(self, path: Path | None, runs: list[Inputs]) -> None:
        self._path, self._runs = path, runs
        self._inputs = list(runs[0])
        self._keys = [tuple(text_of(run[name]) for name in self._inputs) for run in runs]
        if len(set(self._keys)) < len(runs):
            raise ValueError("two runs of the sweep have the same arguments: add one that tells them apart, as a seed")
        self._results: list[dict[str, str] | None] = [None] * len(runs)
        self._columns: list[str] | None = None  # of results
        self._file: io.TextIOWrapper | None = None
        self.done = self.failed = 0
        if path is not None and path.exists():
            self._read(path)

    @property
    def left(self) -> int:
        return len(self._runs) - self.done

    def waiting(self) -> Iterator[tuple[int, Inputs]]:
        return ((number, run) for number, run in enumerate(self._runs) if self._results[number] is None)

    def add(self, number: int, result: Any, error: str) -> None:
        cells = {ERROR: error}
        if not error:
            given = result if isinstance(result, Mapping) else {"result": result}
            names = [str(name) for name in given]
            if self._columns is None:
                self._columns = names
            if names != self._columns:
                cells[ERROR] = f"it returned {', '.join(names)} instead of {', '.join(self._columns or [])}"
            else:
                cells |= {name: text_of(value) for name, value in zip(names, given.values(), strict=True)}
        self._results[number] = cells
        self.done += 1
        self.failed += bool(cells[ERROR])
        self._append(number)

    def finish(self) -> list[Row]:
        """Writes the file anew, in the order of the grid."""
        if self._file is not None:
            self._file.close()
            self._file = None
        if self._path is not None:
            self._write(range(len(self._runs)))
        return [self._row(number) for number in range(len(self._runs))]

    def _row(self, number: int) -> Row:
        cells = self._results[number] or {}
        columns = {name: value_of(cells[name]) if name in cells else None for name in self._columns or []}
        return self._runs[number] | columns | {ERROR: cells.get(ERROR, "")}

    def _cells(self, number: int) -> list[str]:
        cells = self._results[number] or {}
        return [*self._keys[number], *(cells.get(name, "") for name in [*(self._columns or []), ERROR])]

    def _header(self) -> list[str]:
        return [*self._inputs, *(self._columns or []), ERROR]

    def _write(self, numbers: Iterable[int]) -> None:
        assert self._path is not None
        with replacing(self._path) as fresh, fresh.open("w", newline="", encoding="utf-8") as out:
            rows = csv.writer(out)
            rows.writerow(self._header())
            rows.writerows(self._cells(number) for number in numbers if self._results[number] is not None)

    def _append(self, number: int) -> None:
        """A killed sweep loses no result that is here."""
        if self._path is None or self._columns is None:  # a header needs the first result
            return
        if self._file is None:
            self._write(other for other in range(len(self._runs)) if self._results[other] is not None)
            self._file = self._path.open("a", newline="", encoding="utf-8")
            return
        csv.writer(self._file).writerow(self._cells(number))
        self._file.flush()

    def _read(self, path: Path) -> None:
        """The results of a sweep that was stopped. Its last line may be unfinished."""
        text = path.read_text(encoding="utf-8")
        whole = text[: text.rindex("\n") + 1] if "\n" in text else ""
        rows = list(csv.reader(io.StringIO(whole)))
        if not rows:
            return
        header, known = rows[0], len(self._inputs)
        if header[:known] != self._inputs or header[-1] != ERROR:
            raise ValueError(
                f"{path} is of another sweep: its columns are {', '.join(header)}, and the arguments here are "
                f"{', '.join(self._inputs)}. Name another file"
            )
        numbers = {key: number for number, key in enumerate(self._keys)}
        self._columns = header[known:-1] or None
        for row in rows[1:]:
            number = numbers.get(tuple(row[:known])) if len(row) == len(header) else None
            if number is not None and row[-1] == "" and self._results[number] is None:
                self._results[number] = dict(zip(header[known:], row[known:], strict=True))
                self.done += 1


# --- calls ----------------------------------------------------------------------------------------------------------------

Called = tuple[int, Any, str]  # number of the run, its result, why there is none


def call(function: Callable[..., Any], number: int, inputs: Inputs) -> Called:
    try:
        result = function(**inputs)
        given = result if isinstance(result, Mapping) else {"result": result}
        return number, {str(name): plain(value) for name, value in given.items()}, ""
    except Exception as error:
        return number, None, f"{type(error).__name__}: {error}"


def plain(value: Any) -> Any:
    value = value.item() if hasattr(value, "item") else value
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise TypeError(f"a result is a number or a text, not {SHORT.repr(value)}")


def call_here(function: Callable[..., Any], runs: Iterable[tuple[int, Inputs]]) -> Iterator[Called]:
    for number, inputs in runs:
        yield call(function, number, inputs)


def call_there(function: Callable[..., Any], runs: Iterable[tuple[int, Inputs]], count: int) -> Iterator[Called]:
    """In processes, each of which a thread here asks. One that dies, as for want of memory, is replaced, and its run tried
    once more."""
    check_not_worker()
    place = place_of(function)
    waiting, lock = iter(runs), threading.Lock()
    answers: queue.SimpleQueue[Called | None] = queue.SimpleQueue()
    workers: set[Worker] = set()
    is_over = threading.Event()

    def take() -> tuple[int, Inputs] | None:
        with lock:
            return None if is_over.is_set() else next(waiting, None)

    def ask(run: tuple[int, Inputs], worker: Worker | None) -> Worker | None:
        """Puts the answer. Returns the process, None if it has died."""
        for _ in range(TRIES):
            if worker is None:
                worker = Worker(place)
                workers.add(worker)
            answer = worker.ask(run)
            if answer is not None:
                answers.put(answer)
                return worker
            workers.discard(worker)
            code, worker = worker.end(), None
            if is_over.is_set():
                return None
        answers.put((run[0], None, f"its process died {TRIES} times, {how_it_ended(code)}"))
        return None

    def serve() -> None:
        worker: Worker | None = None
        try:
            while (run := take()) is not None:
                worker = ask(run, worker)
        finally:
            if worker is not None:
                worker.end()
            answers.put(None)

    threads = [threading.Thread(target=serve, name="iota-sweep", daemon=True) for _ in range(count)]
    for thread in threads:
        thread.start()
    left = count
    try:
        while left:
            answer = answers.get()
            if answer is None:
                left -= 1
            else:
                yield answer
    finally:
        if left:
            is_over.set()
            for worker in list(workers):
                worker.kill()
        for thread in threads:
            thread.join()


def call_by_ray(function: Callable[..., Any], runs: Iterable[tuple[int, Inputs]], address: str) -> Iterator[Called]:
    """As tasks on the machines of a cluster. Ray tries a task whose process or machine dies once more."""
    check_not_worker()
    place = place_of(function)
    ray = ray_at(address)
    task = ray.remote(call_on_machine).options(max_retries=TRIES - 1, num_cpus=1)
    words = ray.put((list(sys.path), str(Path.cwd()), place))
    waiting = iter(runs)
    asked: dict[Any, int] = {}
    try:
        while True:
            most = QUEUED * max(1, int(ray.cluster_resources().get("CPU", 1)))
            for number, inputs in itertools.islice(waiting, max(0, most - len(asked))):
                asked[task.remote(words, number, inputs)] = number
            if not asked:
                return
            ready, _ = ray.wait(list(asked), num_returns=1)
            for answer in ray.wait(list(asked), num_returns=len(asked), timeout=0)[0] or ready:
                number = asked.pop(answer)
                try:
                    yield ray.get(answer)
                except ray.exceptions.RayError as error:
                    yield number, None, f"its process died {TRIES} times, at last by {type(error).__name__}"
    finally:
        for answer in asked:
            with suppress(Exception):
                ray.cancel(answer, force=True)


places: dict[tuple[str, str], Callable[..., Any]] = {}  # functions that a process of Ray has found


def call_on_machine(words: tuple[list[str], str, tuple[str, str]], number: int, inputs: Inputs) -> Called:
    """In a process of Ray."""
    global is_worker
    is_worker = True
    paths, folder, place = words
    try:
        if place not in places:
            sys.path[:0] = [path for path in paths if path not in sys.path]
            os.chdir(folder)
            places[place] = find(place)
        return call(places[place], number, inputs)
    except Exception as error:
        return number, None, f"{type(error).__name__}: {error}"


def check_not_worker() -> None:
    if is_worker:
        raise RuntimeError(f"iota.sweep is called while a process of a sweep reads the script: {GUARD}")


class Worker:
    """Another process that calls the function, in turn with this one."""

    def __init__(self, place: tuple[str, str]) -> None:
        words = [sys.executable, "-c", "from iota.sweeping import work; work()"]
        self._process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._send((sys.path, place))

    def ask(self, run: tuple[int, Inputs]) -> Called | None:
        """None if the process has died."""
        assert self._process.stdout is not None
        try:
            self._send(run)
            return pickle.load(self._process.stdout)  # type: ignore[no-any-return]
        except (OSError, EOFError, pickle.UnpicklingError):
            return None

    def end(self) -> int:
        """Returns the exit code."""
        assert self._process.stdin is not None and self._process.stdout is not None
        with suppress(OSError):
            self._process.stdin.close()
        self._process.stdout.close()
        return self._process.wait()

    def kill(self) -> None:
        self._process.kill()

    def _send(self, message: Any) -> None:
        assert self._process.stdin is not None
        with suppress(BrokenPipeError):  # the answer tells that it is gone
            pickle.dump(message, self._process.stdin)
            self._process.stdin.flush()


def how_it_ended(code: int) -> str:
    return f"at last by {signal.Signals(-code).name}" if code < 0 else f"at last with exit code {code}"


def work() -> None:
    """In another process, until its input ends. What the function prints goes to stderr. Ctrl-C ends the sweep, which ends
    this."""
    global is_worker
    is_worker = True
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    sys.path[:], place = pickle.load(sys.stdin.buffer)
    function: Callable[..., Any] | None = None
    while True:
        try:
            number, inputs = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        try:
            function = function or find(place)
            answer = call(function, number, inputs)
        except Exception as error:
            answer = number, None, f"{type(error).__name__}: {error}"
        pickle.dump(answer, out)
        out.flush()


def place_of(function: Callable[..., Any]) -> tuple[str, str]:
    """The file or module of a function, and its name there. Raises TypeError for one that another process cannot find."""
    name = getattr(function, "__qualname__", "<")
    module = getattr(function, "__module__", None)
    file = inspect.getsourcefile(function) if inspect.isfunction(function) else None
    if "<" not in name and module in ("__main__", SCRIPT) and file is not None and os.path.isfile(file):
        return os.path.abspath(file), name
    if "<" not in name and module not in (None, "__main__", SCRIPT):
        return module, name
    raise TypeError(
        f"another process cannot find {SHORT.repr(function)}: define it at the top level of a module or script, or sweep "
        "with processes=0"
    )


def find(place: tuple[str, str]) -> Callable[..., Any]:
    where, name = place
    if os.path.isabs(where):
        found: Any = SimpleNamespace(**runpy.run_path(where, run_name=SCRIPT))
    else:
        found = importlib.import_module(where)
    for part in name.split("."):
        found = getattr(found, part)
    return found  # type: ignore[no-any-return]
