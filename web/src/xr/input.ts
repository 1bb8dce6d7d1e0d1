// SPDX-License-Identifier: Apache-2.0
// One hand of the user, with a controller or bare: its pose, its buttons, and its pointer.

import { Matrix4, Quaternion, Vector3 } from "three";
import { Pointer } from "../interact/gestures.ts";
import type { Board } from "./board.ts";
import { HandJoints, indexTip, jointNames, thumbTip } from "./hand_joints.ts";
import { Poke, Spot } from "./plate.ts";

/** A near grab wins within this distance of a controller's tip and of a pinch, m. */
const controllerReach = 0.1;
const handReach = 0.06;
/** Tremor of a hand: about half a degree. */
const tremble = 0.011;
/** Distance of the tip in front of the origin of a controller's ray, m. */
const tipAhead = 0.03;
/** Indices of the "xr-standard" mapping. */
const stickAxes = 2;
const faceButtons = { a: 4, b: 5 } as const;

export type FaceButton = keyof typeof faceButtons;

export class Input {
  readonly source: XRInputSource;
  readonly pointer: Pointer;
  /** null: a controller, or a pinch with only a ray. */
  readonly joints: HandJoints | null;
  /** The pose of the target ray in the reference space: -z points ahead. */
  readonly rayLocal = new Matrix4();
  /** The same in the world. */
  readonly ray = new Matrix4();
  tracked = false;
  /** Some headsets give bare hands joints but no ray. */
  hasRay = false;
  /** Trigger or pinch; and the grip button, which grabs but does not press panels. */
  selecting = false;
  squeezing = false;
  /** Thumbstick, right and away positive, -1..1. */
  readonly stick = { x: 0, y: 0 };
  /** Whether the stick has been at rest since its last use. */
  stickFree = false;
  /** The panel that this hand points at or touches. */
  board: Board | null = null;
  button = -1;
  readonly spot = new Spot();
  /** By the fingertip, not by the ray. */
  touching = false;
  /** Fingertip or front of the controller, world, m. */
  readonly finger = new Float32Array(3);

  private readonly pokes_ = new Map<Board, Poke>();
  private readonly wasDown_: Record<FaceButton, boolean> = { a: false, b: false };
  private readonly reach_: number;
  private scale_ = 1;
  private readonly turn_ = new Quaternion();
  private readonly at_ = new Vector3();
  private readonly other_ = new Vector3();

  constructor(source: XRInputSource) {
    this.source = source;
    this.joints = source.hand !== undefined && source.hand !== null ? new HandJoints(source.hand) : null;
    const transient = source.targetRayMode === "transient-pointer";
    const kind = this.joints !== null ? " hand" : transient ? " pinch" : "";
    this.pointer = new Pointer(`${source.handedness === "none" ? "any" : source.handedness}${kind}`);
    this.pointer.drag = "ray";
    this.pointer.tolerance = tremble;
    this.pointer.pulse = (strength, milliseconds) => this.pulse(strength, milliseconds);
    // A pinch without a hand is aimed by the eyes: it has a ray and no near grab.
    this.reach_ = transient ? 0 : this.joints !== null ? handReach : controllerReach;
  }

  get isHand(): boolean {
    return this.joints !== null;
  }

  /** Whether it can be drawn: a hand or a controller. */
  get hasBody(): boolean {
    return this.source.targetRayMode === "tracked-pointer";
  }

  pulse(strength: number, milliseconds: number): void {
    const actuator = this.source.gamepad?.hapticActuators?.[0] as { pulse?(value: number, duration: number): Promise<unknown> } | undefined;
    // A headset without motors may refuse, which is ignored.
    actuator?.pulse?.(strength, milliseconds)?.catch(() => {});
  }

  /** Reads poses and stick of this frame. */
  read(frame: XRFrame, space: XRReferenceSpace): void {
    const pose = frame.getPose(this.source.targetRaySpace, space);
    this.hasRay = pose !== undefined && pose !== null;
    if (pose !== undefined && pose !== null) this.rayLocal.fromArray(pose.transform.matrix);
    this.joints?.read(frame, space);
    this.tracked = this.hasRay || this.joints?.tracked === true;
    const axes = this.source.gamepad?.axes;
    const has = axes !== undefined && axes.length >= stickAxes + 2;
    this.stick.x = has ? axes[stickAxes] : 0;
    this.stick.y = has ? -axes[stickAxes + 1] : 0;
  }

  /** Puts ray and tips into the world, from the user's room, which may just have moved; its meters are `scale` of the world. */
  lift(room: Matrix4, scale: number): void {
    const { pointer, at_ } = this;
    this.ray.multiplyMatrices(room, this.rayLocal);
    this.scale_ = scale;
    const m = this.ray.elements;
    for (let axis = 0; axis < 3; axis++) {
      pointer.origin[axis] = m[12 + axis];
      pointer.direction[axis] = -m[8 + axis] / scale;
      pointer.tip[axis] = m[12 + axis] - tipAhead * m[8 + axis];
      this.finger[axis] = pointer.tip[axis];
    }
    pointer.active = this.tracked;
    this.describe_(room);
    if (this.joints === null || !this.joints.tracked) return;
    this.jointAt_(indexTip, at_).applyMatrix4(room).toArray(this.finger);
    at_.add(this.jointAt_(thumbTip, this.other_).applyMatrix4(room)).multiplyScalar(0.5).toArray(pointer.tip);
  }

  /** Clears the panel until `aim` finds one. */
  clearPanel(): void {
    this.board = null;
    this.button = -1;
    this.touching = false;
  }

  /** The state of this fingertip at a panel. */
  poke(board: Board): Poke {
    let poke = this.pokes_.get(board);
    if (poke === undefined) {
      poke = new Poke();
      this.pokes_.set(board, poke);
    }
    return poke;
  }

  /** Enables picking of bodies; off if a panel is in the way, or a teleport is being aimed. */
  pick(free: boolean): void {
    this.pointer.far = free && this.hasRay;
    this.pointer.nearReach = free ? this.scale_ * this.reach_ : 0;
  }

  /** Whether a face button went down since the last call. */
  pressed(button: FaceButton): boolean {
    const down = !this.isHand && (this.source.gamepad?.buttons[faceButtons[button]]?.pressed ?? false);
    const edge = down && !this.wasDown_[button];
    this.wasDown_[button] = down;
    return edge;
  }

  /** For scripts. */
  private describe_(room: Matrix4): void {
    const { pointer, joints, at_ } = this;
    this.ray.decompose(at_, this.turn_, this.other_);
    this.turn_.toArray(pointer.rotation);
    const pad = this.source.gamepad;
    const { buttons, axes } = pointer;
    buttons[0] = this.selecting ? 1 : 0;
    for (let index = 0; index < (pad?.buttons.length ?? 0); index++) buttons[index] = pad!.buttons[index].value;
    // The stick comes first; the touchpad that WebXR names before it is rare.
    for (let index = 0; index < (pad?.axes.length ?? 0); index++) axes[index] = pad!.axes[(index + stickAxes) % pad!.axes.length];
    if (joints === null || !joints.tracked) return;
    for (let joint = 0; joint < jointNames.length; joint++) this.jointAt_(joint, at_).applyMatrix4(room).toArray(pointer.joints, 3 * joint);
  }

  private jointAt_(joint: number, out: Vector3): Vector3 {
    const { matrices } = this.joints as HandJoints;
    return out.set(matrices[16 * joint + 12], matrices[16 * joint + 13], matrices[16 * joint + 14]);
  }
}
