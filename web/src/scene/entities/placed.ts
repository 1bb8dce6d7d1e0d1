// SPDX-License-Identifier: Apache-2.0
// Shapes without physics, each at a place of its own: one pool of instances for all with equal looks.

import { Group, Matrix4 } from "three";
import type { Part } from "../../protocol/generated.ts";
import { InstancePool } from "../instance_pool.ts";
import { materialOf } from "../materials.ts";
import { readPart } from "../parts.ts";
import { addCorners, boxOfGeometry, type Points } from "../points.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import { makeGeometry } from "../shapes/shape.ts";
import type { Entity, EntityView } from "./entity.ts";

interface Shown<Record> {
  entity: Record;
  readonly look: string;
  readonly pool: InstancePool;
  index: number;
}

export abstract class Placed<Record extends Entity & { readonly part: Part }> implements EntityView<Record> {
  readonly root = new Group();

  protected readonly poses_: PoseBuffer;
  private readonly warn_: (title: string, text: string) => void;
  private readonly shown_ = new Map<number, Shown<Record>>();
  private readonly pools_ = new Map<string, InstancePool>();
  private readonly matrix_ = new Matrix4();
  private readonly changed_ = new Set<InstancePool>();

  /** `warn` is called for a shape that cannot be drawn. */
  constructor(poses: PoseBuffer, warn: (title: string, text: string) => void) {
    this.poses_ = poses;
    this.warn_ = warn;
  }

  create(entity: Record): void {
    const look = lookOf(entity.part);
    try {
      const pool = this.pools_.get(look) ?? this.makePool_(look, entity);
      const shown = { entity, look, pool, index: pool.add(entity.id.slot) };
      this.shown_.set(entity.id.slot, shown);
      this.placeNow_(shown);
    } catch (error) {
      this.warn_("A shape cannot be drawn", error instanceof Error ? error.message : String(error));
    }
  }

  change(entity: Record): void {
    const shown = this.shown_.get(entity.id.slot);
    if (shown?.look === lookOf(entity.part)) {
      shown.entity = entity;
      this.placeNow_(shown);
      return;
    }
    this.remove_(entity.id.slot);
    this.create(entity);
  }

  destroy(slot: number): void {
    this.remove_(slot);
  }

  draw(): void {
    for (const shown of this.shown_.values()) if (this.isAttached_(shown.entity)) this.placeNow_(shown);
    for (const pool of this.changed_) pool.upload();
    this.changed_.clear();
  }

  /** Corners of those in the world. */
  addPlaces(points: Points): void {
    for (const { entity, pool, index } of this.shown_.values()) {
      if (this.isAttached_(entity)) continue;
      pool.mesh.getMatrixAt(index, this.matrix_);
      addCorners(points, boxOfGeometry(pool.mesh.geometry), this.matrix_);
    }
  }

  /** Its drawn place; false if it is not drawn. */
  protected abstract place_(entity: Record, out: Matrix4): boolean;

  /** Whether it may move without a new record. */
  protected abstract isAttached_(entity: Record): boolean;

  private remove_(slot: number): void {
    const shown = this.shown_.get(slot);
    if (shown === undefined) return;
    this.shown_.delete(slot);
    const { pool, index, look } = shown;
    const moved = this.shown_.get(pool.remove(index));
    if (moved !== undefined) moved.index = index;
    this.changed_.add(pool);
    if (pool.count > 0) return;
    pool.dispose();
    this.pools_.delete(look);
    this.changed_.delete(pool);
  }

  private placeNow_({ entity, pool, index }: Shown<Record>): void {
    if (!this.place_(entity, this.matrix_)) this.matrix_.makeScale(0, 0, 0);
    pool.mesh.setMatrixAt(index, this.matrix_);
    this.changed_.add(pool);
  }

  private makePool_(look: string, { part }: Record): InstancePool {
    const shape = readPart(part);
    const pool = new InstancePool(makeGeometry(shape, "fine"), materialOf(shape), 4).addTo(this.root);
    this.pools_.set(look, pool);
    return pool;
  }
}

function lookOf({ shape, material, color }: Part): string {
  return JSON.stringify([shape.kind, [...shape.sizes], [...shape.vertices], [...shape.triangles], material, color]);
}
