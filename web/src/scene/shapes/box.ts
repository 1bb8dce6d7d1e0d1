// SPDX-License-Identifier: Apache-2.0
import type { BufferGeometry } from "three";
import { RoundedBoxGeometry } from "three/examples/jsm/geometries/RoundedBoxGeometry.js";
import type { Kind } from "./kind.ts";
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
  draw({ sizes: [x, y, z, rounding] }, detail) {
    const least = Math.min(x, y, z);
    const round = Math.max(rounding, bevel * least);
    const isSeen = round > leastSeen * Math.max(x, y, z);
    const segments = detail !== "fine" || !isSeen ? 1 : Math.round(3 + 12 * (round / least));
    const geometry = new RoundedBoxGeometry(x, y, z, segments, round);
    layAlong(geometry, [x, y, z]);
    return geometry;
  },
};
