#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Records every study: films in build/films, contact sheets in docs/pictures/studies, thumbnails of the gallery.

    tools/make_films.py [NAME ...] [--no-films]

The sheets and thumbnails are kept in the repository: check them before a commit.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
IOTA = [sys.executable, "-m", "iota"]
FILMS = ROOT / "build" / "films"
THUMBNAILS = ROOT / "python" / "iota" / "studies" / "pictures"
SHEETS = ROOT / "docs" / "pictures" / "studies"
# As wide as the page that the studies' cameras are chosen for.
SIZE, THUMBNAIL_SIZE = "640x360", "480x270"
COLUMNS = 3  # of a sheet
# The scripts of films that show more of a study than happens by itself.
SCRIPTS = {
    "chain": """from iota import looks
from iota.studies import chain

world = chain.build()
links = world.system.bodies
world.at(8.5)(lambda: world.draw(links, looks.chain_link(chain.LENGTH / len(links))))
world.run()
""",
    "museum": """from iota.studies import museum

world = museum.build()
for number, view in enumerate([*map(museum.view_of, range(len(museum.HALLS))), museum.WHOLE]):
    world.at(0.01 + 2.0 * number)(lambda view=view: setattr(world, "camera", view))
world.run()
""",
}
OPTIONS = {"physics-class": ["--plots"]}
# Duration of a film, s, and time of its thumbnail, if they differ from the defaults.
SECONDS = {
    "chain": 12.0,
    "evacuation": 20.0,
    "grasp": 13.0,
    "knot": 19.0,
    "molecule": 12.0,
    "museum": 12.0,
    "ragdolls": 17.0,
    "rigging": 30.0,
    "undersea": 28.0,
}
USUAL = 10.0
MOMENT = {
    "capstan": 1.9,
    "chain": 2.5,
    "evacuation": 9.0,
    "fireworks": 5.1,
    "grasp": 3.2,
    "knot": 17.5,
    "links": 4.0,
    "marbles": 3.0,
    "physics-class": 3.5,
    "playground": 0.6,
    "pour": 2.25,
    "ragdolls": 4.75,
    "rigging": 9.5,
    "undersea": 9.0,
    "wrecking-ball": 2.3,
}
USUAL_MOMENT = 2.0


def record(what: str | Path, *arguments: str | Path) -> None:
    command = [*IOTA, "record", *map(str, (what, *arguments))]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def make(name: str, with_film: bool) -> None:
    """A sheet of twelve pictures from the film, or, without a film, from twelve frames."""
    seconds = SECONDS.get(name, USUAL)
    what: str | Path = name
    if name in SCRIPTS:
        what = FILMS / f"{name}.py"
        what.write_text(SCRIPTS[name])
    film = ["-o", FILMS / f"{name}.mp4"] if with_film else ["--rate", "10"]
    sheet = ["--sheet", SHEETS / f"{name}.jpg", "--columns", str(COLUMNS), "--size", SIZE, *OPTIONS.get(name, [])]
    record(what, "--seconds", str(seconds), *sheet, *film)
    once = ["--pictures", "1", "--size", THUMBNAIL_SIZE, "--rate", "5"]
    record(name, "--seconds", str(2 * MOMENT.get(name, USUAL_MOMENT)), "--sheet", THUMBNAILS / f"{name}.jpg", *once)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("names", nargs="*", metavar="NAME", help="of studies (default: all)")
    parser.add_argument("--no-films", action="store_true", help="only the sheets: a minute instead of many")
    options = parser.parse_args()
    listed = subprocess.run([*IOTA, "list"], check=True, capture_output=True, text=True).stdout
    names = options.names or [line.split()[0] for line in listed.splitlines()]
    try:
        for folder in (FILMS, SHEETS, THUMBNAILS):
            folder.mkdir(parents=True, exist_ok=True)
        for number, name in enumerate(names, 1):
            print(f"[{number}/{len(names)}] {name} ...", end="", flush=True)
            began = time.monotonic()
            make(name, not options.no_films)
            print(f" {time.monotonic() - began:.0f} s", flush=True)
    except subprocess.CalledProcessError as error:  # which has said why
        print(" failed", flush=True)
        return error.returncode
    except OSError as error:
        print(f"make_films: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
