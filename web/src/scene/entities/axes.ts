// SPDX-License-Identifier: Apache-2.0
// Axes of bodies and of the world: x red, y green, z blue.

import { Quaternion, Vector3 } from "three";
import type { AxesEntity } from "../../protocol/generated.ts";
import { moves, placeOf, turnOf } from "../anchors.ts";
import type { Points } from "../points.ts";
import { addArrow } from "./arrow.ts";
import { Stroked } from "./stroked.ts";

const colors = [0xd0402b, 0x4c9a52, 0x3f7fd0];

export class AxesView extends Stroked<AxesEntity> {
  private readonly origin_ = new Vector3();
  private readonly tip_ = new Vector3();
  private readonly turn_ = new Quaternion();
  private readonly own_ = new Quaternion();

  /** Only those in the world, as for arrows. */
  addPlaces(points: Points): void {
    for (const axes of this.records_.values()) {
      if (moves(axes.at)) continue;
      points.add(...axes.at.point);
      for (let axis = 0; axis < 3; axis++) if (this.aim_(axes, axis)) points.add(this.tip_.x, this.tip_.y, this.tip_.z);
    }
  }

  protected isAttached_({ at }: AxesEntity): boolean {
    return moves(at);
  }

  protected write_(axes: AxesEntity): void {
    colors.forEach((color, axis) => {
      if (this.aim_(axes, axis)) addArrow(this.strokes_, this.origin_, this.tip_, 0, color);
    });
  }

  /** Calculates start and end of one of the arrows; false if the body has no pose yet. */
  private aim_({ at, rotation, length }: AxesEntity, axis: number): boolean {
    if (!placeOf(this.poses_, at, this.origin_) || !turnOf(this.poses_, at.body, this.turn_)) return false;
    this.turn_.multiply(this.own_.set(...rotation).normalize());
    this.tip_.set(0, 0, 0).setComponent(axis, length).applyQuaternion(this.turn_).add(this.origin_);
    return true;
  }
}
