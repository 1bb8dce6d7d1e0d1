// SPDX-License-Identifier: Apache-2.0
// Rods of rope: strands in the geometry, so that a near rope is not a smooth pipe.

import type { BufferGeometry } from "three";
import { revolve, tilesAlong, type ProfilePoint } from "./sweep.ts";

/** Number of strands on the surface; the bump texture has the same number. */
export const strandCount = 3;

/** Height 0..1 of a laid rope's surface at u tiles along and v turns around. */
export function strandHeight(u: number, v: number): number {
  const phase = strandCount * v + u;
  const across = 2 * (phase - Math.floor(phase)) - 1;
  return Math.sqrt(Math.max(0, 1 - across * across));
}

/** Turns the profile of a rod about the x axis, its straight part from -half to +half in rows that strands need. */
export function layRope(profile: readonly ProfilePoint[], half: number, radius: number, length: number): BufferGeometry {
  const tiles = tilesAlong(radius, length);
  const columns = 30;
  const rows = tiles * 6;
  const middle = profile.findIndex((point) => point.x > 0);
  const straight = Array.from({ length: rows - 1 }, (_, row) => ({ x: -half + (2 * half * (row + 1)) / rows, r: radius, nx: 0, nr: 1 }));
  const whole = [...profile.slice(0, middle), ...straight, ...profile.slice(middle)];
  return revolve(whole, columns, length, tiles, (u, v) => 0.9 + 0.1 * strandHeight(u, v));
}
