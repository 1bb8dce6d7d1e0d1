// SPDX-License-Identifier: Apache-2.0
// Labels of a constant size that would cover each other are lifted, so that all of them can be read.

import { Vector3 } from "three";

/** A label as the viewer sees it; lengths at a distance of 1. */
export interface Plate {
  /** From the eye to its place, a unit vector. */
  readonly direction: Vector3;
  width: number;
  height: number;
  /** How far it is drawn above its place: a result, and the last one. */
  lift: number;
}

/** More are left where they are: every pair of them is looked at in each frame. */
export const mostLifted = 200;

const rounding = 1e-9;
const up = new Vector3(0, 1, 0);
const right = new Vector3();
const above = new Vector3();
const between = new Vector3();

/** The direction up on the screen at a place, for a viewer who stands upright. */
export function upAt(direction: Vector3, out: Vector3): Vector3 {
  right.crossVectors(direction, up);
  if (right.lengthSq() < 1e-6) right.set(1, 0, 0);
  return out.crossVectors(right.normalize(), direction).normalize();
}

/** Sorts the plates from the lowest to the highest, as they were drawn last, and lifts each that would cover one below it. */
export function liftApart(plates: Plate[]): void {
  if (plates.length > mostLifted) {
    for (const plate of plates) plate.lift = 0;
    return;
  }
  // By their last places: otherwise two at the same height would change places again and again.
  plates.sort((a, b) => a.direction.y + a.lift - b.direction.y - b.lift);
  for (const [index, plate] of plates.entries()) {
    plate.lift = 0;
    // Above one it may cover another.
    while (liftOnce(plate, plates, index)) continue;
  }
}

/** Lifts a plate above the first of `count` others that it covers; whether there is one. */
function liftOnce(plate: Plate, others: readonly Plate[], count: number): boolean {
  upAt(plate.direction, above);
  for (let index = 0; index < count; index++) {
    const other = others[index];
    if (plate.direction.dot(other.direction) < 0.5) continue;
    between.subVectors(plate.direction, other.direction);
    if (Math.abs(between.dot(right)) >= (plate.width + other.width) / 2) continue;
    const needed = (plate.height + other.height) / 2;
    const apart = between.dot(above) + plate.lift - other.lift;
    if (Math.abs(apart) > needed - rounding) continue;
    plate.lift += needed - apart;
    return true;
  }
  return false;
}
