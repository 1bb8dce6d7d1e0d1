// SPDX-License-Identifier: Apache-2.0
// Draws what ties bodies together: springs as coils that stretch, ropes that sag when they are slack, rods.
// A tie moves with its two ends, so nothing is sent for it but once.

import { Group, InstancedBufferAttribute, InstancedMesh, Matrix4, Quaternion, Vector3, type BufferGeometry } from "three";
import { materialOf } from "./materials.ts";
import type { PoseBuffer } from "./pose_buffer.ts";
import { makeCoil } from "./shapes/coil.ts";
import { makeGeometry, sizeOf, type Shape } from "./shapes/shape.ts";
import { shapeKind } from "./shapes/shape_list.ts";
import type { Change, TieEnd, TieEntry, WorldModel } from "./world_model.ts";

/** Pieces of a rope: straight ones, that lie along a parabola when it is slack. */
const ropePieces = 12;

/** All ties of one class. */
interface Batch {
  readonly mesh: InstancedMesh;
  readonly ties: readonly TieEntry[];
  readonly pieces: number;
  /** That the geometry was made for, m. */
  readonly length: number;
}

const along = new Vector3(1, 0, 0);

export class TieView {
  readonly root = new Group();

  private readonly model_: WorldModel;
  private readonly poses_: PoseBuffer;
  private batches_: Batch[] = [];
  private stale_ = false;
  private readonly from_ = new Vector3();
  private readonly to_ = new Vector3();
  private readonly start_ = new Vector3();
  private readonly end_ = new Vector3();
  private readonly direction_ = new Vector3();
  private readonly size_ = new Vector3();
  private readonly turn_ = new Quaternion();
  private readonly matrix_ = new Matrix4();

  constructor(model: WorldModel, poses: PoseBuffer) {
    this.model_ = model;
    this.poses_ = poses;
  }

  changed(what: Change | string): void {
    if (what === "ties" || what === "bodies" || what === "look") this.stale_ = true;
  }

  update(): void {
    if (this.stale_) this.rebuild(this.model_.look);
    this.stale_ = false;
  }

  /** Builds meshes anew after ties, classes or the look changed. */
  rebuild(look: string): void {
    for (const batch of this.batches_) {
      this.root.remove(batch.mesh);
      batch.mesh.geometry.dispose();
      batch.mesh.dispose();
    }
    this.batches_ = [];
    for (const [className, ties] of this.model_.tiesByClass()) {
      const shape = this.model_.shapesOfClass(className, look).at(0);
      if (shape !== undefined) this.addBatch_(ties, shape);
    }
  }

  draw(): void {
    for (const batch of this.batches_) {
      batch.ties.forEach((tie, index) => this.place_(batch, tie, index));
      batch.mesh.instanceMatrix.needsUpdate = true;
    }
  }

  private addBatch_(ties: readonly TieEntry[], shape: Shape): void {
    const rope = ties[0].kind === "rope";
    const pieces = rope ? ropePieces : 1;
    const radius = sizeOf(shape, "radius");
    const length = Math.max(ties[0].length / pieces, 2 * radius);
    const straight = (): BufferGeometry =>
      makeGeometry({ ...shape, kind: shapeKind(rope ? "capsule" : "cylinder"), sizes: [radius, length] }, "coarse");
    // A spring's look is one turn of it: a ring with its wire.
    const wire = sizeOf(shape, "tube") || 0.15 * radius;
    const geometry = ties[0].kind === "spring" ? makeCoil(radius, wire, length) : straight();
    const count = ties.length * pieces;
    geometry.setAttribute("tint", new InstancedBufferAttribute(new Float32Array(4 * count), 4));
    const mesh = new InstancedMesh(geometry, materialOf(shape.material, shape.color), count);
    mesh.frustumCulled = false;
    mesh.castShadow = mesh.receiveShadow = true;
    this.batches_.push({ mesh, ties, pieces, length });
    this.root.add(mesh);
  }

  private place_(batch: Batch, tie: TieEntry, index: number): void {
    const shown = this.end_of_(tie.a, this.from_) && this.end_of_(tie.b, this.to_);
    const slack = tie.kind === "rope" ? Math.max(0, tie.length - this.from_.distanceTo(this.to_)) : 0;
    // Depth of the parabola of that length over a level span; steep spans hang a little too deep, and nobody minds.
    const sag = Math.sqrt(0.375 * slack * tie.length);
    this.start_.copy(this.from_);
    for (let piece = 1; piece <= batch.pieces; piece++) {
      const t = piece / batch.pieces;
      this.end_.lerpVectors(this.from_, this.to_, t);
      this.end_.y -= 4 * sag * t * (1 - t);
      this.direction_.subVectors(this.end_, this.start_);
      const length = this.direction_.length();
      if (shown && length > 1e-9) {
        this.turn_.setFromUnitVectors(along, this.direction_.divideScalar(length));
        this.start_.add(this.end_).multiplyScalar(0.5);
        this.matrix_.compose(this.start_, this.turn_, this.size_.set(length / batch.length, 1, 1));
      } else {
        this.matrix_.makeScale(0, 0, 0);
      }
      batch.mesh.setMatrixAt(index * batch.pieces + piece - 1, this.matrix_);
      this.start_.copy(this.end_);
    }
  }

  /** World place of an end; false where its body is not known yet. */
  private end_of_(end: TieEnd, out: Vector3): boolean {
    out.set(end.point[0], end.point[1], end.point[2]);
    if (end.body === null) return true;
    if (this.poses_.known[end.body] !== 1) return false;
    const { position, rotation } = this.poses_;
    this.turn_.fromArray(rotation, 4 * end.body);
    out.applyQuaternion(this.turn_);
    out.x += position[3 * end.body];
    out.y += position[3 * end.body + 1];
    out.z += position[3 * end.body + 2];
    return true;
  }
}
