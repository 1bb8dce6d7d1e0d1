// SPDX-License-Identifier: Apache-2.0
// Places on bodies, as drawn in this frame.

import { Quaternion, type Vector3 } from "three";
import { NO_BODY, type Anchor } from "../protocol/generated.ts";
import type { PoseBuffer } from "./pose_buffer.ts";

const turn = new Quaternion();

/** World place of an anchor; false where its body is not known yet. */
export function placeOf(poses: PoseBuffer, { body, point }: Anchor, out: Vector3): boolean {
  out.set(point[0], point[1], point[2]);
  return fromBody(poses, body, out);
}

/** Turns a place in the frame of a body (or the world) into one of the world; false where the body is not known yet. */
export function fromBody(poses: PoseBuffer, body: number, place: Vector3): boolean {
  if (body === NO_BODY) return true;
  if (poses.known[body] !== 1) return false;
  const { position, rotation } = poses;
  place.applyQuaternion(turn.fromArray(rotation, 4 * body));
  place.x += position[3 * body];
  place.y += position[3 * body + 1];
  place.z += position[3 * body + 2];
  return true;
}

/** Orientation of a body, or of the world; false where it is not known yet. */
export function turnOf(poses: PoseBuffer, body: number, out: Quaternion): boolean {
  if (body === NO_BODY) {
    out.identity();
    return true;
  }
  if (poses.known[body] !== 1) return false;
  out.fromArray(poses.rotation, 4 * body);
  return true;
}
