# SPDX-License-Identifier: Apache-2.0
"""A row of cubes beside a high panel, actions for a selected body, and a key for six cards, for browser tests."""

from __future__ import annotations

import iota


def build() -> iota.World:
    system = iota.System()
    for k in range(6):
        system.body(shape=iota.Box((0.3, 0.3, 0.3)), mass=1.0, position=(0.5 * k, 0.15, 0))
    world = iota.World(system, title="cover", ground=0.0)
    world.offer("break", "join", "copy", "measure", "undo", "redo", "rewind")
    world.controls.button("A label of a button that tells in great detail all that the button does")(lambda: None)
    for k in range(6):
        world.controls.slider(f"value {k}", 0, 1)

    @world.on_key("6")
    def tell() -> None:
        for k in range(6):
            world.users.notice(f"Card {k}", "A text of two sentences, as a lesson has it. It says why, in plain words. " * 2, seconds=60)

    return world


if __name__ == "__main__":
    build().run()
