// SPDX-License-Identifier: Apache-2.0
// Mouse, pen and fingers on the canvas: they grab bodies; on empty space they move the camera.

import { Vector3, type PerspectiveCamera } from "three";
import type { Navigation } from "../navigate/navigation.ts";
import { Pointer, type Gestures } from "./gestures.ts";

export interface ScreenInputHost {
  /** A click or tap on empty space, without a drag. */
  clickNothing(): void;
  /** Long press, double tap or right click on a body: shows its actions. (css px) */
  openMenu(body: number, x: number, y: number): void;
  /** A finger drags, maybe after a long press: the actions would cover what it does. */
  closeMenu(): void;
  /** Any input of the user: hidden controls appear again. */
  active(): void;
  /** A rectangle is being drawn, css px; `done`: and is finished. */
  band?(left: number, top: number, right: number, bottom: number, done: boolean): void;
  /** A click that adds a body to the selection or takes it out. */
  toggle?(body: number): void;
}

const tapPixels = 8;
const tapMs = 350;
const longPressMs = 480;
const doubleTapMs = 320;

interface Finger {
  readonly pointer: Pointer;
  readonly touch: boolean;
  readonly button: number;
  x: number;
  y: number;
  readonly startX: number;
  readonly startY: number;
  readonly startedAt: number;
  moved: boolean;
  /** Draws a rectangle. */
  readonly band: boolean;
  longPress: number | undefined;
}

export class ScreenInput {
  readonly mouse = new Pointer("mouse");

  private readonly canvas_: HTMLCanvasElement;
  private readonly camera_: PerspectiveCamera;
  private readonly gestures_: Gestures;
  private readonly navigation_: Navigation;
  private readonly host_: ScreenInputHost;
  private readonly fingers_ = new Map<number, Finger>();
  private readonly freePointers_: Pointer[] = [];
  private touches_ = 0;
  private lastTap_ = { at: -Infinity, x: 0, y: 0 };
  private readonly ray_ = new Vector3();
  private readonly lastMouse_ = { x: 0, y: 0 };

