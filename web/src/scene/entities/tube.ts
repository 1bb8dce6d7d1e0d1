// SPDX-License-Identifier: Apache-2.0
// Tubes along smooth curves through points: ropes, cables, hoses. Rings are transported along the curve without twist,
// and the texture is continuous along its length, so that rope strands have no seams.

import { BufferAttribute, BufferGeometry, DynamicDrawUsage, Group, Mesh, Ray, Vector3, type MeshStandardMaterial } from "three";
import { NO_BODY, type TubeEntity } from "../../protocol/generated.ts";
import { fromBody } from "../anchors.ts";
import { casterLayer } from "../contact_shadow.ts";
import { materialOf } from "../materials.ts";
import { opacityOf, textOf } from "../parts.ts";
import type { Cover, CoverHit } from "../pickable.ts";
import type { Points } from "../points.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import { tilePerRadius } from "../shapes/sweep.ts";
import type { EntityView } from "./entity.ts";

const sides = 12;
/** Rings from one point to the next. */
const ringsPerSpan = 6;

interface Tube {
  entity: TubeEntity;
  readonly mesh: Mesh<BufferGeometry, MeshStandardMaterial>;
  /** World, m; three numbers each. */
  readonly places: Float32Array;
  readonly moves: boolean;
  written: boolean;
}

export class TubeView implements EntityView<TubeEntity>, Cover {
  readonly root = new Group();

  private readonly poses_: PoseBuffer;
  private readonly tubes_ = new Map<number, Tube>();
  private readonly place_ = new Vector3();
  private readonly center_ = new Vector3();
  private readonly before_ = new Vector3();
  private readonly tangent_ = new Vector3();
  private readonly normal_ = new Vector3();
  private readonly across_ = new Vector3();
  private readonly ray_ = new Ray();
  private readonly canHold_: (body: number) => boolean;

  constructor(poses: PoseBuffer, canHold: (body: number) => boolean) {
    this.poses_ = poses;
    this.canHold_ = canHold;
  }

  create(entity: TubeEntity): void {
    const count = entity.points.length / 3;
    if (count < 2) return;
    const geometry = makeTube(ringsPerSpan * (entity.closed ? count : count - 1) + 1);
    const { material, color } = entity;
    const mesh = new Mesh(geometry, materialOf({ material, color: textOf(color), opacity: opacityOf(color) }));
    mesh.frustumCulled = false;
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.layers.enable(casterLayer);
    this.root.add(mesh);
    const moves = entity.bodies.some((body) => body !== NO_BODY);
    this.tubes_.set(entity.id.slot, { entity, mesh, places: new Float32Array(3 * count), moves, written: false });
  }

  change(entity: TubeEntity): void {
    this.destroy(entity.id.slot);
    this.create(entity);
  }

  destroy(slot: number): void {
    const tube = this.tubes_.get(slot);
    if (tube === undefined) return;
    this.tubes_.delete(slot);
    tube.mesh.removeFromParent();
    tube.mesh.geometry.dispose();
  }

  draw(): void {
    for (const tube of this.tubes_.values()) {
      if (tube.written && !tube.moves) continue;
      tube.mesh.visible = this.follow_(tube);
      tube.written = tube.mesh.visible;
      if (tube.mesh.visible) this.write_(tube);
    }
  }

  /** Points of those in the world. */
  addPlaces(points: Points): void {
    for (const { entity: { points: own }, moves } of this.tubes_.values()) {
      if (!moves) points.addSample(own);
    }
  }

  // --- Cover

  hitByRay(origin: ArrayLike<number>, direction: ArrayLike<number>, tolerance: number, hit: CoverHit): void {
    const { ray_: ray, place_: onRay, across_: onTube } = this;
    ray.origin.fromArray(origin);
    ray.direction.fromArray(direction);
    for (const tube of this.tubes_.values()) {
      const pieces = this.firstPiece_(tube);
      for (let piece = 0; piece < pieces; piece++) {
        this.nextPiece_(tube, piece);
        const apart = Math.sqrt(ray.distanceSqToSegment(this.before_, this.center_, onRay, onTube));
        const along = onRay.distanceTo(ray.origin);
        if (along < hit.distance && apart < tube.entity.radius + tolerance * along) this.take_(tube, piece, along, hit);
      }
    }
  }

  hitByPoint(point: ArrayLike<number>, hit: CoverHit): void {
    const { ray_: { origin: from }, across_: way, tangent_: place } = this;
    from.fromArray(point);
    for (const tube of this.tubes_.values()) {
      const pieces = this.firstPiece_(tube);
      for (let piece = 0; piece < pieces; piece++) {
        this.nextPiece_(tube, piece);
        way.subVectors(this.center_, this.before_);
        const share = Math.min(Math.max(place.subVectors(from, this.before_).dot(way) / Math.max(way.lengthSq(), 1e-30), 0), 1);
        const apart = Math.max(place.addScaledVector(way, -share).length() - tube.entity.radius, 0);
        if (apart < hit.distance) this.take_(tube, piece, apart, hit);
      }
    }
  }

  /** Goes to the beginning of a tube; returns its number of straight pieces, 0 for one that is on no body or not drawn. */
  private firstPiece_({ entity: { closed }, places, moves, mesh: { visible } }: Tube): number {
    if (!moves || !visible) return 0;
    onCurve(places, closed, 0, this.center_, this.tangent_);
    return ringsPerSpan * (places.length / 3 - (closed ? 0 : 1));
  }

