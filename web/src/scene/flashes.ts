// SPDX-License-Identifier: Apache-2.0
// A short ring of light where something broke, joined or was taken.

import { AdditiveBlending, Color, DoubleSide, Group, Mesh, MeshBasicMaterial, RingGeometry, type Camera } from "three";
import { palette } from "./materials.ts";

const most = 8;
const shownSeconds = 0.38;

interface Flash {
  readonly mesh: Mesh<RingGeometry, MeshBasicMaterial>;
  age: number;
  size: number;
}

const colors: Record<string, Color> = { break: palette.aboutToBreak, join: palette.calm, grab: palette.hoverOnDark };

export class Flashes {
  readonly root = new Group();
  private readonly flashes_: Flash[] = [];
  private readonly camera_: Camera;
  private next_ = 0;

  /** Rings face the camera. */
  constructor(camera: Camera) {
    this.camera_ = camera;
    const ring = new RingGeometry(0.72, 1, 40);
    for (let index = 0; index < most; index++) {
      const material = new MeshBasicMaterial({
        transparent: true, blending: AdditiveBlending, side: DoubleSide, depthTest: false, depthWrite: false, fog: false,
      });
      const mesh = new Mesh(ring, material);
      mesh.visible = false;
      this.root.add(mesh);
      this.flashes_.push({ mesh, age: shownSeconds, size: 0.1 });
    }
  }

  /** break, join or grab at a place (world, m). */
  effect(kind: string, position: ArrayLike<number>): void {
    const flash = this.flashes_[this.next_];
    this.next_ = (this.next_ + 1) % most;
    flash.age = 0;
    flash.size = kind === "grab" ? 0.04 : 0.13;
    flash.mesh.material.color.copy(colors[kind] ?? palette.hoverOnDark);
    flash.mesh.position.set(position[0], position[1], position[2]);
  }

  draw(seconds: number): void {
    for (const flash of this.flashes_) {
      flash.age = Math.min(flash.age + seconds, shownSeconds);
      const t = flash.age / shownSeconds;
      flash.mesh.visible = t < 1;
      if (t >= 1) continue;
      this.camera_.getWorldQuaternion(flash.mesh.quaternion);
      flash.mesh.scale.setScalar(flash.size * (0.15 + 0.85 * Math.sqrt(t)));
      flash.mesh.material.opacity = (1 - t) * (1 - t);
    }
  }
}
