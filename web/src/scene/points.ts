// SPDX-License-Identifier: Apache-2.0
// Sample points of the drawn scene, for everything that depends on its size: camera, light, ground, fog.

import { Vector3, type BufferGeometry, type Matrix4, type Quaternion } from "three";
import type { Box } from "./shapes/kind.ts";

/** Largest number of points that stand for one thing. */
const mostOfOne = 400;
const place = new Vector3();

/** Points x y z, one after the other; `count` of them are in use. */
export class Points {
  xyz = new Float64Array(3 * 64);
  count = 0;

  clear(): void {
    this.count = 0;
  }

  add(x: number, y: number, z: number): void {
    if (!Number.isFinite(x + y + z)) return;
    if (3 * this.count === this.xyz.length) {
      const larger = new Float64Array(2 * this.xyz.length);
      larger.set(this.xyz);
      this.xyz = larger;
    }
    const at = 3 * this.count++;
    this.xyz[at] = x;
    this.xyz[at + 1] = y;
    this.xyz[at + 2] = z;
  }

  addAll({ xyz, count }: Points): void {
    for (let at = 0; at < 3 * count; at += 3) this.add(xyz[at], xyz[at + 1], xyz[at + 2]);
  }

  /** Adds a sample of places, three numbers each, turned and then moved. */
  addSample(places: ArrayLike<number>, origin?: Vector3, turn?: Quaternion): void {
    const step = 3 * Math.ceil(places.length / 3 / mostOfOne);
    for (let at = 0; at < places.length; at += step) {
      place.fromArray(places, at);
      if (turn !== undefined) place.applyQuaternion(turn);
      if (origin !== undefined) place.add(origin);
      this.add(place.x, place.y, place.z);
    }
  }

  /** Center of their box, and half its diagonal; null without points. */
  bounds(): Bounds | null {
    if (this.count === 0) return null;
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let axis = 0; axis < 3; axis++) {
      for (let at = axis; at < 3 * this.count; at += 3) {
        low[axis] = Math.min(low[axis], this.xyz[at]);
        high[axis] = Math.max(high[axis], this.xyz[at]);
      }
    }
    return {
      center: [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2],
      radius: Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]) / 2,
      lowest: low[1],
    };
  }
}

export interface Bounds {
  readonly center: readonly [number, number, number];
  readonly radius: number;
  readonly lowest: number;
}

/** The box of a geometry along its axes. */
export function boxOfGeometry(geometry: BufferGeometry): Box {
  if (geometry.boundingBox === null) geometry.computeBoundingBox();
  const { min, max } = geometry.boundingBox!;
  return { low: min.toArray(), high: max.toArray() };
}

/** Adds the transformed corners of a box. */
export function addCorners(points: Points, { low, high }: Box, { elements: m }: Matrix4): void {
  for (let corner = 0; corner < 8; corner++) {
    const x = (corner & 1 ? high : low)[0];
    const y = (corner & 2 ? high : low)[1];
    const z = (corner & 4 ? high : low)[2];
    points.add(m[0] * x + m[4] * y + m[8] * z + m[12], m[1] * x + m[5] * y + m[9] * z + m[13], m[2] * x + m[6] * y + m[10] * z + m[14]);
  }
}
