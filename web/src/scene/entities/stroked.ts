// SPDX-License-Identifier: Apache-2.0
// Entities drawn with strokes: all of a kind in one mesh, which is rewritten in frames in which one of them may have
// moved.

import type { PoseBuffer } from "../pose_buffer.ts";
import { Strokes } from "../strokes.ts";
import { EntityRecords, type Entity } from "./entity.ts";

export abstract class Stroked<Record extends Entity> extends EntityRecords<Record> {
  protected readonly strokes_ = new Strokes();
  protected readonly poses_: PoseBuffer;
  private changed_ = true;

  constructor(poses: PoseBuffer) {
    super();
    this.poses_ = poses;
  }

  get root() {
    return this.strokes_.mesh;
  }

  override create(entity: Record): void {
    super.create(entity);
    this.changed_ = true;
  }

  override change(entity: Record): void {
    super.change(entity);
    this.changed_ = true;
  }

  override destroy(slot: number): void {
    super.destroy(slot);
    this.changed_ = true;
  }

  draw(): void {
    if (!this.changed_ && !this.moves_()) return;
    this.changed_ = false;
    this.strokes_.clear();
    for (const record of this.records_.values()) this.write_(record);
    this.strokes_.upload();
  }

  /** Adds the strokes of one entity. */
  protected abstract write_(record: Record): void;

  /** Whether an entity is on a body. */
  protected abstract isAttached_(record: Record): boolean;

  private moves_(): boolean {
    for (const record of this.records_.values()) if (this.isAttached_(record)) return true;
    return false;
  }
}
