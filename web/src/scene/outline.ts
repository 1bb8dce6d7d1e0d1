// SPDX-License-Identifier: Apache-2.0
// A line around one body: a slightly larger copy of each of its parts, drawn inside out.

import { Group, Mesh, type BufferGeometry, type Color, type InstancedMesh } from "three";
import { makeOutlineMaterial, type OutlineMaterial } from "./materials.ts";

/** Drawn place of a part of a body. */
export interface DrawnPart {
  readonly mesh: InstancedMesh;
  readonly index: number;
}

export class Outline {
  readonly root = new Group();
  readonly material: OutlineMaterial;
  /** Slot of the body, -1: none. */
  body = -1;

  private readonly copies_: Mesh<BufferGeometry, OutlineMaterial>[] = [];

  /** `thickness`: m at a distance of 1 m. */
  constructor(color: Color, thickness: number) {
    this.material = makeOutlineMaterial(color);
    this.material.thickness.value = thickness;
  }

  /** Copies the drawn places of its body's parts in this frame. */
  follow(parts: readonly DrawnPart[]): void {
    while (this.copies_.length < parts.length) this.addCopy_(parts[this.copies_.length].mesh.geometry);
    for (let index = 0; index < this.copies_.length; index++) {
      const copy = this.copies_[index];
      copy.visible = index < parts.length;
      if (!copy.visible) continue;
      const part = parts[index];
      copy.geometry = part.mesh.geometry;
      part.mesh.getMatrixAt(part.index, copy.matrixWorld);
    }
  }

  private addCopy_(geometry: BufferGeometry): void {
    const copy = new Mesh(geometry, this.material);
    // The matrix is written each frame from the part's.
    copy.matrixAutoUpdate = copy.matrixWorldAutoUpdate = false;
    copy.frustumCulled = false;
    this.copies_.push(copy);
    this.root.add(copy);
  }
}
