// SPDX-License-Identifier: Apache-2.0
// Fixed shapes as obstacles for the camera. three-mesh-bvh finds the triangle next to a place among hundreds of thousands.

import { Vector3, type BufferGeometry, type Mesh } from "three";
import { MeshBVH, type HitPointInfo } from "three-mesh-bvh";

/** A corner between walls pushes from several sides. */
const mostPushes = 4;

export class Walls {
  private readonly meshes_: () => Iterable<Mesh>;
  /** Built for a geometry when somebody comes near it first. */
  private readonly trees_ = new WeakMap<BufferGeometry, MeshBVH>();
  private readonly at_ = new Vector3();
  private readonly local_ = new Vector3();
  private readonly before_ = new Vector3();
  private readonly nearest_: HitPointInfo = { point: new Vector3(), distance: 0, faceIndex: 0 };

  constructor(meshes: () => Iterable<Mesh>) {
    this.meshes_ = meshes;
  }

  /** Shortens and bends `way` so that a ball of `radius` m that goes it from `from` slides along walls. */
  slide(from: Vector3, way: Vector3, radius: number): void {
    const { at_: at } = this;
    // Shorter than the radius, a step cannot jump over a wall.
    const steps = Math.max(1, Math.ceil((2 * way.length()) / radius));
    at.copy(from);
    for (let step = 0; step < steps; step++) {
      this.before_.copy(at);
      at.addScaledVector(way, 1 / steps);
      if (!this.pushOut_(at, radius)) at.copy(this.before_);
    }
    way.subVectors(at, from);
  }

  /** Moves a ball out of the walls that it touches; false if there is no room for it. */
  private pushOut_(at: Vector3, radius: number): boolean {
    for (let push = 0; push < mostPushes; push++) {
      let touches = false;
      for (const mesh of this.meshes_()) touches = this.pushOutOf_(mesh, at, radius) || touches;
      if (!touches) return true;
    }
    return false;
  }

  private pushOutOf_({ geometry, position, quaternion }: Mesh, at: Vector3, radius: number): boolean {
    const { local_: local, nearest_: nearest } = this;
    local.subVectors(at, position).applyQuaternion(quaternion.clone().conjugate());
    if (geometry.boundingBox === null) geometry.computeBoundingBox();
    if (geometry.boundingBox!.distanceToPoint(local) >= radius) return false;
    let tree = this.trees_.get(geometry);
    if (tree === undefined) this.trees_.set(geometry, (tree = new MeshBVH(geometry, { indirect: true })));
    if (tree.closestPointToPoint(local, nearest, 0, radius) === null || nearest.distance >= 0.999 * radius) return false;
    local.sub(nearest.point);
    // Exactly on a wall there is no direction away from it.
    if (nearest.distance < 1e-6 * radius) return false;
    at.add(local.multiplyScalar(radius / nearest.distance - 1).applyQuaternion(quaternion));
    return true;
  }
}
