// SPDX-License-Identifier: Apache-2.0
// Where a user stands when a session starts: a step away from the thing, facing it. Pure numbers.

import type { Vec3 } from "../protocol/generated.ts";

/** Of a world: where it is first seen from, and how high its ground is (m; null: none). */
export interface Standing {
  readonly eye: Readonly<Vec3>;
  readonly target: Readonly<Vec3>;
  readonly ground: number | null;
}

/** The part of a rig that is set; three's Object3D is one. */
export interface Rig {
  readonly position: { set(x: number, y: number, z: number): unknown };
  readonly rotation: { y: number };
}

const nearest = 0.9;
const farthest = 1.6;
/** A step is shorter than a camera's distance: a headset sees a wider angle than a screen. */
const ofCamera = 0.36;
/** Without a ground, eyes are this far above the thing's middle, m. */
const eyesAbove = 0.15;

/**
 * Moves and turns the rig so that the head (its transform in the reference space, column by column)
 * comes to stand before the middle of the world's view, on the side of the script's camera.
 */
export function standBefore(settings: Standing, head: ArrayLike<number>, rig: Rig): void {
  const { eye, target } = settings;
  let awayX = eye[0] - target[0];
  let awayZ = eye[2] - target[2];
  const far = Math.hypot(awayX, awayZ);
  if (far > 1e-6) {
    awayX /= far;
    awayZ /= far;
  } else {
    awayX = 0;
    awayZ = 1;
  }
  const step = Math.min(Math.max(ofCamera * far, nearest), farthest);
  // The head looks along -z of its own frame; turned about y by `yaw`, -z points to (-sin yaw, -cos yaw).
  const facing = Math.atan2(awayX, awayZ);
  const flat = Math.hypot(head[8], head[10]);
  const looking = flat > 1e-3 ? Math.atan2(head[8], head[10]) : 0;
  const yaw = facing - looking;
  const x = Math.cos(yaw) * head[12] + Math.sin(yaw) * head[14];
  const z = -Math.sin(yaw) * head[12] + Math.cos(yaw) * head[14];
  rig.rotation.y = yaw;
  rig.position.set(
    target[0] + step * awayX - x, settings.ground ?? target[1] + eyesAbove - head[13], target[2] + step * awayZ - z,
  );
}
