// SPDX-License-Identifier: Apache-2.0
import { layRope } from "./rope.ts";
import { boxAbout, type Kind } from "./kind.ts";
import { arc, revolve, tilesAlong, type ProfilePoint } from "./sweep.ts";

/** A cylinder along x with half balls at its ends. */
export const capsule: Kind = {
  name: "capsule",
  sizes: ["radius", "length"],
  word: () => "rod",
  distance: ({ sizes }, x, y, z) => Math.hypot(Math.max(0, Math.abs(x) - sizes[1] / 2), y, z) - sizes[0],
  reach: ({ sizes: [radius, length] }) => length / 2 + radius,
  box: ({ sizes: [radius, length] }) => boxAbout(length / 2 + radius, radius, radius),
  draw({ sizes: [radius, length] }, detail, material) {
    const steps = { fine: 6, coarse: 2, tiny: 1 }[detail];
    const profile: ProfilePoint[] = [];
    arc(profile, -length / 2, 0, radius, 0, Math.PI / 2, steps);
    arc(profile, length / 2, 0, radius, Math.PI / 2, Math.PI, steps);
    if (material === "rope" && detail === "fine") return layRope(profile, length / 2, radius, length);
    return revolve(profile, { fine: 28, coarse: 12, tiny: 6 }[detail], length, tilesAlong(radius, length));
  },
};
