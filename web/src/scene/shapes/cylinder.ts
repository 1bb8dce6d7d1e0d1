// SPDX-License-Identifier: Apache-2.0
import { layRope } from "./rope.ts";
import { boxAbout, type Kind } from "./kind.ts";
import { arc, bevel, revolve, tilesAlong, type ProfilePoint } from "./sweep.ts";

/** Along x, with flat ends; its edges rounded by arcs of `rounding`. */
export const cylinder: Kind = {
  name: "cylinder",
  sizes: ["radius", "length", "rounding"],
  word: ({ sizes: [radius, length] }) => (length > 6 * radius ? "rod" : length < radius ? "disk" : "cylinder"),
  distance({ sizes }, x, y, z) {
    const side = Math.hypot(y, z) - sizes[0] + sizes[2];
    const end = Math.abs(x) - sizes[1] / 2 + sizes[2];
    return Math.min(Math.max(side, end), 0) + Math.hypot(Math.max(side, 0), Math.max(end, 0)) - sizes[2];
  },
  reach: ({ sizes: [radius, length] }) => Math.hypot(length / 2, radius),
  box: ({ sizes: [radius, length] }) => boxAbout(length / 2, radius, radius),
  draw({ sizes: [radius, length, rounding] }, detail, material) {
    const least = Math.min(2 * radius, length);
    const edge = Math.max(rounding, bevel * least);
    const half = length / 2 - edge;
    const steps = Math.ceil((detail === "fine" ? 3 : 1) * (1 + 4 * (rounding / least)));
    const profile: ProfilePoint[] = [{ x: -length / 2, r: 0, nx: -1, nr: 0 }];
    arc(profile, -half, radius - edge, edge, 0, Math.PI / 2, steps);
    arc(profile, half, radius - edge, edge, Math.PI / 2, Math.PI, steps);
    profile.push({ x: length / 2, r: 0, nx: 1, nr: 0 });
    if (material === "rope" && detail === "fine") return layRope(profile, half, radius, length);
    return revolve(profile, { fine: 28, coarse: 12, tiny: 6 }[detail], length, tilesAlong(radius, length));
  },
};
