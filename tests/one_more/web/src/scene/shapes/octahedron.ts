// SPDX-License-Identifier: Apache-2.0
import { OctahedronGeometry } from "three";
import type { Kind } from "./kind.ts";

/** |x| + |y| + |z| <= radius. */
export const octahedron: Kind = {
  name: "octahedron",
  sizes: ["radius"],
  distance({ sizes: [radius] }, x, y, z) {
    const sorted = [Math.abs(x), Math.abs(y), Math.abs(z)].sort((a, b) => b - a);
    const over = sorted[0] + sorted[1] + sorted[2] - radius;
    if (over <= 0) return over / Math.sqrt(3);
    let less = 0;
    let total = 0;
    for (let k = 0; k < 3; k++) {
      total += sorted[k];
      less = (total - radius) / (k + 1);
      if (k < 2 && less >= sorted[k + 1]) break;
    }
    return Math.hypot(...sorted.map((a) => Math.min(a, less)));
  },
  reach: ({ sizes: [radius] }) => radius,
  draw: ({ sizes: [radius] }) => new OctahedronGeometry(radius).toNonIndexed(),
};
