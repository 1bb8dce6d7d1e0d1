// SPDX-License-Identifier: Apache-2.0
// Surfaces between points: cloth, nets, sails, skins. Visible from both sides, smooth, with shadows; those on bodies
// move with them.

import {
  BufferAttribute, BufferGeometry, DoubleSide, DynamicDrawUsage, Group, Mesh, Quaternion, Ray, Triangle, Vector3, type MeshStandardMaterial,
} from "three";
import { NO_BODY, type SurfaceEntity } from "../../protocol/generated.ts";
import { fromBody, moves, placeOf, turnOf } from "../anchors.ts";
import { casterLayer } from "../contact_shadow.ts";
import { materialOf } from "../materials.ts";
import { opacityOf, textOf } from "../parts.ts";
import type { Cover, CoverHit } from "../pickable.ts";
import { addCorners, boxOfGeometry, type Points } from "../points.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import { drawTriangles } from "../shapes/mesh.ts";
import type { EntityView } from "./entity.ts";

interface Surface {
  entity: SurfaceEntity;
  readonly mesh: Mesh<BufferGeometry, MeshStandardMaterial>;
  /** Whether its points are on several bodies; otherwise it is rigid. */
  readonly bends: boolean;
  /** The radius of a rigid surface about its origin, m. */
  readonly reach: number;
}

export class SurfaceView implements EntityView<SurfaceEntity>, Cover {
  readonly root = new Group();

  private readonly poses_: PoseBuffer;
  private readonly surfaces_ = new Map<number, Surface>();
  private readonly canHold_: (body: number) => boolean;
  private readonly isFixed_: (body: number) => boolean;
  private readonly point_ = new Vector3();
  private readonly turn_ = new Quaternion();
  private readonly ray_ = new Ray();
  private readonly triangle_ = new Triangle();

  constructor(poses: PoseBuffer, canHold: (body: number) => boolean, isFixed: (body: number) => boolean) {
    this.poses_ = poses;
    this.canHold_ = canHold;
    this.isFixed_ = isFixed;
  }

  create(entity: SurfaceEntity): void {
    const { material, color, bodies, points, triangles } = entity;
    const bends = bodies.length > 0;
    const coordinates = entity.coordinates.length > 0 ? Float32Array.from(entity.coordinates) : undefined;
    const geometry = bends
      ? makeBending(points.length / 3, triangles, coordinates)
      : drawTriangles(Float32Array.from(points), Uint32Array.from(triangles), coordinates);
    // Untinted; without the attribute, graphics cards take another value.
    geometry.setAttribute("tint", new BufferAttribute(new Float32Array(4 * geometry.getAttribute("position").count), 4));
    const own = materialOf({ material, color: textOf(color), opacity: opacityOf(color), side: DoubleSide });
    const mesh = new Mesh(geometry, own);
    mesh.frustumCulled = false;
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.layers.enable(casterLayer);
    this.root.add(mesh);
    let reach = 0;
    for (let index = 0; index < points.length; index += 3) reach = Math.max(reach, Math.hypot(points[index], points[index + 1], points[index + 2]));
    const surface = { entity, mesh, bends, reach };
    this.surfaces_.set(entity.id.slot, surface);
  }

  change(entity: SurfaceEntity): void {
    this.destroy(entity.id.slot);
    this.create(entity);
  }

  destroy(slot: number): void {
    const surface = this.surfaces_.get(slot);
    if (surface === undefined) return;
    this.surfaces_.delete(slot);
    surface.mesh.removeFromParent();
    surface.mesh.geometry.dispose();
  }

  draw(): void {
    for (const surface of this.surfaces_.values()) {
      if (surface.bends) this.bend_(surface);
      else this.place_(surface);
    }
  }

  /** Points of those in the world: at one place, or each by itself, as those of a skin. */
  addPlaces(points: Points): void {
    for (const { entity: { at, bodies, points: own }, bends, mesh } of this.surfaces_.values()) {
      if (!bends && moves(at) && this.isFixed_(at.body)) {
        mesh.updateMatrixWorld();
        addCorners(points, boxOfGeometry(mesh.geometry), mesh.matrixWorld);
        continue;
      }
      if (bends ? bodies.some((body) => body !== NO_BODY) : moves(at)) continue;
      points.addSample(own, this.point_.fromArray(at.point));
    }
  }

  /** The rigid ones on static bodies, as those of a room: obstacles for walks. */
  *fixed(): Iterable<Mesh> {
    for (const { mesh, bends, entity: { at: { body } } } of this.surfaces_.values()) if (!bends && body !== NO_BODY && this.isFixed_(body)) yield mesh;
  }

  // --- Cover

  hitByRay(origin: ArrayLike<number>, direction: ArrayLike<number>, _tolerance: number, hit: CoverHit): void {
    const { ray_: ray, point_: place } = this;
    for (const surface of this.surfaces_.values()) {
      ray.origin.fromArray(origin);
      ray.direction.fromArray(direction);
      if (!this.intoFrame_(surface, ray.origin, ray.direction)) continue;
      if (!surface.bends && ray.distanceSqToPoint(place.set(0, 0, 0)) > surface.reach ** 2) continue;
      for (let corner = 0; corner < surface.entity.triangles.length; corner += 3) {
        const { a, b, c } = this.cornersOf_(surface, corner);
        if (ray.intersectTriangle(a, b, c, false, place) !== null) this.take_(surface, corner, place.distanceTo(ray.origin), hit);
      }
    }
  }

