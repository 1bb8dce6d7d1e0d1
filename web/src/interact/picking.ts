// SPDX-License-Identifier: Apache-2.0
// Finds the body that a ray or a hand points at. Packed bounding spheres first, then the exact distance
// function of the few that remain. A cone of tolerance makes thin bodies pickable with a finger.

import type { CoverHit, Pickable } from "../scene/pickable.ts";
import { bodyDistance } from "../scene/shapes/shape.ts";

/** The result of a pick; reused by its owner so that hovering allocates nothing. */
export class Hit {
  body = -1;
  /** Along the ray, or from the hand to the surface, m. */
  distance = 0;
  /** World, m. */
  readonly point = new Float32Array(3);
  /** In the body's frame, m. */
  readonly localPoint = new Float32Array(3);
}

const local = new Float32Array(3);

/** World point into a body's frame. */
export function toBody(scene: Pick<Pickable, "position" | "rotation">, body: number, x: number, y: number, z: number, out: Float32Array): void {
  const p = body * 3;
  const r = body * 4;
  rotate(
    -scene.rotation[r], -scene.rotation[r + 1], -scene.rotation[r + 2], scene.rotation[r + 3],
    x - scene.position[p], y - scene.position[p + 1], z - scene.position[p + 2], out,
  );
}

/** Point of a body's frame into the world. */
export function toWorld(scene: Pick<Pickable, "position" | "rotation">, body: number, point: Float32Array, out: Float32Array): void {
  const p = body * 3;
  const r = body * 4;
  rotate(
    scene.rotation[r], scene.rotation[r + 1], scene.rotation[r + 2], scene.rotation[r + 3],
    point[0], point[1], point[2], out,
  );
  out[0] += scene.position[p];
  out[1] += scene.position[p + 1];
  out[2] += scene.position[p + 2];
}

function rotate(
  qx: number, qy: number, qz: number, qw: number, x: number, y: number, z: number, out: Float32Array,
): void {
  const tx = 2 * (qy * z - qz * y);
  const ty = 2 * (qz * x - qx * z);
  const tz = 2 * (qx * y - qy * x);
  out[0] = x + qw * tx + qy * tz - qz * ty;
  out[1] = y + qw * ty + qz * tx - qx * tz;
  out[2] = z + qw * tz + qx * ty - qy * tx;
}

function distanceAt(scene: Pickable, body: number, x: number, y: number, z: number): number {
  toBody(scene, body, x, y, z, local);
  return bodyDistance(scene.shapesOf(body), local[0], local[1], local[2]);
}

/** Moves a point in the body's frame onto the body's surface when it lies outside. */
function pullToSurface(scene: Pickable, body: number, point: Float32Array): void {
  const shapes = scene.shapesOf(body);
  const step = 0.2 * touching(scene);
  const distance = bodyDistance(shapes, point[0], point[1], point[2]);
  if (distance <= 0) return;
  const gx = bodyDistance(shapes, point[0] + step, point[1], point[2]) - distance;
  const gy = bodyDistance(shapes, point[0], point[1] + step, point[2]) - distance;
  const gz = bodyDistance(shapes, point[0], point[1], point[2] + step) - distance;
  const norm = Math.hypot(gx, gy, gz);
  if (norm < 1e-6 * step) return;
  point[0] -= (gx / norm) * distance;
  point[1] -= (gy / norm) * distance;
  point[2] -= (gz / norm) * distance;
}

/** Distance below which a point is on a surface: half a millimeter in a room, less in a smaller scene, m. */
function touching({ size }: Pickable): number {
  return 3e-4 * Math.min(size, 1.6);
}

const coverHit: CoverHit = { distance: 0, body: -1, localPoint: new Float32Array(3) };

function takeCoverHit(scene: Pickable, out: Hit): void {
  out.body = coverHit.body;
  out.distance = coverHit.distance;
  out.localPoint.set(coverHit.localPoint);
  toWorld(scene, out.body, out.localPoint, out.point);
}

