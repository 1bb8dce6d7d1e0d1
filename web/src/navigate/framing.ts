// SPDX-License-Identifier: Apache-2.0
// The place of a camera from which given points fill the picture. Pure functions; lengths in m.

import type { Points } from "../scene/points.ts";

/** The part of the picture to fill, as tangents of angles from the center: to the side, up and down. */
export interface Frame {
  readonly side: number;
  /** To the right, if that is less. */
  readonly right?: number;
  readonly up: number;
  readonly down: number;
}

/** A view: the camera looks at the pivot from `distance`, turned by yaw and pitch. */
export interface FittedView {
  readonly pivot: readonly [number, number, number];
  readonly distance: number;
  readonly yaw: number;
  readonly pitch: number;
}

/** Unit vectors of a view: to the right, up, and from the pivot to the camera. */
export function viewAxes(yaw: number, pitch: number): readonly [right: number[], up: number[], away: number[]] {
  const away = [Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch), Math.cos(pitch) * Math.cos(yaw)];
  const right = [Math.cos(yaw), 0, -Math.sin(yaw)];
  const up = [-Math.sin(pitch) * Math.sin(yaw), Math.cos(pitch), -Math.sin(pitch) * Math.cos(yaw)];
  return [right, up, away];
}

/**
 * The nearest view of this direction that shows all points within the frame. A camera at (x, y, z) of the view's axes has a point
 * (a, b, c) within its right edge where (z - c) side >= a - x, and so on for each edge: the largest of each decides.
 */
export function fitView({ xyz, count }: Points, yaw: number, pitch: number, frame: Frame): FittedView | null {
  const { side, right: edge = side } = frame;
  if (count === 0) return null;
  const [right, up, away] = viewAxes(yaw, pitch);
  let [toRight, toLeft, over, under, front, back] = Array<number>(6).fill(-Infinity);
  for (let at = 0; at < 3 * count; at += 3) {
    const x = xyz[at], y = xyz[at + 1], z = xyz[at + 2];
    const a = right[0] * x + right[2] * z;
    const b = up[0] * x + up[1] * y + up[2] * z;
    const c = away[0] * x + away[1] * y + away[2] * z;
    toRight = Math.max(toRight, c * edge + a);
    toLeft = Math.max(toLeft, c * side - a);
    over = Math.max(over, c * frame.up + b);
    under = Math.max(under, c * frame.down - b);
    front = Math.max(front, c);
    back = Math.max(back, -c);
  }
  const depth = Math.max((toRight + toLeft) / (edge + side), (over + under) / (frame.up + frame.down), front);
  // The rest of the width or the height is divided equally to both sides.
  const aside = ((toRight - depth * edge) + (depth * side - toLeft)) / 2;
  const height = ((over - depth * frame.up) + (depth * frame.down - under)) / 2;
  const middle = (front - back) / 2;
  const distance = Math.max(depth - middle, 1e-12);
  const pivot = [0, 1, 2].map((axis) => aside * right[axis] + height * up[axis] + middle * away[axis]);
  return { pivot: [pivot[0], pivot[1], pivot[2]], distance, yaw, pitch };
}

/** The nearest distance at which a camera that looks at the pivot shows all points within the frame; 0 without points. */
export function distanceToShow({ xyz, count }: Points, { pivot, yaw, pitch }: Omit<FittedView, "distance">, frame: Frame): number {
  const [right, up, away] = viewAxes(yaw, pitch);
  let least = 0;
  for (let at = 0; at < 3 * count; at += 3) {
    const p = [xyz[at] - pivot[0], xyz[at + 1] - pivot[1], xyz[at + 2] - pivot[2]];
    const a = right[0] * p[0] + right[2] * p[2];
    const b = up[0] * p[0] + up[1] * p[1] + up[2] * p[2];
    const c = away[0] * p[0] + away[1] * p[1] + away[2] * p[2];
    least = Math.max(least, c + Math.max(Math.abs(a) / frame.side, b / frame.up, -b / frame.down));
  }
  return least;
}

/** Place of the horizon for a camera that looks up, as a share of the frame below its center. */
const lowHorizon = 0.35;

/**
 * The view of a camera at `eye` that looks at `target`; if not all points are within the frame, moved sideways until they are in the
 * middle, and back as far as needed, to at most `farther` times the distance. It goes back along its line of sight. One that looks up
 * goes back on the level, so that it is never lower than it was, with the horizon below the middle: half of a tall picture would be
 * ground otherwise.
 */
