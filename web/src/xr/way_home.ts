// SPDX-License-Identifier: Apache-2.0
// A small arrow before the user that points to the scene while that is out of view.

import { ConeGeometry, Mesh, MeshBasicMaterial, Vector3, type Matrix4 } from "three";
import { palette } from "../scene/materials.ts";

/** Cosine of the angle from the line of sight beyond which the scene is out of view. */
const outOfView = 0.55;
const away = 0.7;
const below = 0.16;
const easeSeconds = 0.2;

export class WayHome {
  /** In the room. */
  readonly mesh = new Mesh(
    new ConeGeometry(0.016, 0.07, 24).rotateX(Math.PI / 2),
    new MeshBasicMaterial({ transparent: true, opacity: 0, depthTest: false, toneMapped: false, fog: false }),
  );

  private readonly head_ = new Vector3();
  private readonly ahead_ = new Vector3();
  private readonly way_ = new Vector3();

  constructor() {
    this.mesh.material.color.copy(palette.selected);
    this.mesh.name = "way home";
    this.mesh.renderOrder = 19;
    this.mesh.visible = false;
  }

  /** `head`: in the room; `goal`: middle of the scene there, m of the user's; `reach`: half its diagonal. */
  update(head: Matrix4, goal: Vector3, reach: number, seconds: number): void {
    const { mesh, head_: at, ahead_: ahead, way_: way } = this;
    at.setFromMatrixPosition(head);
    ahead.setFromMatrixColumn(head, 2).negate();
    way.subVectors(goal, at);
    const isLost = way.length() > 1.2 * reach && way.normalize().dot(ahead) < outOfView;
    mesh.material.opacity += ((isLost ? 0.9 : 0) - mesh.material.opacity) * (1 - Math.exp(-seconds / easeSeconds));
    mesh.visible = mesh.material.opacity > 0.01;
    if (!mesh.visible) return;
    mesh.position.copy(at).addScaledVector(ahead, away);
    mesh.position.y -= below;
    mesh.quaternion.setFromUnitVectors(forward, way.subVectors(goal, mesh.position).normalize());
  }
}

const forward = new Vector3(0, 0, 1);
