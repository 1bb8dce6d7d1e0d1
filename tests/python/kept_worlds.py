# SPDX-License-Identifier: Apache-2.0
"""Kills processes that keep a world, at random times, and looks at what the next one finds.

    kept_worlds.py FOLDER COUNT SEED        prints one JSON object

Each process is a fork of this one, which has imported Iota but used nothing of it: a start takes milliseconds.
"""

from __future__ import annotations

import json
import os
import random
import signal
import statistics
import struct
import sys
import time
from pathlib import Path

import iota

STATE = struct.Struct("<dQd")  # time of the world, hash, time of the clock


def build(folder: str, number: int) -> iota.World:
    """A chain on a nail, a ball that a function of the script pulls, and edits at random."""
    system = iota.System(threads=1)
    chain = iota.builder.chain(links=5, length=1, top=(0, 2, 0), direction=(1, 0, 0)).realize(system)
    ball = system.body(shape=iota.Sphere(0.1), position=(1, 1, 0))
    system.bond(chain.points[-1], ball.particles[0], pull)
    world = iota.World(system, title="kept")
    world.keep(folder)
    chance = random.Random(number)
    made = world.kept_state("made", [])

    @world.every(0.05)
    def edit() -> None:
        kind = chance.randrange(5)
        if kind == 0:
            with system.edit():
                made.append(system.body(shape=iota.Sphere(0.05), position=(chance.random(), 3, chance.random())))
        elif kind == 1 and len(made) > 3:
            with system.edit():
                made.pop(0).destroy()
        elif kind == 2:
            chain.points[-1].velocity = (chance.uniform(-3, 3), 0, chance.uniform(-3, 3))
        elif kind == 3:
            world.undo()
            made[:] = [body for body in made if body.alive]
        world.keep_state("made", made)

    return world


def pull(bond: iota.types.BondState) -> tuple[float, float, float]:
    return (0.0, 2.0, 0.0)


def live(folder: str, number: int, out: int) -> None:
    """Runs until it is killed. After each step it tells the state, which cannot be known better than this way."""
    sys.stderr = open(os.devnull, "w")  # noqa: SIM115
    world = build(folder, number)
    world._begin()
    tell(world.system, out)
    while True:
        world.step()
        tell(world.system, out)
        time.sleep(0.0005)


def tell(system: iota.System, out: int) -> None:
    os.write(out, STATE.pack(system.time, system.state_hash(), time.monotonic()))


def told(pipe: int) -> list[tuple[float, int, float]]:
    data = b""
    while part := os.read(pipe, 1 << 16):
        data += part
    return [STATE.unpack_from(data, at) for at in range(0, len(data) - STATE.size + 1, STATE.size)]


def kill_at_random(folder: str, number: int, chance: random.Random) -> list[tuple[float, int, float]]:
    """The states that a process told before it was killed."""
    mine, others = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(mine)
        try:
            live(folder, number, others)
        finally:
            os._exit(1)
    os.close(others)
    # Some die while they come back, most at work.
    time.sleep(chance.choice((0.01, 0.02, 0.05, 0.1, 0.15)) * (0.5 + chance.random()))
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    seen = told(mine)
    os.close(mine)
    return seen


def main(folder: str, count: int, seed: int) -> None:
    """Until `count` worlds have come back."""
    chance = random.Random(seed)
    states: dict[tuple[float, int], float] = {}  # with the time of the clock at which each was reached last
    last = 0.0  # the time of the clock at the latest state
    lost: list[float] = []
    kills = worlds_lost = wrong = 0
    while len(lost) + worlds_lost + wrong < count:
        # A process that dies after it has kept its first state, and before it tells it, leaves a world that nobody knows.
        is_kept = bool(states) and any(Path(folder).glob("*.journal"))
        seen = kill_at_random(folder, seed * 1_000_003 + kills, chance)
        kills += 1
        if not seen:
            continue
        first = seen[0][:2]
        if first in states:
            lost.append(max(0.0, last - states[first]))
        elif is_kept and seen[0][0] == 0.0:
            worlds_lost += 1
        elif is_kept:
            wrong += 1
        states.update({(at, hash): clock for at, hash, clock in seen})
        last = seen[-1][2]
    median, most = statistics.median(lost), max(lost)
    counts = {"kills": kills, "back": len(lost), "worlds_lost": worlds_lost, "wrong": wrong}
    print(json.dumps(counts | {"lost_median": median, "lost_most": most}))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
