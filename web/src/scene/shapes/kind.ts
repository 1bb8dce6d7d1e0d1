// SPDX-License-Identifier: Apache-2.0

import type { BufferGeometry } from "three";
import type { MeshData } from "./mesh.ts";

/** fine: a few near bodies; coarse: small on the screen, or hundreds of bodies; tiny: a few pixels. */
export type Detail = "fine" | "coarse" | "tiny";

/** A shape as sent by the server: its kind and sizes. Its frame: the origin at the center, +x along it. Lengths in m.
 * */
export interface Solid {
  readonly kind: Kind;
  readonly sizes: readonly number[];
  /** Only for meshes. */
  readonly mesh: MeshData | null;
}

/** The least and largest coordinates. */
export interface Box {
  readonly low: readonly number[];
  readonly high: readonly number[];
}

/** A box with its middle at the origin, by half its sizes. */
export function boxAbout(x: number, y: number, z: number): Box {
  return { low: [-x, -y, -z], high: [x, y, z] };
}

/** One kind of shape; the engine has a header of the same name in src/shape. */
export interface Kind {
  readonly name: string;
  /** Names of its sizes, in the order of protocol/shapes.json. */
  readonly sizes: readonly string[];
  /** The usual word for such a thing; its name unless given. */
  word?(solid: Solid): string;
  /** Distance of a point from the surface, negative inside. Its slope is at most 1. */
  distance(solid: Solid, x: number, y: number, z: number): number;
  /** Radius of the smallest enclosing sphere about the origin. */
  reach(solid: Solid): number;
  /** The smallest enclosing box along the axes; drawn triangles may be smaller, by their detail. */
  box(solid: Solid): Box;
  /** Triangles, with texture coordinates; the caller disposes of them. */
  draw(solid: Solid, detail: Detail, material: string): BufferGeometry;
}
