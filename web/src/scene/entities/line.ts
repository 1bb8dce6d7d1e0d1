// SPDX-License-Identifier: Apache-2.0
// Lines through points of bodies and of the world.

import { Vector3 } from "three";
import { NO_BODY, type LineEntity } from "../../protocol/generated.ts";
import { fromBody } from "../anchors.ts";
import type { Points } from "../points.ts";
import { Stroked } from "./stroked.ts";

/** Points of one line, for the camera. */
const mostFramed = 100;

export class LineView extends Stroked<LineEntity> {
  private readonly from_ = new Vector3();
  private readonly to_ = new Vector3();
  private readonly first_ = new Vector3();

  /** Adds its points, world, m, for the camera's framing. */
  addPlaces(points: Points): void {
    for (const line of this.records_.values()) {
      const count = line.points.length / 3;
      for (let index = 0; index < count; index += Math.ceil(count / mostFramed)) {
        if (this.place_(line, index, this.to_)) points.add(this.to_.x, this.to_.y, this.to_.z);
      }
    }
  }

  protected isAttached_({ bodies }: LineEntity): boolean {
    return bodies.some((body) => body !== NO_BODY);
  }

  protected write_(line: LineEntity): void {
    const count = line.points.length / 3;
    if (count === 0 || !this.place_(line, 0, this.first_)) return;
    this.from_.copy(this.first_);
    // A single point is drawn as a dot.
    if (count === 1) this.add_(line, this.from_);
    for (let index = 1; index < count; index++) {
      if (!this.place_(line, index, this.to_)) return;
      this.add_(line, this.to_);
      this.from_.copy(this.to_);
    }
    if (line.closed && count > 2) this.add_(line, this.first_);
  }

  private add_({ radius, color }: LineEntity, { x, y, z }: Vector3): void {
    this.strokes_.add(this.from_.x, this.from_.y, this.from_.z, x, y, z, radius, radius, color);
  }

  private place_({ bodies, points }: LineEntity, index: number, out: Vector3): boolean {
    out.fromArray(points, 3 * index);
    return fromBody(this.poses_, bodies.length === 0 ? NO_BODY : bodies[index], out);
  }
}
