// SPDX-License-Identifier: Apache-2.0
import { layRope } from "./rope.ts";
import type { Kind } from "./kind.ts";
import { arc, revolve, tilesAlong, type ProfilePoint } from "./sweep.ts";

/** A cylinder along x with half balls at its ends. */
export const capsule: Kind = {
  name: "capsule",
  sizes: ["radius", "length"],
  distance: ({ sizes }, x, y, z) => Math.hypot(Math.max(0, Math.abs(x) - sizes[1] / 2), y, z) - sizes[0],
  reach: ({ sizes: [radius, length] }) => length / 2 + radius,
  draw({ sizes: [radius, length] }, detail, material) {
    const steps = detail === "fine" ? 6 : 2;
    const profile: ProfilePoint[] = [];
    arc(profile, -length / 2, 0, radius, 0, Math.PI / 2, steps);
    arc(profile, length / 2, 0, radius, Math.PI / 2, Math.PI, steps);
    if (material === "rope" && detail === "fine") return layRope(profile, length / 2, radius, length);
    return revolve(profile, detail === "fine" ? 28 : 9, length, tilesAlong(radius, length));
  },
};
