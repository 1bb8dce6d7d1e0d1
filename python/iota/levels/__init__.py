# SPDX-License-Identifier: Apache-2.0
"""Things that are simulated less while that saves time, and what they do meanwhile; knows no world. `iota.world.levels` is the part of a world."""
