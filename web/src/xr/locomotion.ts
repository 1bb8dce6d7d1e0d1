// SPDX-License-Identifier: Apache-2.0
// Getting about: turns about the head, teleports along an arc, and both hands on nothing, which take hold of the world to move,
// turn and scale it. Only a smooth turn moves the view continuously by itself: the vignette closes meanwhile.

import {
  BufferAttribute, BufferGeometry, CircleGeometry, DoubleSide, DynamicDrawUsage, Group, Mesh, MeshBasicMaterial, RingGeometry, Vector3,
  type Object3D,
} from "three";
import { palette } from "../scene/materials.ts";
import type { Obstacle, Walls } from "../scene/walls.ts";
import { Arc, arcPoints, farthestLanding, throwArc } from "./arc.ts";
import type { Input } from "./input.ts";
import { WorldGrab } from "./world_grab.ts";

/** Degrees of a turn by the stick; 0: it turns smoothly. */
export const turns = [30, 45, 0] as const;
/** In a second, of a smooth turn. */
const smoothDegrees = 90;
/** The stick has to be so far from straight ahead to choose where to face at the end of a teleport, rad. */
const facingFrom = 0.45;
const stickFull = 0.65;
const stickRest = 0.3;
/** Rate at which the stick pushes a held body away, relative to its distance, 1/s. */
const pushRate = 0.9;
const nearestHold = 0.15;
const farthestHold = 20;
const halfWidth = 0.009;
/** Upward part of the normal of what is level enough to stand on: 30 degrees. */
const levelFloor = 0.866;

export class Locomotion {
  /** In the world. */
  readonly root = new Group();
  readonly arc = new Arc();
  /** The hand whose arc is shown, if any. */
  aiming: Input | null = null;
  /** Degrees of a turn by the stick; 0: smooth. */
  turnBy: (typeof turns)[number] = 30;
  /** The view is turning by itself. */
  gliding = false;
  /** The height of the user's floor above the ground under it, m of the user's: a seated user is raised, a user before a low scene is lowered. */
  lift = 0;
  /** The direction to face at the end of a teleport, rad to the left of the head's direction. */
  facing = 0;

  /** Stop a teleport, and are landed on; null: nothing does. */
  walls: Walls | null = null;

  private readonly rig_: Object3D;
  private readonly room_: Object3D;
  private readonly grab_: WorldGrab;
  /** aim: by a panel's button, waits for a pinch; pinch: teleports when it opens; stick: teleports when it is released.
   * */
  private mode_: "aim" | "pinch" | "stick" = "stick";
  private readonly ribbon_: Mesh<BufferGeometry, MeshBasicMaterial>;
  private readonly ring_ = new Group();
  private readonly ringMaterial_ = new MeshBasicMaterial({ transparent: true, depthWrite: false, toneMapped: false, fog: false });
  private readonly discMaterial_ = new MeshBasicMaterial({ transparent: true, opacity: 0.28, depthWrite: false, toneMapped: false, fog: false });
  private readonly from_ = new Vector3();
  private readonly to_ = new Vector3();
  private readonly met_: Obstacle = { share: 1, normal: new Vector3() };
  private readonly ribbonPoints_ = new BufferAttribute(new Float32Array(6 * arcPoints), 3);

