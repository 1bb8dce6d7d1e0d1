// SPDX-License-Identifier: Apache-2.0
// Draws all bodies: one instanced mesh for each part of each visual, tints that ease, outlines. It also has the packed
// data for picking, so that a pick agrees with the picture. An edit touches only the instances of its bodies.

import { Group, Matrix4, Quaternion, Vector3, Color } from "three";
import { BodyKind, NO_COLOR, type BodyEntity, type Id } from "../../protocol/generated.ts";
import { InstancePool } from "../instance_pool.ts";
import { materialOf } from "../materials.ts";
import type { DrawnPart, Outline } from "../outline.ts";
import type { Cover, Pickable } from "../pickable.ts";
import { addCorners, type Points } from "../points.ts";
import { grown, mostSlots, type PoseBuffer } from "../pose_buffer.ts";
import type { Box, Detail } from "../shapes/kind.ts";
import { bodyReach, makeGeometry, placeShape, shapeReach, sizeOf, wordOf, type PlacedShape, type Shape } from "../shapes/shape.ts";
import type { Wall } from "../walls.ts";
import type { EntityView } from "./entity.ts";
import type { Visuals, VisualUser } from "./visual.ts";

/** Up to this number of bodies, outlines are round; above, they have too many vertices. */
const fineUpTo = 160;
/** Radius on the screen, px, from which parts of bodies are drawn fine, and coarse; finer than before only when clearly larger. */
const finePixels = 22;
/** With more bodies these radii are larger, to limit the number of triangles. */
const fineCount = 24;
const coarseCount = 160;
const coarsePixels = 5;
const clearly = 1.25;
/** Triangles of one part that are drawn coarse at most: a headset draws each of them three times, for two eyes and for shadows. */
const mostCoarse = 120_000;
/** So many of a part are drawn coarse whatever they have. */
const fewCoarse = 1500;
/** For rods of at least this half length in radii, the thickness counts. */
const thinness = 6;
/** Frames between two measurements of a batch's size on the screen, and the number of measured members. */
const lookEvery = 6;
const mostLookedAt = 64;
const growSeconds = 0.15;
/** For more new bodies than this, their origins are not searched. */
const mostPieces = 64;
/** A new look grows from this size. */
const regrownSize = 0.6;
const tintSeconds = 0.07;
/** In which one body takes the place of another one. */
const fadeSeconds = 0.3;
/** Steps of a fade, for the shader: see `materialOf`; and its begin. */
const fadeSteps = 32;
const least = 1 / fadeSteps;
/** Numbers of a placement: offset xyz, rotation xyzw, scale along x. */
const placementSize = 8;

/** All instances of one part of one visual. */
class Batch {
  readonly pool: InstancePool;
  private readonly shape_: Shape;
  private detail_: Detail = "coarse";
  private fades_ = false;
  private readonly coarseUpTo_: number;
  /** Placement of each instance in its body's frame. */
  private placements_ = new Float32Array(placementSize);

  /** Made for the first body's length, so that round ends and rope strands of equal bodies are not scaled. */
  constructor(shape: Shape, root: Group) {
    this.shape_ = shape;
    const geometry = makeGeometry(shape, this.detail_);
    this.coarseUpTo_ = Math.max(fewCoarse, mostCoarse / ((geometry.index ?? geometry.getAttribute("position")).count / 3));
    this.pool = new InstancePool(geometry, materialOf(shape), 16).addTo(root);
  }

  /** Radius about the part's own middle, m. */
  get reach(): number {
    return shapeReach(this.shape_);
  }

  /** The box of the shape for which the geometry is made; a longer body's part is stretched by its matrix. */
  get box(): Box {
    return this.shape_.kind.box(this.shape_);
  }

  get placements(): Float32Array {
    return this.placements_;
  }

  /** Returns the index of the new instance. */
  add(body: number, { shape, offset, rotation }: PlacedShape): number {
    const index = this.pool.add(body);
    const room = placementSize * this.pool.members.length;
    if (this.placements_.length < room) this.placements_ = grown(this.placements_, room);
    this.placements_.set(offset, placementSize * index);
    this.placements_.set(rotation, placementSize * index + 3);
    this.placements_[placementSize * index + 7] = this.stretchOf_(shape);
    return index;
  }

