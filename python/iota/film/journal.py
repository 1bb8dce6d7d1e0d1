# SPDX-License-Identifier: Apache-2.0
"""The last seconds of a journal as messages that a page plays, without the script: bodies have their usual looks."""

from __future__ import annotations

import time

from iota._core import Log, RoomRecording, System
from iota.film.files import Failed
from iota.journal.reader import Found
from iota.world import World

PATIENCE = 0.05  # s, for the messages of a frame
FRAME = 1 / 120  # s, between the frames of states that no time is known of


def messages_of(found: Found) -> tuple[list[tuple[float, bytes]], bool]:
    """The messages with their times, s, from the latest snapshot on; and whether they go on to the end. Without the script they end
    where one of its functions was needed. Raises Failed for a snapshot of another version."""
    system = System()
    log = Log(system)
    try:
        system.restore(found.snapshot)
    except ValueError as error:
        raise Failed(str(error)) from None
    world = World(system, title=str(found.header.get("title", "")), ground=None)
    world.serve(port=0)
    try:
        publisher = world.pages._publisher
        assert publisher is not None
        recording = publisher.room.record(1e-6)
        messages = [(0.0, data) for data in frame_of(world, recording)]
        now = 0.0
        for piece in found.pieces:
            try:
                log.repeat(piece.commands)
            except ValueError:
                return messages, False
            if piece.hash != system.state_hash():
                return messages, False
            now += max(piece.seconds, FRAME)
            messages += [(now, data) for data in frame_of(world, recording)]
        return messages, True
    finally:
        world.close()


def frame_of(world: World, recording: RoomRecording) -> list[bytes]:
    """The messages to viewers about the present state. The server sends them on its own thread."""
    world.advance(0)
    end = time.monotonic() + PATIENCE
    while not (taken := recording.take()) and time.monotonic() < end:
        time.sleep(0.0005)
    return [data for _, data in taken]
