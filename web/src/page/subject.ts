// SPDX-License-Identifier: Apache-2.0
// The things that a first view shows: what moves, what stands around it, and not what has gone far away from the others. Pure
// functions; lengths in m.

import type { Points } from "../scene/points.ts";

export type Place = readonly [number, number, number];

/** A body or another thing: its box, and its place in a list of points. */
export interface Item {
  /** -1: not a body. */
  readonly slot: number;
  readonly moves: boolean;
  readonly low: Place;
  readonly high: Place;
  readonly center: Place;
  /** Half the diagonal of the box. */
  readonly radius: number;
  readonly first: number;
  readonly end: number;
}

/** Fixed things count if they are near movable ones, up to this many times their size. */
export const settingSize = 2.6;
/** Things that are neither a floor nor walls around the moving ones count up to so many times their size. */
const supportSize = 24;
/** A floor reaches so many sizes of the moving things beyond them, on all sides. */
const floorSize = 6;
/** A thing that has gone so many times as far from the middle as any other is left out, if it is one, or a tenth of all. */
const gap = 4;
const fewest = 3;

/** The item of the points from `first` on; null if there are none. */
export function makeItem({ xyz, count }: Points, first: number, slot: number, moves: boolean): Item | null {
  if (count === first) return null;
  const low: [number, number, number] = [Infinity, Infinity, Infinity];
  const high: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (let at = 3 * first; at < 3 * count; at += 3) {
    for (let axis = 0; axis < 3; axis++) {
      low[axis] = Math.min(low[axis], xyz[at + axis]);
      high[axis] = Math.max(high[axis], xyz[at + axis]);
    }
  }
  const center: Place = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2];
  return { slot, moves, low, high, center, radius: apart(low, high) / 2, first, end: count };
}

export function apart(a: Place, b: Place): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/** The box around all items. */
export function boxOf(items: readonly Item[]): Pick<Item, "low" | "high" | "center" | "radius"> {
  const end = (side: "low" | "high", best: (...values: number[]) => number): Place => (
    [0, 1, 2].map((axis) => items.reduce((found, item) => best(found, item[side][axis]), items[0][side][axis])) as unknown as Place
  );
  const [low, high] = [end("low", Math.min), end("high", Math.max)];
  return { low, high, center: [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2], radius: apart(low, high) / 2 };
}

/** All but one or a tenth of them that are far beyond the others. */
export function withoutFar(items: readonly Item[]): readonly Item[] {
  if (items.length < fewest) return items;
  const middle = [0, 1, 2].map((axis) => {
    const sorted = items.map(({ center }) => center[axis]).sort((a, b) => a - b);
    return (sorted[(items.length - 1) >> 1] + sorted[items.length >> 1]) / 2;
  }) as unknown as Place;
  const sorted = items.map((item) => ({ item, near: apart(item.center, middle), far: apart(item.center, middle) + item.radius }))
    .sort((a, b) => a.near - b.near);
  const least = items.length - Math.max(1, Math.floor(items.length / 10));
  let reach = 0;
  for (const [index, { near, far }] of sorted.entries()) {
    if (index >= least && near > gap * reach) return sorted.slice(0, index).map(({ item }) => item);
    reach = Math.max(reach, far);
  }
  return items;
}

/**
 * The fixed things that belong to the moving ones: those near them, and larger ones too, except for floors and for walls around
 * them. `support`: false: only near ones.
 */
export function settingOf(moving: readonly Item[], fixed: readonly Item[], support: boolean): readonly Item[] {
  const subject = boxOf(moving);
  const size = Math.max(subject.radius, 1e-12);
  const reachOf = (item: Item) => apart(item.center, subject.center) + item.radius;
  const near = fixed.filter((item) => reachOf(item) < settingSize * size);
  if (!support) return near;
  const larger = fixed.filter((item) => reachOf(item) >= settingSize * size && reachOf(item) < supportSize * size
    && !isFloor(item) && !contains(item));
  return [...near, ...(isRoom(larger) ? [] : larger)];

  function isFloor({ low, high }: Item): boolean {
    return [0, 2].every((axis) => low[axis] < subject.low[axis] - floorSize * size && high[axis] > subject.high[axis] + floorSize * size);
  }

  /** A room of one piece. */
  function contains({ low, high }: Item): boolean {
    return high[1] > subject.high[1] + size && [0, 2].every((axis) => low[axis] < subject.low[axis] - size && high[axis] > subject.high[axis] + size);
  }

  function isRoom(items: readonly Item[]): boolean {
    const sides = new Set<string>();
    for (const { low, high } of items) {
      if (high[1] < subject.high[1] + size) continue;
      for (const [axis, other] of [[0, 2], [2, 0]]) {
        if (low[other] > subject.center[other] || high[other] < subject.center[other]) continue;
        if (low[axis] > subject.high[axis]) sides.add(`${axis}+`);
        if (high[axis] < subject.low[axis]) sides.add(`${axis}-`);
      }
    }
    return sides.size > 2;
  }
}
