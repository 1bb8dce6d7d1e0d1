// SPDX-License-Identifier: Apache-2.0
// Places on bodies and frames, by given poses.

import { Quaternion, type Vector3 } from "three";
import { FIRST_FRAME, NO_BODY, type Anchor, type FrameEntity } from "../protocol/generated.ts";

/** Poses of bodies by slot, as PoseBuffer keeps them, and the frames of the script. */
export interface Poses {
  readonly known: Uint8Array;
  readonly position: Float32Array;
  readonly rotation: Float32Array;
  readonly frames: ReadonlyMap<number, FrameEntity>;
}

/** Largest depth of nested frames; deeper ones are a cycle. */
const deepest = 32;
const turn = new Quaternion();

/** World place of an anchor; false if its body or frame has no pose yet. */
export function placeOf(poses: Poses, { body, point }: Anchor, out: Vector3): boolean {
  out.set(point[0], point[1], point[2]);
  return fromBody(poses, body, out);
}

/** Transforms a place from the frame of a body (or a frame, or the world) to the world; false if it has no pose yet. */
export function fromBody(poses: Poses, body: number, place: Vector3): boolean {
  for (let depth = 0; body >= FIRST_FRAME && body !== NO_BODY; depth++) {
    const frame = frameOf(poses, body);
    if (frame === undefined || depth === deepest) return false;
    const { at: { point }, rotation } = frame;
    place.applyQuaternion(turn.fromArray(rotation));
    place.x += point[0];
    place.y += point[1];
    place.z += point[2];
    body = frame.at.body;
  }
  if (body === NO_BODY) return true;
  if (poses.known[body] !== 1) return false;
  const { position, rotation } = poses;
  place.applyQuaternion(turn.fromArray(rotation, 4 * body));
  place.x += position[3 * body];
  place.y += position[3 * body + 1];
  place.z += position[3 * body + 2];
  return true;
}

/** Orientation of a body, a frame or the world; false if it has no pose yet. */
export function turnOf(poses: Poses, body: number, out: Quaternion): boolean {
  out.identity();
  for (let depth = 0; body >= FIRST_FRAME && body !== NO_BODY; depth++) {
    const frame = frameOf(poses, body);
    if (frame === undefined || depth === deepest) return false;
    out.premultiply(turn.fromArray(frame.rotation));
    body = frame.at.body;
  }
  if (body === NO_BODY) return true;
  if (poses.known[body] !== 1) return false;
  out.premultiply(turn.fromArray(poses.rotation, 4 * body));
  return true;
}

/** The body that an anchor is on, directly or by frames; NO_BODY for a place in the world. */
export function bodyOf(poses: Poses, { body }: Anchor): number {
  for (let depth = 0; body >= FIRST_FRAME && body !== NO_BODY; depth++) {
    const frame = frameOf(poses, body);
    if (frame === undefined || depth === deepest) return NO_BODY;
    body = frame.at.body;
  }
  return body;
}

/** Whether it is on a body or on a frame, so that it may move. */
export function moves({ body }: Anchor): boolean {
  return body !== NO_BODY;
}

function frameOf(poses: Poses, body: number): FrameEntity | undefined {
  return poses.frames.get(body - FIRST_FRAME);
}
