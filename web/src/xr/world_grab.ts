// SPDX-License-Identifier: Apache-2.0
// Both hands pressed on nothing hold the world: what was under each hand stays there while they move, so that the world moves, turns
// about the vertical and grows or shrinks between them.

import { Vector3, type Object3D } from "three";
import type { Input } from "./input.ts";

/** Meters of the world in one of the user's, in sizes of the scene: from as large as a hall to as small as a thumb. */
const leastScale = 0.02;
const mostScale = 40;
/** Hands that are nearer to each other neither turn nor scale, m of the user's. */
const leastSpan = 0.03;

const upward = new Vector3(0, 1, 0);

/** Pressed, on no body. */
function holdsNothing({ pointer, tracked, hasBody, board }: Input): boolean {
  return pointer.pressed && pointer.grab === null && tracked && hasBody && board === null;
}

export class WorldGrab {
  private readonly rig_: Object3D;
  private readonly room_: Object3D;
  private left_: Input | null = null;
  private right_: Input | null = null;
  /** Places in the world that the hands hold, m. */
  private readonly heldLeft_ = new Vector3();
  private readonly heldRight_ = new Vector3();
  /** The present places of the hands in the room, m of the user's. */
  private readonly nowLeft_ = new Vector3();
  private readonly nowRight_ = new Vector3();
  private readonly middle_ = new Vector3();

  /** `rig`: the user's place in the world, turned about the vertical alone; `room`: in it, scaled. */
  constructor(rig: Object3D, room: Object3D) {
    this.rig_ = rig;
    this.room_ = room;
  }

  get active(): boolean {
    return this.left_ !== null;
  }

  /** Takes hold, follows or lets go; returns whether the user's place in the world changed. `size` of the scene, m. */
  update(inputs: readonly Input[], size: number): boolean {
    const [left, right, ...more] = inputs.filter(holdsNothing);
    if (right === undefined || more.length > 0) {
      this.left_ = this.right_ = null;
      return false;
    }
    this.nowLeft_.setFromMatrixPosition(left.rayLocal);
    this.nowRight_.setFromMatrixPosition(right.rayLocal);
    if (this.left_ !== left || this.right_ !== right) {
      this.left_ = left;
      this.right_ = right;
      this.heldLeft_.copy(this.nowLeft_).applyMatrix4(this.room_.matrixWorld);
      this.heldRight_.copy(this.nowRight_).applyMatrix4(this.room_.matrixWorld);
      return false;
    }
    this.follow_(size);
    return true;
  }

  private follow_(size: number): void {
    const { rig_: rig, room_: room, heldLeft_: a, heldRight_: b, nowLeft_: p, nowRight_: q, middle_: middle } = this;
    const span = p.distanceTo(q);
    if (span > leastSpan) {
      const scale = a.distanceTo(b) / span;
      room.scale.setScalar(Math.min(Math.max(scale, leastScale * size), mostScale * size));
      // Hands above each other tell no direction.
      if (Math.hypot(q.x - p.x, q.z - p.z) > leastSpan) {
        rig.rotation.y = Math.atan2(b.x - a.x, b.z - a.z) - Math.atan2(q.x - p.x, q.z - p.z);
      }
    }
    middle.addVectors(p, q).multiplyScalar(room.scale.x / 2).applyAxisAngle(upward, rig.rotation.y);
    rig.position.addVectors(a, b).multiplyScalar(0.5).sub(middle);
    rig.updateMatrixWorld();
  }
}
