// SPDX-License-Identifier: Apache-2.0
// Bodies for tests of picking and gestures, without drawing.

import { toBody } from "../src/interact/picking.ts";
import type { Cover, Pickable } from "../src/scene/pickable.ts";
import { bodyDistance, bodyReach, parseShape, placeShape, type PlacedShape } from "../src/scene/shapes/shape.ts";

export class TestScene implements Pickable {
  readonly size = 1.6;
  readonly covers: Cover[] = [];
  readonly pickable: Uint32Array;
  readonly pickableCount: number;
  readonly position: Float32Array;
  readonly rotation: Float32Array;
  readonly reach: Float32Array;
  private readonly shapes_: PlacedShape[][];

  constructor(shapes: readonly object[]) {
    this.shapes_ = shapes.map((shape) => [placeShape(parseShape(shape), false, null)]);
    this.pickableCount = shapes.length;
    this.pickable = Uint32Array.from(shapes.keys());
    this.position = new Float32Array(3 * shapes.length);
    this.rotation = new Float32Array(4 * shapes.length);
    this.reach = Float32Array.from(this.shapes_, (placed) => bodyReach(placed));
    shapes.forEach((_, body) => this.place(body, [0, 0, 0]));
  }

  shapesOf(body: number): readonly PlacedShape[] {
    return this.shapes_[body];
  }

  place(body: number, position: readonly number[], rotation: readonly number[] = [0, 0, 0, 1]): void {
    this.position.set(position, 3 * body);
    this.rotation.set(rotation, 4 * body);
  }

  /** First body along a ray from the origin by tenths of a millimeter, -1: none. The slow reference of pickRay. */
  slowPick(direction: readonly number[], farthest: number): number {
    const local = new Float32Array(3);
    for (let t = 0; t < farthest; t += 2e-4) {
      for (let body = 0; body < this.pickableCount; body++) {
        toBody(this, body, direction[0] * t, direction[1] * t, direction[2] * t, local);
        if (bodyDistance(this.shapesOf(body), local[0], local[1], local[2]) < 5e-4) return body;
      }
    }
    return -1;
  }
}
