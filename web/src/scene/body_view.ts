// SPDX-License-Identifier: Apache-2.0
// Draws all bodies: one instanced mesh for each shape of each class, tints that ease, outlines.
// Also the packed data that picking reads, so that what is picked is what is drawn.

import {
  Color, Group, InstancedBufferAttribute, InstancedMesh, Matrix4, Mesh, type BufferGeometry, type MeshStandardMaterial,
} from "three";
import { makeOutlineMaterial, materialOf, type OutlineMaterial } from "./materials.ts";
import { PoseBuffer } from "./pose_buffer.ts";
import type { Pickable } from "./pickable.ts";
import { bodyReach, makeGeometry, sizeOf, type PlacedShape, type Shape } from "./shapes/shape.ts";
import type { Change, WorldModel } from "./world_model.ts";

/** Up to here bodies are few enough for round outlines; above, vertices cost too much. */
const fineUpTo = 160;
const growSeconds = 0.15;
const tintSeconds = 0.07;

/** All instances of one shape of one class. */
interface Batch {
  readonly mesh: InstancedMesh<BufferGeometry, MeshStandardMaterial>;
  readonly tint: InstancedBufferAttribute;
  readonly bodies: Uint32Array;
  /** Eight numbers an instance: offset xyz, rotation xyzw, scale along x. */
  readonly placement: Float32Array;
}

interface OutlinePart {
  readonly mesh: Mesh;
  batch: Batch | null;
  instance: number;
}

/** A line around one body. */
export class Outline {
  body = -1;
  readonly material: OutlineMaterial;
  readonly parts: OutlinePart[] = [];

  constructor(color: Color) {
    this.material = makeOutlineMaterial(color);
  }
}

/** Matrix of an instance from body pose and placement, written to out[at .. at + 15]. */
function writeMatrix(
  position: Float32Array, rotation: Float32Array, body: number,
  placement: Float32Array, from: number, grown: number, out: ArrayLike<number> & { [index: number]: number }, at: number,
): void {
  const bx = rotation[4 * body], by = rotation[4 * body + 1], bz = rotation[4 * body + 2], bw = rotation[4 * body + 3];
  const ox = placement[from], oy = placement[from + 1], oz = placement[from + 2];
  const lx = placement[from + 3], ly = placement[from + 4], lz = placement[from + 5], lw = placement[from + 6];
  const tx = 2 * (by * oz - bz * oy), ty = 2 * (bz * ox - bx * oz), tz = 2 * (bx * oy - by * ox);
  const x = bw * lx + bx * lw + by * lz - bz * ly;
  const y = bw * ly - bx * lz + by * lw + bz * lx;
  const z = bw * lz + bx * ly - by * lx + bz * lw;
  const w = bw * lw - bx * lx - by * ly - bz * lz;
  const sx = grown * placement[from + 7];
  out[at] = (1 - 2 * (y * y + z * z)) * sx;
  out[at + 1] = 2 * (x * y + z * w) * sx;
  out[at + 2] = 2 * (x * z - y * w) * sx;
  out[at + 3] = 0;
  out[at + 4] = 2 * (x * y - z * w) * grown;
  out[at + 5] = (1 - 2 * (x * x + z * z)) * grown;
  out[at + 6] = 2 * (y * z + x * w) * grown;
  out[at + 7] = 0;
  out[at + 8] = 2 * (x * z + y * w) * grown;
  out[at + 9] = 2 * (y * z - x * w) * grown;
  out[at + 10] = (1 - 2 * (x * x + y * y)) * grown;
  out[at + 11] = 0;
  out[at + 12] = position[3 * body] + ox + bw * tx + by * tz - bz * ty;
  out[at + 13] = position[3 * body + 1] + oy + bw * ty + bz * tx - bx * tz;
  out[at + 14] = position[3 * body + 2] + oz + bw * tz + bx * ty - by * tx;
  out[at + 15] = 1;
}

export class BodyView implements Pickable {
  readonly root = new Group();
  readonly poses = new PoseBuffer();
  pickable = new Uint32Array(0);
  pickableCount = 0;
  reach = new Float32Array(0);

  private readonly model_: WorldModel;
  private batches_: Batch[] = [];
  private shapes_ = new Map<number, readonly PlacedShape[]>();
  private grown_ = new Float32Array(0);
  private tintGoal_ = new Float32Array(0);
  private tintNow_ = new Float32Array(0);
  private readonly outlines_: Outline[] = [];
  private order_ = new Uint32Array(0);
  private stale_: "no" | "bodies" | "look" = "no";

