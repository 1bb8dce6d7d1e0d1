// SPDX-License-Identifier: Apache-2.0
// Draws a tracked hand: a ball at each measured joint and a rod along each bone. Thumb and index finger show a pinch.

import {
  Color, CylinderGeometry, DynamicDrawUsage, Group, InstancedMesh, Matrix4, MeshStandardMaterial, Quaternion, SphereGeometry, Vector3,
} from "three";
import { palette } from "../scene/materials.ts";
import { indexTip, jointNames, thumbTip, wrist } from "./hand_joints.ts";
import type { Input } from "./input.ts";

/** Joint numbers at both ends of a rod: along the fingers, then across the palm. */
function makeBones(): [number, number][] {
  const bones: [number, number][] = [[wrist, 1], [1, 2], [2, 3], [3, 4]];
  for (const first of [5, 10, 15, 20]) {
    bones.push([wrist, first]);
    for (let joint = first; joint < first + 4; joint++) bones.push([joint, joint + 1]);
  }
  for (const first of [5, 10, 15]) bones.push([first, first + 5], [first + 1, first + 6], [first, first + 6]);
  bones.push([2, 6], [1, 5], [wrist, 6], [wrist, 21]);
  return bones;
}

const bones = makeBones();
const glove = new Color("#e6ddd0");
const axis = new Vector3(0, 1, 0);

export class HandView {
  readonly root = new Group();

  private readonly balls_: InstancedMesh;
  private readonly rods_: InstancedMesh;
  private pinched_ = -1;
  private readonly from_ = new Vector3();
  private readonly to_ = new Vector3();
  private readonly turn_ = new Quaternion();
  private readonly size_ = new Vector3();
  private readonly matrix_ = new Matrix4();

  constructor() {
    const material = new MeshStandardMaterial({ roughness: 0.75 });
    this.balls_ = new InstancedMesh(new SphereGeometry(1, 16, 12), material, jointNames.length);
    this.rods_ = new InstancedMesh(new CylinderGeometry(1, 1, 1, 14, 1, true), material, bones.length);
    for (const mesh of [this.balls_, this.rods_]) {
      mesh.frustumCulled = false;
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      for (let index = 0; index < mesh.count; index++) mesh.setColorAt(index, glove);
      this.root.add(mesh);
    }
  }

  update(input: Input): void {
    const { joints } = input;
    this.root.visible = joints !== null && joints.tracked;
    if (joints === null || !this.root.visible) return;
    const { matrices, radii } = joints;
    for (let joint = 0; joint < jointNames.length; joint++) {
      this.at_(matrices, joint, this.from_);
      this.matrix_.makeScale(radii[joint], radii[joint], radii[joint]).setPosition(this.from_);
      this.balls_.setMatrixAt(joint, this.matrix_);
    }
    for (let index = 0; index < bones.length; index++) {
      const a = bones[index][0];
      const b = bones[index][1];
      this.at_(matrices, a, this.from_);
      this.at_(matrices, b, this.to_).sub(this.from_);
      const length = this.to_.length();
      const radius = 0.48 * (radii[a] + radii[b]);
      if (length > 1e-6) this.turn_.setFromUnitVectors(axis, this.size_.copy(this.to_).divideScalar(length));
      this.from_.addScaledVector(this.to_, 0.5);
      this.matrix_.compose(this.from_, this.turn_, this.size_.set(radius, length, radius));
      this.rods_.setMatrixAt(index, this.matrix_);
    }
    this.balls_.instanceMatrix.needsUpdate = this.rods_.instanceMatrix.needsUpdate = true;
    this.tint_(input.pointer.grab !== null ? 2 : input.selecting ? 1 : 0);
  }

  /** Color of fingertips: 0 open, 1 pinched, 2 holding a body. */
  private tint_(state: number): void {
    if (state === this.pinched_) return;
    this.pinched_ = state;
    const color = state === 2 ? palette.held : state === 1 ? palette.calm : glove;
    this.balls_.setColorAt(thumbTip, color);
    this.balls_.setColorAt(indexTip, color);
    if (this.balls_.instanceColor !== null) this.balls_.instanceColor.needsUpdate = true;
  }

  private at_(matrices: Float32Array, joint: number, out: Vector3): Vector3 {
    return out.set(matrices[16 * joint + 12], matrices[16 * joint + 13], matrices[16 * joint + 14]);
  }
}
