// SPDX-License-Identifier: Apache-2.0
// Converts the server's parts to the shapes that the page draws and picks.

import { NO_COLOR, type Part } from "../protocol/generated.ts";
import { parseShape, type Shape } from "./shapes/shape.ts";

/** "#rrggbb"; null: that of the material. */
export function textOf(color: number): string | null {
  return color === NO_COLOR ? null : `#${(color & 0xffffff).toString(16).padStart(6, "0")}`;
}

/** 1: opaque. */
export function opacityOf(color: number): number {
  return color === NO_COLOR ? 1 : 1 - (color >>> 24) / 255;
}

/** Throws an Error that names the wrong field. */
export function readPart({ shape, offset, rotation, turn, material, color }: Part): Shape {
  return parseShape({
    kind: shape.kind,
    sizes: [...shape.sizes],
    ...(shape.triangles.length > 0 ? { vertices: [...shape.vertices], triangles: [...shape.triangles] } : {}),
    offset,
    rotation,
    turn,
    material,
    color: textOf(color) ?? undefined,
    opacity: opacityOf(color),
  });
}
