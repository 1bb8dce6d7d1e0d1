// SPDX-License-Identifier: Apache-2.0
// Getting about: snap turns about the head, and teleports along an arc. Nothing here moves the view by
// itself or continuously, so there is nothing to narrow the view for.

import {
  BufferAttribute, BufferGeometry, CircleGeometry, DoubleSide, DynamicDrawUsage, Group, Mesh, MeshBasicMaterial, RingGeometry, Vector3,
  type Object3D,
} from "three";
import { palette } from "../scene/materials.ts";
import { Arc, arcPoints, throwArc } from "./arc.ts";
import type { Input } from "./input.ts";

export const snapDegrees = 30;
const stickFull = 0.65;
const stickRest = 0.3;
/** A held thing is pushed away with the stick at so many times its distance a second. */
const pushRate = 0.9;
const nearestHold = 0.15;
const farthestHold = 20;
const halfWidth = 0.009;

export class Locomotion {
  /** In the world. */
  readonly root = new Group();
  readonly arc = new Arc();
  /** The hand whose arc is shown, if any. */
  aiming: Input | null = null;

  private readonly rig_: Object3D;
  /** aim: by a panel's button, waits for a pinch; pinch: goes when it opens; stick: goes when it is let go. */
  private mode_: "aim" | "pinch" | "stick" = "stick";
  private readonly ribbon_: Mesh<BufferGeometry, MeshBasicMaterial>;
  private readonly ring_ = new Group();
  private readonly ringMaterial_ = new MeshBasicMaterial({ transparent: true, depthWrite: false, toneMapped: false, fog: false });
  private readonly discMaterial_ = new MeshBasicMaterial({ transparent: true, opacity: 0.28, depthWrite: false, toneMapped: false, fog: false });
  private readonly ribbonPoints_ = new BufferAttribute(new Float32Array(6 * arcPoints), 3);

  constructor(rig: Object3D) {
    this.rig_ = rig;
    this.ribbonPoints_.setUsage(DynamicDrawUsage);
    const geometry = new BufferGeometry();
    const colors = new Float32Array(8 * arcPoints);
    const indices: number[] = [];
    for (let index = 0; index < arcPoints; index++) {
      // Faint at the hand, so that it does not hide it.
      const alpha = Math.min(1, 0.08 + index / 8);
      colors.set([1, 1, 1, alpha, 1, 1, 1, alpha], 8 * index);
      if (index > 0) indices.push(2 * index - 2, 2 * index - 1, 2 * index, 2 * index, 2 * index - 1, 2 * index + 1);
    }
    geometry.setAttribute("position", this.ribbonPoints_);
    geometry.setAttribute("color", new BufferAttribute(colors, 4));
    geometry.setIndex(indices);
    this.ribbon_ = new Mesh(geometry, new MeshBasicMaterial({
      transparent: true, vertexColors: true, side: DoubleSide, depthWrite: false, toneMapped: false, fog: false,
    }));
    this.ribbon_.frustumCulled = false;
    const flat = (shape: BufferGeometry, material: MeshBasicMaterial) => {
      const mesh = new Mesh(shape, material);
      mesh.rotation.x = -Math.PI / 2;
      mesh.renderOrder = 2;
      this.ring_.add(mesh);
    };
    flat(new RingGeometry(0.21, 0.245, 64), this.ringMaterial_);
    flat(new CircleGeometry(0.21, 64), this.discMaterial_);
    flat(new CircleGeometry(0.025, 32), this.ringMaterial_);
    this.root.add(this.ribbon_, this.ring_);
    this.root.visible = false;
  }

  /** Whether the arc waits for a pinch, as a panel's button wished. */
  get armed(): boolean {
    return this.aiming !== null && this.mode_ !== "stick";
  }

  /** Shows this hand's arc; the end of its next pinch or trigger teleports. Called again, it cancels. */
  arm(input: Input): void {
    this.aiming = this.armed ? null : input;
    this.mode_ = "aim";
  }

  /** Takes a press of a hand whose arc is armed. */
  press(input: Input): boolean {
    if (this.aiming !== input || this.mode_ !== "aim") return false;
    this.mode_ = "pinch";
    return true;
  }