  constructor(model: WorldModel) {
    this.model_ = model;
  }

  get position(): Float32Array {
    return this.poses.position;
  }

  get rotation(): Float32Array {
    return this.poses.rotation;
  }

  shapesOf(body: number): readonly PlacedShape[] {
    return this.shapes_.get(body) ?? [];
  }

  /** Whether a body is drawn now. */
  has(body: number): boolean {
    return this.shapes_.has(body) && this.poses.known[body] === 1;
  }

  addOutline(outline: Outline): void {
    this.outlines_.push(outline);
  }

  changed(what: Change | string): void {
    if (what === "look") this.stale_ = "look";
    else if (what === "bodies" && this.stale_ === "no") this.stale_ = "bodies";
  }

  /** Builds meshes anew after bodies, classes or the look changed; `regrow` lets all of it grow in again. */
  rebuild(look: string, regrow: boolean): void {
    this.dispose_();
    const model = this.model_;
    let slots = 0;
    for (const body of model.bodies.keys()) slots = Math.max(slots, body + 1);
    this.poses.reserve(slots);
    this.reserve_();
    const previous = this.shapes_;
    this.shapes_ = new Map();
    const members = new Map<string, { shape: Shape; bodies: number[]; placed: PlacedShape[] }>();
    let pickable = 0;
    this.order_ = new Uint32Array(model.bodies.size);
    for (const entry of model.bodies.values()) {
      if (entry.kind === "inactive") continue;
      const placed = model.placedShapes(entry, look);
      if (placed.length === 0) continue;
      this.shapes_.set(entry.body, placed);
      this.reach[entry.body] = bodyReach(placed);
      if (regrow) this.grown_[entry.body] = 0.6;
      else if (!previous.has(entry.body)) this.grown_[entry.body] = 0;
      if (entry.kind === "dynamic") this.order_[pickable++] = entry.body;
      placed.forEach((item, index) => {
        const key = `${entry.className} ${index}`;
        // Built for the first body's length: where all are alike, round ends and rope lay stay unscaled.
        const member = members.get(key) ?? { shape: item.shape, bodies: [], placed: [] };
        member.bodies.push(entry.body);
        member.placed.push(item);
        members.set(key, member);
      });
    }
    if (this.pickable.length < pickable) this.pickable = new Uint32Array(pickable);
    for (const member of members.values()) this.addBatch_(member.shape, member.bodies, member.placed);
    for (const outline of this.outlines_) this.attach_(outline);
  }

  /** Tint of a body for this frame; amount 0..1. Without a call a body eases back to its own color. */
  setTint(body: number, color: Color, amount: number): void {
    if (4 * body + 3 >= this.tintGoal_.length) return;
    this.tintGoal_[4 * body] = color.r;
    this.tintGoal_[4 * body + 1] = color.g;
    this.tintGoal_[4 * body + 2] = color.b;
    this.tintGoal_[4 * body + 3] = amount;
  }

  clearTints(): void {
    for (let at = 3; at < this.tintGoal_.length; at += 4) this.tintGoal_[at] = 0;
  }

  /** Puts an outline around a body, -1: none. */
  outline(outline: Outline, body: number): void {
    if (outline.body === body) return;
    outline.body = body;
    this.attach_(outline);
  }

  /** Takes in what has changed, and interpolates poses; to be called before picking. */
  update(seconds: number, now: number): void {
    if (this.stale_ !== "no") this.rebuild(this.model_.look, this.stale_ === "look");
    this.stale_ = "no";
    this.poses.sample(now, seconds);
    if (this.grown_.length < this.poses.capacity) this.reserve_();
    let count = 0;
    for (let index = 0; index < this.order_.length; index++) {
      const body = this.order_[index];
      if (this.shapes_.has(body) && this.poses.known[body] === 1) this.pickable[count++] = body;
    }
    this.pickableCount = count;
  }

