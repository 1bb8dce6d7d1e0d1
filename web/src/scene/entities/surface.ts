// SPDX-License-Identifier: Apache-2.0
// Surfaces between points: cloth, nets, sails, skins. Seen from both sides, smooth, with shadows; those on bodies move with them.

import { BufferAttribute, BufferGeometry, DoubleSide, DynamicDrawUsage, Group, Mesh, Vector3, type MeshStandardMaterial } from "three";
import type { SurfaceEntity } from "../../protocol/generated.ts";
import { fromBody, moves, placeOf, turnOf } from "../anchors.ts";
import { casterLayer } from "../contact_shadow.ts";
import { materialOf } from "../materials.ts";
import { opacityOf, textOf } from "../parts.ts";
import type { Points } from "../points.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import { drawTriangles } from "../shapes/mesh.ts";
import type { EntityView } from "./entity.ts";

interface Surface {
  entity: SurfaceEntity;
  readonly mesh: Mesh<BufferGeometry, MeshStandardMaterial>;
  /** Its points are on several bodies; else it is rigid. */
  readonly bends: boolean;
}

/** Of one surface, for the camera. */
const mostFramed = 400;

export class SurfaceView implements EntityView<SurfaceEntity> {
  readonly root = new Group();

  private readonly poses_: PoseBuffer;
  private readonly surfaces_ = new Map<number, Surface>();
  private readonly point_ = new Vector3();

  constructor(poses: PoseBuffer) {
    this.poses_ = poses;
  }

  create(entity: SurfaceEntity): void {
    const { material, color, bodies, points, triangles } = entity;
    const bends = bodies.length > 0;
    const geometry = bends ? makeBending(points.length / 3, triangles) : drawTriangles(Float32Array.from(points), Uint32Array.from(triangles));
    // Untinted; without the attribute, graphics cards take another value.
    geometry.setAttribute("tint", new BufferAttribute(new Float32Array(4 * geometry.getAttribute("position").count), 4));
    const own = materialOf({ material, color: textOf(color), opacity: opacityOf(color), side: DoubleSide });
    const mesh = new Mesh(geometry, own);
    mesh.frustumCulled = false;
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.layers.enable(casterLayer);
    this.root.add(mesh);
    const surface = { entity, mesh, bends };
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

  /** Points of those in the world. */
  addPlaces(points: Points): void {
    for (const { entity: { at, points: own }, bends } of this.surfaces_.values()) {
      if (bends || moves(at)) continue;
      const [x, y, z] = at.point;
      for (let from = 0; from < own.length; from += 3 * Math.ceil(own.length / 3 / mostFramed)) points.add(x + own[from], y + own[from + 1], z + own[from + 2]);
    }
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

/** Room for points that are written each frame. */
function makeBending(count: number, triangles: ArrayLike<number>): BufferGeometry {
  const geometry = new BufferGeometry();
  for (const [name, size] of [["position", 3], ["normal", 3], ["uv", 2]] as const) {
    geometry.setAttribute(name, new BufferAttribute(new Float32Array(size * count), size).setUsage(DynamicDrawUsage));
  }
  return geometry.setIndex(new BufferAttribute(Uint32Array.from(triangles), 1));
}

/** Adds the normal of a triangle, as long as it is large, to those of its corners. */
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