  /** Draws in the detail for a radius on the screen, px. */
  fit(pixels: number): void {
    const { detail_: now, shape_: shape } = this;
    // For long, thin bodies the thickness counts.
    const radius = sizeOf(shape, "radius");
    const length = sizeOf(shape, "length");
    if (length > 0) pixels *= Math.min(1, (thinness * radius) / shapeReach(shape));
    const fine = finePixels * Math.sqrt(Math.max(this.pool.count / fineCount, 1)) * (now === "fine" ? 1 : clearly);
    const coarse = coarsePixels * Math.sqrt(Math.max(this.pool.count / coarseCount, 1)) * (now === "tiny" ? clearly : 1);
    const few = this.pool.count <= fineUpTo;
    const wanted: Detail = pixels >= fine && few ? "fine" : pixels >= coarse && this.pool.count <= this.coarseUpTo_ ? "coarse" : "tiny";
    if (wanted === now) return;
    this.detail_ = wanted;
    this.pool.setGeometry(makeGeometry(this.shape_, wanted));
  }

  /** Whether some of it fade in or out. */
  setFades(fades: boolean): void {
    if (fades === this.fades_) return;
    this.fades_ = fades;
    this.pool.mesh.material = materialOf({ ...this.shape_, fades });
  }

  /** Returns the body whose instance has taken the index, or -1. */
  remove(index: number): number {
    const last = this.pool.count - 1;
    this.placements_.copyWithin(placementSize * index, placementSize * last, placementSize * (last + 1));
    return this.pool.remove(index);
  }

  /** Length of a shape relative to that of the geometry; 1 for shapes without a length. */
  private stretchOf_(shape: Shape): number {
    const madeFor = sizeOf(this.shape_, "length");
    return madeFor > 0 ? sizeOf(shape, "length") / madeFor : 1;
  }
}

/** Drawn place of a part of a body. */
class Instance implements DrawnPart {
  readonly batch: Batch;
  index: number;

  constructor(batch: Batch, index: number) {
    this.batch = batch;
    this.index = index;
  }

  get mesh(): InstancePool["mesh"] {
    return this.batch.pool.mesh;
  }
}

interface Body {
  entity: BodyEntity;
  shapes: readonly PlacedShape[];
  /** One for each shape. */
  instances: readonly Instance[];
}

const noInstances: readonly Instance[] = [];
const noShapes: readonly PlacedShape[] = [];

export class BodyView implements EntityView<BodyEntity>, Pickable, VisualUser {
  readonly root = new Group();
  readonly poses: PoseBuffer;
  pickable = new Uint32Array(0);
  pickableCount = 0;
  reach = new Float32Array(0);
  size = 1;
  readonly covers: Cover[] = [];
  /** Place of the camera, world, m; and px of a length at a distance of the same length. */
  readonly eye = new Vector3();
  pixels = 800;
  /** Rises when the script gives a body another name. */
  renamed = 0;

  private readonly visuals_: Visuals;
  private readonly bodyGone_: (body: number) => void;
  private readonly bodies_ = new Map<number, Body>();
  /** By visual: a batch for each of its parts. */
  private readonly batches_ = new Map<number, Batch[]>();
  private readonly outlines_: Outline[] = [];
  private painted_: ReadonlyMap<number, Color> = new Map();
  private readonly hue_ = new Color();
  private readonly matrix_ = new Matrix4();
  private frame_ = 0;
  /** Drawn slots, in order, and those of them that can be held: updated after a change. */
  private drawn_ = new Uint32Array(0);
  private drawnCount_ = 0;
  private dynamic_ = new Uint32Array(0);
  private dynamicCount_ = 0;
  private listed_ = true;
  private grown_ = new Float32Array(0);
  /** New bodies of this frame. */
  private readonly pieces_: number[] = [];
  private tintGoal_ = new Float32Array(0);
  private tintNow_ = new Float32Array(0);
  /** 0: drawn as it is; up to 1: appears; up to 2: disappears. */
  private fade_ = new Float32Array(0);
  /** By slot: bodies that are gone or inactive, until they have faded. */
  private readonly leaving_ = new Map<number, Body>();
  /** Bodies made since the last frame; and whether one that stays has become inactive or active meanwhile: then others take its place. */
  private made_: number[] = [];
  private swaps_ = false;
  /** Made bodies that take the place of others. */
  private arriving_: number[] = [];