  /** Puts the ends of a piece into `before_` and `center_`. */
  private nextPiece_({ entity: { closed }, places }: Tube, piece: number): void {
    this.before_.copy(this.center_);
    onCurve(places, closed, (piece + 1) / ringsPerSpan, this.center_, this.tangent_);
  }

  /** A hit on a piece: of the nearer one of the two bodies that it is between, or of the other where that cannot be held. */
  private take_({ entity: { bodies, points } }: Tube, piece: number, distance: number, hit: CoverHit): void {
    const t = (piece + 0.5) / ringsPerSpan;
    const nearest = Math.round(t);
    for (const index of [nearest, nearest > t ? nearest - 1 : nearest + 1]) {
      const point = index % bodies.length;
      if (!this.canHold_(bodies[point])) continue;
      hit.body = bodies[point];
      hit.distance = distance;
      for (let axis = 0; axis < 3; axis++) hit.localPoint[axis] = points[3 * point + axis];
      return;
    }
  }

  private follow_({ entity: { bodies, points }, places }: Tube): boolean {
    for (let index = 0; 3 * index < points.length; index++) {
      const body = bodies.length === 0 ? NO_BODY : bodies[index];
      if (!fromBody(this.poses_, body, this.place_.fromArray(points, 3 * index))) return false;
      this.place_.toArray(places, 3 * index);
    }
    return true;
  }

  private write_({ entity: { radius, closed }, mesh: { geometry }, places }: Tube): void {
    const { position, normal, uv } = geometry.attributes as Record<string, BufferAttribute>;
    const { center_: center, before_: before, tangent_: tangent, normal_: turned, across_: across } = this;
    const rings = position.count / (sides + 1);
    let length = 0;
    for (let ring = 0; ring < rings; ring++) {
      onCurve(places, closed, ring / ringsPerSpan, center, tangent);
      if (ring === 0) {
        turned.set(0, 1, 0);
        if (Math.abs(tangent.y) > 0.9) turned.set(1, 0, 0);
      } else {
        length += center.distanceTo(before);
      }
      // The previous ring's direction, projected normal to the curve.
      turned.addScaledVector(tangent, -turned.dot(tangent)).normalize();
      across.crossVectors(tangent, turned);
      for (let side = 0; side <= sides; side++) {
        const angle = (2 * Math.PI * side) / sides;
        const at = ring * (sides + 1) + side;
        const [c, s] = [Math.cos(angle), Math.sin(angle)];
        const nx = c * turned.x + s * across.x, ny = c * turned.y + s * across.y, nz = c * turned.z + s * across.z;
        normal.setXYZ(at, nx, ny, nz);
        position.setXYZ(at, center.x + radius * nx, center.y + radius * ny, center.z + radius * nz);
        uv.setXY(at, length / (tilePerRadius * radius), side / sides);
      }
      before.copy(center);
    }
    position.needsUpdate = normal.needsUpdate = uv.needsUpdate = true;
  }
}

/** Place and direction at t spans from the first point: a Catmull-Rom spline. */
function onCurve(places: Float32Array, closed: boolean, t: number, center: Vector3, tangent: Vector3): void {
  const count = places.length / 3;
  const spans = closed ? count : count - 1;
  const span = Math.min(Math.floor(t), spans - 1);
  const u = t - span;
  const at = (index: number) => 3 * (closed ? (index + count) % count : Math.min(Math.max(index, 0), count - 1));
  const [a, b, c, d] = [at(span - 1), at(span), at(span + 1), at(span + 2)];
  for (let axis = 0; axis < 3; axis++) {
    const from = places[b + axis], to = places[c + axis];
    const start = (to - places[a + axis]) / (a === b ? 1 : 2);
    const end = (places[d + axis] - from) / (c === d ? 1 : 2);
    const way = from - to;
    const p3 = 2 * way + start + end, p2 = -3 * way - 2 * start - end;
    center.setComponent(axis, ((p3 * u + p2) * u + start) * u + from);
    tangent.setComponent(axis, (3 * p3 * u + 2 * p2) * u + start);
  }
  if (tangent.lengthSq() > 0) tangent.normalize();
  else tangent.set(1, 0, 0);
}

function makeTube(rings: number): BufferGeometry {
  const geometry = new BufferGeometry();
  const count = rings * (sides + 1);
  for (const [name, size] of [["position", 3], ["normal", 3], ["uv", 2]] as const) {
    geometry.setAttribute(name, new BufferAttribute(new Float32Array(size * count), size).setUsage(DynamicDrawUsage));
  }
  // Untinted; without the attribute, graphics cards take another value.
  geometry.setAttribute("tint", new BufferAttribute(new Float32Array(4 * count), 4));
  const index = new Uint32Array(6 * sides * (rings - 1) + 6 * (sides - 2));
  let at = 0;
  for (let ring = 0; ring + 1 < rings; ring++) {
    for (let side = 0; side < sides; side++) {
      const a = ring * (sides + 1) + side, b = a + sides + 1;
      index.set([a, a + 1, b, a + 1, b + 1, b], at);
      at += 6;
    }
  }
  const last = (rings - 1) * (sides + 1);
  for (let side = 1; side + 1 < sides; side++) {
    index.set([0, side + 1, side, last, last + side, last + side + 1], at);
    at += 6;
  }
  return geometry.setIndex(new BufferAttribute(index, 1));
}
