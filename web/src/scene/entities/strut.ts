// SPDX-License-Identifier: Apache-2.0
// Shapes from one point to another. They turn with the line by the smallest rotation, so that their roll changes
// smoothly.

import { Matrix4, Quaternion, Vector3 } from "three";
import type { StrutEntity } from "../../protocol/generated.ts";
import { moves, placeOf } from "../anchors.ts";
import { Placed } from "./placed.ts";

interface Aim {
  readonly direction: Vector3;
  readonly turn: Quaternion;
}

/** Shorter ones have no direction and are not drawn, m. */
const shortest = 1e-15;
const along = new Vector3(1, 0, 0);

export class StrutView extends Placed<StrutEntity> {
  /** Last rotation of each. */
  private readonly aims_ = new Map<number, Aim>();
  private readonly from_ = new Vector3();
  private readonly to_ = new Vector3();
  private readonly size_ = new Vector3();
  private readonly by_ = new Quaternion();
  private readonly own_ = new Matrix4();
  private readonly ownTurn_ = new Quaternion();

  override destroy(slot: number): void {
    super.destroy(slot);
    this.aims_.delete(slot);
  }

  protected isAttached_({ a, b }: StrutEntity): boolean {
    return moves(a) || moves(b);
  }

  protected place_({ id, a, b, length, part: { offset, rotation } }: StrutEntity, out: Matrix4): boolean {
    const { from_: from, to_: to, size_: size } = this;
    if (!placeOf(this.poses_, a, from) || !placeOf(this.poses_, b, to)) return false;
    const span = to.distanceTo(from);
    if (!(span > shortest)) return false;
    const middle = from.add(to).multiplyScalar(0.5);
    // `to` is one end, relative to the center.
    const turn = this.aim_(id.slot, to.sub(middle).divideScalar(span / 2));
    const own = this.own_.compose(size.set(...offset), this.ownTurn_.set(...rotation).normalize(), unit);
    out.compose(middle, turn, size.set(span / length, 1, 1)).multiply(own);
    return true;
  }

  private aim_(slot: number, direction: Vector3): Quaternion {
    let aim = this.aims_.get(slot);
    if (aim === undefined) {
      aim = { direction: along.clone(), turn: new Quaternion() };
      this.aims_.set(slot, aim);
    }
    aim.turn.premultiply(this.by_.setFromUnitVectors(aim.direction, direction)).normalize();
    aim.direction.copy(direction);
    return aim.turn;
  }
}

const unit = new Vector3(1, 1, 1);
