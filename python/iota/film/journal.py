# SPDX-License-Identifier: Apache-2.0
"""The last seconds of a journal as messages that a page plays, without the script: bodies have their usual looks."""

from __future__ import annotations

import struct
import time

from iota._core import Log, RoomRecording, System
from iota.film.files import Failed
from iota.journal.reader import Found
from iota.journal.records import Commands
from iota.world import World

PATIENCE = 2.0  # s, for the messages of a frame: a busy machine sends them late
POSES = 68  # type of the message
FRAME = 1 / 120  # s, between the frames of states that no time is known of


def messages_of(all_found: list[Found]) -> tuple[list[tuple[float, bytes]], bool]:
    """The messages with their times, s; and whether nothing is left out: without the script the world stands still from where
    one of its functions was needed until the next snapshot. Raises Failed for a snapshot of another version."""
    system = System()
    log = Log(system)
    try:
        system.restore(all_found[0].snapshot)
    except ValueError as error:
        raise Failed(str(error)) from None
    world = World(system, title=str(all_found[0].header.get("title", "")), ground=None)
    world.serve(port=0)
    try:
        publisher = world.pages._publisher
        assert publisher is not None
        recording = publisher.room.record(1e-6)
        messages: list[tuple[float, bytes]] = []
        now, is_whole = 0.0, True
        for found in all_found:
            system.restore(found.snapshot)
            messages += [(now, data) for data in frame_of(world, recording)]
            is_same = True
            for piece in found.pieces:
                now += max(piece.seconds, FRAME)
                is_same = is_same and is_repeated(system, log, piece)
                is_whole = is_whole and is_same
                if is_same:
                    messages += [(now, data) for data in frame_of(world, recording)]
        return messages, is_whole
    finally:
        world.close()


def is_repeated(system: System, log: Log, piece: Commands) -> bool:
    """Whether its commands led to the same state again."""
    try:
        log.repeat(piece.commands)
    except ValueError:
        return False
    return piece.leads_to(system)


def frame_of(world: World, recording: RoomRecording) -> list[bytes]:
    """The messages to viewers about the present state."""
    world.advance(0)
    return messages_to_viewers(recording, world.system.time)


def messages_to_viewers(recording: RoomRecording, time_now: float) -> list[bytes]:
    """The messages up to the poses of a time, s, with which a frame ends. The server sends them on its own thread."""
    end = time.monotonic() + PATIENCE
    taken: list[bytes] = []
    while not any(ends_at(data, time_now) for data in taken) and time.monotonic() < end:
        if not (more := [data for _, data in recording.take()]):
            time.sleep(0.0005)
        taken += more
    return taken


def ends_at(message: bytes, time_now: float) -> bool:
    """Whether it has the poses of a time or a later one."""
    return message[0] == POSES and float(struct.unpack_from("<d", message, 9)[0]) >= time_now
