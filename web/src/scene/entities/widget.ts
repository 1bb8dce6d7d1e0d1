// SPDX-License-Identifier: Apache-2.0
// Controls and plots of the script: stored here, shown by the panel of the page.

import type { Id, WidgetEntity } from "../../protocol/generated.ts";
import { EntityRecords } from "./entity.ts";

export class WatchedRecords<Record extends { readonly id: Id }> extends EntityRecords<Record> {
  /** Rises with each change. */
  version = 0;

  override create(entity: Record): void {
    super.create(entity);
    this.version++;
  }

  override change(entity: Record): void {
    super.change(entity);
    this.version++;
  }

  override destroy(slot: number): void {
    super.destroy(slot);
    this.version++;
  }

  /** In the order of creation. */
  all(): Record[] {
    return [...this.records_.values()].sort((a, b) => a.id.slot - b.id.slot);
  }
}

/** Controls, each for all users or for one. */
export class Widgets extends WatchedRecords<WidgetEntity> {
  of(user: number): WidgetEntity[] {
    return this.all().filter(({ client }) => client === 0 || client === user);
  }
}
