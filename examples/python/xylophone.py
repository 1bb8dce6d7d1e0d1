# SPDX-License-Identifier: Apache-2.0
"""Marbles fall on five bars: a bar sounds when it is hit, the louder the harder, and the hits are counted."""

import numpy as np

import iota

NOTES = (523.25, 587.33, 659.25, 783.99, 880.0)  # Hz

system = iota.System()
world = iota.World(system, title="xylophone")
time = np.arange(22_050) / 44_100
marbles = system.group("marbles")
score = world.label("0 hits", at=(0, 1.2, 0))
hits = 0


def note_of(pitch):
    tone = world.drawings.sound(np.sin(2 * np.pi * pitch * time) * np.exp(-9 * time))

    def sound(event):
        global hits
        if event.phase == "start":
            hits += 1
            score.text = f"{hits} hits"
            tone.play(event.point, volume=min(1.0, event.contact.speed / 3))

    return sound


for i, pitch in enumerate(NOTES):
    bar = system.obstacle(iota.Box((0.16, 0.03, 0.5 - 0.05 * i)), (0.2 * (i - 2), 0.3, 0), material=iota.Material())
    world.on_contact(bar, marbles, min_speed=0.2, cooldown=0.05)(note_of(pitch))
for i in range(15):
    marble = system.body(shape=iota.Sphere(0.02), position=(0.2 * (i % 5 - 2), 0.6 + 0.11 * i, 0.03 * (i // 5 - 1)))
    marbles.add(marble.particles[0])
system.ignore_contacts(marbles, marbles)  # so that each one plays its tune undisturbed

world.run()
