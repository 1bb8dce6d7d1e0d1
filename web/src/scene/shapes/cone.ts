// SPDX-License-Identifier: Apache-2.0
import { boxAbout, type Kind } from "./kind.ts";
import { arc, bevel, revolve, tilesAlong, type ProfilePoint } from "./sweep.ts";

/** Along x: its base at -length/2, its tip at +length/2. In a half plane through the axis it is a triangle. */
export const cone: Kind = {
  name: "cone",
  sizes: ["radius", "length"],
  distance({ sizes }, x, y, z) {
    const radius = sizes[0], length = sizes[1];
    const away = Math.hypot(y, z);
    const slant = Math.hypot(length, radius);
    const behindTip = length / 2 - x;
    const base = -length / 2 - x;
    const side = (away * length - behindTip * radius) / slant;
    if (base <= 0 && side <= 0) return Math.max(base, side);
    if (base > 0 && away <= radius) return base;
    const down = (behindTip * length + away * radius) / slant; // along the side, from the tip
    if (down <= 0) return Math.hypot(behindTip, away);
    return down < slant ? side : Math.hypot(base, away - radius);
  },
  reach: ({ sizes: [radius, length] }) => Math.hypot(length / 2, radius),
  box: ({ sizes: [radius, length] }) => boxAbout(length / 2, radius, radius),
  draw({ sizes: [radius, length] }, detail) {
    const slant = Math.hypot(length, radius);
    const normal = { nx: radius / slant, nr: length / slant };
    // The bevel of the rim: an arc that touches the base and the side.
    const edge = bevel * Math.min(2 * radius, length);
    const center = { x: -length / 2 + edge, r: radius - (edge * (slant + radius)) / length };
    const profile: ProfilePoint[] = [{ x: -length / 2, r: 0, nx: -1, nr: 0 }];
    arc(profile, center.x, center.r, edge, 0, Math.PI - Math.acos(normal.nx), detail === "fine" ? 3 : 1);
    profile.push({ x: length / 2, r: 0, ...normal });
    return revolve(profile, detail === "fine" ? 40 : 12, length, tilesAlong(radius, length));
  },
};