  /** `bodyGone` is called for each body that is destroyed, before its slot can be used again. */
  constructor(poses: PoseBuffer, visuals: Visuals, bodyGone: (body: number) => void) {
    this.poses = poses;
    this.visuals_ = visuals;
    this.bodyGone_ = bodyGone;
    visuals.addUser(this);
  }

  get position(): Float32Array {
    return this.poses.position;
  }

  get rotation(): Float32Array {
    return this.poses.rotation;
  }

  /** Users may take hold of it, drawn or not. */
  canHold(slot: number): boolean {
    return this.poses.known[slot] === 1 && this.bodies_.get(slot)?.entity.kind === BodyKind.dynamic;
  }

  // --- EntityView

  create(entity: BodyEntity): void {
    const { slot } = entity.id;
    if (slot >= mostSlots) throw new Error(`body ${slot} is not drawn: a page draws bodies with slots below ${mostSlots}`);
    this.poses.reserve(slot + 1);
    this.reserve_();
    this.endLeaving_(slot);
    this.made_.push(slot);
    this.grown_[slot] = entity.kind === BodyKind.static ? 1 : 0;
    this.tintNow_[4 * slot + 3] = 0;
    this.tintGoal_[4 * slot + 3] = 0;
    const body: Body = { entity, shapes: noShapes, instances: noInstances };
    this.bodies_.set(slot, body);
    this.addInstances_(body);
  }

  change(entity: BodyEntity): void {
    const body = this.bodies_.get(entity.id.slot);
    if (body === undefined) return;
    const { kind, visual, odd, length } = body.entity;
    if (entity.kind === kind && entity.visual === visual && entity.odd === odd && entity.length === length) {
      if (entity.name !== body.entity.name) this.renamed++;
      const isRecolored = entity.color !== body.entity.color;
      body.entity = entity;
      if (isRecolored) this.color_(body);
      return;
    }
    if (entity.kind === BodyKind.inactive) {
      this.swaps_ = true;
      this.leave_(body);
    } else this.removeInstances_(body);
    body.entity = entity;
    if (kind === BodyKind.inactive) {
      this.swaps_ = true;
      this.endLeaving_(entity.id.slot);
      this.fade_[entity.id.slot] = least;
    }
    this.addInstances_(body);
  }

  destroy(slot: number): void {
    const body = this.bodies_.get(slot);
    if (body === undefined) return;
    this.bodies_.delete(slot);
    this.leave_(body);
    for (const outline of this.outlines_) if (outline.body === slot) outline.body = -1;
    this.bodyGone_(slot);
  }

  /** Whether there are bodies to pick, but no pose of them yet. */
  get unposed(): boolean {
    return this.pickableCount === 0 && this.dynamicCount_ > 0;
  }

  /** Interpolates poses; to be called before picking. */
  update(seconds: number, now: number): void {
    this.poses.sample(now, seconds);
    if (!this.listed_) this.list_();
    let count = 0;
    for (let index = 0; index < this.dynamicCount_; index++) {
      const body = this.dynamic_[index];
      if (this.poses.known[body] === 1) this.pickable[count++] = body;
    }
    this.pickableCount = count;
  }

  /** Writes instance matrices and tints. */
  draw(seconds: number): void {
    const grow = seconds / growSeconds;
    const ease = 1 - Math.exp(-seconds / tintSeconds);
    const { known } = this.poses;
    const fade = this.swap_() ? Math.max(seconds / fadeSeconds, least) : 0;
    this.pieces_.length = 0;
    for (let index = 0; index < this.drawnCount_; index++) {
      const body = this.drawn_[index];
      if (known[body] === 1 && this.grown_[body] === 0 && this.pieces_.length <= mostPieces) this.pieces_.push(body);
    }
    // A body that was split off another one existed before, so it does not grow.
    for (let found = this.pieces_.length <= mostPieces; found;) {
      found = false;  // one piece may come from another one
      for (const body of this.pieces_) {
        if (this.grown_[body] === 1 || !this.touchesGrown_(body)) continue;
        this.grown_[body] = 1;
        found = true;
      }
    }
    for (let index = 0; index < this.drawnCount_; index++) {
      const body = this.drawn_[index];
      if (known[body] === 1) this.grown_[body] = Math.min(1, this.grown_[body] + grow);
      if (this.fade_[body] > 0 && (this.fade_[body] += fade) >= 1) this.fade_[body] = 0;
      this.easeTint_(body, ease);
    }
    for (const slot of this.leaving_.keys()) if ((this.fade_[slot] += fade) >= 2) this.endLeaving_(slot);
    if (this.frame_++ % lookEvery === 0) {
      for (const batches of this.batches_.values()) for (const batch of batches) batch.fit(this.calcPixels_(batch));
    }
    for (const batches of this.batches_.values()) for (const batch of batches) this.drawBatch_(batch);
    for (const outline of this.outlines_) {
      outline.follow(this.has(outline.body) ? (this.bodies_.get(outline.body)?.instances ?? noInstances) : noInstances);
    }
  }

