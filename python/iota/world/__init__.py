# SPDX-License-Identifier: Apache-2.0
"""`World`: a system in real time, on a page, in users' hands."""

from iota.world.event import Event
from iota.world.hands import Client
from iota.world.scene import Camera
from iota.world.server import Server
from iota.world.summary import RunSummary
from iota.world.world import World

__all__ = ["Camera", "Client", "Event", "RunSummary", "Server", "World"]
