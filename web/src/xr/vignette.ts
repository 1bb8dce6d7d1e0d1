// SPDX-License-Identifier: Apache-2.0
// Narrows the view while it moves by itself, which spares many people sickness.

import { BackSide, BufferAttribute, Mesh, MeshBasicMaterial, SphereGeometry, type Matrix4 } from "three";

/** Angles from the line of sight, rad: clear up to the one, dark from the other on. */
const clear = 0.42;
const dark = 0.62;
const easeSeconds = 0.12;

export class Vignette {
  /** About the head, in the room. */
  readonly mesh: Mesh<SphereGeometry, MeshBasicMaterial>;

  constructor() {
    // Its pole is in the line of sight, -z.
    const geometry = new SphereGeometry(0.3, 32, 24, 0, 2 * Math.PI, clear, Math.PI - clear).rotateX(-Math.PI / 2);
    const position = geometry.getAttribute("position");
    const colors = new Float32Array(4 * position.count);
    for (let index = 0; index < position.count; index++) {
      const angle = Math.acos(Math.min(-position.getZ(index) / 0.3, 1));
      colors[4 * index + 3] = Math.min(Math.max((angle - clear) / (dark - clear), 0), 1);
    }
    geometry.setAttribute("color", new BufferAttribute(colors, 4));
    this.mesh = new Mesh(geometry, new MeshBasicMaterial({
      vertexColors: true, transparent: true, side: BackSide, depthTest: false, depthWrite: false, toneMapped: false, fog: false, opacity: 0,
    }));
    this.mesh.matrixAutoUpdate = false;
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 20;
    this.mesh.visible = false;
  }

  /** `head`: in the room. */
  update(head: Matrix4, moving: boolean, seconds: number): void {
    const { material } = this.mesh;
    material.opacity += ((moving ? 1 : 0) - material.opacity) * (1 - Math.exp(-seconds / easeSeconds));
    this.mesh.visible = material.opacity > 0.01;
    this.mesh.matrix.copy(head);
  }
}