  hitByPoint(point: ArrayLike<number>, hit: CoverHit): void {
    const from = this.ray_.origin;
    for (const surface of this.surfaces_.values()) {
      if (!this.intoFrame_(surface, from.fromArray(point), this.ray_.direction)) continue;
      if (!surface.bends && from.length() - surface.reach > hit.distance) continue;
      for (let corner = 0; corner < surface.entity.triangles.length; corner += 3) {
        this.cornersOf_(surface, corner).closestPointToPoint(from, this.point_);
        this.take_(surface, corner, this.point_.distanceTo(from), hit);
      }
    }
  }

  /** Turns a place and a direction of the world into the frame of a rigid surface; false for one that is not drawn, or on nothing
   * that can be held. */
  private intoFrame_({ entity: { at }, mesh, bends }: Surface, place: Vector3, direction: Vector3): boolean {
    if (bends || !mesh.visible) return mesh.visible;
    if (!this.canHold_(at.body)) return false;  // before a look at each triangle of a room
    this.turn_.copy(mesh.quaternion).invert();
    place.sub(mesh.position).applyQuaternion(this.turn_);
    direction.applyQuaternion(this.turn_);
    return true;
  }

  /** The triangle that begins at a corner: in the world, or of a rigid one in its frame. */
  private cornersOf_({ entity: { triangles, points }, mesh: { geometry }, bends }: Surface, corner: number): Triangle {
    const places = bends ? geometry.getAttribute("position").array : points;
    this.triangle_.a.fromArray(places, 3 * triangles[corner]);
    this.triangle_.b.fromArray(places, 3 * triangles[corner + 1]);
    this.triangle_.c.fromArray(places, 3 * triangles[corner + 2]);
    return this.triangle_;
  }

  /** A hit at `point_`, on a triangle: of the body of the nearest corner that can be held. */
  private take_({ entity: { at, bodies, points, triangles }, bends }: Surface, corner: number, distance: number, hit: CoverHit): void {
    if (distance >= hit.distance) return;
    if (!bends) {
      hit.body = at.body;
      hit.distance = distance;
      for (let axis = 0; axis < 3; axis++) hit.localPoint[axis] = at.point[axis] + this.point_.getComponent(axis);
      return;
    }
    const { a, b, c } = this.triangle_;
    let nearest = Infinity;
    [a, b, c].forEach((place, index) => {
      const point = triangles[corner + index];
      const apart = place.distanceTo(this.point_);
      if (apart >= nearest || !this.canHold_(bodies[point])) return;
      nearest = apart;
      hit.body = bodies[point];
      hit.distance = distance;
      for (let axis = 0; axis < 3; axis++) hit.localPoint[axis] = points[3 * point + axis];
    });
  }

  private place_({ entity: { at }, mesh }: Surface): void {
    mesh.visible = placeOf(this.poses_, at, mesh.position) && turnOf(this.poses_, at.body, mesh.quaternion);
  }

  private bend_({ entity: { bodies, points, triangles }, mesh }: Surface): void {
    const { position, normal } = mesh.geometry.attributes as Record<string, BufferAttribute>;
    const places = position.array as Float32Array;
    const normals = normal.array as Float32Array;
    mesh.visible = true;
    for (let index = 0; index < bodies.length; index++) {
      if (!fromBody(this.poses_, bodies[index], this.point_.fromArray(points, 3 * index))) mesh.visible = false;
      this.point_.toArray(places, 3 * index);
    }
    normals.fill(0);
    for (let at = 0; at < triangles.length; at += 3) addNormal(places, normals, 3 * triangles[at], 3 * triangles[at + 1], 3 * triangles[at + 2]);
    for (let at = 0; at < normals.length; at += 3) {
      const size = Math.hypot(normals[at], normals[at + 1], normals[at + 2]) || 1;
      for (let axis = 0; axis < 3; axis++) normals[at + axis] /= size;
    }
    position.needsUpdate = normal.needsUpdate = true;
  }
}

/** Buffer for points that are written each frame. */
function makeBending(count: number, triangles: ArrayLike<number>, coordinates = new Float32Array(2 * count)): BufferGeometry {
  const geometry = new BufferGeometry();
  for (const name of ["position", "normal"]) {
    geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * count), 3).setUsage(DynamicDrawUsage));
  }
  geometry.setAttribute("uv", new BufferAttribute(coordinates, 2));
  return geometry.setIndex(new BufferAttribute(Uint32Array.from(triangles), 1));
}

/** Adds the normal of a triangle, weighted by its area, to those of its corners. */
function addNormal(places: Float32Array, normals: Float32Array, a: number, b: number, c: number): void {
  const ux = places[b] - places[a], uy = places[b + 1] - places[a + 1], uz = places[b + 2] - places[a + 2];
  const vx = places[c] - places[a], vy = places[c + 1] - places[a + 1], vz = places[c + 2] - places[a + 2];
  const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
  for (const corner of [a, b, c]) {
    normals[corner] += x;
    normals[corner + 1] += y;
    normals[corner + 2] += z;
  }
}