  /** Writes instance matrices and tints. */
  draw(seconds: number): void {
    const grow = seconds / growSeconds;
    const ease = 1 - Math.exp(-seconds / tintSeconds);
    const { position, rotation, known } = this.poses;
    for (const body of this.shapes_.keys()) {
      if (known[body] === 1) this.grown_[body] = Math.min(1, this.grown_[body] + grow);
      this.easeTint_(body, ease);
    }
    for (const batch of this.batches_) {
      const matrices = batch.mesh.instanceMatrix.array;
      const tints = batch.tint.array;
      for (let index = 0; index < batch.bodies.length; index++) {
        const body = batch.bodies[index];
        const grown = known[body] === 1 ? Math.max(this.grown_[body], 1e-3) : 0;
        writeMatrix(position, rotation, body, batch.placement, 8 * index, grown, matrices, 16 * index);
        for (let channel = 0; channel < 4; channel++) tints[4 * index + channel] = this.tintNow_[4 * body + channel];
      }
      batch.mesh.instanceMatrix.needsUpdate = true;
      batch.tint.needsUpdate = true;
    }
    for (const outline of this.outlines_) this.drawOutline_(outline);
  }

  private easeTint_(body: number, ease: number): void {
    const at = 4 * body;
    const goal = this.tintGoal_;
    const now = this.tintNow_;
    // A tint that fades out keeps its color; one that comes from nothing starts in its own.
    if (goal[at + 3] > 0) {
      const jump = now[at + 3] < 0.02 ? 1 : ease;
      for (let channel = 0; channel < 3; channel++) now[at + channel] += (goal[at + channel] - now[at + channel]) * jump;
    }
    now[at + 3] += (goal[at + 3] - now[at + 3]) * ease;
  }

  private drawOutline_(outline: Outline): void {
    const shown = outline.body >= 0 && this.has(outline.body);
    for (const part of outline.parts) {
      part.mesh.visible = shown && part.batch !== null;
      if (shown && part.batch !== null) part.batch.mesh.getMatrixAt(part.instance, part.mesh.matrixWorld);
    }
  }

  private attach_(outline: Outline): void {
    let used = 0;
    for (const batch of this.batches_) {
      const instance = outline.body < 0 ? -1 : batch.bodies.indexOf(outline.body);
      if (instance < 0) continue;
      if (used === outline.parts.length) {
        const mesh = new Mesh(batch.mesh.geometry, outline.material);
        // The matrix is written each frame from the instance's.
        mesh.matrixAutoUpdate = mesh.matrixWorldAutoUpdate = false;
        mesh.frustumCulled = false;
        mesh.visible = false;
        this.root.add(mesh);
        outline.parts.push({ mesh, batch: null, instance: 0 });
      }
      const part = outline.parts[used++];
      part.mesh.geometry = batch.mesh.geometry;
      part.batch = batch;
      part.instance = instance;
    }
    for (; used < outline.parts.length; used++) {
      outline.parts[used].batch = null;
      outline.parts[used].mesh.visible = false;
    }
  }

  private addBatch_(shape: Shape, bodies: number[], placed: PlacedShape[]): void {
    const geometry = makeGeometry(shape, bodies.length <= fineUpTo ? "fine" : "coarse");
    const tint = new InstancedBufferAttribute(new Float32Array(4 * bodies.length), 4);
    geometry.setAttribute("tint", tint);
    const mesh = new InstancedMesh(geometry, materialOf(shape.material, shape.color), bodies.length);
    // Bodies move each frame: a bounding sphere kept right would cost more than it culls.
    mesh.frustumCulled = false;
    mesh.castShadow = mesh.receiveShadow = true;
    const placement = new Float32Array(8 * bodies.length);
    const nothing = new Matrix4().makeScale(0, 0, 0);
    placed.forEach((item, index) => {
      const stretch = sizeOf(item.shape, "length") / sizeOf(shape, "length") || 1;
      placement.set([...item.offset, ...item.rotation, stretch], 8 * index);
      mesh.setMatrixAt(index, nothing);
    });
    this.batches_.push({ mesh, tint, bodies: Uint32Array.from(bodies), placement });
    this.root.add(mesh);
  }

  private dispose_(): void {
    for (const batch of this.batches_) {
      this.root.remove(batch.mesh);
      batch.mesh.geometry.dispose();
      batch.mesh.dispose();
    }
    this.batches_ = [];
  }

  private reserve_(): void {
    const capacity = this.poses.capacity;
    if (this.grown_.length >= capacity) return;
    const grow = (array: Float32Array, length: number) => {
      const larger = new Float32Array(length);
      larger.set(array);
      return larger;
    };
    this.reach = grow(this.reach, capacity);
    this.grown_ = grow(this.grown_, capacity);
    this.tintGoal_ = grow(this.tintGoal_, 4 * capacity);
    this.tintNow_ = grow(this.tintNow_, 4 * capacity);
  }
}
