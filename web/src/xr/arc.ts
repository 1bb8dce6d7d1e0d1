// SPDX-License-Identifier: Apache-2.0
// The path of a teleport: a ballistic curve. Pure functions, no three.js.

/** Number of points of a path, with both ends. */
export const arcPoints = 33;

export class Arc {
  /** Three numbers a point, world, m. */
  readonly points = new Float32Array(3 * arcPoints);
  /** World, m; meaningful when `valid`. */
  readonly landing = new Float32Array(3);
  /** Whether the landing is allowed. */
  valid = false;
}

/** Initial speed, m/s: reaches about 6 m from a hand at rest. */
const speed = 7;
const earthGravity = 9.81;
/** Farthest landing along the ground, m. */
export const farthestLanding = 8;
/** An arc without landing is drawn for this time, s. */
const lostAfter = 1.2;

/**
 * Throws from `origin` along unit `direction` onto the plane y = `floor` and writes the path; a user's meter is `scale` of the world.
 * Invalid if the hand is below the floor or the landing too far away.
 */
export function throwArc(origin: ArrayLike<number>, direction: ArrayLike<number>, floor: number, arc: Arc, scale = 1): void {
  const thrown = scale * speed;
  const gravity = scale * earthGravity;
  const vx = thrown * direction[0], vy = thrown * direction[1], vz = thrown * direction[2];
  const drop = origin[1] - floor;
  // 1/2 g t^2 - vy t - drop = 0; the later root is the landing.
  const root = vy * vy + 2 * gravity * drop;
  const lands = drop > 0 && root >= 0;
  const time = lands ? (vy + Math.sqrt(root)) / gravity : lostAfter;
  for (let index = 0; index < arcPoints; index++) {
    const t = (time * index) / (arcPoints - 1);
    arc.points[3 * index] = origin[0] + vx * t;
    arc.points[3 * index + 1] = origin[1] + vy * t - 0.5 * gravity * t * t;
    arc.points[3 * index + 2] = origin[2] + vz * t;
  }
  arc.landing[0] = origin[0] + vx * time;
  arc.landing[1] = floor;
  arc.landing[2] = origin[2] + vz * time;
  arc.valid = lands && Math.hypot(vx * time, vz * time) <= scale * farthestLanding;
}
