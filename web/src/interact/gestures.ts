// SPDX-License-Identifier: Apache-2.0
// One pipeline for mouse, touch, controller ray, near grab and pinch: hover, start, update, end.
// A source writes a Pointer and calls update(); this file interprets it. It acts on presses and releases only and needs
// no hover before a press, since a pinch may appear at the moment of its start.

import type { Pickable } from "../scene/pickable.ts";
import { Hit, pickPoint, pickRay, toWorld } from "./picking.ts";

/**
 * How a held body follows. plane: stays under the pointer in the plane that faces the viewer (mouse, touch). ray: stays
 * at its distance on the ray (controller).
 */
export type RayDrag = "plane" | "ray";

/** State of a source of input; its owner writes the fields, then calls Gestures.update(pointer). */
export class Pointer {
  /** For users and tests: "mouse", "touch 1", "right". */
  readonly name: string;
  /** Off: no hover, and its grab ends. */
  active = false;
  pressed = false;
  /** Ray in the world: origin in m, unit direction. */
  readonly origin = new Float32Array(3);
  readonly direction = new Float32Array([0, 0, -1]);
  /** Half-angle of the cone in which a near miss still counts, as a tangent. */
  tolerance = 0.004;
  /** Place of a near grab, world, m; used only if `nearReach` is above 0. */
  readonly tip = new Float32Array(3);
  /** Distance from the tip within which a near grab wins over the ray, m; 0: never. */
  nearReach = 0;
  /** Whether the ray picks (off for hands that only grab near). */
  far = true;
  drag: RayDrag = "plane";
  /** Unit normal of the drag plane, pointing away from the viewer; for drag "plane". */
  readonly facing = new Float32Array([0, 0, -1]);
  /** Distance by which the held body is pushed away from the viewer, m; the pointer's owner adds to it (wheel, thumbstick). */
  depth = 0;
  /** When it was pressed or released last, ms of performance.now(); 0: its owner does not know, so that it is when it is told of. */
  at = 0;
  /** The state of a hand or controller, for scripts: x y z w in the world; how far its buttons are pressed; its sticks; its joints in the world, m. */
  readonly rotation: [number, number, number, number] = [0, 0, 0, 1];
  readonly buttons: number[] = [];
  readonly axes: number[] = [];
  readonly joints: number[] = [];
  /** A haptic pulse; strength 0..1. */
  pulse: (strength: number, milliseconds: number) => void = () => {};

  /** Below: written by Gestures for the owner. */
  hovered = -1;
  /** The body under the pointer is within near reach. */
  near = false;
  readonly hit = new Hit();
  grab: Grab | null = null;

  constructor(name: string) {
    this.name = name;
  }
}

/** One hand on one body. */
export class Grab {
  /** This client's number for the hold, as sent to the server. */
  readonly hold: number;
  body: number;
  /** The body was destroyed, or became part of another one. */
  isGone = false;
  /** Its target counts from the place where the server acts on the body. */
  isPlaced = false;
  readonly pointer: Pointer;
  readonly near: boolean;
  /** In the body's frame, m. */
  readonly localPoint: Float32Array;
  /** Place of the hand, world, m. */
  readonly target: Float32Array;
  /** Grabbed point at the start, world, m. */
  readonly start: Float32Array;
  /** Distance along the ray at the start, m. */
  readonly distance: number;
  /** From the pointer's target to the grabbed point at the start, m: a near miss must not jerk the body. */
  readonly offset = new Float32Array(3);
  readonly startedAt: number;

  constructor(hold: number, pointer: Pointer, hit: Hit, near: boolean, now: number) {
    this.hold = hold;
    this.body = hit.body;
    this.pointer = pointer;
    this.near = near;
    this.localPoint = hit.localPoint.slice();
    this.start = hit.point.slice();
    this.target = hit.point.slice();
    this.distance = hit.distance;
    this.startedAt = now;
  }
}

export interface GestureListener {
  /** Whether a press takes hold of a body; otherwise it is told of by `bodyPressed`, and a drag moves the camera. Default: it does. */
  mayHold?(): boolean;
  bodyPressed?(body: number): void;
  /** The body under a pointer changed; -1: none. */
  hoverChanged(pointer: Pointer, body: number): void;
  grabStarted(grab: Grab): void;
  /** The target moved. */
  grabMoved(grab: Grab): void;
  grabEnded(grab: Grab): void;
  /** A press on no body: the source may orbit, teleport or clear the selection. */
  pressedNothing(pointer: Pointer): void;
  /** The end of such a press, or of one whose grab has ended before. */
  releasedNothing?(pointer: Pointer): void;
}

/** Relative to the size of the scene: range of a ray, least distance of a hold, smallest move of a target that is sent.
 * */
const farthest = 100;
const nearest = 0.03;
const still = 5e-6;

export class Gestures {
  readonly grabs: Grab[] = [];
  private readonly scene_: Pickable;
  private readonly listener_: GestureListener;
  private readonly pointers_: Pointer[] = [];
  private readonly wasPressed_ = new Set<Pointer>();
  private nextHold_ = 1;
  private readonly target_ = new Float32Array(3);

  constructor(scene: Pickable, listener: GestureListener) {
    this.scene_ = scene;
    this.listener_ = listener;
  }

  get mayHold(): boolean {
    return this.listener_.mayHold?.() !== false;
  }

  get pointers(): readonly Pointer[] {
    return this.pointers_;
  }

