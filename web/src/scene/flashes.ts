// SPDX-License-Identifier: Apache-2.0
// A short ring of light at a break, join or grab. It moves with its body.

import { Color, DoubleSide, Group, Mesh, MeshBasicMaterial, RingGeometry, type Camera, type Vector3 } from "three";
import { palette } from "./materials.ts";

const most = 8;
const shownSeconds = 0.55;

interface Flash {
  readonly mesh: Mesh<RingGeometry, MeshBasicMaterial>;
  age: number;
  size: number;
  /** Writes its present place, world, m. */
  follow: (out: Vector3) => void;
}

/** Relative to the size of the scene. */
const grabSize = 0.025;
const usualSize = 0.085;
const noMove = (): void => {};

const colors: Record<string, Color> = { break: palette.aboutToBreak, join: palette.calm, grab: palette.hoverOnDark };

export class Flashes {
  readonly root = new Group();
  private readonly flashes_: Flash[] = [];
  private readonly camera_: Camera;
  private next_ = 0;
  private warming_ = false;

  /** Rings face the camera. */
  constructor(camera: Camera) {
    this.camera_ = camera;
    const ring = new RingGeometry(0.72, 1, 40);
    for (let index = 0; index < most; index++) {
      const material = new MeshBasicMaterial({
        transparent: true, toneMapped: false, side: DoubleSide, depthTest: false, depthWrite: false, fog: false,
      });
      const mesh = new Mesh(ring, material);
      mesh.visible = false;
      this.root.add(mesh);
      this.flashes_.push({ mesh, age: shownSeconds, size: 0.1, follow: noMove });
    }
  }

  /**
   * break, join or grab at a place (world, m) in a scene of some size; `follow` writes the moved place, or leaves it
   * unchanged.
   */
  show(kind: string, position: ArrayLike<number>, size: number, follow: (out: Vector3) => void = noMove): void {
    const flash = this.flashes_[this.next_];
    this.next_ = (this.next_ + 1) % most;
    flash.age = 0;
    flash.size = (kind === "grab" ? grabSize : usualSize) * size;
    flash.follow = follow;
    flash.mesh.material.color.copy(colors[kind] ?? palette.hoverOnDark);
    flash.mesh.position.set(position[0], position[1], position[2]);
  }

  /** Draws an invisible ring, so that its shader is compiled. */
  warmUp(): void {
    this.warming_ = true;
  }

  draw(seconds: number): void {
    for (const flash of this.flashes_) {
      if (flash.age === shownSeconds) {
        flash.mesh.visible = this.warming_;
        flash.mesh.scale.setScalar(0);
        continue;
      }
      flash.age = Math.min(flash.age + seconds, shownSeconds);
      const t = flash.age / shownSeconds;
      flash.mesh.visible = t < 1;
      if (t >= 1) continue;
      flash.follow(flash.mesh.position);
      this.camera_.getWorldQuaternion(flash.mesh.quaternion);
      flash.mesh.scale.setScalar(flash.size * (0.15 + 0.85 * Math.sqrt(t)));
      flash.mesh.material.opacity = (1 - t) * (1 - t);
    }
    this.warming_ = false;
  }
}
