// SPDX-License-Identifier: Apache-2.0
// The rectangle that a drag draws to select all bodies within.

import { Vector3 } from "three";
import type { Page } from "../page/page.ts";
import "./band.css";
import { make } from "./dom.ts";

export class Band {
  private readonly page_: Pick<Page, "world" | "viewer" | "selection">;
  private readonly element_ = make("div", "band");
  private readonly place_ = new Vector3();

  constructor(page: Pick<Page, "world" | "viewer" | "selection">) {
    this.page_ = page;
    this.element_.hidden = true;
    document.body.append(this.element_);
  }

  /** Shows it, css px; `done`: selects what is within. */
  draw(left: number, top: number, right: number, bottom: number, done: boolean): void {
    this.element_.hidden = done;
    Object.assign(this.element_.style, { left: `${left}px`, top: `${top}px`, width: `${right - left}px`, height: `${bottom - top}px` });
    if (done) this.page_.selection.selectMany(this.bodiesWithin_(left, top, right, bottom));
  }

  /** By their origins. */
  private bodiesWithin_(left: number, top: number, right: number, bottom: number): number[] {
    const { world: { entities: { body: bodies } }, viewer: { camera } } = this.page_;
    const found: number[] = [];
    for (let index = 0; index < bodies.pickableCount; index++) {
      const body = bodies.pickable[index];
      const { x, y, z } = this.place_.fromArray(bodies.position, 3 * body).project(camera);
      const [across, down] = [((x + 1) / 2) * innerWidth, ((1 - y) / 2) * innerHeight];
      if (z < 1 && across >= left && across <= right && down >= top && down <= bottom) found.push(body);
    }
    return found;
  }
}
