// SPDX-License-Identifier: Apache-2.0
// Shapes on bodies, on frames and in the world.

import { Quaternion, Vector3, type Matrix4 } from "three";
import { NO_BODY, type MarkerEntity } from "../../protocol/generated.ts";
import { fromBody, turnOf } from "../anchors.ts";
import { Placed } from "./placed.ts";

const unit = new Vector3(1, 1, 1);

export class MarkerView extends Placed<MarkerEntity> {
  private readonly origin_ = new Vector3();
  private readonly turn_ = new Quaternion();
  private readonly own_ = new Quaternion();

  protected isAttached_({ body }: MarkerEntity): boolean {
    return body !== NO_BODY;
  }

  protected place_({ body, part: { offset, rotation } }: MarkerEntity, out: Matrix4): boolean {
    if (!turnOf(this.poses_, body, this.turn_) || !fromBody(this.poses_, body, this.origin_.set(...offset))) return false;
    out.compose(this.origin_, this.turn_.multiply(this.own_.set(...rotation)), unit);
    return true;
  }
}