  /** Takes the end of that press; returns whether the rig moved. */
  release(input: Input, head: Vector3): boolean {
    return this.aiming === input && this.mode_ === "pinch" && this.go_(head);
  }

  /** A hand is gone, or the session. */
  drop(input: Input | null): void {
    if (input === null || this.aiming === input) this.aiming = null;
    if (this.aiming === null) this.root.visible = false;
  }

  /** Turns the rig about the head (world, m), positive to the left. */
  turn(degrees: number, head: Vector3): void {
    const angle = (degrees * Math.PI) / 180;
    const { position, rotation } = this.rig_;
    const x = position.x - head.x;
    const z = position.z - head.z;
    position.x = head.x + Math.cos(angle) * x + Math.sin(angle) * z;
    position.z = head.z - Math.sin(angle) * x + Math.cos(angle) * z;
    rotation.y += angle;
    this.rig_.updateMatrixWorld();
  }

  /** Thumbsticks of this frame; returns whether the rig moved. `head` in the world, m. */
  steer(inputs: readonly Input[], head: Vector3, seconds: number): boolean {
    let moved = false;
    for (const input of inputs) {
      const { x, y } = input.stick;
      const grab = input.pointer.grab;
      if (grab !== null) {
        // The stick moves the held body. It must come to rest before it moves the user again.
        input.stickFree = false;
        const push = Math.abs(y) < stickRest / 2 ? 0 : y * pushRate * Math.max(grab.distance + input.pointer.depth, 0.3) * seconds;
        input.pointer.depth = Math.min(Math.max(input.pointer.depth + push, nearestHold - grab.distance), farthestHold);
        continue;
      }
      if (Math.abs(x) < stickRest && Math.abs(y) < stickRest) {
        input.stickFree = true;
        if (this.aiming === input && this.mode_ === "stick") moved = this.go_(head) || moved;
        continue;
      }
      if (!input.stickFree) continue;
      if (Math.abs(x) > stickFull && Math.abs(x) > Math.abs(y)) {
        input.stickFree = false;
        this.turn(x > 0 ? -snapDegrees : snapDegrees, head);
        input.pulse(0.2, 15);
        moved = true;
      } else if (y > stickFull && this.aiming === null) {
        input.stickFree = false;
        this.aiming = input;
        this.mode_ = "stick";
      }
    }
    return moved;
  }

  /** Draws the arc of the aiming hand over a floor at this height, m. */
  draw(floor: number): void {
    this.root.visible = this.aiming !== null && this.aiming.tracked;
    if (this.aiming === null || !this.root.visible) return;
    const { origin, direction } = this.aiming.pointer;
    throwArc(origin, direction, floor, this.arc);
    const flat = Math.hypot(direction[0], direction[2]);
    const sideX = flat > 1e-6 ? (-direction[2] / flat) * halfWidth : halfWidth;
    const sideZ = flat > 1e-6 ? (direction[0] / flat) * halfWidth : 0;
    const { points, landing, valid } = this.arc;
    for (let index = 0; index < arcPoints; index++) {
      const px = points[3 * index];
      const py = points[3 * index + 1];
      const pz = points[3 * index + 2];
      this.ribbonPoints_.setXYZ(2 * index, px - sideX, py, pz - sideZ);
      this.ribbonPoints_.setXYZ(2 * index + 1, px + sideX, py, pz + sideZ);
    }
    this.ribbonPoints_.needsUpdate = true;
    const color = valid ? palette.calm : palette.held;
    this.ribbon_.material.color.copy(color);
    this.ringMaterial_.color.copy(color);
    this.discMaterial_.color.copy(color);
    this.ring_.visible = valid;
    this.ring_.position.set(landing[0], landing[1] + 0.006, landing[2]);
  }

  private go_(head: Vector3): boolean {
    const input = this.aiming;
    this.aiming = null;
    this.root.visible = false;
    if (input === null || !this.arc.valid) return false;
    const { position } = this.rig_;
    position.set(position.x + this.arc.landing[0] - head.x, this.arc.landing[1], position.z + this.arc.landing[2] - head.z);
    this.rig_.updateMatrixWorld();
    input.pulse(0.35, 25);
    return true;
  }
}
