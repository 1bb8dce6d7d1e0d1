// SPDX-License-Identifier: Apache-2.0
// Tells the script where pointers are and what is pressed on them: mouse, fingers, hands, controllers, gamepad. Fetched when the
// script listens to that.

import { Vector3 } from "three";
import type { Pointer } from "../interact/gestures.ts";
import { PointerKind, type ClientMessage, type Vec3 } from "../protocol/generated.ts";
import type { PageParts } from "./page_parts.ts";

type Move = Extract<ClientMessage, { type: "pointer" }>;

/** A headset draws faster than scripts are called. */
const everyMs = 1000 / 60;

export class PointerMoves {
  private readonly parts_: Pick<PageParts, "world" | "session" | "gestures" | "viewer">;
  /** The last message of each pointer, by its name. */
  private readonly told_ = new Map<string, string>();
  /** The pointers whose latest report had something pressed. */
  private readonly pressed_ = new Set<Pointer>();
  private last_ = 0;
  private readonly a_ = new Vector3();
  private readonly b_ = new Vector3();

  constructor(parts: Pick<PageParts, "world" | "session" | "gestures" | "viewer">) {
    this.parts_ = parts;
  }

  /** Once a frame: tells what differs from before. */
  tell(): void {
    const now = performance.now();
    if (now - this.last_ < everyMs - 2) return;
    this.last_ = now;
    for (const pointer of this.parts_.gestures.pointers) if (pointer.active) this.tellNow(pointer);
    // A controller may be gone with a button down.
    for (const pointer of this.pressed_) if (!pointer.active) this.tellNow(pointer);
    const pad = navigator.getGamepads().find((each) => each !== null);
    if (pad !== undefined && pad !== null && !this.parts_.viewer.presenting) this.send_(this.moveOfPad_(pad));
  }

  /** A press or release must not wait for a frame: both may be before the next one, and a finger is gone when it is lifted. */
  tellNow(pointer: Pointer): void {
    const told = this.moveOf_(pointer);
    if (told.buttons.some((value) => value > 0)) this.pressed_.add(pointer);
    else this.pressed_.delete(pointer);
    this.send_(told);
  }

  private moveOf_(pointer: Pointer): Move {
    const known = pointer.buttons.length > 0 ? pointer.buttons : [pointer.pressed ? 1 : 0];
    const buttons = pointer.active ? known : known.map(() => 0);
    return move(pointer.name, this.placeOf_(pointer), pointer.origin, pointer.direction, pointer.rotation, buttons, pointer.axes, pointer.joints);
  }

  /** The place of a pointer: the tip of a hand; for a mouse or finger the held or hovered point, or the point of its ray beside the middle of the view. */
  private placeOf_({ grab, hovered, hit, tip, origin, direction, drag }: Pointer): ArrayLike<number> {
    if (drag === "ray") return tip;
    if (grab !== null) return grab.target;
    if (hovered >= 0) return hit.point;
    const { viewer } = this.parts_;
    const facing = viewer.camera.getWorldDirection(this.a_);
    const ray = this.b_.fromArray(direction);
    return ray.multiplyScalar(viewer.lookDistance() / Math.max(ray.dot(facing), 0.05)).add(facing.fromArray(origin)).toArray();
  }

  private moveOfPad_({ buttons, axes }: Gamepad): Move {
    const { camera } = this.parts_.viewer;
    const at = camera.getWorldPosition(this.a_).toArray();
    const rounded = axes.map((value) => Math.round(value * 100) / 100);
    return move("gamepad", at, at, camera.getWorldDirection(this.b_).toArray(), [0, 0, 0, 1], buttons.map(({ value }) => value), rounded, []);
  }

  private send_(told: Move): void {
    const text = JSON.stringify([told.point, told.direction, told.rotation, ...[told.buttons, told.axes, told.joints].map((each) => [...each])]);
    if (this.told_.get(told.name) === text) return;
    this.told_.set(told.name, text);
    this.parts_.session.send(told);
  }
}

function move(
  name: string, point: ArrayLike<number>, origin: ArrayLike<number>, direction: ArrayLike<number>, rotation: Move["rotation"],
  buttons: ArrayLike<number>, axes: ArrayLike<number>, joints: ArrayLike<number>,
): Move {
  return {
    type: "pointer", kind: PointerKind.move, body: { slot: 0, generation: 0 }, name: name.slice(0, 16), point: vec3(point), origin: vec3(origin),
    direction: vec3(direction), rotation: [...rotation], buttons: Float32Array.from(Array.from(buttons).slice(0, 32)), axes: Float32Array.from(Array.from(axes).slice(0, 16)),
    joints: Float32Array.from(joints),
  };
}

function vec3(from: ArrayLike<number>): Vec3 {
  return [from[0], from[1], from[2]];
}
