// SPDX-License-Identifier: Apache-2.0
// The user's place at the start of a session and at "home": before the scene, facing it, so far away and so low that it is whole in the
// view without a turn of the head. Pure functions.

import type { Vec3 } from "../protocol/generated.ts";

/** The first view of a world: from where it is seen, how high its ground is (m; null: none), and how many of its meters are one of the user's. */
export interface Standing {
  readonly scale: number;
  readonly eye: Readonly<Vec3>;
  readonly target: Readonly<Vec3>;
  readonly ground: number | null;
  /** From where on the level all that moves is in the headset's view, m from the target; 0: from anywhere. */
  readonly toShow?: number;
}

/** The used part of a rig; three's Object3D has it. */
export interface Rig {
  readonly position: { set(x: number, y: number, z: number): unknown };
  readonly rotation: { y: number };
}

/** The shortest distance from the scene at which a user first stands, m of the user's. */
const nearest = 0.9;
/** A step is shorter than a camera's distance, as a headset has a wider view than a screen. */
const ofCamera = 0.75;
/** A wide scene is seen from farther away, up to so many distances of the camera. */
const widestStep = 1.3;
/** Without a ground in reach, eyes are this far above the scene's center, m. */
const eyesAbove = 0.15;
/** A small scene whose center is farther above the ground is out of reach from there, m of the user's. */
const highest = 2.5;
/** Eyes are at most this far above the scene's center, in steps from it: 17 degrees, as its lower half has to be in view too. */
const steepest = 0.3;
/** Eyes never come nearer to the ground, since hands hang below them, m of the user's. */
const lowest = 0.6;

/**
 * Scenes that the script's camera sees from the one to the other distance, m, are as large as they are; others are as large as a table.
 * Not by what is there at the moment: rockets that fly or a rod that falls would change it.
 */
const closest = 1.2;
const remotest = 25;
const tableDistance = 2;

/** Meters of the world in one of the user's, so that a scene seen from a distance by the script's camera can be looked at and worked on. */
export function fitScale(distance: number): number {
  return distance >= closest && distance <= remotest ? 1 : tableScale(distance);
}

export function tableScale(distance: number): number {
  return distance / tableDistance;
}

/**
 * Moves and turns the rig so that the head (its transform in the reference space, column by column) is in front of the center of the
 * world's view, on the side of the script's camera. On the world's ground, raised by `raised` if the user sits (m of the user's); but a
 * low scene is brought up to the eyes: then the ground is above the user's floor, as a table is.
 */
export function standBefore(settings: Standing, head: ArrayLike<number>, raised: number, rig: Rig): void {
  const { eye, target, scale, ground, toShow = 0 } = settings;
  let awayX = eye[0] - target[0];
  let awayZ = eye[2] - target[2];
  const far = Math.hypot(awayX, awayZ);
  if (far > 1e-6 * scale) {
    awayX /= far;
    awayZ /= far;
  } else {
    awayX = 0;
    awayZ = 1;
  }
  const step = Math.max(ofCamera * far, Math.min(toShow, widestStep * far), scale * nearest);
  // The head looks along -z of its own frame; turned about y by `yaw`, -z points to (-sin yaw, -cos yaw).
  const facing = Math.atan2(awayX, awayZ);
  const flat = Math.hypot(head[8], head[10]);
  const looking = flat > 1e-3 ? Math.atan2(head[8], head[10]) : 0;
  const yaw = facing - looking;
  const x = scale * (Math.cos(yaw) * head[12] + Math.sin(yaw) * head[14]);
  const z = scale * (-Math.sin(yaw) * head[12] + Math.cos(yaw) * head[14]);
  rig.rotation.y = yaw;
  const isInReach = ground !== null && (scale >= 1 || target[1] - ground <= scale * highest);
  const eyes = isInReach
    ? Math.min(ground + scale * (head[13] + raised), Math.max(target[1] + steepest * step, ground + scale * lowest))
    : target[1] + scale * eyesAbove;
  rig.position.set(target[0] + step * awayX - x, eyes - scale * head[13], target[2] + step * awayZ - z);
}
