// SPDX-License-Identifier: Apache-2.0
import { BoxGeometry, BufferAttribute, BufferGeometry } from "three";
import { RoundedBoxGeometry } from "three/examples/jsm/geometries/RoundedBoxGeometry.js";
import { boxAbout, type Kind } from "./kind.ts";
import { bevel } from "./sweep.ts";

/** Texture coordinates of a box by meters, u along its longest side: grain and brushing run along a beam. */
function layAlong(geometry: BufferGeometry, size: readonly number[]): void {
  const position = geometry.getAttribute("position");
  const normal = geometry.getAttribute("normal");
  const uv = geometry.getAttribute("uv");
  const long = size.indexOf(Math.max(...size));
  const [a, b] = [0, 1, 2].filter((axis) => axis !== long);
  for (let index = 0; index < position.count; index++) {
    const at = [position.getX(index), position.getY(index), position.getZ(index)];
    const facing = [normal.getX(index), normal.getY(index), normal.getZ(index)].map(Math.abs);
    const end = facing[long] > facing[a] && facing[long] > facing[b];
    const across = end || facing[a] < facing[b] ? at[a] : at[b] + 0.37 * size[a];
    uv.setXY(index, end ? at[b] / 0.9 : at[long] / 0.9, across / 0.22);
  }
}

/** Roundings below this share of the longest edge are a pixel or two, and get one facet. */
const leastSeen = 0.002;

/** Roundings above this share of the least edge are part of the form, at any size on the screen. */
const leastForm = 0.1;

/** Four of the eight corners around a face or an edge, in order, for the two axes in which they differ. */
const ring = [[0, 0], [1, 0], [1, 1], [0, 1]] as const;

/**
 * A box with one facet for each edge and corner: as many vertices as a plain one, 44 triangles. Normals are those of the faces, so that
 * facets look round.
 */
function makeBevelled(size: readonly number[], round: number): BufferGeometry {
  const positions: number[] = [];
  const normals: number[] = [];
  const triangles: number[] = [];
  // Vertex 8 * axis + corner is on the face along the axis; bit k of the corner: on the positive side of axis k.
  for (let axis = 0; axis < 3; axis++) {
    for (let corner = 0; corner < 8; corner++) {
      for (let k = 0; k < 3; k++) {
        const side = (corner >> k) & 1 ? 1 : -1;
        positions.push(side * (size[k] / 2 - (k === axis ? 0 : round)));
        normals.push(k === axis ? side : 0);
      }
    }
  }
  const at = (vertex: number, axis: number) => positions[3 * vertex + axis];
  const add = (a: number, b: number, c: number) => {
    let outward = 0;
    for (let x = 0; x < 3; x++) {
      const [y, z] = [(x + 1) % 3, (x + 2) % 3];
      const normal = (at(b, y) - at(a, y)) * (at(c, z) - at(a, z)) - (at(b, z) - at(a, z)) * (at(c, y) - at(a, y));
      outward += normal * (at(a, x) + at(b, x) + at(c, x));
    }
    triangles.push(a, ...(outward > 0 ? [b, c] : [c, b]));
  };
  const addQuad = ([a, b, c, d]: readonly number[]) => {
    add(a, b, c);
    add(a, c, d);
  };
  for (let axis = 0; axis < 3; axis++) {
    const [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
    for (const side of [0, 1]) {
      addQuad(ring.map(([i, j]) => 8 * axis + (side << axis) + (i << next) + (j << last)));
      // Two edges along this axis; from the face along the next axis to that along the last.
      for (const other of [0, 1]) addQuad(ring.map(([i, j]) => 8 * (j === 0 ? next : last) + (i << axis) + (side << next) + (other << last)));
    }
  }
  for (let corner = 0; corner < 8; corner++) add(corner, 8 + corner, 16 + corner);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
  geometry.setAttribute("normal", new BufferAttribute(new Float32Array(normals), 3));
  geometry.setAttribute("uv", new BufferAttribute(new Float32Array(2 * (positions.length / 3)), 2));
  geometry.setIndex(triangles);
  return geometry;
}

/** Edges along x, y, z, rounded by arcs of `rounding`: all points within that of a smaller box. */
export const box: Kind = {
  name: "box",
  sizes: ["size_x", "size_y", "size_z", "rounding"],
  distance({ sizes }, x, y, z) {
    const rounding = sizes[3];
    const dx = Math.abs(x) - sizes[0] / 2 + rounding;
    const dy = Math.abs(y) - sizes[1] / 2 + rounding;
    const dz = Math.abs(z) - sizes[2] / 2 + rounding;
    const outside = Math.hypot(Math.max(dx, 0), Math.max(dy, 0), Math.max(dz, 0));
    return outside + Math.min(Math.max(dx, dy, dz), 0) - rounding;
  },
  reach({ sizes: [x, y, z, rounding] }) {
    return Math.hypot(x / 2 - rounding, y / 2 - rounding, z / 2 - rounding) + rounding;
  },
  box: ({ sizes: [x, y, z] }) => boxAbout(x / 2, y / 2, z / 2),
  draw({ sizes: [x, y, z, rounding] }, detail) {
    const least = Math.min(x, y, z);
    const round = Math.max(rounding, bevel * least);
    const segments = round > leastSeen * Math.max(x, y, z) ? Math.round(3 + 12 * (round / least)) : 1;
    const isPlain = detail === "tiny" && round <= leastForm * least;
    const geometry = isPlain ? new BoxGeometry(x, y, z)
      : detail === "fine" && segments > 1 ? new RoundedBoxGeometry(x, y, z, segments, round)
      : makeBevelled([x, y, z], Math.min(round, least / 2));
    layAlong(geometry, [x, y, z]);
    return geometry;
  },
};
