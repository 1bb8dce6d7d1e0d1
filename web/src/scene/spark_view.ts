// SPDX-License-Identifier: Apache-2.0
// Sparks: particles of emitters, by the thousand. They come whole with each frame and have no names, so they are drawn where the
// newest frame has them: one instanced ball, nothing to pick, no shadows.

import { Color, DynamicDrawUsage, Group, IcosahedronGeometry, InstancedMesh, Matrix4, MeshStandardMaterial } from "three";
import type { PoseSparkColumns } from "../protocol/generated.ts";

/** Of sparks to which nobody gave a radius, m. */
const usualRadius = 0.01;

export class SparkView {
  readonly root = new Group();

  private mesh_: InstancedMesh | null = null;
  private readonly geometry_ = new IcosahedronGeometry(1, 2);
  private readonly material_ = new MeshStandardMaterial({ roughness: 0.5 });
  private readonly matrix_ = new Matrix4();
  private readonly color_ = new Color();

  get count(): number {
    return this.mesh_?.count ?? 0;
  }

  /** Shows these in place of those before. */
  take(sparks: PoseSparkColumns): void {
    if (sparks.count === 0 && this.count === 0) return;
    const mesh = this.room_(sparks.count);
    for (let index = 0; index < sparks.count; index++) {
      const radius = sparks.radius[index] > 0 ? sparks.radius[index] : usualRadius;
      const { position } = sparks;
      this.matrix_.makeScale(radius, radius, radius);
      this.matrix_.setPosition(position[3 * index], position[3 * index + 1], position[3 * index + 2]);
      mesh.setMatrixAt(index, this.matrix_);
      mesh.setColorAt(index, this.color_.setHex(sparks.color[index]));
    }
    mesh.count = sparks.count;
    mesh.visible = sparks.count > 0;
    mesh.instanceMatrix.needsUpdate = true;
    if (mesh.instanceColor !== null) mesh.instanceColor.needsUpdate = true;
  }

  private room_(count: number): InstancedMesh {
    const old = this.mesh_;
    if (old !== null && old.instanceMatrix.count >= count) return old;
    if (old !== null) {
      this.root.remove(old);
      old.dispose();
    }
    const mesh = new InstancedMesh(this.geometry_, this.material_, Math.max(64, 2 * count));
    mesh.frustumCulled = false;
    mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    this.root.add(mesh);
    this.mesh_ = mesh;
    return mesh;
  }
}
