// SPDX-License-Identifier: Apache-2.0
// Controls an emulated headset by mouse and keys. Only while it presents; README.md lists the keys. Positions are in
// the device's own space: the floor at 0, m.

import { Euler, Quaternion, Vector3 } from "three";
import type { XRDevice } from "iwer";
import { Hit, pickRay } from "../interact/picking.ts";
import { ownKeys } from "../page/focus.ts";
import type { Page } from "../page/page.ts";
import type { FramePart } from "../page/viewer.ts";
import { rayOnPlate, Spot, type Plate } from "./plate.ts";

type Side = "left" | "right";

const walkSpeed = 1.2;
/** The place of the left wrist, relative to the head, while it shows its panel, m. */
const wristAt = new Vector3(-0.16, -0.2, -0.42);
const handAt = { left: new Vector3(-0.2, -0.26, -0.4), right: new Vector3(0.2, -0.24, -0.4) } as const;
/** Distance at which the ray of a hand meets the line of sight under the mouse if there is no body or panel, m. */
const meetsAt = 1.6;
/** Precision of a mouse, as a tangent. */
const tolerance = 0.012;
const forward = new Vector3(0, 0, -1);
const upward = new Vector3(0, 1, 0);
const sideways = new Quaternion(0, -Math.SQRT1_2, 0, Math.SQRT1_2);
const walkKeys: Record<string, readonly [number, number, number]> = {
  w: [0, 0, -1], s: [0, 0, 1], a: [-1, 0, 0], d: [1, 0, 0], q: [0, -1, 0], e: [0, 1, 0],
};
const stickKeys: Record<string, readonly [number, number]> = {
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
};

const otherKeys: ReadonlySet<string> = new Set(["1", "2", "h", "v", "x", "Escape"]);

type DeskPage = Pick<Page, "viewer" | "world">;

export class DeskControls implements FramePart {
  /** Panels for the mouse; set once they exist. */
  plates: readonly (Plate & { readonly ready: boolean })[] = [];

  private readonly page_: DeskPage;
  private readonly device_: XRDevice;
  private readonly down_ = new Set<string>();
  private readonly mouse_ = { x: 0, y: 0, known: false };
  private side_: Side = "right";
  private isWristUp_ = false;
  private pressed_ = false;
  private distance_ = meetsAt;
  /** Pose of the head in the device. */
  private readonly turn_ = new Quaternion();
  private readonly angles_ = new Euler(0, 0, 0, "YXZ");
  private readonly ray_ = new Vector3();
  private readonly at_ = new Vector3();
  private readonly flat_ = new Vector3();
  private readonly aim_ = new Quaternion();
  private readonly wrist_ = new Quaternion();
  /** The orientation of the left wrist of a bare hand in the frame of its ray. */
  private readonly wristInRay_ = new Quaternion();
  private readonly wristOfRay_ = new Quaternion();
  private readonly ofRay_ = new Quaternion();
  private readonly back_ = new Vector3();
  private readonly sight_ = new Vector3();
  private readonly origin_ = new Float32Array(3);
  private readonly direction_ = new Float32Array(3);
  private readonly hit_ = new Hit();
  private readonly spot_ = new Spot();

  constructor(page: DeskPage, canvas: HTMLCanvasElement, device: XRDevice) {
    this.page_ = page;
    this.device_ = device;
    // Also before the script's, which has its actions on the wrist panel and the buttons of the controllers.
    ownKeys((key) => this.on_ && (key.toLowerCase() in walkKeys || key in stickKeys || otherKeys.has(key)));
    // Before the page's own listeners, since the mouse is a hand in a session.
    const take = (type: string, act: (event: Event) => void) => window.addEventListener(type, (event) => {
      if (this.on_ && (event.target === canvas || event instanceof KeyboardEvent)) act(event);
    }, { capture: true, passive: false });
    take("pointermove", (event) => this.move_(event as PointerEvent));
    take("pointerdown", (event) => this.press_(event as PointerEvent, 1));
    take("pointerup", (event) => this.press_(event as PointerEvent, 0));
    take("contextmenu", (event) => event.preventDefault());
    take("wheel", (event) => this.wheel_(event as WheelEvent));
    take("keydown", (event) => this.key_(event as KeyboardEvent, true));
    take("keyup", (event) => this.key_(event as KeyboardEvent, false));
  }

