# SPDX-License-Identifier: Apache-2.0
"""`World`: runs a system in real time and shows it on a page, where users act on it."""

from iota.arguments import explain
from iota.levels.level import Level, LevelChange
from iota.levels.managed import Managed
from iota.world.clients import Client
from iota.world.clock import Clock
from iota.world.controls import Controls
from iota.world.custom import Custom, Sound
from iota.world.drawings import Drawings
from iota.world.event import Event
from iota.world.events import Events
from iota.world.fixtures import Fixtures
from iota.world.levels import Levels
from iota.world.pages import Pages
from iota.world.queries import Queries
from iota.world.scene import Camera, Scene
from iota.world.server import Server
from iota.world.summary import RunSummary
from iota.world.survey import Survey
from iota.world.things import Frame
from iota.world.tools import Tools
from iota.world.users import Users
from iota.world.view import View
from iota.world.widgets import Button, Checkbox, Choice, Plot, Slider, TextField
from iota.world.world import World

__all__ = [
    "Camera",
    "Client",
    "Clock",
    "Controls",
    "Drawings",
    "Event",
    "Events",
    "Fixtures",
    "Level",
    "LevelChange",
    "Levels",
    "Managed",
    "Pages",
    "Queries",
    "RunSummary",
    "Scene",
    "Server",
    "Survey",
    "Tools",
    "Users",
    "View",
    "World",
]

explain(Scene, Drawings, Controls, Events, Tools, Fixtures, Queries, Users, Clock, Pages, Levels)
explain(Client, Custom, Sound, Frame, Button, Checkbox, Choice, Plot, Slider, TextField)
