// SPDX-License-Identifier: Apache-2.0
// A view whose code is fetched with its first entity, as most worlds have none of its kind.

import { Group } from "three";
import type { Points } from "../points.ts";
import type { Entity, EntityView } from "./entity.ts";

export class Later<Record extends Entity, View extends EntityView<Record> = EntityView<Record>> implements EntityView<Record> {
  readonly root = new Group();

  private readonly fetch_: () => Promise<View>;
  private readonly changed_: () => void;
  private readonly waiting_ = new Map<number, Record>();
  private view_: View | null = null;
  private fetched_: Promise<void> | null = null;

  /** `changed` is called when the code has come, and its entities can be drawn. */
  constructor(fetch: () => Promise<View>, changed: () => void) {
    this.fetch_ = fetch;
    this.changed_ = changed;
  }

  /** Null until its code has come. */
  get view(): View | null {
    return this.view_;
  }

  create(entity: Record): void {
    if (this.view_ !== null) return this.view_.create(entity);
    this.waiting_.set(entity.id.slot, entity);
    this.fetched_ ??= this.fetch_().then((view) => {
      this.view_ = view;
      if (view.root !== undefined) this.root.add(view.root);
      for (const each of this.waiting_.values()) view.create(each);
      this.waiting_.clear();
      this.changed_();
    });
  }

  change(entity: Record): void {
    if (this.view_ === null) this.create(entity);
    else this.view_.change(entity);
  }

  destroy(slot: number): void {
    this.waiting_.delete(slot);
    this.view_?.destroy(slot);
  }

  draw(seconds: number): void {
    this.view_?.draw?.(seconds);
  }

  addPlaces(points: Points): void {
    this.view_?.addPlaces?.(points);
  }

  addMoving(points: Points): void {
    this.view_?.addMoving?.(points);
  }
}
