// SPDX-License-Identifier: Apache-2.0
// The spring between a held point and a hand: a thin line whose color shows its force, with a small bead at both ends.
// Its thickness is an angle, so that it is equally thin at a distance and in a headset.

import {
  Color, CylinderGeometry, Group, InstancedMesh, Matrix4, MeshBasicMaterial, Quaternion, SphereGeometry, Vector3,
} from "three";
import { forceColor } from "./materials.ts";

const most = 64;
const axis = new Vector3(0, 1, 0);

export class HoldLines {
  readonly root = new Group();

  private readonly lines_: InstancedMesh;
  private readonly beads_: InstancedMesh;
  private count_ = 0;
  private readonly from_ = new Vector3();
  private readonly to_ = new Vector3();
  private readonly middle_ = new Vector3();
  private readonly along_ = new Vector3();
  private readonly size_ = new Vector3();
  private readonly turn_ = new Quaternion();
  private readonly still_ = new Quaternion();
  private readonly matrix_ = new Matrix4();
  private readonly color_ = new Color();

  constructor() {
    const material = new MeshBasicMaterial({ toneMapped: false, fog: false });
    this.lines_ = new InstancedMesh(new CylinderGeometry(1, 1, 1, 10, 1, true), material, most);
    this.beads_ = new InstancedMesh(new SphereGeometry(1, 16, 10), material, 2 * most);
    for (const mesh of [this.lines_, this.beads_]) {
      mesh.frustumCulled = false;
      mesh.count = 0;
      mesh.setColorAt(0, this.color_);
      this.root.add(mesh);
    }
  }

  begin(): void {
    this.count_ = 0;
  }

  /** One spring from a point to a target (world, m) seen from `eye`; `strength` fades springs of other users. */
  add(point: ArrayLike<number>, target: ArrayLike<number>, newtons: number, eye: Vector3, strength: number): void {
    if (this.count_ === most) return;
    const index = this.count_++;
    this.from_.set(point[0], point[1], point[2]);
    this.to_.set(target[0], target[1], target[2]);
    this.along_.subVectors(this.to_, this.from_);
    const length = this.along_.length();
    this.middle_.addVectors(this.from_, this.to_).multiplyScalar(0.5);
    const thick = 0.0012 * strength * this.middle_.distanceTo(eye);
    if (length > 1e-6) this.turn_.setFromUnitVectors(axis, this.along_.divideScalar(length));
    else this.turn_.identity();
    this.matrix_.compose(this.middle_, this.turn_, this.size_.set(thick, length, thick));
    this.lines_.setMatrixAt(index, this.matrix_);
    forceColor(newtons, this.color_);
    this.lines_.setColorAt(index, this.color_);
    this.bead_(2 * index, this.from_, 0.0028 * strength * this.from_.distanceTo(eye));
    this.bead_(2 * index + 1, this.to_, 0.0045 * strength * this.to_.distanceTo(eye));
  }

  end(): void {
    this.lines_.count = this.count_;
    this.beads_.count = 2 * this.count_;
    for (const mesh of [this.lines_, this.beads_]) {
      mesh.visible = this.count_ > 0;
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor !== null) mesh.instanceColor.needsUpdate = true;
    }
  }

  private bead_(index: number, at: Vector3, radius: number): void {
    this.matrix_.compose(at, this.still_, this.size_.setScalar(radius));
    this.beads_.setMatrixAt(index, this.matrix_);
    this.beads_.setColorAt(index, this.color_);
  }
}
