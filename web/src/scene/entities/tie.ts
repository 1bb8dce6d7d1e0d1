// SPDX-License-Identifier: Apache-2.0
// Draws springs as coils that stretch, ropes that sag when slack, and rods. A tie moves with its two ends, so it is
// sent only once.

import { Group, Matrix4, Quaternion, Vector3, type BufferGeometry } from "three";
import { TieKind, type TieEntity } from "../../protocol/generated.ts";
import { placeOf } from "../anchors.ts";
import { InstancePool } from "../instance_pool.ts";
import { materialOf } from "../materials.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import { makeCoil } from "../shapes/coil.ts";
import { makeGeometry, sizeOf, withSize, type Shape } from "../shapes/shape.ts";
import { shapeKind } from "../shapes/shape_list.ts";
import type { EntityView } from "./entity.ts";
import type { Visuals, VisualUser } from "./visual.ts";

/** Straight pieces of a rope, along a parabola when it is slack. */
const ropePieces = 12;

/** All ties of one kind and visual. */
interface Batch {
  readonly visual: number;
  readonly pool: InstancePool;
  /** Length of the geometry, m. */
  readonly length: number;
}

interface Tie {
  entity: TieEntity;
  /** Null: its visual has no shape. */
  batch: Batch | null;
  index: number;
}

const along = new Vector3(1, 0, 0);

/** A torus is one turn of a spring's coil, and an ellipsoid reaches from end to end; with any other shape a tie is a thread. */
function geometryOf(shape: Shape, kind: TieKind, radius: number, length: number): BufferGeometry {
  if (kind === TieKind.rope) return makeGeometry({ ...shape, kind: shapeKind("capsule"), sizes: [radius, length] }, "coarse");
  if (kind === TieKind.spring && shape.kind.name === "torus") return makeCoil(radius, sizeOf(shape, "tube") || 0.15 * radius, length);
  if (shape.kind.name === "ellipsoid") return makeGeometry(withSize(shape, "size_x", length), "coarse");
  return makeGeometry({ ...shape, kind: shapeKind("cylinder"), sizes: [radius, length, 0] }, "tiny");
}

export class TieView implements EntityView<TieEntity>, VisualUser {
  readonly root = new Group();

  private readonly poses_: PoseBuffer;
  private readonly visuals_: Visuals;
  private readonly ties_ = new Map<number, Tie>();
  /** By visual and kind. */
  private readonly batches_ = new Map<string, Batch>();
  private readonly from_ = new Vector3();
  private readonly to_ = new Vector3();
  private readonly start_ = new Vector3();
  private readonly end_ = new Vector3();
  private readonly direction_ = new Vector3();
  private readonly size_ = new Vector3();
  private readonly turn_ = new Quaternion();
  private readonly matrix_ = new Matrix4();

  constructor(poses: PoseBuffer, visuals: Visuals) {
    this.poses_ = poses;
    this.visuals_ = visuals;
    visuals.addUser(this);
  }

  // --- EntityView

  create(entity: TieEntity): void {
    const tie: Tie = { entity, batch: null, index: 0 };
    this.ties_.set(entity.id.slot, tie);
    this.add_(tie);
  }

  change(entity: TieEntity): void {
    const tie = this.ties_.get(entity.id.slot);
    if (tie === undefined) return;
    this.remove_(tie);
    tie.entity = entity;
    this.add_(tie);
  }

  destroy(slot: number): void {
    const tie = this.ties_.get(slot);
    if (tie === undefined) return;
    this.remove_(tie);
    this.ties_.delete(slot);
  }

  draw(): void {
    for (const tie of this.ties_.values()) if (tie.batch !== null) this.placePieces_(tie, tie.batch);
    for (const { pool } of this.batches_.values()) pool.upload();
  }

  // --- VisualUser

  redraw(visual: number): void {
    for (const [key, batch] of this.batches_) if (batch.visual === visual) this.dispose_(key, batch);
    for (const tie of this.ties_.values()) if (tie.entity.visual === visual) this.add_(tie);
  }

  redrawAll(): void {
    for (const [key, batch] of this.batches_) this.dispose_(key, batch);
    for (const tie of this.ties_.values()) this.add_(tie);
  }

  // --- inside

  private add_(tie: Tie): void {
    const { id, visual, kind } = tie.entity;
    const shape = this.visuals_.shapesOf(visual).at(0);
    tie.batch = null;
    if (shape === undefined) return;
    const key = `${visual} ${kind}`;
    tie.batch = this.batches_.get(key) ?? this.makeBatch_(tie.entity, shape);
    this.batches_.set(key, tie.batch);
    tie.index = tie.batch.pool.add(id.slot);
  }

  private remove_({ batch, index }: Tie): void {
    if (batch === null) return;
    const moved = this.ties_.get(batch.pool.remove(index));
    if (moved !== undefined) moved.index = index;
  }

  private makeBatch_({ kind, visual, length: atRest }: TieEntity, shape: Shape): Batch {
    const rope = kind === TieKind.rope;
    const pieces = rope ? ropePieces : 1;
    const radius = sizeOf(shape, "radius");
    const length = Math.max(atRest / pieces, 2 * radius, sizeOf(shape, "size_y"));
    const pool = new InstancePool(geometryOf(shape, kind, radius, length), materialOf(shape), 16, pieces).addTo(this.root);
    return { visual, pool, length };
  }

  private dispose_(key: string, batch: Batch): void {
    batch.pool.dispose();
    this.batches_.delete(key);
  }

  private placePieces_({ entity, index }: Tie, { pool: { mesh, pieces }, length: madeFor }: Batch): void {
    const shown = placeOf(this.poses_, entity.a, this.from_) && placeOf(this.poses_, entity.b, this.to_);
    const slack = entity.kind === TieKind.rope ? Math.max(0, entity.length - this.from_.distanceTo(this.to_)) : 0;
    // Depth of the parabola of that length over a level span. Steep spans sag a little too much, which is not visible.
    const sag = Math.sqrt(0.375 * slack * entity.length);
    this.start_.copy(this.from_);
    for (let piece = 1; piece <= pieces; piece++) {
      const t = piece / pieces;
      this.end_.lerpVectors(this.from_, this.to_, t);
      this.end_.y -= 4 * sag * t * (1 - t);
      this.direction_.subVectors(this.end_, this.start_);
      const length = this.direction_.length();
      if (shown && length > 1e-9) {
        this.turn_.setFromUnitVectors(along, this.direction_.divideScalar(length));
        this.start_.add(this.end_).multiplyScalar(0.5);
        this.matrix_.compose(this.start_, this.turn_, this.size_.set(length / madeFor, 1, 1));
      } else {
        this.matrix_.makeScale(0, 0, 0);
      }
      mesh.setMatrixAt(index * pieces + piece - 1, this.matrix_);
      this.start_.copy(this.end_);
    }
  }
}
