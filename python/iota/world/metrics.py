# SPDX-License-Identifier: Apache-2.0
"""The figures of a served world, for `/metrics`."""

from __future__ import annotations

from collections import Counter

from iota._core import ServerStatistics
from iota.metrics import Metric, one
from iota.world.state import State


def of_world(state: State, statistics: ServerStatistics) -> list[Metric]:
    """On the thread that runs the world."""
    clock, system = state.clock, state.system
    roles = Counter(client.role for client in state.clients.by_id.values())
    people = [({"role": role}, float(roles[role])) for role in ("host", "guest", "viewer")]
    return [
        one("iota_world_time_seconds", "gauge", "Simulated time.", system.time),
        one("iota_world_paused", "gauge", "1 while it is paused.", clock.paused),
        one("iota_world_speed", "gauge", "Simulated seconds in a second, as asked for.", clock.speed),
        one(
            "iota_world_reached_speed",
            "gauge",
            "The share of it that is reached; below 1: slow motion.",
            clock.reached_speed,
        ),
        one("iota_step_seconds", "gauge", "Time of a step, smoothed.", state.step_ms / 1e3),
        one("iota_steps_total", "counter", "Steps of the system.", system.step_count),
        one("iota_bodies", "gauge", "Bodies that are simulated.", len(system.bodies)),
        Metric("iota_people", "gauge", "Open pages.", people),
        one("iota_sent_bytes_total", "counter", "Sent to pages.", statistics.bytes_sent),
        one("iota_sent_frames_total", "counter", "Sent to pages.", statistics.frames_sent),
        one("iota_dropped_frames_total", "counter", "Poses that slow pages did not get.", statistics.frames_dropped),
        one(
            "iota_dropped_clients_total",
            "counter",
            "Pages that were let go, silent or too slow.",
            statistics.clients_dropped,
        ),
        one("iota_refused_requests_total", "counter", "Wrong token, Host or Origin.", statistics.upgrades_refused),
        one("iota_refused_frames_total", "counter", "Messages of pages that made no sense.", statistics.frames_refused),
    ]
