// SPDX-License-Identifier: Apache-2.0
// The bodies that can be pointed at and held, as packed arrays. They are the arrays that are drawn, so that picks agree with the picture.

import type { PlacedShape } from "./shapes/shape.ts";

/** Arrays are indexed by body slot; poses are those of the current picture. */
export interface Pickable {
  readonly pickable: Uint32Array;
  readonly pickableCount: number;
  /** Three numbers a slot, m. */
  readonly position: Float32Array;
  /** Four numbers a slot, x y z w. */
  readonly rotation: Float32Array;
  /** Bounding radius about the body's origin, m, by slot. */
  readonly reach: Float32Array;
  /** Of the scene, m: what is near enough to count as touched follows it. */
  readonly size: number;
  shapesOf(body: number): readonly PlacedShape[];
}
