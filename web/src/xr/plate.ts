// SPDX-License-Identifier: Apache-2.0
// Rays and fingertips on a flat panel with buttons. Pure functions, no three.js.

/** A rectangle in the world: center at its origin, x right, y up, z towards the reader. */
export interface Plate {
  /** Transform into the world, column by column: rigid, times one scale. */
  matrix: ArrayLike<number>;
  /** m, of its own frame. */
  width: number;
  height: number;
  /** The resolution of its picture, pixels a meter. */
  density: number;
}

/** A place in a picture, px from its top left corner. */
export interface Rect {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

/** Result of a test, reused by its owner. */
export class Spot {
  /** px from the top left corner. */
  x = 0;
  y = 0;
  /** Along the ray, m of the world; or in front of the plate (negative: behind), m of its frame. */
  distance = 0;
}

/** Square of the scale of a plate. */
function scaleOf({ matrix: m }: Plate): number {
  return m[8] * m[8] + m[9] * m[9] + m[10] * m[10];
}

function toPicture(plate: Plate, px: number, py: number, pz: number, spot: Spot): boolean {
  const m = plate.matrix;
  const scale = scaleOf(plate);
  const dx = (px - m[12]) / scale, dy = (py - m[13]) / scale, dz = (pz - m[14]) / scale;
  const x = dx * m[0] + dy * m[1] + dz * m[2];
  const y = dx * m[4] + dy * m[5] + dz * m[6];
  spot.x = (x + plate.width / 2) * plate.density;
  spot.y = (plate.height / 2 - y) * plate.density;
  return Math.abs(x) <= plate.width / 2 && Math.abs(y) <= plate.height / 2;
}

/** Whether a ray hits the plate from the front; the spot is the place. */
export function rayOnPlate(plate: Plate, origin: ArrayLike<number>, direction: ArrayLike<number>, spot: Spot): boolean {
  const m = plate.matrix;
  const slope = direction[0] * m[8] + direction[1] * m[9] + direction[2] * m[10];
  if (slope > -1e-3 * Math.sqrt(scaleOf(plate))) return false;
  const height = (origin[0] - m[12]) * m[8] + (origin[1] - m[13]) * m[9] + (origin[2] - m[14]) * m[10];
  if (height < 0) return false;
  const t = -height / slope;
  spot.distance = t;
  return toPicture(plate, origin[0] + t * direction[0], origin[1] + t * direction[1], origin[2] + t * direction[2], spot);
}

/** Whether a point lies over (or behind) the plate; the spot is its foot, with the signed distance. */
export function pointOnPlate(plate: Plate, point: ArrayLike<number>, spot: Spot): boolean {
  const m = plate.matrix;
  spot.distance = ((point[0] - m[12]) * m[8] + (point[1] - m[13]) * m[9] + (point[2] - m[14]) * m[10]) / scaleOf(plate);
  return toPicture(plate, point[0], point[1], point[2], spot);
}

/** Index of the button at a place, -1: none. `slack` widens each button, px: fingers are blunt. */
export function buttonAt(buttons: readonly Rect[], x: number, y: number, slack = 0): number {
  for (let index = 0; index < buttons.length; index++) {
    const { x: left, y: top, width, height } = buttons[index];
    if (x >= left - slack && x <= left + width + slack && y >= top - slack && y <= top + height + slack) return index;
  }
  return -1;
}

/** A fingertip comes near and is about to press. */
export const pokeNear = 0.08;
const armAbove = 0.012;
/** Deeper than this the finger reaches through instead of pressing. */
const through = -0.06;

/** One fingertip: presses once when it passes through the plate from the front, again only after it has left. */
export class Poke {
  /** Whether the finger is in front of the panel and near enough to touch the button under it. */
  near = false;
  private armed_ = false;

  /** `over`: whether it is over the plate; `height`: distance in front, m. Returns whether it presses now. */
  update(over: boolean, height: number): boolean {
    this.near = over && height < pokeNear && height > through;
    if (!over || height > pokeNear) {
      this.armed_ = over && height <= 2 * pokeNear;
      return false;
    }
    if (height > armAbove) this.armed_ = true;
    if (!this.armed_ || height > 0 || height < through) return false;
    this.armed_ = false;
    return true;
  }
}
