# SPDX-License-Identifier: Apache-2.0
"""`World`: runs a system in real time and shows it on a page, where users act on it."""

from iota.arguments import explain
from iota.world.clients import Client
from iota.world.custom import Custom, Sound
from iota.world.event import Event
from iota.world.scene import Camera
from iota.world.server import Server
from iota.world.summary import RunSummary
from iota.world.things import Frame
from iota.world.view import View
from iota.world.widgets import Button, Checkbox, Choice, Plot, Slider, TextField
from iota.world.world import World

__all__ = ["Camera", "Client", "Event", "RunSummary", "Server", "View", "World"]

explain(Client, Custom, Sound, Frame, Button, Checkbox, Choice, Plot, Slider, TextField)