/**
 * Nearest body along a ray with unit direction. A hit has priority over a body that is only within `tolerance` (tangent
 * of the cone's half-angle) of the ray; among the latter the one nearest to the ray is taken.
 */
export function pickRay(
  scene: Pickable, origin: ArrayLike<number>, direction: ArrayLike<number>,
  tolerance: number, farthest: number, out: Hit,
): boolean {
  const ox = origin[0], oy = origin[1], oz = origin[2];
  const dx = direction[0], dy = direction[1], dz = direction[2];
  const close = touching(scene);
  let best = Infinity;
  let bestMiss = tolerance;
  let found = -1;
  let foundAt = 0;
  for (let index = 0; index < scene.pickableCount; index++) {
    const body = scene.pickable[index];
    const cx = scene.position[body * 3] - ox;
    const cy = scene.position[body * 3 + 1] - oy;
    const cz = scene.position[body * 3 + 2] - oz;
    const reach = scene.reach[body];
    const middle = cx * dx + cy * dy + cz * dz;
    if (middle < -reach || middle - reach > Math.min(best, farthest)) continue;
    const aside = cx * cx + cy * cy + cz * cz - middle * middle;
    const wide = reach + tolerance * Math.max(middle + reach, 0);
    if (aside > wide * wide) continue;
    // Sphere tracing by the distance to the body: exact for every shape, without triangles.
    let t = Math.max(0, middle - wide);
    const end = Math.min(middle + wide, farthest);
    for (let step = 0; step < 96 && t <= end; step++) {
      const distance = distanceAt(scene, body, ox + dx * t, oy + dy * t, oz + dz * t);
      if (distance < close) {
        if (t < best) {
          best = t;
          found = body;
          foundAt = t;
        }
        break;
      }
      const miss = distance / Math.max(t, 2 * close);
      if (best === Infinity && miss < bestMiss) {
        bestMiss = miss;
        found = body;
        foundAt = t;
      }
      t += distance;
    }
  }
  coverHit.body = -1;
  coverHit.distance = Math.min(best, farthest);
  for (const cover of scene.covers) cover.hitByRay(origin, direction, tolerance, coverHit);
  if (coverHit.body >= 0) {
    takeCoverHit(scene, out);
    return true;
  }
  if (found < 0) return false;
  out.body = found;
  out.distance = foundAt;
  toBody(scene, found, ox + dx * foundAt, oy + dy * foundAt, oz + dz * foundAt, out.localPoint);
  pullToSurface(scene, found, out.localPoint);
  toWorld(scene, found, out.localPoint, out.point);
  return true;
}

/** The body whose surface is nearest to a point (a fingertip, a controller), within `reach` meters. */
export function pickPoint(scene: Pickable, point: ArrayLike<number>, reach: number, out: Hit): boolean {
  const x = point[0], y = point[1], z = point[2];
  let best = reach;
  let found = -1;
  for (let index = 0; index < scene.pickableCount; index++) {
    const body = scene.pickable[index];
    const apart = Math.hypot(
      scene.position[body * 3] - x, scene.position[body * 3 + 1] - y, scene.position[body * 3 + 2] - z,
    );
    if (apart - scene.reach[body] > best) continue;
    const distance = distanceAt(scene, body, x, y, z);
    if (distance < best) {
      best = distance;
      found = body;
    }
  }
  coverHit.body = -1;
  coverHit.distance = best;
  for (const cover of scene.covers) cover.hitByPoint(point, coverHit);
  if (coverHit.body >= 0) {
    takeCoverHit(scene, out);
    return true;
  }
  if (found < 0) return false;
  out.body = found;
  out.distance = Math.max(best, 0);
  toBody(scene, found, x, y, z, out.localPoint);
  pullToSurface(scene, found, out.localPoint);
  toWorld(scene, found, out.localPoint, out.point);
  return true;
}
