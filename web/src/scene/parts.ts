// SPDX-License-Identifier: Apache-2.0
// Parts as they come from the server, read into the shapes that the page draws and picks.

import { NO_COLOR, type Part } from "../protocol/generated.ts";
import { parseShape, type Shape } from "./shapes/shape.ts";

/** Throws an Error that says what is wrong. */
export function readPart({ shape, offset, rotation, turn, material, color }: Part): Shape {
  return parseShape({
    kind: shape.kind,
    sizes: [...shape.sizes],
    ...(shape.triangles.length > 0 ? { vertices: [...shape.vertices], triangles: [...shape.triangles] } : {}),
    offset,
    rotation,
    turn,
    material,
    color: color === NO_COLOR ? undefined : `#${color.toString(16).padStart(6, "0")}`,
  });
}
