// SPDX-License-Identifier: Apache-2.0
// The obstacles of a page's world, for walks and teleports.

import { Vector3, type Mesh } from "three";
import { toBody } from "../interact/picking.ts";
import { bodyDistance } from "../scene/shapes/shape.ts";
import { Walls, type Solid } from "../scene/walls.ts";
import type { World } from "../world/world.ts";

class FixedBody implements Solid {
  slot = 0;
  reach = 0;
  readonly middle = new Vector3();
  private readonly world_: World;
  private readonly local_ = new Float32Array(3);

  constructor(world: World) {
    this.world_ = world;
  }

  distance(x: number, y: number, z: number): number {
    const { body } = this.world_.entities;
    toBody(body, this.slot, x, y, z, this.local_);
    return bodyDistance(body.shapesOf(this.slot), this.local_[0], this.local_[1], this.local_[2]);
  }
}

/** Everything that is fixed: shapes and surfaces without physics, and static bodies. */
export function wallsOf(world: World): Walls {
  // One object for all, as they are looked at one after the other.
  const solid = new FixedBody(world);
  const { body, staticShape, surface } = world.entities;
  function* solids(): Iterable<Solid> {
    for (const slot of body.slots()) {
      if (!body.isFixed(slot) || !body.has(slot)) continue;
      solid.slot = slot;
      solid.reach = body.reach[slot];
      solid.middle.fromArray(body.position, 3 * slot);
      yield solid;
    }
  }
  function* meshes(): Iterable<Mesh> {
    yield* staticShape.meshes();
    yield* surface.fixed();
  }
  return new Walls(meshes, solids, () => world.ground);
}