  // --- Pickable

  /** None before the body's first pose has arrived. */
  shapesOf(body: number): readonly PlacedShape[] {
    return this.poses.known[body] === 1 ? (this.bodies_.get(body)?.shapes ?? noShapes) : noShapes;
  }

  // --- VisualUser

  redraw(visual: number): void {
    const leaving = [...this.leaving_].filter(([, { entity }]) => entity.visual === visual);
    if (leaving.length > 0 && this.visuals_.shapesOf(visual).length === 0) return;  // goes with the last of them
    for (const [slot] of leaving) this.endLeaving_(slot);
    const bodies = this.bodiesOf_(visual);
    for (const batch of this.batches_.get(visual) ?? []) batch.pool.dispose();
    this.batches_.delete(visual);
    for (const body of bodies) this.addInstances_(body);
  }

  redrawAll(): void {
    for (const slot of this.leaving_.keys()) this.endLeaving_(slot);
    for (const batches of this.batches_.values()) for (const batch of batches) batch.pool.dispose();
    this.batches_.clear();
    for (const body of this.bodies_.values()) {
      if (!this.isFixed(body.entity.id.slot)) this.grown_[body.entity.id.slot] = regrownSize;
      this.addInstances_(body);
    }
  }

  // --- for the rest of the page

  /** Slots of all bodies, drawn or not. */
  slots(): IterableIterator<number> {
    return this.bodies_.keys();
  }

  /** Adds the corners of all drawn bodies that can be held. */
  addPoints(points: Points): void {
    this.forEachDrawn((slot, kind) => {
      if (kind === BodyKind.dynamic) this.addCorners(points, slot);
    });
  }

  /** Calls `visit` with each drawn body that has a place and an end, or with every n-th. */
  forEachDrawn(visit: (slot: number, kind: BodyKind) => void, every = 1): void {
    let number = 0;
    for (const { entity: { id: { slot }, kind }, instances } of this.bodies_.values()) {
      if (instances.length === 0 || number++ % every !== 0) continue;
      if (this.poses.known[slot] === 1 && Number.isFinite(this.reach[slot])) visit(slot, kind);
    }
  }

  /** Adds the corners of a drawn body, whatever the detail in which it is drawn now: the first view depends on them. */
  addCorners(points: Points, slot: number): void {
    for (const instance of this.bodies_.get(slot)?.instances ?? noInstances) addCorners(points, instance.batch.box, this.placed_(slot, instance));
  }

  /** The meshes of triangles of bodies that stay where they are; a place is only valid until the next one. */
  *fixedMeshes(): Iterable<Wall> {
    const wall = { position: new Vector3(), quaternion: new Quaternion(), size: new Vector3() };
    for (const { entity: { id: { slot } }, shapes, instances } of this.bodies_.values()) {
      if (!this.isFixed(slot) || this.poses.known[slot] !== 1) continue;
      for (const [index, instance] of instances.entries()) {
        if (shapes[index].shape.mesh === null) continue;
        this.placed_(slot, instance).decompose(wall.position, wall.quaternion, wall.size);
        yield { ...wall, geometry: instance.mesh.geometry };
      }
    }
  }

  /** Neither the simulator nor the script moves it. */
  isFixed(slot: number): boolean {
    return this.bodies_.get(slot)?.entity.kind === BodyKind.static;
  }

  /** Number of drawn bodies. */
  get count(): number {
    return this.bodies_.size;
  }

  /** Whether a body is drawn now. */
  has(body: number): boolean {
    return this.shapesOf(body).length > 0;
  }

