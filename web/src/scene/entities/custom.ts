// SPDX-License-Identifier: Apache-2.0
// Objects of classes that modules of the script define: how they are drawn, their bounds, what a ray or a hand meets, and what
// happens when they are selected. Fetched with the first object or class.

import {
  Box3, Group, Matrix4, Mesh, Quaternion, Ray, Triangle, Vector3, type BufferGeometry, type Material, type Object3D,
} from "three";
import type { CustomEntity, Vec3 } from "../../protocol/generated.ts";
import { bodyOf, moves, placeOf, turnOf } from "../anchors.ts";
import type { Cover, CoverHit } from "../pickable.ts";
import type { Points } from "../points.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import type { EntityView } from "./entity.ts";

export type Mark = "" | "hovered" | "selected" | "held";

/** A class of the script. `values` is what the script gave the object; places are in its frame, m. Only `make` is required. */
export interface CustomClass {
  /** The drawn object. It is made anew when the values change. */
  make(values: unknown): Object3D;
  /** Once a frame; `seconds` since the last one. */
  draw?(object: Object3D, values: unknown, seconds: number): void;
  /** Two opposite corners of a box around it; default: that of the object. */
  bounds?(values: unknown): readonly [Readonly<Vec3>, Readonly<Vec3>];
  /** From its surface, negative inside; decides what rays and hands meet. Default: the triangles of the object when it was made. */
  distance?(values: unknown, point: Readonly<Vec3>): number;
  /** The body that it is on came under a pointer, was selected, held, or none of these. */
  select?(object: Object3D, mark: Mark): void;
}

/** The bodies under a pointer, selected and held by this user, -1: none; kept up to date. */
export interface Marks {
  hovered: number;
  selected: number;
  held: number;
}

const classes = new Map<string, CustomClass>();
const views = new Set<CustomView>();
/** A module that defines a class may come later than its objects. */
const patienceMs = 5000;
/** Steps along a ray, by distances to the surface. */
const mostSteps = 96;

/** Defines a class for all its objects, also for those that are there already. */
export function defineClass(name: string, made: CustomClass): void {
  if (typeof made?.make !== "function") throw new TypeError(`the class ${name} needs a function make(values) that returns an Object3D`);
  classes.set(name, made);
  for (const view of views) view.defined(name);
}

interface Shown {
  entity: CustomEntity;
  readonly values: unknown;
  readonly object: Object3D;
  /** Its bounds in its frame. */
  readonly box: Box3;
  /** Nine numbers each, in its frame; null: its class tells distances. */
  readonly triangles: Float32Array | null;
  /** At its place. */
  readonly holder: Group;
  mark: Mark;
}

export class CustomView implements EntityView<CustomEntity>, Cover {
  readonly root = new Group();

  private readonly poses_: PoseBuffer;
  private readonly marks_: Marks;
  private readonly canHold_: (body: number) => boolean;
  private readonly warn_: (title: string, text: string) => void;
  private readonly changed_: () => void;
  private readonly entities_ = new Map<number, CustomEntity>();
  private readonly shown_ = new Map<number, Shown>();
  private readonly told_ = new Set<string>();
  private readonly ray_ = new Ray();
  private readonly triangle_ = new Triangle();
  private readonly point_ = new Vector3();
  private readonly near_ = new Vector3();
  private readonly turn_ = new Quaternion();
  private readonly box_ = new Box3();
  private readonly inverse_ = new Matrix4();

  /** `changed` is called when an object can be drawn that could not before. */
  constructor(
    poses: PoseBuffer, marks: Marks, canHold: (body: number) => boolean, warn: (title: string, text: string) => void, changed: () => void,
  ) {
    this.poses_ = poses;
    this.marks_ = marks;
    this.canHold_ = canHold;
    this.warn_ = warn;
    this.changed_ = changed;
    views.add(this);
  }

  /** How many are drawn. */
  get count(): number {
    return this.shown_.size;
  }

  /** A class has come, or has changed. */
  defined(name: string): void {
    for (const entity of [...this.entities_.values()].filter(({ className }) => className === name)) {
      this.remove_(entity.id.slot);
      this.make_(entity);
    }
    this.changed_();
  }

  create(entity: CustomEntity): void {
    this.entities_.set(entity.id.slot, entity);
    if (classes.has(entity.className)) return this.make_(entity);
    setTimeout(() => {
      if (!classes.has(entity.className) && this.entities_.has(entity.id.slot)) {
        this.tellOnce_(entity.className, "is not defined", "No module of the script has called iota.define for it.");
      }
    }, patienceMs);
  }

