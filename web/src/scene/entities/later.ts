// SPDX-License-Identifier: Apache-2.0
// A view whose code is fetched with its first entity, as most worlds have none of its kind.

import { Group } from "three";
import type { Entity, EntityView } from "./entity.ts";

export class Later<Record extends Entity> implements EntityView<Record> {
  readonly root = new Group();

  private readonly fetch_: () => Promise<EntityView<Record>>;
  private readonly waiting_ = new Map<number, Record>();
  private view_: EntityView<Record> | null = null;
  private fetched_: Promise<void> | null = null;

  constructor(fetch: () => Promise<EntityView<Record>>) {
    this.fetch_ = fetch;
  }

  create(entity: Record): void {
    if (this.view_ !== null) return this.view_.create(entity);
    this.waiting_.set(entity.id.slot, entity);
    this.fetched_ ??= this.fetch_().then((view) => {
      this.view_ = view;
      if (view.root !== undefined) this.root.add(view.root);
      for (const each of this.waiting_.values()) view.create(each);
      this.waiting_.clear();
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
}
