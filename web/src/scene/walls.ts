// SPDX-License-Identifier: Apache-2.0
// Fixed shapes and bodies as obstacles for the camera and for teleports, and as floors. three-mesh-bvh finds the triangle next to a
// place among hundreds of thousands; bodies are felt by their distance functions.

import { DoubleSide, Ray, Vector3, type BufferGeometry, type Mesh } from "three";
import { MeshBVH, type HitPointInfo } from "three-mesh-bvh";

/** Triangles that stay where they are. */
export type Wall = Pick<Mesh, "geometry" | "position" | "quaternion">;

/** A body that stays where it is. */
export interface Solid {
  /** The middle of a ball around it, world, m, and its radius. */
  readonly middle: Vector3;
  readonly reach: number;
  /** The distance of a place of the world from the surface, m, negative inside; its slope is at most 1. */
  distance(x: number, y: number, z: number): number;
}

/** The first wall on a way. */
export interface Obstacle {
  /** The part of the way up to it; 1: nothing is met. */
  share: number;
  /** Its normal, towards where the way came from. */
  readonly normal: Vector3;
}

/** A corner between walls pushes from several sides. */
const mostPushes = 4;
/** A floor that is higher or lower than the last one by this much is climbed, m; in a small world, by so many radii of the walker. */
const stair = 0.4;
const stairRadii = 4;
/** Users whose eyes are higher over the floor than this look from above, and do not fall off edges, m; in a small world, radii. */
const tallest = 2.5;
const tallestRadii = 40;
/** How far below the eyes a floor is looked for where there is no ground, m. */
const deepestFloor = 50;
const mostTraces = 200;

export class Walls {
  private readonly meshes_: () => Iterable<Wall>;
  private readonly solids_: () => Iterable<Solid>;
  private readonly ground_: () => number | null;
  /** Built for a geometry when somebody comes near it first. */
  private readonly trees_ = new WeakMap<BufferGeometry, MeshBVH>();
  private readonly at_ = new Vector3();
  private readonly local_ = new Vector3();
  private readonly before_ = new Vector3();
  private readonly slope_ = new Vector3();
  private readonly below_ = new Vector3();
  private readonly ray_ = new Ray();
  private readonly nearest_: HitPointInfo = { point: new Vector3(), distance: 0, faceIndex: 0 };
  private readonly floor_: Obstacle = { share: 1, normal: new Vector3() };

  /** `ground`: its height, m; null: none. */
  constructor(meshes: () => Iterable<Wall>, solids: () => Iterable<Solid> = () => [], ground: () => number | null = () => null) {
    this.meshes_ = meshes;
    this.solids_ = solids;
    this.ground_ = ground;
  }

  /** Shortens and bends `way` so that a ball of `radius` m that goes it from `from` slides along walls, and keeps its height over
   * stairs. Whether it leads over an edge: the floor at its end is lower than by a stair. */
  slide(from: Vector3, way: Vector3, radius: number): boolean {
    const { at_: at } = this;
    const floor = this.floorBelow(from);
    // Shorter than the radius, a step cannot jump over a wall.
    const steps = Math.max(1, Math.ceil((2 * way.length()) / radius));
    at.copy(from);
    for (let step = 0; step < steps; step++) {
      this.before_.copy(at);
      at.addScaledVector(way, 1 / steps);
      if (!this.pushOut_(at, radius)) at.copy(this.before_);
    }
    const rise = this.floorBelow(at) - floor;
    if (Math.abs(rise) <= 1.001 * Math.min(stair, stairRadii * radius) && this.hasRoom_(this.before_.copy(at).setY(at.y + rise), radius)) at.y += rise;
    way.subVectors(at, from);
    return Number.isFinite(rise) && rise < -1.001 * Math.min(stair, stairRadii * radius) && from.y - floor <= Math.min(tallest, tallestRadii * radius);
  }

  /** Height of what one stands on at a place, m; -Infinity: nothing. */
  floorBelow(place: Vector3): number {
    const ground = this.ground_() ?? -Infinity;
    const depth = Math.min(place.y - ground, deepestFloor);
    if (!(depth > 0)) return ground;
    const { share } = this.meet(place, this.below_.copy(place).setY(place.y - depth), this.floor_);
    return share < 1 ? place.y - share * depth : ground;
  }

