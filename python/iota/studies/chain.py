# SPDX-License-Identifier: Apache-2.0
"""A chain on a nail: drag it, break it with b, rejoin it with c; while nobody does, it falls apart and mends itself, as with t."""

from __future__ import annotations

import iota
from iota import looks
from iota.studies._stands import tripod
from iota.studies._story import Story

NAIL = (0.0, 2.1, 0.0)
LENGTH = 1.8
APART = 0.05  # m: the ends do not pass through each other before they are joined


def build(links: int = 24) -> iota.World:
    """The world of the study.

    Up to 500 links keep their energy; finer chains, whose links whirl faster than any eye, are stepped robustly."""
    system = iota.System(damping=0.05, mode="energy_keeping" if links <= 500 else "robust")
    chain = iota.builder.chain(links, LENGTH, top=NAIL, direction=(-0.2, -0.9, 0.35)).realize(system).bodies
    system.usual_material = iota.Material(friction=0.6, touches="obstacles")  # its parts are joined again
    world = iota.World(system, title=f"chain: {LENGTH:g} m to be pulled, broken and joined", style="chain")
    present(world, chain)

    world.offer("break", "join")
    script_break(world, chain)
    return world


def present(world: iota.World, chain: list[iota.Body]) -> None:
    """Two looks for the links, and the tripod that they hang from, before a wall."""
    link = LENGTH / len(chain)
    radius = min(0.03, 0.4 * link)
    world.draw(chain, {"rope": looks.capsule(radius, "rope"), "chain": looks.chain_link(link)})
    tripod(world, iota.Vec3(*NAIL))
    world.wall((0, 0, -1.3), (9.0, 3.4), color="#b4c2ba")
    world.stage(ground="#a98d70")
    world.camera = iota.Camera(position=(0.5, 1.35, 3.8), target=(0, 1.06, 0))


def script_break(world: iota.World, chain: list[iota.Body]) -> None:
    """Thesis 5.1.2, on request or while nobody touches it: the lower part falls off, is kept near by a force, pulled close by a second
    one, and rejoined."""
    cut = len(chain) * 2 // 3
    if cut == 0:
        return
    hook, eye = chain[cut - 1].particles[-1], chain[cut].particles[0]
    weight = 9.81 * sum(link.mass for link in chain[cut:])  # N, what the forces have to carry
    system = world.system

    def pull(bond: iota.types.BondState) -> iota.Vec3:
        return weight * min(10 * (bond.distance - APART), 2.5) * bond.direction

    def fall_off() -> None:
        if system.articulate_count > 1 or system.bonds:
            return  # somebody is at it, or it is under way
        hook.separate(eye)
        system.bond(hook, eye, "spring", stiffness=weight / 0.2, damping=weight / 3, length=APART)
        world.keep_state("fell", system.time)

    @world.on_step
    def mend() -> None:  # also after the process was killed meanwhile
        bonds = list(system.bonds)
        since = system.time - world.kept_state("fell", 0.0) if bonds else 0.0
        if len(bonds) == 1 and since >= 2.5 - 1e-9:
            system.bond(hook, eye, pull)
            system.bond(hook, eye, "drag", damping=weight / 2)
        elif since >= 4.0 - 1e-9:
            for bond in bonds:
                bond.destroy()
            if hook.body.articulate != eye.body.articulate:
                hook.combine(eye, over=0.4)

    story = Story(world, wait=8.0, first=4.0)
    story.at(0.0)(fall_off)
    story.at(5.0)(lambda: None)

    story.action("fall apart", key="t", help="the lower part falls off and is pulled back by forces")(fall_off)


if __name__ == "__main__":
    build().run()
