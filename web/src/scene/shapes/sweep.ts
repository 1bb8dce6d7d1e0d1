// SPDX-License-Identifier: Apache-2.0
// Swept surfaces: of a profile about the x axis, of a circle along a line.

import { BufferAttribute, BufferGeometry } from "three";

/** Writes point, normal and texture coordinates of a surface at row i, column j. */
type Surface = (i: number, j: number, point: number[], normal: number[], uv: number[]) => void;

export function sweep(rows: number, columns: number, surface: Surface): BufferGeometry {
  const count = (rows + 1) * (columns + 1);
  const positions = new Float32Array(count * 3);
  const normals = new Float32Array(count * 3);
  const uvs = new Float32Array(count * 2);
  const indices: number[] = [];
  const point = [0, 0, 0];
  const normal = [0, 0, 0];
  const uv = [0, 0];
  for (let i = 0; i <= rows; i++) {
    for (let j = 0; j <= columns; j++) {
      const at = i * (columns + 1) + j;
      surface(i, j, point, normal, uv);
      positions.set(point, at * 3);
      normals.set(normal, at * 3);
      uvs.set(uv, at * 2);
      if (i === rows || j === columns) continue;
      indices.push(at, at + columns + 1, at + 1, at + 1, at + columns + 1, at + columns + 2);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new BufferAttribute(normals, 3));
  geometry.setAttribute("uv", new BufferAttribute(uvs, 2));
  geometry.setIndex(indices);
  return geometry;
}

/** A point of a profile: along the x axis and away from it, m; its normal. */
export interface ProfilePoint {
  readonly x: number;
  readonly r: number;
  readonly nx: number;
  readonly nr: number;
}

/** Adds an arc about (cx, cr) to a profile; angle 0 is the direction -x, a quarter turn points away from the axis. */
export function arc(profile: ProfilePoint[], cx: number, cr: number, radius: number, from: number, to: number, steps: number): void {
  for (let step = 0; step <= steps; step++) {
    const angle = from + ((to - from) * step) / steps;
    const nx = -Math.cos(angle);
    const nr = Math.sin(angle);
    profile.push({ x: cx + radius * nx, r: Math.max(cr + radius * nr, 0), nx, nr });
  }
}

/** Turns a profile, from -x to +x, about the x axis. Texture: u in `tiles` over `length`, v once around. `relief`: a factor
 * of the radius there, which leaves the normals. */
export function revolve(
  profile: readonly ProfilePoint[], columns: number, length: number, tiles: number, relief = (_u: number, _v: number) => 1,
): BufferGeometry {
  return sweep(profile.length - 1, columns, (i, j, point, normal, uv) => {
    const { x, r, nx, nr } = profile[i];
    const u = (x / length + 0.5) * tiles;
    const v = j / columns;
    const angle = -2 * Math.PI * v; // in this direction the faces are outward
    const out = r * relief(u, v);
    point[0] = x;
    point[1] = out * Math.cos(angle);
    point[2] = out * Math.sin(angle);
    normal[0] = nx;
    normal[1] = nr * Math.cos(angle);
    normal[2] = nr * Math.sin(angle);
    uv[0] = u;
    uv[1] = v;
  });
}

/** Tiles of texture along a rod: whole ones, so that neighbors match. */
export function tilesAlong(radius: number, length: number): number {
  return Math.max(1, Math.round(length / (tilePerRadius * radius)));
}
/** Length of a texture tile in radii of the rod: a strand goes once around in strandCount tiles. */
export const tilePerRadius = 4.7;

/**
 * Sharp edges are drawn with a bevel of this share of the least size, so that they reflect light: less than the error
 * of a coarse ball.
 */
export const bevel = 0.01;
