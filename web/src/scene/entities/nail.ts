// SPDX-License-Identifier: Apache-2.0
// Nails: a small pin at each, which shows what holds a hanging body. A nail in the world has a fixed place; a nail
// given by a point of a body moves with it.

import { Group, Matrix4, SphereGeometry, Vector3 } from "three";
import { NO_BODY, type NailEntity } from "../../protocol/generated.ts";
import { placeOf } from "../anchors.ts";
import { InstancePool } from "../instance_pool.ts";
import { materialOf } from "../materials.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import { EntityRecords } from "./entity.ts";

/** Corners of a pin's equator: many pins have few triangles each. */
function aroundOf(count: number): number {
  return count <= 30 ? 20 : count <= 500 ? 10 : 6;
}

export class NailView extends EntityRecords<NailEntity> {
  readonly root = new Group();
  /** m; follows the size of the scene. */
  pinRadius = 0.01;

  private readonly poses_: PoseBuffer;
  private readonly pool_: InstancePool;
  private around_ = aroundOf(0);
  /** Since the last draw. */
  private changed_ = false;
  /** Whether a nail is on a body or a frame. */
  private moves_ = false;
  private drawnRadius_ = 0;
  private readonly indices_ = new Map<number, number>();
  private readonly matrix_ = new Matrix4();
  private readonly place_ = new Vector3();

  constructor(poses: PoseBuffer) {
    super();
    this.poses_ = poses;
    this.pool_ = new InstancePool(this.makePin_(), materialOf({ material: "brass", color: null }), 16).addTo(this.root);
  }

  private makePin_(): SphereGeometry {
    return new SphereGeometry(1, this.around_, Math.round(0.7 * this.around_));
  }

  override create(entity: NailEntity): void {
    super.create(entity);
    this.changed_ = true;
    this.indices_.set(entity.id.slot, this.pool_.add(entity.id.slot));
  }

  override change(entity: NailEntity): void {
    super.change(entity);
    this.changed_ = true;
  }

  override destroy(slot: number): void {
    this.changed_ = true;
    const index = this.indices_.get(slot);
    if (index !== undefined) {
      const moved = this.pool_.remove(index);
      if (moved >= 0) this.indices_.set(moved, index);
      this.indices_.delete(slot);
    }
    super.destroy(slot);
  }

  /** Calls a function with the slot of each nailed body and the place of its nail, world, m. */
  forEachPlace(visit: (body: number, place: Vector3) => void): void {
    for (const { at } of this.records_.values()) if (placeOf(this.poses_, at, this.place_)) visit(at.body, this.place_);
  }

  draw(): void {
    if (!this.changed_ && !this.moves_ && this.drawnRadius_ === this.pinRadius) return;
    this.changed_ = this.moves_ = false;
    const around = aroundOf(this.pool_.count);
    if (around !== this.around_) {
      this.around_ = around;
      this.pool_.setGeometry(this.makePin_());
    }
    const { members, count, mesh } = this.pool_;
    const radius = this.pinRadius;
    this.drawnRadius_ = radius;
    for (let index = 0; index < count; index++) {
      const nail = this.records_.get(members[index]);
      if (nail !== undefined && nail.at.body !== NO_BODY) this.moves_ = true;
      if (nail !== undefined && placeOf(this.poses_, nail.at, this.place_)) {
        this.matrix_.makeScale(radius, radius, radius).setPosition(this.place_);
      } else {
        this.matrix_.makeScale(0, 0, 0);
      }
      mesh.setMatrixAt(index, this.matrix_);
    }
    this.pool_.upload();
  }
}