  change(entity: CustomEntity): void {
    const shown = this.shown_.get(entity.id.slot);
    this.entities_.set(entity.id.slot, entity);
    if (shown !== undefined && shown.entity.className === entity.className && shown.entity.values === entity.values) {
      shown.entity = entity;
      return;
    }
    this.remove_(entity.id.slot);
    if (classes.has(entity.className)) this.make_(entity);
  }

  destroy(slot: number): void {
    this.entities_.delete(slot);
    this.remove_(slot);
  }

  draw(seconds: number): void {
    for (const shown of this.shown_.values()) {
      const { entity, holder, object, values } = shown;
      holder.visible = this.place_(entity, holder);
      this.call_(entity.className, "draw", (made) => made.draw?.(object, values, seconds));
      const mark = this.markOf_(bodyOf(this.poses_, entity.at));
      if (mark === shown.mark) continue;
      shown.mark = mark;
      this.call_(entity.className, "select", (made) => made.select?.(object, mark));
    }
  }

  addPlaces(points: Points): void {
    for (const shown of this.shown_.values()) if (!moves(shown.entity.at)) this.addCorners_(shown, points);
  }

  addMoving(points: Points): void {
    for (const shown of this.shown_.values()) if (moves(shown.entity.at)) this.addCorners_(shown, points);
  }

  // --- Cover

  hitByRay(origin: ArrayLike<number>, direction: ArrayLike<number>, _tolerance: number, hit: CoverHit): void {
    const { ray_: ray, point_: point } = this;
    for (const shown of this.shown_.values()) {
      if (!shown.holder.visible) continue;
      const body = bodyOf(this.poses_, shown.entity.at);
      if (!this.canHold_(body)) continue;
      ray.origin.fromArray(origin);
      ray.direction.fromArray(direction);
      ray.applyMatrix4(this.intoFrame_(shown));
      if (ray.intersectBox(shown.box, point) === null) continue;
      const far = this.alongRay_(shown, shown.box.containsPoint(ray.origin) ? 0 : point.distanceTo(ray.origin));
      if (!(far < hit.distance)) continue;
      hit.distance = far;
      this.take_(shown, body, ray.at(far, point), hit);
    }
  }

  hitByPoint(place: ArrayLike<number>, hit: CoverHit): void {
    const { near_: near, point_: point } = this;
    for (const shown of this.shown_.values()) {
      if (!shown.holder.visible) continue;
      const body = bodyOf(this.poses_, shown.entity.at);
      if (!this.canHold_(body)) continue;
      point.fromArray(place).applyMatrix4(this.intoFrame_(shown));
      if (shown.box.distanceToPoint(point) > hit.distance) continue;
      const far = Math.max(shown.triangles === null ? this.distance_(shown, point) : nearestOf(shown.triangles, point, this.triangle_, near), 0);
      if (!(far < hit.distance)) continue;
      hit.distance = far;
      this.take_(shown, body, shown.triangles === null ? point : near, hit);
    }
  }

  // --- inside

  private make_(entity: CustomEntity): void {
    let values: unknown = null;
    const made = this.call_(entity.className, "make", (own) => {
      values = JSON.parse(entity.values);
      const object = own.make(values);
      if (object?.isObject3D !== true) throw new TypeError("it returns no Object3D");
      object.updateMatrixWorld(true);
      const given = own.bounds?.(values);
      const box = given === undefined ? new Box3().setFromObject(object) : new Box3().setFromPoints(given.map((corner) => new Vector3(...corner)));
      // Whatever it draws by itself within its bounds is not cut off.
      if (given !== undefined) object.traverse((part) => void (part.frustumCulled = false));
      return { object, box, triangles: own.distance === undefined ? trianglesOf(object) : null };
    });
    if (made === undefined) return;
    const holder = new Group();
    holder.add(made.object);
    this.root.add(holder);
    this.shown_.set(entity.id.slot, { ...made, entity, values, holder, mark: "" });
  }

  private remove_(slot: number): void {
    const shown = this.shown_.get(slot);
    if (shown === undefined) return;
    this.shown_.delete(slot);
    shown.holder.removeFromParent();
    shown.object.traverse((part) => {
      const { geometry, material } = part as Partial<Mesh<BufferGeometry, Material>>;
      geometry?.dispose();
      material?.dispose?.();
    });
  }

  private place_({ at, rotation }: CustomEntity, { position, quaternion }: Group): boolean {
    if (!placeOf(this.poses_, at, position) || !turnOf(this.poses_, at.body, quaternion)) return false;
    quaternion.multiply(this.turn_.set(...rotation));
    return true;
  }

