// SPDX-License-Identifier: Apache-2.0
// The camera of a flat screen: orbit around a point, look around, walk through, all eased and
// interruptible. One state serves all of them: a point, a distance and two angles.

import { MathUtils, Vector3, type PerspectiveCamera } from "three";
import type { FittedView } from "./framing.ts";

const easeSeconds = 0.07;
/** A returning view takes longer than a dragged one. */
const travelSeconds = 0.25;
const steepest = 1.5;
/** Of the size of the scene: how near and far the camera goes, how far what it looks at is from the scene's middle. */
const nearest = 0.02;
const farthest = 14;
const widest = 4;
/** Of the same: height that the camera keeps over the ground, and walking in a second. */
const headroom = 0.02;
const pace = 0.75;

interface View {
  readonly pivot: Vector3;
  distance: number;
  yaw: number;
  pitch: number;
}

function makeView(): View {
  return { pivot: new Vector3(0, 1, 0), distance: 3, yaw: 0.5, pitch: 0.15 };
}

export class Navigation {
  /** Whether a drag on nothing looks around from the place instead of orbiting. */
  flying = false;
  /** Height of the ground, m, which the camera stays above; null: anywhere. */
  ground: number | null = null;
  /** Whether the user has moved the camera since it was last at its first view. */
  touched = false;
  /** Rises whenever the user moves the camera by hand. */
  moves = 0;
  /** Right, up, forward in -1..1, from keys. */
  readonly walk = new Vector3();
  /** Walking three times as fast. */
  walkingFast = false;

  private readonly camera_: PerspectiveCamera;
  private readonly goal_ = makeView();
  private readonly now_ = makeView();
  private readonly home_ = makeView();
  private seconds_ = easeSeconds;
  private readonly direction_ = new Vector3();
  private readonly right_ = new Vector3();
  private readonly up_ = new Vector3();
  private readonly middle_ = new Vector3(0, 1, 0);
  private size_ = 2;

  constructor(camera: PerspectiveCamera) {
    this.camera_ = camera;
  }

  /** Where the scene is and how large, m: paces and limits follow it. */
  setScene(middle: readonly [number, number, number], size: number): void {
    this.middle_.set(...middle);
    this.size_ = size;
  }

  /** Distance from the camera to what it looks at, m. */
  get distance(): number {
    return this.now_.distance;
  }

  /** The view that reset returns to. */
  setHome({ pivot, distance, yaw, pitch }: FittedView): void {
    this.home_.pivot.set(...pivot);
    this.home_.distance = distance;
    this.home_.yaw = yaw;
    this.home_.pitch = MathUtils.clamp(pitch, -steepest, steepest);
  }

  get home(): FittedView {
    const { pivot, distance, yaw, pitch } = this.home_;
    return { pivot: [pivot.x, pivot.y, pivot.z], distance, yaw, pitch };
  }

  /** The view that the camera is on its way to. */
  get goal(): FittedView {
    const { pivot, distance, yaw, pitch } = this.goal_;
    return { pivot: [pivot.x, pivot.y, pivot.z], distance, yaw, pitch };
  }

  /** Goes to a view, which stays the user's. */
  goTo({ pivot, distance, yaw, pitch }: FittedView): void {
    this.touched = true;
    this.goal_.pivot.set(...pivot);
    this.goal_.distance = distance;
    this.goal_.yaw = yaw;
    this.goal_.pitch = pitch;
    this.seconds_ = travelSeconds;
  }

  /** Is at a view at once, which stays the user's. */
  jumpTo(view: FittedView): void {
    this.goTo(view);
    copyView(this.goal_, this.now_);
  }

  /** Moves along with something, m. */
  shift(way: Vector3): void {
    this.touched = true;
    this.goal_.pivot.add(way);
    this.now_.pivot.add(way);
  }

  /** Goes after a first view that moves. */
  follow(): void {
    copyView(this.home_, this.goal_);
    this.seconds_ = travelSeconds;
  }

  /** Goes to the first view without a way there. */
  jumpHome(): void {
    this.touched = false;
    copyView(this.home_, this.goal_);
    copyView(this.home_, this.now_);
  }

  reset(): void {
    this.touched = false;
    this.moves++;
    copyView(this.home_, this.goal_);
    // The short way round.
    this.goal_.yaw += 2 * Math.PI * Math.round((this.now_.yaw - this.goal_.yaw) / (2 * Math.PI));
    this.seconds_ = travelSeconds;
  }

  /** Drag by so many css pixels: turn about the pivot. */
  orbit(dx: number, dy: number): void {
    this.touch_();
    this.goal_.yaw -= dx * 0.006;
    this.goal_.pitch = MathUtils.clamp(this.goal_.pitch + dy * 0.006, -steepest, steepest);
  }

