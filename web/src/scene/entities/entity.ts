// SPDX-License-Identifier: Apache-2.0
// The view of entities of one kind. One file here for each kind, and one line in entity_list.ts.

import type { Object3D } from "three";
import type { Id } from "../../protocol/generated.ts";
import type { Points } from "../points.ts";

/** Every record of the schema has an id. */
export interface Entity {
  readonly id: Id;
}

/**
 * Shows entities of one kind. Slots are unique among existing entities: an entity is destroyed before its slot is used
 * again. All other methods are optional.
 */
export interface EntityView<Record extends Entity> {
  /** The drawn objects, if there are any. */
  readonly root?: Object3D;
  create(entity: Record): void;
  /** A new record of an existing entity. */
  change(entity: Record): void;
  destroy(slot: number): void;
  /** Once a frame, before pointers are aimed; `now` in ms of performance.now(). */
  update?(seconds: number, now: number): void;
  /** Once a frame: writes the data for the renderer. */
  draw?(seconds: number): void;
  /** Adds places of its drawings besides bodies, world, m, for the camera's framing. */
  addPlaces?(points: Points): void;
  /** The same of those on bodies that reach farther than these. */
  addMoving?(points: Points): void;
}

/** Keeps the records of a kind that is not drawn. */
export class EntityRecords<Record extends Entity> implements EntityView<Record> {
  protected readonly records_ = new Map<number, Record>();

  get size(): number {
    return this.records_.size;
  }

  get(slot: number): Record | undefined {
    return this.records_.get(slot);
  }

  create(entity: Record): void {
    this.records_.set(entity.id.slot, entity);
  }

  change(entity: Record): void {
    this.records_.set(entity.id.slot, entity);
  }

  destroy(slot: number): void {
    this.records_.delete(slot);
  }
}
