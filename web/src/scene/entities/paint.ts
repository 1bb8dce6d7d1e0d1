// SPDX-License-Identifier: Apache-2.0
// Colors of single bodies.

import { Color } from "three";
import { NO_COLOR, type PaintEntity } from "../../protocol/generated.ts";
import type { BodyView } from "./body.ts";
import type { EntityView } from "./entity.ts";

export class PaintView implements EntityView<PaintEntity> {
  private readonly bodies_: BodyView;
  private readonly paints_ = new Map<number, PaintEntity>();

  constructor(bodies: BodyView) {
    this.bodies_ = bodies;
  }

  create(entity: PaintEntity): void {
    this.paints_.set(entity.id.slot, entity);
    this.apply_();
  }

  change(entity: PaintEntity): void {
    this.create(entity);
  }

  destroy(slot: number): void {
    this.paints_.delete(slot);
    this.apply_();
  }

  private apply_(): void {
    const colors = new Map<number, Color>();
    for (const slot of [...this.paints_.keys()].toSorted((a, b) => a - b)) {
      const { bodies, colors: own } = this.paints_.get(slot)!;
      bodies.forEach((body, index) => {
        const color = own[own.length === 1 ? 0 : index];
        if (color === NO_COLOR) colors.delete(body);
        else colors.set(body, new Color(color & 0xffffff));
      });
    }
    this.bodies_.paint(colors);
  }
}
