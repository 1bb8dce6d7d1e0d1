// SPDX-License-Identifier: Apache-2.0
// Arrows: a shaft and a cone.

import { Vector3 } from "three";
import type { ArrowEntity } from "../../protocol/generated.ts";
import { moves, placeOf } from "../anchors.ts";
import type { Points } from "../points.ts";
import type { Strokes } from "../strokes.ts";
import { Stroked } from "./stroked.ts";

/** Radius of a shaft, relative to the arrow's length. */
const usualRadius = 0.018;

/** Adds an arrow; `radius` of its shaft, m; 0: in proportion to its length. An arrow of length 0 is not drawn. */
export function addArrow(strokes: Strokes, from: Vector3, to: Vector3, radius: number, color: number): void {
  const length = from.distanceTo(to);
  if (!(length > 1e-12)) return;
  const shaft = radius > 0 ? radius : usualRadius * length;
  const head = Math.min(7 * shaft, 0.6 * length) / length;
  const x = to.x + (from.x - to.x) * head;
  const y = to.y + (from.y - to.y) * head;
  const z = to.z + (from.z - to.z) * head;
  strokes.add(from.x, from.y, from.z, x, y, z, shaft, shaft, color);
  strokes.add(x, y, z, to.x, to.y, to.z, Math.min(2.6 * shaft, 0.3 * length), 1e-4 * shaft, color);
}

export class ArrowView extends Stroked<ArrowEntity> {
  private readonly from_ = new Vector3();
  private readonly to_ = new Vector3();

  /** Only those in the world: arrows on bodies, such as forces, do not affect the camera. */
  addPlaces(points: Points): void {
    for (const { a, b, vector } of this.records_.values()) {
      if (moves(a) || moves(b)) continue;
      points.add(...a.point);
      points.add(b.point[0] + vector[0], b.point[1] + vector[1], b.point[2] + vector[2]);
    }
  }

  protected isAttached_({ a, b }: ArrowEntity): boolean {
    return moves(a) || moves(b);
  }

  protected write_({ a, b, vector, radius, color }: ArrowEntity): void {
    if (!placeOf(this.poses_, a, this.from_) || !placeOf(this.poses_, b, this.to_)) return;
    this.to_.x += vector[0];
    this.to_.y += vector[1];
    this.to_.z += vector[2];
    addArrow(this.strokes_, this.from_, this.to_, radius, color);
  }
}
