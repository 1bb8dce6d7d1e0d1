// SPDX-License-Identifier: Apache-2.0
// The bodies that can be picked and held, as packed arrays. They are the drawn arrays, so that picks agree with the
// picture.

import type { PlacedShape } from "./shapes/shape.ts";

/** The nearest place of covers so far. */
export interface CoverHit {
  /** Along the ray, or from the point, m; what is farther does not count. */
  distance: number;
  /** -1: none yet. */
  body: number;
  /** In the body's frame, m: where the cover is fixed to it. */
  readonly localPoint: Float32Array;
}

/** A drawing between bodies that represents them, such as a cloth on its knots: a hit on it is a hit on the nearest of its bodies. */
export interface Cover {
  /** Along a ray with unit direction; `tolerance`: tangent of the half-angle of the cone in which a miss counts for thin ones. */
  hitByRay(origin: ArrayLike<number>, direction: ArrayLike<number>, tolerance: number, hit: CoverHit): void;
  hitByPoint(point: ArrayLike<number>, hit: CoverHit): void;
}

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
  /** Size of the scene, m: the distance for a touch depends on it. */
  readonly size: number;
  readonly covers: readonly Cover[];
  shapesOf(body: number): readonly PlacedShape[];
}
