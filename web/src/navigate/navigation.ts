// SPDX-License-Identifier: Apache-2.0
// The camera of a flat screen: orbit around a point, look around, walk through, all eased and
// interruptible. All modes use one state: a point, a distance and two angles.

import { MathUtils, Vector3, type PerspectiveCamera } from "three";
import type { FittedView } from "./framing.ts";

const easeSeconds = 0.07;
/** Returning to a view is slower than a drag. */
const travelSeconds = 0.25;
/** In distances from the camera to what it looks at. */
const longestTravel = 3;
const steepest = 1.5;
/** Relative to the size of the scene: limits of the camera's distance, and of the pivot's distance from the scene's
 * center. */
const nearest = 0.02;
const farthest = 14;
const widest = 4;
/** Also relative: least height of the camera over the ground, and walking distance per second. */
const headroom = 0.02;
const pace = 0.75;
/** And the distance that a walk keeps from walls. */
const elbowroom = 0.03;
/** Acceleration of a fall, m/s²; in a world that is smaller than a meter, in its sizes. */
const gravity = 9.81;

export interface Walls {
  /** Shortens and bends a way from a place to one that a ball of a radius can go, m; whether it leads over an edge. */
  slide(from: Vector3, way: Vector3, radius: number): boolean;
  /** Height of what one stands on at a place, m; -Infinity: nothing. */
  floorBelow(place: Vector3): number;
}

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
  /** Whether a drag on empty space looks around instead of orbiting. */
  flying = false;
  /** Whether it selects what is within its rectangle. */
  banding = false;
  /** Height of the ground, m, which the camera stays above; null: anywhere. */
  ground: number | null = null;
  /** Whether the user has moved the camera since it was last at its first view. */
  touched = false;
  /** Rises whenever the user moves the camera by hand. */
  moves = 0;
  /** Right, up, forward in -1..1, from keys. */
  readonly walk = new Vector3();
  /** Walks three times as fast. */
  walkingFast = false;
  /** Stop a walk; null: nothing does. */
  walls: Walls | null = null;

  private readonly camera_: PerspectiveCamera;
  private readonly goal_ = makeView();
  private readonly now_ = makeView();
  private readonly home_ = makeView();
  private seconds_ = easeSeconds;
  private readonly direction_ = new Vector3();
  private readonly right_ = new Vector3();
  private readonly up_ = new Vector3();
  private readonly way_ = new Vector3();
  private readonly eye_ = new Vector3();
  private readonly middle_ = new Vector3(0, 1, 0);
  private size_ = 2;
  /** The size for the speed of walks: a room may have a small scene on its table. */
  private walkSize_ = 2;
  /** After a walk over an edge: the height over the floor where the eyes come to rest, m, and their speed, m/s. */
  private fall_: { readonly height: number; speed: number } | null = null;

  constructor(camera: PerspectiveCamera) {
    this.camera_ = camera;
  }

  /** Center and size of the scene, m: speeds and limits depend on it. `reach`: from the center to the farthest of the surroundings. */
  setScene(middle: readonly [number, number, number], size: number, reach = size): void {
    this.middle_.set(...middle);
    this.size_ = size;
    this.walkSize_ = Math.max(size, reach / widest);
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

  /** The view to which the camera moves. */
  get goal(): FittedView {
    const { pivot, distance, yaw, pitch } = this.goal_;
    return { pivot: [pivot.x, pivot.y, pivot.z], distance, yaw, pitch };
  }

  /** Moves to a view, which then counts as chosen by the user. */
  goTo({ pivot, distance, yaw, pitch }: FittedView): void {
    this.fall_ = null;
    this.touched = true;
    this.goal_.pivot.set(...pivot);
    this.goal_.distance = distance;
    this.goal_.yaw = yaw;
    this.goal_.pitch = pitch;
    this.seconds_ = travelSeconds;
  }

  /** Jumps to a view, which then counts as chosen by the user. */
  jumpTo(view: FittedView): void {
    this.goTo(view);
    copyView(this.goal_, this.now_);
  }

  /** Moves by a vector, m. */
  shift(way: Vector3): void {
    this.touched = true;
    this.goal_.pivot.add(way);
    this.now_.pivot.add(way);
  }

  /** Follows a first view that moves, in which all has moved by a vector, m: what goes steadily stays in its place in the picture. */
  follow(way: readonly [number, number, number]): void {
    copyView(this.home_, this.goal_);
    this.seconds_ = travelSeconds;
    this.now_.pivot.add(this.way_.set(...way));
    // On a longer journey nothing would be seen.
    if (this.now_.pivot.distanceTo(this.goal_.pivot) > longestTravel * this.goal_.distance) copyView(this.goal_, this.now_);
  }

  /** Jumps to the first view. */
  jumpHome(): void {
    this.fall_ = null;
    this.touched = false;
    copyView(this.home_, this.goal_);
    copyView(this.home_, this.now_);
  }

  reset(): void {
    this.fall_ = null;
    this.touched = false;
    this.moves++;
    copyView(this.home_, this.goal_);
    // The shorter direction.
    this.goal_.yaw += 2 * Math.PI * Math.round((this.now_.yaw - this.goal_.yaw) / (2 * Math.PI));
    this.seconds_ = travelSeconds;
  }

  /** A drag in css pixels: turns about the pivot. */
  orbit(dx: number, dy: number): void {
    this.touch_();
    this.goal_.yaw -= dx * 0.006;
    this.goal_.pitch = MathUtils.clamp(this.goal_.pitch + dy * 0.006, -steepest, steepest);
  }

  /** Turns the camera at its place. */
  look(dx: number, dy: number): void {
    this.touch_();
    const eye = this.eyeOf_(this.goal_, new Vector3());
    this.goal_.yaw -= dx * 0.0035;
    this.goal_.pitch = MathUtils.clamp(this.goal_.pitch + dy * 0.0035, -steepest, steepest);
    this.goal_.pivot.copy(eye).sub(this.awayOf_(this.goal_, this.direction_).multiplyScalar(this.goal_.distance));
  }

  /** Moves sideways with the pointer: points at the pivot's depth stay under it. */
  pan(dx: number, dy: number, viewHeight: number): void {
    this.touch_();
    const meters = (2 * this.goal_.distance * Math.tan(MathUtils.degToRad(this.camera_.fov / 2))) / viewHeight;
    this.axes_(this.goal_);
    this.goal_.pivot.addScaledVector(this.right_, -dx * meters).addScaledVector(this.up_, dy * meters);
    this.keepNear_();
  }

  /**
   * Above 1: away. The point at x, y of the picture (-1 .. 1, right and up), at `depth` m from the camera or at the
   * pivot's depth, stays there.
   */
  zoom(factor: number, x = 0, y = 0, depth = this.goal_.distance): void {
    this.touch_();
    const before = this.goal_.distance;
    const close = nearest * this.size_;
    this.goal_.distance = MathUtils.clamp(before * Math.max(factor, Math.min(1, close / depth)), close, farthest * this.size_);
    const share = 1 - this.goal_.distance / before;
    const tangent = Math.tan(MathUtils.degToRad(this.camera_.fov / 2));
    this.axes_(this.goal_);
    this.goal_.pivot
      .addScaledVector(this.right_, share * x * tangent * this.camera_.aspect * depth)
      .addScaledVector(this.up_, share * y * tangent * depth)
      .addScaledVector(this.direction_, share * (before - depth));
    this.keepNear_();
  }

  /** How far ahead of the camera a place will be, m, when it has reached its goal; a wheel turns faster than the camera eases. */
  depthOf(point: ArrayLike<number>): number {
    const eye = this.eyeOf_(this.goal_, this.eye_);
    return Math.max(eye.sub(this.way_.fromArray(point)).dot(this.awayOf_(this.goal_, this.direction_)), 1e-9 * this.size_);
  }

  /** Advances and places the camera; returns whether it moved. */
  update(seconds: number): boolean {
    if (this.walk.lengthSq() > 0) this.step_(seconds);
    if (this.fall_ !== null) this.fallOn_(this.fall_, seconds);
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

  private step_(seconds: number): void {
    this.touch_();
    this.axes_(this.goal_);
    const length = (this.walkingFast ? 3 : 1) * pace * this.walkSize_ * seconds;
    this.way_.copy(this.right_).multiplyScalar(this.walk.x * length).addScaledVector(this.direction_, -this.walk.z * length);
    this.way_.y += this.walk.y * length;
    const eye = this.eyeOf_(this.goal_, this.eye_);
    const isOverEdge = this.walls?.slide(eye, this.way_, elbowroom * this.walkSize_) === true;
    if (this.walk.y !== 0) this.fall_ = null; // flies
    else if (isOverEdge && !this.flying) this.fall_ ??= { height: eye.y - this.walls!.floorBelow(eye), speed: 0 };
    this.goal_.pivot.add(this.way_);
    this.keepNear_();
  }

  private fallOn_(fall: { readonly height: number; speed: number }, seconds: number): void {
    const eye = this.eyeOf_(this.goal_, this.eye_);
    const left = eye.y - (this.walls?.floorBelow(eye) ?? -Infinity) - fall.height;
    fall.speed += gravity * Math.min(this.walkSize_, 1) * seconds;
    this.goal_.pivot.y -= Math.max(0, Math.min(fall.speed * seconds, left));
    if (fall.speed * seconds >= left || !Number.isFinite(left)) this.fall_ = null;
  }

  private touch_(): void {
    this.touched = true;
    this.moves++;
    this.seconds_ = easeSeconds;
  }

  /** Keeps the pivot near the scene. */
  private keepNear_(): void {
    this.goal_.pivot.sub(this.middle_).clampLength(0, widest * this.walkSize_).add(this.middle_);
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
