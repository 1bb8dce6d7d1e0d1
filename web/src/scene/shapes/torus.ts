// SPDX-License-Identifier: Apache-2.0
import { boxAbout, type Kind } from "./kind.ts";
import { sweep } from "./sweep.ts";

/** A ring in the x-y plane, or with `stretch` the stadium of a chain link: two half circles and two straight sides. */
export const torus: Kind = {
  name: "torus",
  sizes: ["radius", "tube", "stretch"],
  word: () => "ring",
  distance({ sizes }, x, y, z) {
    const beyond = Math.max(0, Math.abs(x) - sizes[2] / 2);
    return Math.hypot(Math.hypot(beyond, y) - sizes[0], z) - sizes[1];
  },
  reach: ({ sizes: [radius, tube, stretch] }) => stretch / 2 + radius + tube,
  box: ({ sizes: [radius, tube, stretch] }) => boxAbout(stretch / 2 + radius + tube, radius + tube, tube),
  draw({ sizes: [radius, tube, stretch] }, detail) {
    const bends = detail === "fine" ? 20 : 6;
    const columns = detail === "fine" ? 18 : 7;
    const center: { x: number; y: number; nx: number; ny: number; at: number }[] = [];
    const half = stretch / 2;
    const bend = Math.PI * radius;
    const around = 2 * (bend + stretch);
    for (const side of [1, -1]) {
      const start = side === 1 ? 0 : bend + stretch;
      for (let step = 0; step <= bends; step++) {
        const angle = -Math.PI / 2 + (Math.PI * step) / bends;
        const nx = side * Math.cos(angle);
        const ny = side * Math.sin(angle);
        center.push({ x: side * half + radius * nx, y: radius * ny, nx, ny, at: start + (bend * step) / bends });
      }
    }
    center.push({ ...center[0], at: around });
    const tiles = Math.max(1, Math.round(around / (2 * Math.PI * tube)));
    return sweep(center.length - 1, columns, (i, j, point, normal, uv) => {
      const c = center[i];
      const angle = (2 * Math.PI * j) / columns;
      const out = Math.cos(angle);
      const up = Math.sin(angle);
      point[0] = c.x + tube * out * c.nx;
      point[1] = c.y + tube * out * c.ny;
      point[2] = tube * up;
      normal[0] = out * c.nx;
      normal[1] = out * c.ny;
      normal[2] = up;
      uv[0] = (c.at / around) * tiles;
      uv[1] = j / columns;
    });
  },
};
