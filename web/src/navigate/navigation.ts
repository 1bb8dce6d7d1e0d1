// SPDX-License-Identifier: Apache-2.0
// The camera of a flat screen: orbit around a point, look around, walk through, all eased and
// interruptible. One state serves all of them: a point, a distance and two angles.

import { MathUtils, Vector3, type PerspectiveCamera } from "three";
import type { Vec3 } from "../protocol/generated.ts";

const easeSeconds = 0.07;
/** A returning view takes longer than a dragged one. */
const travelSeconds = 0.25;
const steepest = 1.5;
const headroom = 0.05;

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
  /** Lowest height of the camera, m; null: anywhere. */
  ground: number | null = null;
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

  constructor(camera: PerspectiveCamera) {
    this.camera_ = camera;
  }

  /** The view that reset returns to; taken at once the first time. */
  setHome(position: Vec3, target: Vec3, atOnce: boolean): void {
    const away = new Vector3(...position).sub(new Vector3(...target));
    this.home_.pivot.set(...target);
    this.home_.distance = Math.max(away.length(), 0.05);
    this.home_.yaw = Math.atan2(away.x, away.z);
    this.home_.pitch = MathUtils.clamp(Math.asin(away.y / this.home_.distance), -steepest, steepest);
    copyView(this.home_, this.goal_);
    if (atOnce) copyView(this.home_, this.now_);
  }

  reset(): void {
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
  }

  /** Above 1: away. */
  zoom(factor: number): void {
    this.touch_();
    this.goal_.distance = MathUtils.clamp(this.goal_.distance * factor, 0.08, 60);
  }

  /** Advances and places the camera; returns whether it moved. */
  update(seconds: number): boolean {
    if (this.walk.lengthSq() > 0) {
      this.touch_();
      this.axes_(this.goal_);
      const pace = (this.walkingFast ? 4.5 : 1.5) * seconds;
      this.awayOf_(this.goal_, this.direction_);
      this.goal_.pivot
        .addScaledVector(this.right_, this.walk.x * pace)
        .addScaledVector(this.direction_, -this.walk.z * pace);
      this.goal_.pivot.y += this.walk.y * pace;
    }
    this.keepAbove_();
    const ease = 1 - Math.exp(-seconds / this.seconds_);
    const before = this.now_.yaw + this.now_.pitch + this.now_.distance;
    const drift = this.now_.pivot.distanceTo(this.goal_.pivot);
    this.now_.pivot.lerp(this.goal_.pivot, ease);
    this.now_.distance += (this.goal_.distance - this.now_.distance) * ease;
    this.now_.yaw += (this.goal_.yaw - this.now_.yaw) * ease;
    this.now_.pitch += (this.goal_.pitch - this.now_.pitch) * ease;
    this.eyeOf_(this.now_, this.camera_.position);
    this.camera_.rotation.set(-this.now_.pitch, this.now_.yaw, 0, "YXZ");
    return drift > 1e-6 || Math.abs(this.now_.yaw + this.now_.pitch + this.now_.distance - before) > 1e-6;
  }

  private touch_(): void {
    this.seconds_ = easeSeconds;
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
    const lowest = this.ground + headroom;
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