  constructor(
    canvas: HTMLCanvasElement, camera: PerspectiveCamera, gestures: Gestures, navigation: Navigation, host: ScreenInputHost,
  ) {
    this.canvas_ = canvas;
    this.camera_ = camera;
    this.gestures_ = gestures;
    this.navigation_ = navigation;
    this.host_ = host;
    gestures.add(this.mouse);
    canvas.addEventListener("pointerdown", (event) => this.down_(event));
    canvas.addEventListener("pointermove", (event) => this.move_(event));
    canvas.addEventListener("pointerup", (event) => this.up_(event, false));
    canvas.addEventListener("pointercancel", (event) => this.up_(event, true));
    canvas.addEventListener("pointerleave", () => {
      if (!this.mouse.pressed) this.mouse.active = false;
    });
    canvas.addEventListener("wheel", (event) => this.wheel_(event), { passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  /** Aims all pointers from the camera's present place; once a frame, before the gestures. */
  aim(): void {
    if (this.mouse.active) this.aimAt_(this.mouse, this.lastMouse_.x, this.lastMouse_.y);
    for (const finger of this.fingers_.values()) if (finger.touch) this.aimAt_(finger.pointer, finger.x, finger.y);
  }

  private aimAt_(pointer: Pointer, x: number, y: number): void {
    // The canvas fills the window; reading its box would allocate an object each frame.
    const ndcX = (x / innerWidth) * 2 - 1;
    const ndcY = 1 - (y / innerHeight) * 2;
    this.camera_.updateMatrixWorld();
    this.ray_.set(ndcX, ndcY, 0.5).unproject(this.camera_).sub(this.camera_.position).normalize();
    this.camera_.position.toArray(pointer.origin);
    this.ray_.toArray(pointer.direction);
    this.camera_.getWorldDirection(this.ray_).toArray(pointer.facing);
    // A finger covers about 22 px; a mouse is more precise, but bodies swing.
    const pixels = pointer === this.mouse ? 8 : 22;
    pointer.tolerance = (pixels * 2 * Math.tan((this.camera_.fov * Math.PI) / 360)) / innerHeight;
  }

  private down_(event: PointerEvent): void {
    this.host_.active();
    const touch = event.pointerType === "touch";
    // Only the first button of a mouse grabs; the others steer the camera while a grab goes on.
    if (!touch && this.fingers_.has(event.pointerId)) return;
    const pointer = touch ? (this.freePointers_.pop() ?? new Pointer(`touch ${++this.touches_}`)) : this.mouse;
    const adds = this.host_.band !== undefined && event.button === 0 && (event.ctrlKey || event.metaKey);
    const finger: Finger = {
      band: adds || (event.button === 0 && this.navigation_.banding && !this.isOnBody_(pointer, event)),
      pointer, touch, button: event.button, x: event.clientX, y: event.clientY,
      // By the event, which may be handled only after a long frame.
      startX: event.clientX, startY: event.clientY, startedAt: event.timeStamp, moved: false, longPress: undefined,
    };
    this.fingers_.set(event.pointerId, finger);
    this.canvas_.setPointerCapture(event.pointerId);
    if (touch) {
      pointer.pulse = (strength, milliseconds) => navigator.vibrate?.(Math.round(milliseconds * Math.min(1, strength)));
      this.gestures_.add(pointer);
    } else {
      this.lastMouse_.x = event.clientX;
      this.lastMouse_.y = event.clientY;
    }
    pointer.active = true;
    this.aimAt_(pointer, event.clientX, event.clientY);
    if (event.button === 0 && !event.shiftKey && !finger.band) {
      pointer.pressed = true;
      pointer.at = event.timeStamp;
      this.gestures_.update(pointer);
    }
    if (touch && pointer.grab !== null) {
      const body = pointer.grab.body;
      finger.longPress = window.setTimeout(() => {
        if (!finger.moved) this.host_.openMenu(body, finger.x, finger.y);
      }, longPressMs);
    }
  }

  private move_(event: PointerEvent): void {
    this.host_.active();
    const finger = this.fingers_.get(event.pointerId);
    if (event.pointerType !== "touch") {
      this.lastMouse_.x = event.clientX;
      this.lastMouse_.y = event.clientY;
      this.mouse.active = true;
    }
    if (finger === undefined) return;
    const dx = event.clientX - finger.x;
    const dy = event.clientY - finger.y;
    const pinch = finger.touch ? this.partner_(finger) : null;
    const apart = pinch === null ? 0 : Math.hypot(finger.x - pinch.x, finger.y - pinch.y);
    finger.x = event.clientX;
    finger.y = event.clientY;
    if (!finger.moved && Math.hypot(finger.x - finger.startX, finger.y - finger.startY) > tapPixels) {
      finger.moved = true;
      window.clearTimeout(finger.longPress);
      if (finger.touch) this.host_.closeMenu();
    }
    if (finger.band) {
      if (finger.moved) this.drawBand_(finger, false);
      return;
    }
    const grab = finger.pointer.grab;
    if (grab !== null) {
      if (event.shiftKey) {
        // Up moves the target away. The rest of the move keeps it under the pointer.
        finger.pointer.depth -= dy * 0.006 * grab.distance;
      }
      return;
    }
    if (pinch !== null) this.pinch_(finger, pinch, dx, dy, apart);
    else this.steer_(finger, event, dx, dy);
  }

  /** Another finger without a grab. */
  private partner_(finger: Finger): Finger | null {
    for (const other of this.fingers_.values()) {
      if (other !== finger && other.touch && other.pointer.grab === null) return other;
    }
    return null;
  }

  private pinch_(finger: Finger, other: Finger, dx: number, dy: number, apart: number): void {
    const now = Math.hypot(finger.x - other.x, finger.y - other.y);
    if (apart > 1 && now > 1) this.zoomAt_(apart / now, (finger.x + other.x) / 2, (finger.y + other.y) / 2, false);
    // Each finger moves the center by half.
    this.navigation_.pan(dx / 2, dy / 2, this.canvas_.clientHeight);
  }

  private steer_(finger: Finger, event: PointerEvent, dx: number, dy: number): void {
    if (finger.touch || finger.button === 0) {
      if (event.shiftKey) this.navigation_.pan(dx, dy, this.canvas_.clientHeight);
      else if (this.navigation_.flying) this.navigation_.look(dx, dy);
      else this.navigation_.orbit(dx, dy);
    } else if (finger.button === 1) {
      this.navigation_.pan(dx, dy, this.canvas_.clientHeight);
    } else {
      this.navigation_.look(dx, dy);
    }
  }

  private up_(event: PointerEvent, canceled: boolean): void {
    const finger = this.fingers_.get(event.pointerId);
    if (finger === undefined || (!finger.touch && !canceled && event.buttons !== 0)) return;
    this.fingers_.delete(event.pointerId);
    window.clearTimeout(finger.longPress);
    const { pointer } = finger;
    if (finger.band && finger.moved) this.drawBand_(finger, true);
    const body = pointer.grab?.body ?? (finger.button === 2 || !this.gestures_.mayHold ? pointer.hovered : -1);
    pointer.pressed = false;
    pointer.at = event.timeStamp;
    // It may have moved since the last frame: then this is not a click.
    if (!canceled) this.aimAt_(pointer, event.clientX, event.clientY);
    if (finger.touch) {
      this.gestures_.remove(pointer);
      this.freePointers_.push(pointer);
    } else {
      this.gestures_.update(pointer);
    }
    const tap = !canceled && !finger.moved && event.timeStamp - finger.startedAt < tapMs;
    if (tap) this.tap_(finger, body, event.timeStamp);
  }

  private isOnBody_(pointer: Pointer, event: PointerEvent): boolean {
    pointer.active = true;
    this.aimAt_(pointer, event.clientX, event.clientY);
    this.gestures_.update(pointer);
    return pointer.hovered >= 0;
  }

  private drawBand_({ x, y, startX, startY }: Finger, done: boolean): void {
    this.host_.band?.(Math.min(x, startX), Math.min(y, startY), Math.max(x, startX), Math.max(y, startY), done);
  }

  private tap_(finger: Finger, body: number, now: number): void {
    if (finger.button === 2) {
      if (body >= 0) this.host_.openMenu(body, finger.x, finger.y);
      return;
    }
    if (finger.button !== 0) return;
    if (finger.band && finger.pointer.hovered >= 0) {
      this.host_.toggle?.(finger.pointer.hovered);
      return;
    }
    if (body < 0) {
      this.host_.clickNothing();
      return;
    }
    const near = Math.hypot(finger.x - this.lastTap_.x, finger.y - this.lastTap_.y) < 40;
    const again = now - this.lastTap_.at < doubleTapMs && near;
    this.lastTap_ = { at: again ? -Infinity : now, x: finger.x, y: finger.y };
    if (again) this.host_.openMenu(body, finger.x, finger.y);
  }

  /** Zooms about a place in css px, at the depth of the body there or, without one, of the camera's pivot. */
  private zoomAt_(factor: number, x: number, y: number, onBody: boolean): void {
    const at = [(x / innerWidth) * 2 - 1, 1 - (y / innerHeight) * 2] as const;
    if (!onBody) return this.navigation_.zoom(factor, ...at);
    this.navigation_.zoom(factor, ...at, this.navigation_.depthOf(this.mouse.hit.point));
  }

  private wheel_(event: WheelEvent): void {
    event.preventDefault();
    this.host_.active();
    const lines = event.deltaMode === 1 ? 33 : 1;
    const amount = Math.min(Math.max(event.deltaY * lines, -240), 240);
    const grab = this.mouse.grab;
    if (grab !== null) this.mouse.depth -= amount * 0.0006 * grab.distance;
    else this.zoomAt_(Math.exp(amount * 0.0011), event.clientX, event.clientY, this.mouse.hovered >= 0);
  }
}