  private markOf_(body: number): Mark {
    const { hovered, selected, held } = this.marks_;
    return body === held ? "held" : body === selected ? "selected" : body === hovered ? "hovered" : "";
  }

  private addCorners_({ holder, box, entity }: Shown, points: Points): void {
    if (box.isEmpty() || !this.place_(entity, holder)) return;
    holder.updateMatrix();
    const { min, max } = this.box_.copy(box).applyMatrix4(holder.matrix);
    points.add(min.x, min.y, min.z);
    points.add(max.x, max.y, max.z);
  }

  private intoFrame_({ holder }: Shown): Matrix4 {
    holder.updateMatrix();
    return this.inverse_.copy(holder.matrix).invert();
  }

  /** The distance along `ray_` to the shown thing, m; Infinity if the ray does not meet it within bounds. */
  private alongRay_(shown: Shown, start: number): number {
    const { ray_: ray, point_: point, triangle_: triangle } = this;
    let best = Infinity;
    if (shown.triangles !== null) {
      for (let at = 0; at < shown.triangles.length; at += 9) {
        setTriangle(triangle, shown.triangles, at);
        if (ray.intersectTriangle(triangle.a, triangle.b, triangle.c, false, point) !== null) best = Math.min(best, point.distanceTo(ray.origin));
      }
      return best;
    }
    const size = shown.box.getSize(this.near_).length();
    let far = start;
    for (let step = 0; step < mostSteps && far <= start + size; step++) {
      const apart = this.distance_(shown, ray.at(far, point));
      if (apart < 1e-4 * size) return far;
      far += apart;
    }
    return Infinity;
  }

  private distance_({ entity, values }: Shown, point: Vector3): number {
    const far = this.call_(entity.className, "distance", (made) => made.distance!(values, [point.x, point.y, point.z]));
    return typeof far === "number" && Number.isFinite(far) ? far : Infinity;
  }

  /** A hit at a place of its frame. */
  private take_({ holder }: Shown, body: number, place: Vector3, hit: CoverHit): void {
    place.applyMatrix4(holder.matrix);
    const { position, rotation } = this.poses_;
    place.sub(this.near_.fromArray(position, 3 * body)).applyQuaternion(this.turn_.fromArray(rotation, 4 * body).invert());
    hit.body = body;
    place.toArray(hit.localPoint);
  }

  /** Calls a function of a class; one that throws is told once and not called again. */
  private call_<Result>(name: string, what: keyof CustomClass, run: (made: CustomClass) => Result): Result | undefined {
    const made = classes.get(name);
    if (made === undefined || (this.told_.size > 0 && what !== "make" && this.told_.has(`${name} ${what}`))) return undefined;
    try {
      return run(made);
    } catch (error) {
      this.tellOnce_(name, what, error instanceof Error ? `${error.name}: ${error.message}` : String(error));
      return undefined;
    }
  }

  private tellOnce_(name: string, what: string, text: string): void {
    const key = `${name} ${what}`;
    if (this.told_.has(key)) return;
    this.told_.add(key);
    this.warn_(what.startsWith("is ") ? `The class ${name} ${what}` : `${what} of the class ${name} failed`, text);
  }
}

/** Nine numbers for each triangle of an object's meshes, in its frame. */
function trianglesOf(object: Object3D): Float32Array {
  const found: number[] = [];
  const corner = new Vector3();
  object.traverse((part) => {
    if (!(part instanceof Mesh)) return;
    const { position } = (part.geometry as BufferGeometry).attributes;
    const index = (part.geometry as BufferGeometry).getIndex();
    const count = index?.count ?? position.count;
    for (let at = 0; at < count; at++) found.push(...corner.fromBufferAttribute(position, index === null ? at : index.getX(at)).applyMatrix4(part.matrixWorld).toArray());
  });
  return Float32Array.from(found);
}

function setTriangle({ a, b, c }: Triangle, corners: Float32Array, at: number): void {
  a.fromArray(corners, at);
  b.fromArray(corners, at + 3);
  c.fromArray(corners, at + 6);
}

/** Distance from a point to the nearest triangle, m; `out` is the nearest place. */
function nearestOf(triangles: Float32Array, point: Vector3, triangle: Triangle, out: Vector3): number {
  const place = new Vector3();
  let best = Infinity;
  for (let at = 0; at < triangles.length; at += 9) {
    setTriangle(triangle, triangles, at);
    const apart = triangle.closestPointToPoint(point, place).distanceTo(point);
    if (apart >= best) continue;
    best = apart;
    out.copy(place);
  }
  return best;
}
