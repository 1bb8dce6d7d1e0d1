// SPDX-License-Identifier: Apache-2.0
// The articulates of bodies. Not drawn; used to draw all bodies of an articulate without delay.

import type { MembershipEntity } from "../../protocol/generated.ts";
import type { EntityView } from "./entity.ts";

const none = -1;

export class Memberships implements EntityView<MembershipEntity> {
  /** By the body's slot; -1: unknown. */
  private articulates_ = new Int32Array(0);

  create({ id: { slot }, articulate }: MembershipEntity): void {
    if (slot >= this.articulates_.length) {
      const grown = new Int32Array(Math.max(slot + 1, 2 * this.articulates_.length)).fill(none);
      grown.set(this.articulates_);
      this.articulates_ = grown;
    }
    this.articulates_[slot] = articulate;
  }

  change(entity: MembershipEntity): void {
    this.create(entity);
  }

  destroy(slot: number): void {
    this.articulates_[slot] = none;
  }

  /** The articulate of a body, -1: unknown. */
  articulateOf(body: number): number {
    return body < this.articulates_.length ? this.articulates_[body] : none;
  }

  /** Sets `values[slot]` for all bodies of a body's articulate. */
  fillAlong(body: number, values: Float32Array, value: number): void {
    if (body < values.length) values[body] = value;
    const articulate = this.articulateOf(body);
    if (articulate === none) return;
    const end = Math.min(this.articulates_.length, values.length);
    for (let slot = 0; slot < end; slot++) if (this.articulates_[slot] === articulate) values[slot] = value;
  }
}
