// SPDX-License-Identifier: Apache-2.0
// Shapes of the script that are only drawn, on bodies or in the world: one pool for all that look alike.

import { Group, Matrix4, Quaternion, Vector3 } from "three";
import { NO_BODY, type MarkerEntity } from "../../protocol/generated.ts";
import { turnOf } from "../anchors.ts";
import { InstancePool } from "../instance_pool.ts";
import { materialOf } from "../materials.ts";
import { readPart } from "../parts.ts";
import { addCorners, type Points } from "../points.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import { makeGeometry } from "../shapes/shape.ts";
import type { EntityView } from "./entity.ts";

interface Marker {
  entity: MarkerEntity;
  readonly look: string;
  readonly pool: InstancePool;
  index: number;
}

const unit = new Vector3(1, 1, 1);

export class MarkerView implements EntityView<MarkerEntity> {
  readonly root = new Group();

  private readonly poses_: PoseBuffer;
  private readonly warn_: (title: string, text: string) => void;
  private readonly markers_ = new Map<number, Marker>();
  private readonly pools_ = new Map<string, InstancePool>();
  private readonly place_ = new Vector3();
  private readonly turn_ = new Quaternion();
  private readonly own_ = new Quaternion();
  private readonly matrix_ = new Matrix4();
  private readonly changed_ = new Set<InstancePool>();

  /** `warn` is called for a shape that cannot be drawn. */
  constructor(poses: PoseBuffer, warn: (title: string, text: string) => void) {
    this.poses_ = poses;
    this.warn_ = warn;
  }

  create(entity: MarkerEntity): void {
    const { shape, material, color } = entity.part;
    const look = JSON.stringify([shape.kind, [...shape.sizes], [...shape.vertices], [...shape.triangles], material, color]);
    try {
      const pool = this.pools_.get(look) ?? this.makePool_(look, entity);
      const marker: Marker = { entity, look, pool, index: pool.add(entity.id.slot) };
      this.markers_.set(entity.id.slot, marker);
      this.placeNow_(marker);
    } catch (error) {
      this.warn_("A shape cannot be drawn", error instanceof Error ? error.message : String(error));
    }
  }

  change(entity: MarkerEntity): void {
    this.destroy(entity.id.slot);
    this.create(entity);
  }

  destroy(slot: number): void {
    const marker = this.markers_.get(slot);
    if (marker === undefined) return;
    this.markers_.delete(slot);
    const { pool, index, look } = marker;
    const moved = this.markers_.get(pool.remove(index));
    if (moved !== undefined) moved.index = index;
    this.changed_.add(pool);
    if (pool.count > 0) return;
    pool.dispose();
    this.pools_.delete(look);
    this.changed_.delete(pool);
  }

  draw(): void {
    for (const marker of this.markers_.values()) if (marker.entity.body !== NO_BODY) this.placeNow_(marker);
    for (const pool of this.changed_) pool.upload();
    this.changed_.clear();
  }

  /** Corners of those in the world. */
  addPlaces(points: Points): void {
    for (const { entity: { body }, pool, index } of this.markers_.values()) {
      if (body !== NO_BODY) continue;
      pool.mesh.getMatrixAt(index, this.matrix_);
      addCorners(points, pool.mesh.geometry, this.matrix_);
    }
  }

  private placeNow_({ entity: { body, part: { offset, rotation } }, pool, index }: Marker): void {
    const { poses_: poses, place_: place, turn_: turn, matrix_: matrix } = this;
    if (turnOf(poses, body, turn)) {
      place.set(...offset).applyQuaternion(turn);
      if (body !== NO_BODY) {
        place.x += poses.position[3 * body];
        place.y += poses.position[3 * body + 1];
        place.z += poses.position[3 * body + 2];
      }
      matrix.compose(place, turn.multiply(this.own_.set(...rotation)), unit);
    } else {
      matrix.makeScale(0, 0, 0);
    }
    pool.mesh.setMatrixAt(index, matrix);
    this.changed_.add(pool);
  }

  private makePool_(look: string, { part }: MarkerEntity): InstancePool {
    const shape = readPart(part);
    const pool = new InstancePool(makeGeometry(shape, "fine"), materialOf(shape.material, shape.color), 4).addTo(this.root);
    this.pools_.set(look, pool);
    return pool;
  }
}