  /** The full id of a body, for the server; undefined if the slot is empty. */
  idOf(body: number): Id | undefined {
    return this.bodies_.get(body)?.entity.id;
  }

  /** The slot of a body of this generation; -1 if it does not exist. */
  slotOf(id: Id): number {
    return this.idOf(id.slot)?.generation === id.generation ? id.slot : -1;
  }

  /** The name that the script gave to a body; empty without one. */
  ownNameOf(body: number): string {
    return this.bodies_.get(body)?.entity.name ?? "";
  }

  /** The body's own name, else the one of its look or the word for its shape, as in "ball"; empty if there is no such body. */
  nameOf(body: number): string {
    const found = this.bodies_.get(body);
    if (found === undefined) return "";
    if (found.entity.name !== "") return found.entity.name;
    const name = this.visuals_.nameOf(found.entity.visual);
    // Names that the world or the server makes up mean nothing to users.
    return name === "" || /^visual \d+$|^\(/.test(name) ? wordOf(found.shapes) : name;
  }

  /** Moves a point onto the place of a body where a hand acts that presses there, as far as the server's own looks tell. */
  toAnchor(body: number, point: Float32Array): void {
    const name = this.visuals_.nameOf(this.bodies_.get(body)?.entity.visual ?? -1);
    if (name === "(particle)") point.fill(0);
    if (name === "(rod)") point.fill(0, 1);
  }

  addOutline(outline: Outline): void {
    this.outlines_.push(outline);
    this.root.add(outline.root);
  }

  /** Tint of a body for this frame; amount 0..1. Without a call a body eases back to its own color. */
  setTint(body: number, color: Color, amount: number): void {
    if (4 * body + 3 >= this.tintGoal_.length) return;
    this.tintGoal_[4 * body] = color.r;
    this.tintGoal_[4 * body + 1] = color.g;
    this.tintGoal_[4 * body + 2] = color.b;
    this.tintGoal_[4 * body + 3] = amount;
  }

  /** Draws bodies in these colors, by slot; all others in those of their materials. */
  paint(colors: ReadonlyMap<number, Color>): void {
    const before = this.painted_;
    this.painted_ = colors;
    for (const slot of new Set([...before.keys(), ...colors.keys()])) {
      const body = this.bodies_.get(slot);
      if (body !== undefined) this.color_(body);
    }
  }

  clearTints(): void {
    for (let at = 3; at < this.tintGoal_.length; at += 4) this.tintGoal_[at] = 0;
  }

  // --- inside

  private placed_(slot: number, { batch: { placements }, index }: Instance): Matrix4 {
    writeMatrix(this.position, this.rotation, slot, placements, placementSize * index, 1, this.matrix_.elements, 0);
    return this.matrix_;
  }

  /** Adds a body's parts to the batches of its visual. */
  private addInstances_(body: Body): void {
    const { id: { slot }, visual, kind, odd, length } = body.entity;
    this.listed_ = false;
    const shapes = kind === BodyKind.inactive ? [] : this.visuals_.shapesOf(visual);
    if (shapes.length === 0) {
      body.shapes = noShapes;
      body.instances = noInstances;
      return;
    }
    const placed = shapes.map((shape) => placeShape(shape, odd, length > 0 ? length : null));
    const batches = this.batchesOf_(visual, placed);
    body.shapes = placed;
    body.instances = placed.map((part, index) => new Instance(batches[index], batches[index].add(slot, part)));
    if (body.entity.color !== NO_COLOR || this.painted_.has(slot)) this.color_(body);
    this.reach[slot] = bodyReach(placed);
  }

  /** Draws a body in the color that it was painted with, or its own; without one in those of its materials. */
  private color_({ entity: { id: { slot }, color }, instances }: Body): void {
    const hue = this.painted_.get(slot) ?? (color === NO_COLOR ? null : this.hue_.setHex(color & 0xffffff));
    for (const { batch: { pool }, index } of instances) pool.setHue(index, hue);
  }

  private removeInstances_(body: Body): void {
    this.listed_ = false;
    for (const { batch, index } of body.instances) {
      const moved = batch.remove(index);
      for (const bodies of [this.bodies_, this.leaving_]) {
        const instance = bodies.get(moved)?.instances.find((other) => other.batch === batch);
        if (instance !== undefined) instance.index = index;
      }
    }
    body.shapes = noShapes;
    body.instances = noInstances;
  }

  /** Its instances stay until others have taken its place. */
  private leave_(body: Body): void {
    const { entity, instances } = body;
    this.endLeaving_(entity.id.slot);
    this.leaving_.set(entity.id.slot, { entity, shapes: noShapes, instances });
    this.fade_[entity.id.slot] = 1;
    this.listed_ = false;
    body.shapes = noShapes;
    body.instances = noInstances;
  }

  private endLeaving_(slot: number): void {
    const body = this.leaving_.get(slot);
    if (body === undefined) return;
    this.removeInstances_(body);
    this.leaving_.delete(slot);
    this.fade_[slot] = 0;
    if (!this.bodies_.has(slot)) this.poses.forget(slot);
    if (this.visuals_.shapesOf(body.entity.visual).length === 0) this.redraw(body.entity.visual);
  }

  /** Bodies that have come and gone fade where some take the place of others. False while some of them have no place yet. */
  private swap_(): boolean {
    if (this.swaps_) {
      for (const slot of this.made_) [this.grown_[slot], this.fade_[slot]] = [1, least];
      this.arriving_ = this.made_;
      this.made_ = [];
    } else for (const slot of this.leaving_.keys()) if (this.fade_[slot] === 1 && !this.arriving_.length) this.endLeaving_(slot);
    this.made_.length = 0;
    this.swaps_ = false;
    if (this.arriving_.length > 0) this.arriving_ = this.arriving_.filter((slot) => this.poses.known[slot] === 0 && this.bodies_.get(slot)?.instances.length);
    return this.arriving_.length === 0;
  }

  /** Bodies with a visual, also one that has not arrived. */
  private bodiesOf_(visual: number): readonly Body[] {
    const drawn = this.batches_.get(visual)?.at(0)?.pool;
    if (drawn === undefined) return [...this.bodies_.values()].filter((body) => body.entity.visual === visual);
    return Array.from(drawn.members.subarray(0, drawn.count), (slot) => this.bodies_.get(slot)).filter((body) => body !== undefined);
  }

  private batchesOf_(visual: number, placed: readonly PlacedShape[]): readonly Batch[] {
    let batches = this.batches_.get(visual);
    if (batches === undefined) {
      batches = placed.map(({ shape }) => new Batch(shape, this.root));
      this.batches_.set(visual, batches);
    }
    return batches;
  }

  private list_(): void {
    this.listed_ = true;
    const count = this.bodies_.size;
    if (this.drawn_.length < count) {
      this.drawn_ = new Uint32Array(2 * count);
      this.dynamic_ = new Uint32Array(2 * count);
      this.pickable = new Uint32Array(2 * count);
    }
    this.drawnCount_ = this.dynamicCount_ = 0;
    for (const [slot, body] of this.bodies_) {
      if (body.instances.length === 0) continue;
      this.drawn_[this.drawnCount_++] = slot;
      if (body.entity.kind === BodyKind.dynamic) this.dynamic_[this.dynamicCount_++] = slot;
    }
  }

  /** Radius on the screen of the nearest of some members, px: of this part of the body, which may be a small one. */
  private calcPixels_({ pool: { members, count }, reach }: Batch): number {
    const { position, known } = this.poses;
    let most = 0;
    for (let index = 0; index < count; index += Math.ceil(count / mostLookedAt)) {
      const body = members[index];
      if (known[body] !== 1) continue;
      const apart = Math.hypot(
        position[3 * body] - this.eye.x, position[3 * body + 1] - this.eye.y, position[3 * body + 2] - this.eye.z,
      );
      most = Math.max(most, (this.pixels * reach) / Math.max(apart - this.reach[body], 0.01 * this.reach[body]));
    }
    return most;
  }

  private drawBatch_(batch: Batch): void {
    const { pool, placements } = batch;
    const { position, rotation, known } = this.poses;
    const { members, count, matrices, tints } = pool;
    let tinted = false;
    let fades = false;
    for (let index = 0; index < count; index++) {
      const body = members[index];
      fades ||= this.fade_[body] > 0;
      const size = known[body] === 1 ? Math.max(this.grown_[body], 1e-3) : 0;
      writeMatrix(position, rotation, body, placements, placementSize * index, size, matrices, 16 * index);
      for (let channel = 0; channel < 4; channel++) {
        const tint = this.tintNow_[4 * body + channel] + (channel < 3 ? 0 : 2 * Math.round(fadeSteps * this.fade_[body]));
        if (tints[4 * index + channel] === tint) continue;
        tints[4 * index + channel] = tint;
        tinted = true;
      }
    }
    batch.setFades(fades);
    pool.upload();
    if (tinted) pool.uploadTints();
  }

  /** Whether a fully drawn body reaches as far as this one. */
  private touchesGrown_(body: number): boolean {
    const { position, known } = this.poses;
    for (let index = 0; index < this.drawnCount_; index++) {
      const other = this.drawn_[index];
      if (other === body || known[other] !== 1 || this.grown_[other] !== 1) continue;
      const apart = Math.hypot(
        position[3 * body] - position[3 * other], position[3 * body + 1] - position[3 * other + 1],
        position[3 * body + 2] - position[3 * other + 2],
      );
      if (apart < this.reach[body] + this.reach[other]) return true;
    }
    return false;
  }

  private easeTint_(body: number, ease: number): void {
    const at = 4 * body;
    const goal = this.tintGoal_;
    const now = this.tintNow_;
    // A tint that fades out keeps its color; a new one starts in its own.
    if (goal[at + 3] > 0) {
      const jump = now[at + 3] < 0.02 ? 1 : ease;
      for (let channel = 0; channel < 3; channel++) now[at + channel] += (goal[at + channel] - now[at + channel]) * jump;
    }
    now[at + 3] += (goal[at + 3] - now[at + 3]) * ease;
  }

  private reserve_(): void {
    const { capacity } = this.poses;
    if (this.grown_.length >= capacity) return;
    this.reach = grown(this.reach, capacity);
    this.grown_ = grown(this.grown_, capacity);
    this.fade_ = grown(this.fade_, capacity);
    this.tintGoal_ = grown(this.tintGoal_, 4 * capacity);
    this.tintNow_ = grown(this.tintNow_, 4 * capacity);
  }
}

/** Matrix of an instance from body pose and placement, written to out[at .. at + 15]. */
function writeMatrix(
  position: Float32Array, rotation: Float32Array, body: number,
  placement: Float32Array, from: number, size: number, out: ArrayLike<number> & { [index: number]: number }, at: number,
): void {
  const bx = rotation[4 * body], by = rotation[4 * body + 1], bz = rotation[4 * body + 2], bw = rotation[4 * body + 3];
  const ox = placement[from], oy = placement[from + 1], oz = placement[from + 2];
  const lx = placement[from + 3], ly = placement[from + 4], lz = placement[from + 5], lw = placement[from + 6];
  const tx = 2 * (by * oz - bz * oy), ty = 2 * (bz * ox - bx * oz), tz = 2 * (bx * oy - by * ox);
  const x = bw * lx + bx * lw + by * lz - bz * ly;
  const y = bw * ly - bx * lz + by * lw + bz * lx;
  const z = bw * lz + bx * ly - by * lx + bz * lw;
  const w = bw * lw - bx * lx - by * ly - bz * lz;
  const sx = size * placement[from + 7];
  out[at] = (1 - 2 * (y * y + z * z)) * sx;
  out[at + 1] = 2 * (x * y + z * w) * sx;
  out[at + 2] = 2 * (x * z - y * w) * sx;
  out[at + 3] = 0;
  out[at + 4] = 2 * (x * y - z * w) * size;
  out[at + 5] = (1 - 2 * (x * x + z * z)) * size;
  out[at + 6] = 2 * (y * z + x * w) * size;
  out[at + 7] = 0;
  out[at + 8] = 2 * (x * z + y * w) * size;
  out[at + 9] = 2 * (y * z - x * w) * size;
  out[at + 10] = (1 - 2 * (x * x + y * y)) * size;
  out[at + 11] = 0;
  out[at + 12] = position[3 * body] + ox + bw * tx + by * tz - bz * ty;
  out[at + 13] = position[3 * body + 1] + oy + bw * ty + bz * tx - bx * tz;
  out[at + 14] = position[3 * body + 2] + oz + bw * tz + bx * ty - by * tx;
  out[at + 15] = 1;
}
