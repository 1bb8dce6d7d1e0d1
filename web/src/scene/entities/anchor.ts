// SPDX-License-Identifier: Apache-2.0
// Where an anchor is now: a point of a body, or of the world.

import { Quaternion, type Vector3 } from "three";
import { NO_BODY, type Anchor } from "../../protocol/generated.ts";
import type { PoseBuffer } from "../pose_buffer.ts";

const turn = new Quaternion();

/** World place of an anchor, m; false where its body is not known yet. */
export function calcAnchor({ known, position, rotation }: PoseBuffer, { body, point }: Anchor, out: Vector3): boolean {
  out.set(point[0], point[1], point[2]);
  if (body === NO_BODY) return true;
  if (known[body] !== 1) return false;
  out.applyQuaternion(turn.fromArray(rotation, 4 * body));
  out.x += position[3 * body];
  out.y += position[3 * body + 1];
  out.z += position[3 * body + 2];
  return true;
}