  /** The first thing on the straight way between two places. */
  meet(from: Vector3, to: Vector3, out: Obstacle): Obstacle {
    const length = from.distanceTo(to);
    out.share = 1;
    if (length === 0) return out;
    for (const mesh of this.meshes_()) this.meetMesh_(mesh, from, to, length, out);
    for (const solid of this.solids_()) this.meetSolid_(solid, from, to, length, out);
    return out;
  }

  private meetMesh_({ geometry, position, quaternion }: Wall, from: Vector3, to: Vector3, length: number, out: Obstacle): void {
    const { ray_: { origin, direction }, ray_: ray } = this;
    const back = quaternion.clone().conjugate();
    origin.subVectors(from, position).applyQuaternion(back);
    direction.subVectors(to, from).divideScalar(length).applyQuaternion(back);
    const hit = this.treeOf_(geometry).raycastFirst(ray, DoubleSide, 0, out.share * length);
    if (hit === null) return;
    out.share = hit.distance / length;
    if (hit.face != null) out.normal.copy(hit.face.normal).multiplyScalar(hit.face.normal.dot(direction) > 0 ? -1 : 1).applyQuaternion(quaternion);
  }

  /** Goes as far as the distance allows, which never passes the surface. */
  private meetSolid_(solid: Solid, from: Vector3, to: Vector3, length: number, out: Obstacle): void {
    const close = 1e-4 * length;
    const at = this.local_;
    for (let gone = 0, trace = 0; gone < out.share * length && trace < mostTraces; trace++) {
      at.copy(from).lerp(to, gone / length);
      // Far away its ball is enough.
      const apart = at.distanceTo(solid.middle) - solid.reach;
      const distance = apart > 2 * close ? apart : solid.distance(at.x, at.y, at.z);
      if (distance < close) {
        out.share = gone / length;
        this.slopeOf_(solid, at, close, out.normal);
        return;
      }
      gone += distance;
    }
  }

  private slopeOf_(solid: Solid, { x, y, z }: Vector3, step: number, out: Vector3): void {
    const here = solid.distance(x, y, z);
    out.set(solid.distance(x + step, y, z) - here, solid.distance(x, y + step, z) - here, solid.distance(x, y, z + step) - here).normalize();
  }

  /** Moves a ball out of the walls that it touches; false if there is no room for it. */
  private pushOut_(at: Vector3, radius: number): boolean {
    for (let push = 0; push < mostPushes; push++) {
      let touches = false;
      for (const mesh of this.meshes_()) touches = this.pushOutOf_(mesh, at, radius) || touches;
      for (const solid of this.solids_()) touches = this.pushOutOfSolid_(solid, at, radius) || touches;
      if (!touches) return true;
    }
    return false;
  }

  private hasRoom_(at: Vector3, radius: number): boolean {
    return this.pushOut_(this.below_.copy(at), radius) && this.below_.distanceTo(at) < 0.01 * radius;
  }

  private pushOutOf_({ geometry, position, quaternion }: Wall, at: Vector3, radius: number): boolean {
    const { local_: local, nearest_: nearest } = this;
    local.subVectors(at, position).applyQuaternion(quaternion.clone().conjugate());
    if (geometry.boundingBox === null) geometry.computeBoundingBox();
    if (geometry.boundingBox!.distanceToPoint(local) >= radius) return false;
    const tree = this.treeOf_(geometry);
    if (tree.closestPointToPoint(local, nearest, 0, radius) === null || nearest.distance >= 0.999 * radius) return false;
    local.sub(nearest.point);
    // Exactly on a wall there is no direction away from it.
    if (nearest.distance < 1e-6 * radius) return false;
    at.add(local.multiplyScalar(radius / nearest.distance - 1).applyQuaternion(quaternion));
    return true;
  }

  private pushOutOfSolid_(solid: Solid, at: Vector3, radius: number): boolean {
    if (at.distanceTo(solid.middle) - solid.reach >= radius) return false;
    const distance = solid.distance(at.x, at.y, at.z);
    if (distance >= 0.999 * radius) return false;
    this.slopeOf_(solid, at, 1e-3 * radius, this.slope_);
    // In the very middle of a ball no direction leads out.
    if (this.slope_.lengthSq() === 0) return false;
    at.addScaledVector(this.slope_, radius - distance);
    return true;
  }

  private treeOf_(geometry: BufferGeometry): MeshBVH {
    let tree = this.trees_.get(geometry);
    if (tree === undefined) this.trees_.set(geometry, (tree = new MeshBVH(geometry, { indirect: true })));
    return tree;
  }
}
