// SPDX-License-Identifier: Apache-2.0
// Places on bodies and frames, as drawn in this frame of the picture.

import { Quaternion, type Vector3 } from "three";
import { FIRST_FRAME, NO_BODY, type Anchor, type FrameEntity } from "../protocol/generated.ts";
import type { PoseBuffer } from "./pose_buffer.ts";

/** Largest depth of nested frames; deeper ones are a cycle. */
const deepest = 32;
const turn = new Quaternion();

/** World place of an anchor; false if its body or frame has no pose yet. */
export function placeOf(poses: PoseBuffer, { body, point }: Anchor, out: Vector3): boolean {
  out.set(point[0], point[1], point[2]);
  return fromBody(poses, body, out);
}

/** Transforms a place from the frame of a body (or a frame, or the world) to the world; false if it has no pose yet. */
export function fromBody(poses: PoseBuffer, body: number, place: Vector3): boolean {
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
export function turnOf(poses: PoseBuffer, body: number, out: Quaternion): boolean {
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

/** Whether it is on a body or on a frame, so that it may move. */
export function moves({ body }: Anchor): boolean {
  return body !== NO_BODY;
}

function frameOf(poses: PoseBuffer, body: number): FrameEntity | undefined {
  return poses.frames.get(body - FIRST_FRAME);
}
