// SPDX-License-Identifier: Apache-2.0
import { SphereGeometry } from "three";
import { boxAbout, type Kind } from "./kind.ts";

export const sphere: Kind = {
  name: "sphere",
  sizes: ["radius"],
  word: () => "ball",
  distance: ({ sizes }, x, y, z) => Math.hypot(x, y, z) - sizes[0],
  reach: ({ sizes: [radius] }) => radius,
  box: ({ sizes: [radius] }) => boxAbout(radius, radius, radius),
  draw({ sizes: [radius] }, detail) {
    const around = { fine: 40, coarse: 16, tiny: 8 }[detail];
    return new SphereGeometry(radius, around, Math.round(0.6 * around));
  },
};
