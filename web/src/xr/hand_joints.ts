// SPDX-License-Identifier: Apache-2.0
// The 25 joints of a tracked hand, read without allocating.

export const jointNames = [
  "wrist",
  "thumb-metacarpal", "thumb-phalanx-proximal", "thumb-phalanx-distal", "thumb-tip",
  ...["index", "middle", "ring", "pinky"].flatMap((finger) => [
    `${finger}-finger-metacarpal`, `${finger}-finger-phalanx-proximal`, `${finger}-finger-phalanx-intermediate`,
    `${finger}-finger-phalanx-distal`, `${finger}-finger-tip`,
  ]),
] as readonly XRHandJoint[];

export const wrist = 0;
export const thumbTip = 4;
export const indexTip = 9;
export const middleKnuckle = 11;

/** Not in the type package: Hand Input, section 4. */
interface HandFrame {
  fillPoses?(spaces: readonly XRSpace[], base: XRSpace, transforms: Float32Array): boolean;
  fillJointRadii?(spaces: readonly XRJointSpace[], radii: Float32Array): boolean;
}

export class HandJoints {
  /** 16 numbers a joint, column by column, in the reference space. */
  readonly matrices = new Float32Array(16 * jointNames.length);
  /** m */
  readonly radii = new Float32Array(jointNames.length).fill(0.009);
  tracked = false;

  private readonly spaces_: XRJointSpace[] = [];

  constructor(hand: XRHand) {
    for (const name of jointNames) {
      const space = hand.get(name);
      if (space !== undefined) this.spaces_.push(space);
    }
  }

  read(frame: XRFrame, base: XRSpace): void {
    if (this.spaces_.length < jointNames.length) return;
    const filler = frame as unknown as HandFrame;
    if (filler.fillPoses !== undefined && filler.fillJointRadii !== undefined) {
      this.tracked = filler.fillPoses(this.spaces_, base, this.matrices) && Number.isFinite(this.matrices[12]);
      if (this.tracked) filler.fillJointRadii(this.spaces_, this.radii);
      return;
    }
    this.tracked = true;
    for (let index = 0; index < this.spaces_.length; index++) {
      const pose = frame.getJointPose?.(this.spaces_[index], base);
      if (pose === undefined || pose === null) {
        this.tracked = false;
        return;
      }
      this.matrices.set(pose.transform.matrix, 16 * index);
      this.radii[index] = pose.radius ?? 0.009;
    }
  }
}
