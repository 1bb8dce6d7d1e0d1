// SPDX-License-Identifier: Apache-2.0
// The user's place at the start of a session: a step in front of the scene, facing it. Pure functions.

import type { Vec3 } from "../protocol/generated.ts";

/** Of a world: where it is first seen from, how high its ground is (m; null: none), and how many of its meters are one of the user's. */
export interface Standing {
  readonly scale: number;
  readonly eye: Readonly<Vec3>;
  readonly target: Readonly<Vec3>;
  readonly ground: number | null;
}

/** The used part of a rig; three's Object3D has it. */
export interface Rig {
  readonly position: { set(x: number, y: number, z: number): unknown };
  readonly rotation: { y: number };
}

const nearest = 0.9;
const farthest = 1.6;
/** A step is shorter than a camera's distance, as a headset has a wider view than a screen. */
const ofCamera = 0.36;
/** Without a ground in reach, eyes are this far above the scene's center, m. */
const eyesAbove = 0.15;
/** A small scene whose center is farther above the ground is out of reach from there, m of the user's. */
const highest = 2.5;

/** Scenes from the one to the other size (half their diagonal, m) are as large as they are; others are as large as a table. */
const smallest = 0.12;
const largest = 20;
const tableSize = 0.7;

/** Meters of the world in one of the user's, so that a scene of a size can be looked at and worked on. */
export function fitScale(size: number): number {
  return size >= smallest && size <= largest ? 1 : tableScale(size);
}

export function tableScale(size: number): number {
  return size / tableSize;
}

/**
 * Moves and turns the rig so that the head (its transform in the reference space, column by column)
 * is in front of the center of the world's view, on the side of the script's camera.
 */
export function standBefore(settings: Standing, head: ArrayLike<number>, rig: Rig): void {
  const { eye, target } = settings;
  let awayX = eye[0] - target[0];
  let awayZ = eye[2] - target[2];
  const far = Math.hypot(awayX, awayZ);
  if (far > 1e-6 * settings.scale) {
    awayX /= far;
    awayZ /= far;
  } else {
    awayX = 0;
    awayZ = 1;
  }
  const { scale } = settings;
  const step = scale * Math.min(Math.max((ofCamera * far) / scale, nearest), farthest);
  // The head looks along -z of its own frame; turned about y by `yaw`, -z points to (-sin yaw, -cos yaw).
  const facing = Math.atan2(awayX, awayZ);
  const flat = Math.hypot(head[8], head[10]);
  const looking = flat > 1e-3 ? Math.atan2(head[8], head[10]) : 0;
  const yaw = facing - looking;
  const x = scale * (Math.cos(yaw) * head[12] + Math.sin(yaw) * head[14]);
  const z = scale * (-Math.sin(yaw) * head[12] + Math.cos(yaw) * head[14]);
  rig.rotation.y = yaw;
  const { ground } = settings;
  const isInReach = ground !== null && (scale >= 1 || target[1] - ground <= scale * highest);
  const floor = isInReach ? ground : target[1] + scale * (eyesAbove - head[13]);
  rig.position.set(target[0] + step * awayX - x, floor, target[2] + step * awayZ - z);
}