  aim(seconds: number, frame: XRFrame | null): void {
    if (!this.on_) return;
    this.readWrist_(frame);
    if (this.down_.size === 0) return;
    this.flat_.set(0, 0, 0);
    for (const key of this.down_) {
      const walk = walkKeys[key] as readonly [number, number, number] | undefined;
      if (walk !== undefined) this.flat_.x += walk[0];
      if (walk !== undefined) this.flat_.y += walk[1];
      if (walk !== undefined) this.flat_.z += walk[2];
    }
    if (this.flat_.lengthSq() === 0) return;
    this.readHead_();
    this.flat_.applyAxisAngle(upward, this.angles_.y).multiplyScalar(walkSpeed * seconds);
    const { position } = this.device_;
    position.set(position.x + this.flat_.x, Math.max(position.y + this.flat_.y, 0.2), position.z + this.flat_.z);
    this.moveHands_();
  }

  private get on_(): boolean {
    return this.page_.viewer.presenting;
  }

  private move_(event: PointerEvent): void {
    event.stopImmediatePropagation();
    const { mouse_ } = this;
    // Browsers send move events for a resting mouse when elements move under it.
    if (mouse_.known && event.clientX === mouse_.x && event.clientY === mouse_.y) return;
    const dx = event.clientX - mouse_.x;
    const dy = event.clientY - mouse_.y;
    const first = !mouse_.known;
    mouse_.x = event.clientX;
    mouse_.y = event.clientY;
    mouse_.known = true;
    if (first) return;
    if ((event.buttons & 2) !== 0) {
      this.readHead_();
      this.angles_.set(Math.min(Math.max(this.angles_.x - dy * 0.005, -1.4), 1.4), this.angles_.y - dx * 0.005, 0);
      this.turn_.setFromEuler(this.angles_);
      this.device_.quaternion.set(this.turn_.x, this.turn_.y, this.turn_.z, this.turn_.w);
      this.moveHands_();
    }
    this.side_ = event.shiftKey ? "left" : "right";
    this.aimHand_();
  }

  private press_(event: PointerEvent, value: 0 | 1): void {
    event.stopImmediatePropagation();
    if (event.button !== 0) return;
    this.pressed_ = value === 1;
    for (const side of value === 1 ? [this.side_] : (["left", "right"] as const)) {
      this.device_.controllers[side]?.updateButtonValue("trigger", value);
      this.device_.hands[side]?.updatePinchValue(value);
    }
  }

  private wheel_(event: WheelEvent): void {
    event.preventDefault();
    event.stopImmediatePropagation();
    const controller = this.device_.controllers[this.side_];
    controller?.updateAxes("thumbstick", 0, Math.sign(event.deltaY) * 0.6);
    window.setTimeout(() => controller?.updateAxes("thumbstick", 0, 0), 120);
  }

