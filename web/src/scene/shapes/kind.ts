// SPDX-License-Identifier: Apache-2.0

import type { BufferGeometry } from "three";
import type { MeshData } from "./mesh.ts";

/** fine: a few bodies seen near; coarse: small on the screen, or hundreds, where vertices are what costs; tiny: a few pixels. */
export type Detail = "fine" | "coarse" | "tiny";

/** A shape as the server sends it: which one, and its sizes. Its frame: the origin at the center, +x along it. Lengths in m. */
export interface Solid {
  readonly kind: Kind;
  readonly sizes: readonly number[];
  /** Of a mesh alone. */
  readonly mesh: MeshData | null;
}

/** What the page knows of one kind of shape; the engine has a header of the same name in src/shape. */
export interface Kind {
  readonly name: string;
  /** Names of its sizes, in the order in which they come: that of protocol/shapes.json. */
  readonly sizes: readonly string[];
  /** Of a point from the surface, negative inside. Never grows faster than the way walked. */
  distance(solid: Solid, x: number, y: number, z: number): number;
  /** Radius of the smallest sphere about the origin that holds it. */
  reach(solid: Solid): number;
  /** Triangles, with texture coordinates; the caller disposes of them. */
  draw(solid: Solid, detail: Detail, material: string): BufferGeometry;
}