  add(pointer: Pointer): void {
    if (!this.pointers_.includes(pointer)) this.pointers_.push(pointer);
  }

  /** Ends its grab and removes it. */
  remove(pointer: Pointer): void {
    pointer.active = false;
    pointer.pressed = false;
    this.update(pointer);
    const index = this.pointers_.indexOf(pointer);
    if (index >= 0) this.pointers_.splice(index, 1);
    this.wasPressed_.delete(pointer);
  }

  /** Once a frame, after poses were sampled, since bodies move under resting pointers. */
  updateAll(): void {
    for (let index = 0; index < this.pointers_.length; index++) this.update(this.pointers_[index]);
  }

  /** Updates one pointer now; sources call it on press and release. */
  update(pointer: Pointer): void {
    const pressed = pointer.active && pointer.pressed;
    const before = this.wasPressed_.has(pointer);
    if (pressed && !before) {
      this.wasPressed_.add(pointer);
      this.press_(pointer);
      return;
    }
    if (!pressed && before) {
      this.wasPressed_.delete(pointer);
      if (pointer.grab === null) this.listener_.releasedNothing?.(pointer);
      else this.release(pointer);
    }
    if (pointer.grab !== null) this.follow_(pointer.grab);
    else if (!pressed) this.hover_(pointer);
  }

  /** Ends the pointer's grab, if it has one. */
  release(pointer: Pointer): void {
    const grab = pointer.grab;
    if (grab === null) return;
    pointer.grab = null;
    this.grabs.splice(this.grabs.indexOf(grab), 1);
    this.listener_.grabEnded(grab);
  }

  /** Ends all grabs (connection lost, session over). */
  releaseAll(): void {
    for (const grab of this.grabs.slice()) this.release(grab.pointer);
  }

  /** A body was destroyed: marks the grabs on it and stops hovering over it. */
  forget(body: number): void {
    for (const grab of this.grabs) if (grab.body === body) grab.isGone = true;
    for (const pointer of this.pointers_) {
      if (pointer.hovered !== body) continue;
      pointer.hovered = -1;
      this.listener_.hoverChanged(pointer, -1);
    }
  }

  private pick_(pointer: Pointer): boolean {
    pointer.near = pointer.nearReach > 0 && pickPoint(this.scene_, pointer.tip, pointer.nearReach, pointer.hit);
    if (pointer.near) return true;
    return pointer.far
      && pickRay(this.scene_, pointer.origin, pointer.direction, pointer.tolerance, farthest * this.scene_.size, pointer.hit);
  }

  private hover_(pointer: Pointer): void {
    const body = pointer.active && this.pick_(pointer) ? pointer.hit.body : -1;
    if (body === pointer.hovered) return;
    pointer.hovered = body;
    this.listener_.hoverChanged(pointer, body);
  }

  private press_(pointer: Pointer): void {
    if (!this.pick_(pointer)) {
      this.listener_.pressedNothing(pointer);
      return;
    }
    if (pointer.hovered !== pointer.hit.body) {
      pointer.hovered = pointer.hit.body;
      this.listener_.hoverChanged(pointer, pointer.hit.body);
    }
    if (!this.mayHold) {
      this.listener_.bodyPressed?.(pointer.hit.body);
      return;
    }
    pointer.depth = 0;
    const grab = new Grab(this.nextHold_++, pointer, pointer.hit, pointer.near, performance.now());
    if (this.calcTarget_(grab, this.target_)) {
      for (let axis = 0; axis < 3; axis++) grab.offset[axis] = grab.start[axis] - this.target_[axis];
    }
    pointer.grab = grab;
    this.grabs.push(grab);
    this.listener_.grabStarted(grab);
  }

  private follow_(grab: Grab): void {
    const target = this.target_;
    if (!this.calcTarget_(grab, target)) return;
    const moved = Math.hypot(target[0] - grab.target[0], target[1] - grab.target[1], target[2] - grab.target[2]);
    if (moved < still * this.scene_.size) return;
    grab.target.set(target);
    this.listener_.grabMoved(grab);
  }

  private calcTarget_(grab: Grab, out: Float32Array): boolean {
    const { origin, direction, facing, tip, depth } = grab.pointer;
    if (grab.near) {
      for (let axis = 0; axis < 3; axis++) out[axis] = tip[axis] + grab.offset[axis];
      return true;
    }
    const least = Math.min(nearest * this.scene_.size, grab.distance);
    let along = Math.max(grab.distance + depth, least);
    if (grab.pointer.drag === "plane") {
      const slope = direction[0] * facing[0] + direction[1] * facing[1] + direction[2] * facing[2];
      // For a ray nearly parallel to the plane, the point would move to the horizon.
      if (slope < 0.05) return false;
      const away = (grab.start[0] - origin[0]) * facing[0] + (grab.start[1] - origin[1]) * facing[1]
        + (grab.start[2] - origin[2]) * facing[2];
      along = Math.min(Math.max((away + depth) / slope, least), farthest * this.scene_.size);
    }
    for (let axis = 0; axis < 3; axis++) out[axis] = origin[axis] + direction[axis] * along + grab.offset[axis];
    return true;
  }

  /** Drawn place of a grab's point, world, m. */
  grabbedPoint(grab: Grab, out: Float32Array): void {
    toWorld(this.scene_, grab.body, grab.localPoint, out);
  }
}