  /** `rig`: the user's place in the world; `room`: in it, scaled. */
  constructor(rig: Object3D, room: Object3D) {
    this.rig_ = rig;
    this.room_ = room;
    this.grab_ = new WorldGrab(rig, room);
    this.ribbonPoints_.setUsage(DynamicDrawUsage);
    const geometry = new BufferGeometry();
    const colors = new Float32Array(8 * arcPoints);
    const indices: number[] = [];
    for (let index = 0; index < arcPoints; index++) {
      // Faint at the hand, in order not to hide it.
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
    // A triangle outside of the ring: there the user will look.
    const pointer = new CircleGeometry(0.07, 3, Math.PI / 2);
    pointer.translate(0, 0.3, 0);
    flat(pointer, this.ringMaterial_);
    this.root.add(this.ribbon_, this.ring_);
    this.root.visible = false;
  }

  private get scale_(): number {
    return this.room_.scale.x;
  }

  /** Both hands have hold of the world. */
  get grabbing(): boolean {
    return this.grab_.active;
  }

  /** Whether the arc waits for a pinch, after a panel's button. */
  get armed(): boolean {
    return this.aiming !== null && this.mode_ !== "stick";
  }

  /** Shows this hand's arc; the end of its next pinch or trigger teleports. Called again, it cancels. */
  arm(input: Input): void {
    this.aiming = this.armed ? null : input;
    this.mode_ = "aim";
    this.facing = 0;
  }

  /** Handles a press of a hand with an armed arc. */
  press(input: Input): boolean {
    if (this.aiming !== input || this.mode_ !== "aim") return false;
    this.mode_ = "pinch";
    return true;
  }

  /** Handles the end of that press; returns whether the rig moved. */
  release(input: Input, head: Vector3): boolean {
    return this.aiming === input && this.mode_ === "pinch" && this.go_(head);
  }

  /** A hand disappeared, or the session ended. */
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

  /** Thumbsticks and empty hands of this frame; returns whether the rig moved. `head` in the world, m; `size` of the scene, m. */
  steer(inputs: readonly Input[], head: Vector3, size: number, seconds: number): boolean {
    this.gliding = false;
    let moved = this.grab_.update(inputs, size);
    for (const input of inputs) {
      const { x, y } = input.stick;
      const grab = input.pointer.grab;
      if (grab !== null) {
        // The stick moves the held body. It must return to rest before it moves the user again.
        input.stickFree = false;
        const push = Math.abs(y) < stickRest / 2 ? 0 : y * pushRate * Math.max(grab.distance + input.pointer.depth, 0.3 * this.scale_) * seconds;
        const nearest = Math.min(nearestHold * this.scale_ - grab.distance, 0);
        input.pointer.depth = Math.min(Math.max(input.pointer.depth + push, nearest), farthestHold * this.scale_);
        continue;
      }
      if (Math.abs(x) < stickRest && Math.abs(y) < stickRest) {
        input.stickFree = true;
        if (this.aiming === input && this.mode_ === "stick") moved = this.go_(head) || moved;
        continue;
      }
      if (this.aiming === input && this.mode_ === "stick" && Math.hypot(x, y) > stickFull) {
        const turn = Math.atan2(-x, y);
        this.facing = Math.abs(turn) < facingFrom ? 0 : turn;
      }
      if (!input.stickFree) continue;
      if (this.turnBy === 0 && this.aiming === null && Math.abs(x) > stickRest && Math.abs(x) > Math.abs(y)) {
        this.turn(-Math.sign(x) * smoothDegrees * ((Math.abs(x) - stickRest) / (1 - stickRest)) * seconds, head);
        this.gliding = moved = true;
        continue;
      }
      if (Math.abs(x) > stickFull && Math.abs(x) > Math.abs(y)) {
        input.stickFree = false;
        this.turn(x > 0 ? -this.turnBy : this.turnBy, head);
        input.pulse(0.2, 15);
        moved = true;
      } else if (y > stickFull && this.aiming === null) {
        input.stickFree = false;
        this.aiming = input;
        this.mode_ = "stick";
        this.facing = 0;
      }
    }
    return moved;
  }

  /** Draws the arc of the aiming hand over a floor at this height, m. `yaw`: of the head in the world, rad. */
  draw(floor: number, yaw: number): void {
    this.root.visible = this.aiming !== null && this.aiming.tracked;
    if (this.aiming === null || !this.root.visible) return;
    const { origin, direction } = this.aiming.pointer;
    const scale = this.scale_;
    throwArc(origin, direction, floor, this.arc, scale);
    this.meetWalls_();
    const flat = Math.hypot(direction[0], direction[2]);
    const sideX = scale * halfWidth * (flat > 1e-6 ? -direction[2] / flat : 1);
    const sideZ = scale * halfWidth * (flat > 1e-6 ? direction[0] / flat : 0);
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
    this.ring_.position.set(landing[0], landing[1] + 0.006 * scale, landing[2]);
    this.ring_.scale.setScalar(scale);
    this.ring_.rotation.y = yaw + this.facing;
  }

  /** Ends the arc at the first thing that it meets: it lands on what is level, and nowhere behind a wall. */
  private meetWalls_(): void {
    const { walls, arc: { points, landing }, arc, from_: from, to_: to, met_: met } = this;
    if (walls === null) return;
    for (let index = 1; index < arcPoints; index++) {
      from.fromArray(points, 3 * index - 3);
      to.fromArray(points, 3 * index);
      // Its end on the ground does not obstruct it.
      if (walls.meet(from, to, met).share >= 1 || (index === arcPoints - 1 && arc.valid && met.share > 0.999)) continue;
      from.lerp(to, met.share).toArray(landing);
      for (let rest = index; rest < arcPoints; rest++) from.toArray(points, 3 * rest);
      arc.valid = met.normal.y > levelFloor && Math.hypot(from.x - points[0], from.z - points[2]) <= this.scale_ * farthestLanding;
      return;
    }
  }

  private go_(head: Vector3): boolean {
    const input = this.aiming;
    this.aiming = null;
    this.root.visible = false;
    if (input === null || !this.arc.valid) return false;
    const { position } = this.rig_;
    this.turn((this.facing * 180) / Math.PI, head);
    position.set(
      position.x + this.arc.landing[0] - head.x, this.arc.landing[1] + this.scale_ * this.lift, position.z + this.arc.landing[2] - head.z,
    );
    this.rig_.updateMatrixWorld();
    input.pulse(0.35, 25);
    return true;
  }
}
