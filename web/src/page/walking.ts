// SPDX-License-Identifier: Apache-2.0
// The obstacles of a page's world, for walks and teleports.

import { Vector3 } from "three";
import { toBody } from "../interact/picking.ts";
import { bodyDistance, type PlacedShape } from "../scene/shapes/shape.ts";
import { Walls, type Solid, type Wall } from "../scene/walls.ts";
import type { World } from "../world/world.ts";

/** A static body without its meshes of triangles. */
class FixedBody implements Solid {
  slot = 0;
  shapes: readonly PlacedShape[] = [];
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
    return bodyDistance(this.shapes, this.local_[0], this.local_[1], this.local_[2]);
  }
}

const isMesh = ({ shape }: PlacedShape): boolean => shape.mesh !== null;

/** The static bodies: their shapes, and the surfaces that are drawn on them. */
export function wallsOf(world: World): Walls {
  // One object for all, as they are looked at one after the other.
  const solid = new FixedBody(world);
  const { body, surface } = world.entities;
  function* solids(): Iterable<Solid> {
    for (const slot of body.slots()) {
      if (!body.isFixed(slot) || !body.has(slot)) continue;
      const shapes = body.shapesOf(slot);
      if (shapes.every(isMesh)) continue;
      // A walk asks often: no new list for a body without meshes.
      solid.shapes = shapes.some(isMesh) ? shapes.filter((shape) => !isMesh(shape)) : shapes;
      solid.slot = slot;
      solid.reach = body.reach[slot];
      solid.middle.fromArray(body.position, 3 * slot);
      yield solid;
    }
  }
  function* meshes(): Iterable<Wall> {
    yield* body.fixedMeshes();
    yield* surface.fixed();
  }
  return new Walls(meshes, solids, () => world.ground);
}
