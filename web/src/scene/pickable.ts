// SPDX-License-Identifier: Apache-2.0
// What can be pointed at and held, as packed data: what is drawn is what is picked.

import type { PlacedShape } from "./shapes/shape.ts";

/** What can be picked, indexed by body slot; poses are those that are drawn at this moment. */
export interface Pickable {
  readonly pickable: Uint32Array;
  readonly pickableCount: number;
  /** Three numbers a slot, m. */
  readonly position: Float32Array;
  /** Four numbers a slot, x y z w. */
  readonly rotation: Float32Array;
  /** Bounding radius about the body's origin, m, by slot. */
  readonly reach: Float32Array;
  shapesOf(body: number): readonly PlacedShape[];
}