  private key_(event: KeyboardEvent, down: boolean): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (!this.own_(event.key, down, event.repeat)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  private own_(key: string, down: boolean, repeat: boolean): boolean {
    if (key.toLowerCase() in walkKeys) {
      if (down) this.down_.add(key.toLowerCase());
      else this.down_.delete(key.toLowerCase());
      return true;
    }
    const controller = this.device_.controllers[this.side_];
    if (key in stickKeys) {
      const [x, y] = down ? stickKeys[key] : [0, 0];
      controller?.updateAxes("thumbstick", x, y);
      return true;
    }
    if (key === "1" || key === "2") {
      const id = { left: { 1: "x-button", 2: "y-button" }, right: { 1: "a-button", 2: "b-button" } }[this.side_][key];
      controller?.updateButtonValue(id, down ? 1 : 0);
      return true;
    }
    if (!otherKeys.has(key)) return false;
    if (!down || repeat) return true;
    if (key === "x") {
      this.isWristUp_ = !this.isWristUp_;
      this.readHead_();
      this.moveHands_();
    }
    if (key === "h") this.device_.primaryInputMode = this.device_.primaryInputMode === "hand" ? "controller" : "hand";
    if (key === "v") this.device_.stereoEnabled = !this.device_.stereoEnabled;
    if (key === "Escape") void this.device_.activeSession?.end();
    return true;
  }

  private readHead_(): void {
    const { quaternion } = this.device_;
    this.turn_.set(quaternion.x, quaternion.y, quaternion.z, quaternion.w);
    this.angles_.setFromQuaternion(this.turn_);
  }

  private readWrist_(frame: XRFrame | null): void {
    const source = this.device_.hands.left?.inputSource as XRInputSource | undefined;
    const joint = source?.hand?.get("wrist");
    if (frame === null || source === undefined || joint === undefined) return;
    const pose = frame.getJointPose?.(joint, source.targetRaySpace);
    if (pose === undefined || pose === null) return;
    const { x, y, z, w } = pose.transform.orientation;
    this.wristInRay_.set(x, y, z, w);
  }

  private placeHand_(side: Side, turn: Quaternion): void {
    const { position } = this.device_;
    const isRaised = side === "left" && this.isWristUp_;
    this.at_.copy(isRaised ? wristAt : handAt[side]);
    // Its back, which is up at rest, towards the eyes, and its fingers to the right.
    if (isRaised) turn = this.wrist_.setFromUnitVectors(upward, this.back_.copy(wristAt).negate().normalize()).multiply(sideways).premultiply(this.turn_);
    this.at_.applyQuaternion(this.turn_);
    const { controllers: { [side]: controller }, hands: { [side]: hand } } = this.device_;
    for (const part of [controller, hand]) {
      part?.position.set(position.x + this.at_.x, position.y + this.at_.y, position.z + this.at_.z);
      part?.quaternion.set(turn.x, turn.y, turn.z, turn.w);
    }
    if (!isRaised) return;
    // A bare hand's ray is not along its wrist.
    const { x, y, z, w } = this.ofRay_.copy(turn).multiply(this.wristOfRay_.copy(this.wristInRay_).invert());
    hand?.quaternion.set(x, y, z, w);
  }

  /** Hands move with the head. */
  private moveHands_(): void {
    this.placeHand_("left", this.turn_);
    this.placeHand_("right", this.turn_);
    this.aimHand_();
  }

  /** Points the hand at the target under the mouse, in either eye's picture. */
  private aimHand_(): void {
    const { stereoEnabled, fovy, ipd } = this.device_;
    this.readHead_();
    const half = stereoEnabled ? innerWidth / 2 : innerWidth;
    const eye = stereoEnabled && this.mouse_.x >= half ? 1 : 0;
    const slope = Math.tan(fovy / 2);
    const x = ((this.mouse_.x - eye * half) / half) * 2 - 1;
    const y = 1 - (this.mouse_.y / innerHeight) * 2;
    this.ray_.set(x * slope * (half / innerHeight), y * slope, -1).normalize();
    // A held body keeps its distance.
    if (!this.pressed_) this.distance_ = this.look_(eye);
    this.ray_.multiplyScalar(this.distance_);
    this.ray_.x += (eye - 0.5) * ipd;
    this.ray_.sub(handAt[this.side_]).normalize().applyQuaternion(this.turn_);
    this.placeHand_(this.side_, this.aim_.setFromUnitVectors(forward, this.ray_));
  }

  /** Distance of the target along an eye's ray, m. */
  private look_(eye: number): number {
    const camera = this.page_.viewer.renderer.xr.getCamera().cameras.at(eye);
    if (camera === undefined) return meetsAt;
    const scale = this.page_.viewer.room.scale.x;
    this.sight_.setFromMatrixPosition(camera.matrixWorld).toArray(this.origin_);
    this.sight_.copy(this.ray_).transformDirection(camera.matrixWorld).toArray(this.direction_);
    for (const plate of this.plates) {
      if (plate.ready && rayOnPlate(plate, this.origin_, this.direction_, this.spot_)) return this.spot_.distance / scale;
    }
    return pickRay(this.page_.world.entities.body, this.origin_, this.direction_, tolerance, 50 * scale, this.hit_) ? this.hit_.distance / scale : meetsAt;
  }
}
