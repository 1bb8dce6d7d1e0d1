// SPDX-License-Identifier: Apache-2.0
// The coil of a spring between two bodies; not a shape of bodies.

import type { BufferGeometry } from "three";
import { sweep } from "./sweep.ts";

/** A coil spring along x with straight ends: wire of radius `tube` wound at `radius`, `length` from end to end, m. */
export function makeCoil(radius: number, tube: number, length: number): BufferGeometry {
  const turns = Math.max(4, Math.min(40, Math.round(length / (5 * tube))));
  const straight = 0.12;
  const rows = 12 * turns;
  const center = (t: number): [number, number, number] => {
    const wound = Math.min(1, Math.max(0, (t - straight) / (1 - 2 * straight)));
    // The wire starts and ends at the axis.
    const grown = Math.min(1, 6 * Math.min(t, 1 - t));
    const angle = 2 * Math.PI * turns * wound;
    return [(t - 0.5) * length, grown * radius * Math.cos(angle), grown * radius * Math.sin(angle)];
  };
  return sweep(rows, 6, (i, j, point, normal, uv) => {
    const t = i / rows;
    const here = center(t);
    const ahead = center(Math.min(1, t + 0.25 / rows));
    const behind = center(Math.max(0, t - 0.25 / rows));
    const tangent = [ahead[0] - behind[0], ahead[1] - behind[1], ahead[2] - behind[2]];
    const size = Math.hypot(tangent[0], tangent[1], tangent[2]);
    // Away from the axis, projected normal to the wire.
    const away = Math.hypot(here[1], here[2]) > 1e-9 * radius ? [0, here[1], here[2]] : [0, 1, 0];
    const part = (away[1] * tangent[1] + away[2] * tangent[2]) / (size * size);
    const u = [away[0] - part * tangent[0], away[1] - part * tangent[1], away[2] - part * tangent[2]];
    const us = Math.hypot(u[0], u[1], u[2]);
    const v = [
      (tangent[1] * u[2] - tangent[2] * u[1]) / (size * us),
      (tangent[2] * u[0] - tangent[0] * u[2]) / (size * us),
      (tangent[0] * u[1] - tangent[1] * u[0]) / (size * us),
    ];
    const angle = (-2 * Math.PI * j) / 6;
    for (let axis = 0; axis < 3; axis++) {
      normal[axis] = (Math.cos(angle) * u[axis]) / us + Math.sin(angle) * v[axis];
      point[axis] = here[axis] + tube * normal[axis];
    }
    uv[0] = t * turns;
    uv[1] = j / 6;
  });
}
