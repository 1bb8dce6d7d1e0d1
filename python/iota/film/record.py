# SPDX-License-Identifier: Apache-2.0
"""Records a world frame by frame: the film is smooth and runs at the world's own speed on any machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from iota.film.browser import FilmPage, film_page
from iota.film.files import Failed, FilmFile, check_name, video_library, write_sheet
from iota.film.journal import messages_to_viewers
from iota.film.stream import write_stream
from iota.saving import replacing
from iota.world import World

WARM_UP = 6  # frames before the first: light and camera settle
MOST_PIXELS = 4096


@dataclass
class Film:
    """Options of a recording. film: an .mp4 file, an .iota file with the server's messages, or an .html page that plays
    these. sheet: a .png or .jpg file with `pictures` of its frames, evenly spaced in time, `columns` in a row. seconds:
    simulated. rate: frames a second. plots: those of the script are drawn over the picture."""

    film: Path | None = None
    sheet: Path | None = None
    seconds: float = 10.0
    rate: int = 30
    width: int = 640
    height: int = 480
    pictures: int = 12
    columns: int = 4
    plots: bool = False

    @property
    def frames(self) -> int:
        return max(1, round(self.seconds * self.rate))

    def check(self) -> None:
        """Raises Failed for invalid options, before a world is built."""
        if self.film is None and self.sheet is None:
            raise Failed("nothing to make: name a film by -o FILE.mp4, a contact sheet by --sheet FILE.png, or both")
        if self.film is not None:
            check_name(self.film, [".mp4", ".html", ".iota"])
        if self.sheet is not None:
            check_name(self.sheet, [".png", ".jpg"])
        for side in (self.width, self.height):
            if not 16 <= side <= MOST_PIXELS or side % 2:
                raise Failed(f"width and height must be even, from 16 to {MOST_PIXELS}, not {self.width}x{self.height}")
        if self.is_drawn or self.sheet is not None:
            video_library()

    @property
    def is_drawn(self) -> bool:
        """Whether all frames are needed as pictures."""
        return self.film is not None and self.film.suffix.lower() == ".mp4"

    def on_sheet(self) -> set[int]:
        """The frames that the sheet shows: the middle of each of its equal parts of the time."""
        count = min(self.pictures, self.frames) if self.sheet is not None else 0
        return {int((number + 0.5) * self.frames / count) for number in range(count)}


def record(world: World, film: Film, progress: Callable[[int, int], None] = lambda done, all: None) -> None:
    """Runs a world and makes its film. progress: called after each frame. Raises Failed; no incomplete file is left."""
    film.check()
    if film.film is not None and not film.is_drawn and film.sheet is None:
        return record_messages(world, film, film.film, progress)
    with plain_errors(), ExitStack() as stack:
        sheet = stack.enter_context(replacing(film.sheet)) if film.sheet is not None else None
        file = stack.enter_context(replacing(film.film)) if film.film is not None else None
        movie: FilmFile | None = None
        if file is not None and film.is_drawn:
            movie = FilmFile(file, film.width, film.height, film.rate)
            stack.callback(movie.close)
        page = stack.enter_context(film_page(world.serve(port=0), film.width, film.height))
        shown, wanted = [], film.on_sheet()
        told: list[tuple[float, bytes]] = []  # for a file of messages beside a sheet

        def keep(number: int, picture: bytes) -> None:
            if movie is not None:
                movie.add(picture)
            if number in wanted:
                shown.append(picture)

        begun: int | None = None  # the frame that the page draws while the one before is kept and the next is stepped
        for number in range(film.frames):
            advance(world, page, film, number)
            if film.is_drawn or number in wanted:
                picture = page.next_picture(1 / film.rate, film.plots)
                if begun is not None:
                    keep(begun, picture)
                begun = number
            else:
                page.pass_time(1 / film.rate)
            frames = page.take_frames()
            if file is not None and movie is None:
                told += [(number / film.rate, data) for data in frames]
            progress(number + 1, film.frames)
        if begun is not None:
            keep(begun, page.last_picture())
        if sheet is not None:
            write_sheet(sheet, shown, min(film.columns, len(shown)), film.width)
        if file is not None and movie is None:
            write_stream(file, told, world.title)


def record_messages(world: World, film: Film, path: Path, progress: Callable[[int, int], None]) -> None:
    """A file of what pages are told, for which no browser is needed."""
    with plain_errors(), replacing(path) as file:
        world.serve(port=0)
        publisher = world.pages._publisher
        assert publisher is not None
        recording = publisher.room.record(1e-6)
        told: list[tuple[float, bytes]] = []
        for number in range(film.frames):
            world.advance(steps_before(number, film, world) if number else 0)
            told += [(number / film.rate, data) for data in messages_to_viewers(recording, world.system.time)]
            progress(number + 1, film.frames)
        recording.end()
        write_stream(file, told, world.title)


def steps_before(number: int, film: Film, world: World) -> int:
    """The number of steps from the frame before to this one."""
    steps = 1 / film.rate / world.dt
    return round(number * steps) - round((number - 1) * steps)


@contextmanager
def plain_errors() -> Iterator[None]:
    """For a full disk, or a folder that cannot be written."""
    try:
        yield
    except OSError as error:
        raise Failed(str(error)) from None


def advance(world: World, page: FilmPage, film: Film, number: int) -> None:
    """Steps the world to a frame, which the page then has; the first frame shows the start."""
    if number == 0:
        page.wait_for(world.system.step_count, meanwhile=lambda: world.advance(0))
        for _ in range(WARM_UP):
            page.next_picture(1 / film.rate, film.plots)
        page.last_picture()
    else:
        world.advance(steps_before(number, film, world))
        page.wait_for(world.system.step_count)
