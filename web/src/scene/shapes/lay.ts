// SPDX-License-Identifier: Apache-2.0
// Texture coordinates from 0 to 1 for an image. Those of the page's own materials are in meters, as wood has a grain of its own size.

import type { BufferAttribute, BufferGeometry } from "three";

/** Right and up on the faces of a box, as seen from the side of a positive normal, by the axis of that: axis and sign. */
const onFace = [
  { right: [2, -1], up: [1, 1] },
  { right: [0, 1], up: [2, -1] },
  { right: [0, 1], up: [1, 1] },
] as const;

/** On the faces of a box around it: upright on its sides, and not mirrored. `sideOf`: the face of a vertex, +x, -x, +y .. -z. */
function layOnBox(geometry: BufferGeometry, uv: BufferAttribute, sideOf: (index: number) => number): void {
  geometry.computeBoundingBox();
  const { min, max } = geometry.boundingBox!;
  const position = geometry.getAttribute("position");
  const share = (index: number, axis: number, sign: number) => {
    const low = min.getComponent(axis);
    const part = (position.getComponent(index, axis) - low) / (max.getComponent(axis) - low || 1);
    return sign > 0 ? part : 1 - part;
  };
  for (let index = 0; index < position.count; index++) {
    const side = sideOf(index);
    const { right: [u, right], up: [v, up] } = onFace[side >> 1];
    // Seen from the other side, right is left; of a lid, up is down instead.
    const other = side % 2 === 0 ? 1 : -1;
    const isLid = side >> 1 === 1;
    uv.setXY(index, share(index, u, isLid ? right : right * other), share(index, v, isLid ? up * other : up));
  }
}

/** The face towards which a triangle looks; the triangles of a mesh share no vertices. */
function sideOfTriangle({ array }: BufferAttribute, index: number): number {
  const first = 9 * Math.floor(index / 3);
  const normal = [0, 1, 2].map((axis) => array[first + axis] + array[first + 3 + axis] + array[first + 6 + axis]);
  const sizes = normal.map(Math.abs);
  const axis = sizes.indexOf(Math.max(...sizes));
  return 2 * axis + (normal[axis] < 0 ? 1 : 0);
}

/** On a solid of revolution, whose own coordinates are tiles along its axis and one turn around it: around it, upright where +x is up. */
function layAround(uv: BufferAttribute): void {
  let tiles = 0;
  for (let index = 0; index < uv.count; index++) tiles = Math.max(tiles, uv.getX(index));
  for (let index = 0; index < uv.count; index++) uv.setXY(index, 1 - uv.getY(index), uv.getX(index) / (tiles || 1));
}

/** Balls have such coordinates already: around them, with the poles along y. */
export function lay(geometry: BufferGeometry, kind: string): void {
  const uv = geometry.getAttribute("uv") as BufferAttribute;
  // Its vertices are in the order of its faces.
  if (kind === "box") layOnBox(geometry, uv, (index) => Math.floor((6 * index) / uv.count));
  else if (kind === "mesh") layOnBox(geometry, uv, (index) => sideOfTriangle(geometry.getAttribute("normal") as BufferAttribute, index));
  else if (kind !== "sphere" && kind !== "ellipsoid") layAround(uv);
  uv.needsUpdate = true;
}