export function standBack(
  points: Points, eye: readonly [number, number, number], target: readonly [number, number, number], frame: Frame, farther: number,
): FittedView {
  const from = [eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]];
  const distance = Math.max(Math.hypot(...from), 1e-12);
  const yaw = Math.atan2(from[0], from[2]);
  const view = { pivot: target, distance, yaw, pitch: Math.asin(from[1] / distance) };
  if (Math.min(farther, distanceToShow(points, view, frame) / distance) <= 1.05) return view;
  const pitch = view.pitch < 0 ? -Math.atan(lowHorizon * frame.down) : view.pitch;
  const [right, up, away] = viewAxes(yaw, pitch);
  const back = pitch < 0 ? [Math.sin(yaw), 0, Math.cos(yaw)] : away;
  const rises = dot(up, back);
  const recedes = dot(away, back);
  let [toRight, toLeft, way] = [-Infinity, -Infinity, 0];
  for (let at = 0; at < 3 * points.count; at += 3) {
    const p = [points.xyz[at] - eye[0], points.xyz[at + 1] - eye[1], points.xyz[at + 2] - eye[2]];
    const [a, b, c] = [dot(right, p), dot(up, p), dot(away, p)];
    toRight = Math.max(toRight, c * frame.side + a);
    toLeft = Math.max(toLeft, c * frame.side - a);
    way = Math.max(way, (c * frame.up + b) / (frame.up * recedes + rises), (c * frame.down - b) / (frame.down * recedes - rises));
  }
  way = Math.min(Math.max(way, (toRight + toLeft) / (2 * frame.side * recedes)), (farther - 1) * distance);
  const aside = (toRight - toLeft) / 2;
  const depth = distance + way * recedes;
  const pivot = [0, 1, 2].map((axis) => eye[axis] + way * back[axis] + aside * right[axis] - depth * away[axis]);
  return { pivot: [pivot[0], pivot[1], pivot[2]], distance: depth, yaw, pitch };
}

/** Keeps the points within the frame of a camera at `eye` that looks at `target`. */
export function dropOutside(points: Points, eye: readonly [number, number, number], target: readonly [number, number, number], frame: Frame): void {
  const from = [eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]];
  const distance = Math.max(Math.hypot(...from), 1e-12);
  const [right, up, away] = viewAxes(Math.atan2(from[0], from[2]), Math.asin(from[1] / distance));
  const { xyz, count } = points;
  points.count = 0;
  for (let at = 0; at < 3 * count; at += 3) {
    const p = [xyz[at] - eye[0], xyz[at + 1] - eye[1], xyz[at + 2] - eye[2]];
    const [a, b, depth] = [dot(right, p), dot(up, p), -dot(away, p)];
    if (Math.abs(a) <= depth * frame.side && b <= depth * frame.up && -b <= depth * frame.down) points.add(xyz[at], xyz[at + 1], xyz[at + 2]);
  }
}

/** Adds to `found` the points that are farthest out of the frame of a view, to each side. */
export function addOutermost(found: Points, points: Points, view: FittedView, frame: Frame): void {
  const [right, up, away] = viewAxes(view.yaw, view.pitch);
  const most = Array<number>(4).fill(-Infinity);
  const outermost = Array<number>(4).fill(-1);
  for (let at = 0; at < 3 * points.count; at += 3) {
    const p = [points.xyz[at] - view.pivot[0], points.xyz[at + 1] - view.pivot[1], points.xyz[at + 2] - view.pivot[2]];
    const [a, b, c] = [dot(right, p), dot(up, p), dot(away, p)];
    const out = [c * (frame.right ?? frame.side) + a, c * frame.side - a, c * frame.up + b, c * frame.down - b];
    for (let side = 0; side < 4; side++) {
      if (out[side] <= most[side]) continue;
      most[side] = out[side];
      outermost[side] = at;
    }
  }
  for (const at of outermost) if (at >= 0) found.add(points.xyz[at], points.xyz[at + 1], points.xyz[at + 2]);
}

/** Share of the points outside the frame of a view; 0 without points. */
export function shareOutside({ xyz, count }: Points, view: FittedView, frame: Frame): number {
  const [right, up, away] = viewAxes(view.yaw, view.pitch);
  let outside = 0;
  for (let at = 0; at < 3 * count; at += 3) {
    const p = [xyz[at] - view.pivot[0], xyz[at + 1] - view.pivot[1], xyz[at + 2] - view.pivot[2]];
    const a = right[0] * p[0] + right[2] * p[2];
    const b = up[0] * p[0] + up[1] * p[1] + up[2] * p[2];
    const depth = view.distance - (away[0] * p[0] + away[1] * p[1] + away[2] * p[2]);
    if (depth <= 0 || a > (frame.right ?? frame.side) * depth || -a > frame.side * depth || b > frame.up * depth || -b > frame.down * depth) outside++;
  }
  return count === 0 ? 0 : outside / count;
}

function dot(a: readonly number[], b: readonly number[]): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
