// SPDX-License-Identifier: Apache-2.0
import { SphereGeometry } from "three";
import type { Kind } from "./kind.ts";

export const sphere: Kind = {
  name: "sphere",
  sizes: ["radius"],
  distance: ({ sizes }, x, y, z) => Math.hypot(x, y, z) - sizes[0],
  reach: ({ sizes: [radius] }) => radius,
  draw: ({ sizes: [radius] }, detail) =>
    detail === "fine" ? new SphereGeometry(radius, 40, 24) : new SphereGeometry(radius, 16, 10),
};
