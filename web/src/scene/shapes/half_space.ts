// SPDX-License-Identifier: Apache-2.0
import { PlaneGeometry, Quaternion, Vector3 } from "three";
import { boxAbout, type Kind } from "./kind.ts";

/** Edge of the drawn square of the plane, m: its end is hidden by fog. */
const drawn = 1000;

/** All on one side of a plane through the origin: the ground, a wall. */
export const halfSpace: Kind = {
  name: "half_space",
  sizes: ["normal_x", "normal_y", "normal_z"],
  word: () => "ground",
  distance: ({ sizes: n }, x, y, z) => (n[0] * x + n[1] * y + n[2] * z) / Math.hypot(n[0], n[1], n[2]),
  reach: () => Infinity,
  box: () => boxAbout(Infinity, Infinity, Infinity),
  draw({ sizes: [x, y, z] }) {
    const geometry = new PlaneGeometry(drawn, drawn);
    const uv = geometry.getAttribute("uv");
    for (let index = 0; index < uv.count; index++) uv.setXY(index, uv.getX(index) * drawn, uv.getY(index) * drawn);
    return geometry.applyQuaternion(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(x, y, z).normalize()));
  },
};
