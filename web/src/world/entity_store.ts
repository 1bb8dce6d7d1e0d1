// SPDX-License-Identifier: Apache-2.0
// Tracks existing entities, by kind and id, and converts messages of the server to calls of views: create, change,
// destroy.

import { decodeEntities, entityKindOf, type EntitiesDestroyed, type EntitiesSet, type EntityKind, type Id } from "../protocol/generated.ts";

/** A view, for the store. The store calls its methods only with records of the view's kind. */
export interface StoredView {
  create(entity: never): void;
  change(entity: never): void;
  destroy(slot: number): void;
}

interface Stored {
  generation: number;
  /** Number of the last complete description that includes it, or that preceded it. */
  picture: number;
}

export class EntityStore {
  private readonly views_: { readonly [K in EntityKind]: StoredView };
  private readonly warn_: (title: string, text: string) => void;
  private readonly stored_ = new Map<EntityKind, Map<number, Stored>>();
  private readonly unknown_ = new Set<string>();
  private picture_ = 0;

  /** `warn` is called once for each unknown kind, and for records that a view refuses. */
  constructor(views: { readonly [K in EntityKind]: StoredView }, warn: (title: string, text: string) => void) {
    this.views_ = views;
    this.warn_ = warn;
  }

  /** The server starts a complete description: an entity that is not in it before `endPicture` no longer exists. */
  beginPicture(): void {
    this.picture_++;
  }

  endPicture(): void {
    for (const [kind, entities] of this.stored_) {
      for (const [slot, { picture }] of entities) if (picture !== this.picture_) this.destroy_(kind, slot);
    }
  }

  set(message: EntitiesSet): void {
    const kind = this.kindOf_(message.kind);
    if (kind === undefined) return;
    for (const entity of decodeEntities(kind, message.records)) this.put_(kind, entity);
  }

  destroy(message: EntitiesDestroyed): void {
    const kind = this.kindOf_(message.kind);
    if (kind === undefined) return;
    for (const { slot, generation } of message.ids) {
      // A later generation stays. An earlier one has gone too: its slot was used again and emptied between two messages.
      const known = this.stored_.get(kind)?.get(slot);
      if (known !== undefined && known.generation <= generation) this.destroy_(kind, slot);
    }
  }

  private put_(kind: EntityKind, entity: { readonly id: Id }): void {
    const { slot, generation } = entity.id;
    let entities = this.stored_.get(kind);
    if (entities === undefined) this.stored_.set(kind, entities = new Map());
    const known = entities.get(slot);
    const same = known?.generation === generation;
    if (known !== undefined && !same) this.destroy_(kind, slot);
    entities.set(slot, { generation, picture: this.picture_ });
    const view = this.views_[kind];
    try {
      // The kind determines the type of the record, which the compiler cannot infer.
      if (same) view.change(entity as never);
      else view.create(entity as never);
    } catch (error) {
      this.warn_(`An entity of the kind "${kind}" cannot be shown`, error instanceof Error ? error.message : String(error));
    }
  }

  private destroy_(kind: EntityKind, slot: number): void {
    this.stored_.get(kind)?.delete(slot);
    this.views_[kind].destroy(slot);
  }

  private kindOf_(name: string): EntityKind | undefined {
    const kind = entityKindOf(name);
    if (kind === undefined && !this.unknown_.has(name)) {
      this.unknown_.add(name);
      this.warn_(`This page cannot show "${name}"`, "The server is newer than the page; everything else is shown.");
    }
    return kind;
  }
}