  /** Look around from where the camera is. */
  look(dx: number, dy: number): void {
    this.touch_();
    const eye = this.eyeOf_(this.goal_, new Vector3());
    this.goal_.yaw -= dx * 0.0035;
    this.goal_.pitch = MathUtils.clamp(this.goal_.pitch + dy * 0.0035, -steepest, steepest);
    this.goal_.pivot.copy(eye).sub(this.awayOf_(this.goal_, this.direction_).multiplyScalar(this.goal_.distance));
  }

  /** Move sideways with the pointer: what lies at the pivot's depth stays under it. */
  pan(dx: number, dy: number, viewHeight: number): void {
    this.touch_();
    const meters = (2 * this.goal_.distance * Math.tan(MathUtils.degToRad(this.camera_.fov / 2))) / viewHeight;
    this.axes_(this.goal_);
    this.goal_.pivot.addScaledVector(this.right_, -dx * meters).addScaledVector(this.up_, dy * meters);
    this.keepNear_();
  }

  /**
   * Above 1: away. What is at x, y of the picture (-1 .. 1, right and up), `depth` m from the camera or as far as the pivot, stays
   * there.
   */
  zoom(factor: number, x = 0, y = 0, depth = this.goal_.distance): void {
    this.touch_();
    const before = this.goal_.distance;
    this.goal_.distance = MathUtils.clamp(before * factor, nearest * this.size_, farthest * this.size_);
    const share = 1 - this.goal_.distance / before;
    const tangent = Math.tan(MathUtils.degToRad(this.camera_.fov / 2));
    this.axes_(this.goal_);
    this.goal_.pivot
      .addScaledVector(this.right_, share * x * tangent * this.camera_.aspect * depth)
      .addScaledVector(this.up_, share * y * tangent * depth)
      .addScaledVector(this.direction_, share * (before - depth));
    this.keepNear_();
  }

  /** Advances and places the camera; returns whether it moved. */
  update(seconds: number): boolean {
    if (this.walk.lengthSq() > 0) {
      this.touch_();
      this.axes_(this.goal_);
      const way = (this.walkingFast ? 3 : 1) * pace * this.size_ * seconds;
      this.awayOf_(this.goal_, this.direction_);
      this.goal_.pivot
        .addScaledVector(this.right_, this.walk.x * way)
        .addScaledVector(this.direction_, -this.walk.z * way);
      this.goal_.pivot.y += this.walk.y * way;
      this.keepNear_();
    }
    this.keepAbove_();
    const ease = 1 - Math.exp(-seconds / this.seconds_);
    const before = { turn: this.now_.yaw + this.now_.pitch, distance: this.now_.distance };
    const drift = this.now_.pivot.distanceTo(this.goal_.pivot);
    this.now_.pivot.lerp(this.goal_.pivot, ease);
    this.now_.distance += (this.goal_.distance - this.now_.distance) * ease;
    this.now_.yaw += (this.goal_.yaw - this.now_.yaw) * ease;
    this.now_.pitch += (this.goal_.pitch - this.now_.pitch) * ease;
    this.eyeOf_(this.now_, this.camera_.position);
    this.camera_.rotation.set(-this.now_.pitch, this.now_.yaw, 0, "YXZ");
    const least = 1e-6 * this.size_;
    return drift > least || Math.abs(this.now_.distance - before.distance) > least || Math.abs(this.now_.yaw + this.now_.pitch - before.turn) > 1e-6;
  }

  private touch_(): void {
    this.touched = true;
    this.moves++;
    this.seconds_ = easeSeconds;
  }

  /** What the camera looks at stays where there is something to see. */
  private keepNear_(): void {
    this.goal_.pivot.sub(this.middle_).clampLength(0, widest * this.size_).add(this.middle_);
  }

  /** Unit vector from the pivot to the camera. */
  private awayOf_(view: View, out: Vector3): Vector3 {
    const flat = Math.cos(view.pitch);
    return out.set(flat * Math.sin(view.yaw), Math.sin(view.pitch), flat * Math.cos(view.yaw));
  }

  private eyeOf_(view: View, out: Vector3): Vector3 {
    return this.awayOf_(view, out).multiplyScalar(view.distance).add(view.pivot);
  }

  private axes_(view: View): void {
    this.awayOf_(view, this.direction_);
    this.right_.set(Math.cos(view.yaw), 0, -Math.sin(view.yaw));
    this.up_.crossVectors(this.direction_, this.right_);
  }

  private keepAbove_(): void {
    if (this.ground === null) return;
    const lowest = this.ground + headroom * Math.min(this.size_, this.goal_.distance);
    const height = this.goal_.pivot.y + this.goal_.distance * Math.sin(this.goal_.pitch);
    if (height >= lowest) return;
    const pitch = (lowest - this.goal_.pivot.y) / this.goal_.distance;
    if (Math.abs(pitch) < 1) this.goal_.pitch = Math.asin(pitch);
    else this.goal_.pivot.y += lowest - height;
  }
}

function copyView(from: View, to: View): void {
  to.pivot.copy(from.pivot);
  to.distance = from.distance;
  to.yaw = from.yaw;
  to.pitch = from.pitch;
}
