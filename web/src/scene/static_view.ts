// SPDX-License-Identifier: Apache-2.0
// What is only drawn and stays where it is: a beam, a stand.

import { Group, InstancedBufferAttribute, InstancedMesh, Matrix4 } from "three";
import { makeGeometry } from "./shapes/shape.ts";
import { materialOf } from "./materials.ts";
import type { Change, WorldModel } from "./world_model.ts";

export class StaticView {
  readonly root = new Group();
  private readonly model_: WorldModel;

  constructor(model: WorldModel) {
    this.model_ = model;
  }

  changed(what: Change | string): void {
    if (what === "statics") this.rebuild_();
  }

  private rebuild_(): void {
    for (const child of this.root.children.slice()) {
      this.root.remove(child);
      const mesh = child as InstancedMesh;
      mesh.geometry.dispose();
      mesh.dispose();
    }
    for (const entry of this.model_.statics) {
      const { shape } = entry;
      const geometry = makeGeometry(shape, "fine");
      geometry.setAttribute("tint", new InstancedBufferAttribute(new Float32Array(4), 4));
      // An instance of one, so that statics and bodies share a program.
      const mesh = new InstancedMesh(geometry, materialOf(shape.material, shape.color), 1);
      mesh.setMatrixAt(0, new Matrix4());
      mesh.position.set(...entry.position);
      mesh.quaternion.set(...entry.rotation);
      mesh.castShadow = mesh.receiveShadow = true;
      this.root.add(mesh);
    }
  }
}
