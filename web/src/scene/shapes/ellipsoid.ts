// SPDX-License-Identifier: Apache-2.0
import { SphereGeometry } from "three";
import { boxAbout, type Kind } from "./kind.ts";

const half = [0, 0, 0];
const at = [0, 0, 0];
const ratio = [0, 0, 0];

/**
 * Distance from the ellipsoid's surface: the foot of a point has the coordinates r_k p_k / (s + r_k), r_k = (a_k / a)^2, with
 * the root s > -1 of a falling function (Eberly 2013; src/shape/ellipsoid.h has the same).
 */
function distance(sizes: readonly number[], x: number, y: number, z: number): number {
  at[0] = x;
  at[1] = y;
  at[2] = z;
  let m = 0; // the shortest axis; of equal ones that with most of the point
  for (let k = 0; k < 3; k++) {
    half[k] = sizes[k] / 2;
    if (half[k] < half[m] || (half[k] === half[m] && Math.abs(at[k]) > Math.abs(at[m]))) m = k;
  }
  let inside = 0;
  let widest = 0;
  for (let k = 0; k < 3; k++) {
    ratio[k] = (half[k] / half[m]) ** 2;
    inside += (at[k] / half[k]) ** 2;
    widest += (ratio[k] * at[k] / half[k]) ** 2;
  }
  const squares = (s: number): number => {
    let sum = 0;
    for (let k = 0; k < 3; k++) if (at[k] !== 0) sum += (ratio[k] * at[k] / half[k] / (s + ratio[k])) ** 2;
    return sum;
  };
  let apart = 0;
  if (at[m] === 0 && squares(-1) < 1) {
    let rest = 1;
    for (let k = 0; k < 3; k++) {
      if (ratio[k] === 1) continue;
      const foot = (ratio[k] * at[k]) / (ratio[k] - 1);
      rest -= (foot / half[k]) ** 2;
      apart += (foot - at[k]) ** 2;
    }
    apart += half[m] ** 2 * Math.max(rest, 0);
  } else {
    let low = Math.abs(at[m] / half[m]) - 1;
    let high = Math.sqrt(widest) - 1;
    for (let s = (low + high) / 2; s > low && s < high; s = (low + high) / 2) {
      if (squares(s) > 1) low = s;
      else high = s;
    }
    for (let k = 0; k < 3; k++) apart += ((high * at[k]) / (high + ratio[k])) ** 2;
  }
  return inside <= 1 ? -Math.sqrt(apart) : Math.sqrt(apart);
}

/** Its whole axes are along x, y, z. */
export const ellipsoid: Kind = {
  name: "ellipsoid",
  sizes: ["size_x", "size_y", "size_z"],
  distance: ({ sizes }, x, y, z) => distance(sizes, x, y, z),
  reach: ({ sizes }) => Math.max(...sizes) / 2,
  box: ({ sizes: [x, y, z] }) => boxAbout(x / 2, y / 2, z / 2),
  draw({ sizes: [x, y, z] }, detail) {
    const [around, along] = { fine: [32, 20], coarse: [14, 8], tiny: [8, 5] }[detail];
    return new SphereGeometry(0.5, around, along).scale(x, y, z);
  },
};
