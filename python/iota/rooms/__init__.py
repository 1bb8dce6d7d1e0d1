# SPDX-License-Identifier: Apache-2.0
"""Worlds that are kept, each in a process of its own, with a page that lists them: `iota rooms`.

folder: the files of a room. room: what its process does. nursery: makes these processes fast. process: how
`iota rooms` starts and watches one. cluster: the same on other machines. serving: all of them, and their page.
"""

from iota.rooms.cluster import Cluster
from iota.rooms.serving import Rooms

__all__ = ["Cluster", "Rooms"]
