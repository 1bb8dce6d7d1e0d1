// SPDX-License-Identifier: Apache-2.0
// The place of a camera from which given points fill the picture. Pure functions; lengths in m.

import type { Points } from "../scene/points.ts";

/** The part of the picture to fill, as tangents of angles from the center: to the side, up and down. */
export interface Frame {
  readonly side: number;
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
  if (count === 0) return null;
  const [right, up, away] = viewAxes(yaw, pitch);
  let [toRight, toLeft, over, under, front, back] = Array<number>(6).fill(-Infinity);
  for (let at = 0; at < 3 * count; at += 3) {
    const x = xyz[at], y = xyz[at + 1], z = xyz[at + 2];
    const a = right[0] * x + right[2] * z;
    const b = up[0] * x + up[1] * y + up[2] * z;
    const c = away[0] * x + away[1] * y + away[2] * z;
    toRight = Math.max(toRight, c * frame.side + a);
    toLeft = Math.max(toLeft, c * frame.side - a);
    over = Math.max(over, c * frame.up + b);
    under = Math.max(under, c * frame.down - b);
    front = Math.max(front, c);
    back = Math.max(back, -c);
  }
  const depth = Math.max((toRight + toLeft) / (2 * frame.side), (over + under) / (frame.up + frame.down), front);
  const aside = (toRight - toLeft) / 2;
  // If the width is decisive, the remaining height is divided equally above and below.
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

/**
 * The view of a camera at `eye` that looks at `target`, from up to `farther` times as far away where not all points are within the frame.
 * It goes back along its line of sight, or on the level where it looks up, so that it is never lower than it was.
 */
export function standBack(
  points: Points, eye: readonly [number, number, number], target: readonly [number, number, number], frame: Frame, farther: number,
): FittedView {
  const away = [eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]];
  const distance = Math.max(Math.hypot(...away), 1e-12);
  const view = { pivot: target, distance, yaw: Math.atan2(away[0], away[2]), pitch: Math.asin(away[1] / distance) };
  const times = Math.min(farther, distanceToShow(points, view, frame) / distance);
  if (times <= 1.05) return view;
  if (away[1] >= 0) return { ...view, distance: times * distance };
  const back = Math.hypot(times * away[0], away[1], times * away[2]);
  return { ...view, distance: back, pitch: Math.asin(away[1] / back) };
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
    if (depth <= 0 || Math.abs(a) > frame.side * depth || b > frame.up * depth || -b > frame.down * depth) outside++;
  }
  return count === 0 ? 0 : outside / count;
}
