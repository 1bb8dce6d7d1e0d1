// SPDX-License-Identifier: Apache-2.0
// The ways of things that leave the view: which of them come back, or stay near. Fetched when the first one leaves it.

import type { Points } from "../scene/points.ts";
import { apart, type Item, type Place } from "./subject.ts";

/** Among many things, only the ways of those outside the view are followed. */
const mostWays = 100;
/** The places of one way: a circle is found by places that are far apart. */
const mostPlaces = 12;
/** Places on a smaller arc are as good as on a line: the plane of their circle is not known. Rad. */
const leastTurn = 0.05;
/** In sizes of the scene: from its middle, what rests outside the view; what is rest between two looks; where circles are looked for. */
const restSize = 1.6;
const still = 0.01;
const circleSize = 2.5;
const circleMiddle = 1.5;

export class Ways {
  /** The latest places, by slot, oldest first. */
  private readonly places_ = new Map<number, readonly Place[]>();

  /**
   * Adds to `kept` places of single things outside the view that turn back or rest, and, if `mayCircle`, the circles along which they go;
   * whether one circles. What swings over a ground would not go around. `addItem` adds a thing's corners.
   */
  follow(
    members: readonly Item[], out: readonly Item[], { center, radius }: { readonly center: Place; readonly radius: number }, kept: Points,
    mayCircle: boolean, addItem: (item: Item) => void,
  ): boolean {
    const { places_: ways } = this;
    const slots = new Set(members.map(({ slot }) => slot));
    for (const slot of ways.keys()) if (!slots.has(slot)) ways.delete(slot);
    for (const item of members.length > mostWays ? out : members) ways.set(item.slot, [...(ways.get(item.slot) ?? []), item.center].slice(-mostPlaces));
    let circles = false;
    for (const item of out) {
      const way = ways.get(item.slot)!;
      if (way.length < 2 || item.slot < 0) continue;
      const far = apart(item.center, center);
      const rests = way.length > 2 && apart(way.at(-3)!, item.center) < still * radius && far < restSize * radius;
      if (rests || far < apart(way.at(-2)!, center) - (still * radius) / 2) addItem(item);
      const circle = mayCircle && way.length > 2 ? circleThrough(way[0], way[way.length >> 1], item.center) : null;
      if (circle === null || circle.radius > circleSize * radius || apart(circle.center, center) > circleMiddle * radius) continue;
      circles = true;
      for (const place of circle.points) kept.add(...place);
    }
    return circles;
  }

  clear(): void {
    this.places_.clear();
  }
}

/** The circle through three places; null for those nearly on a line. */
export function circleThrough(a: Place, b: Place, c: Place): { center: Place; radius: number; points: readonly Place[] } | null {
  const [u, v] = [minus(b, a), minus(c, a)];
  const n = cross(u, v);
  const [uu, vv, nn] = [dot(u, u), dot(v, v), dot(n, n)];
  if (nn < leastTurn * leastTurn * uu * vv) return null;
  const [toU, toV] = [cross(n, u), cross(v, n)];
  const way = [0, 1, 2].map((axis) => (vv * toU[axis] + uu * toV[axis]) / (2 * nn)) as unknown as Place;
  const center: Place = [a[0] + way[0], a[1] + way[1], a[2] + way[2]];
  const radius = Math.hypot(...way);
  const across = cross(n, way);
  const scale = radius / Math.hypot(...across);
  const points = [...Array(12).keys()].map((k): Place => {
    const [cos, sin] = [Math.cos((k * Math.PI) / 6), Math.sin((k * Math.PI) / 6)];
    return [0, 1, 2].map((axis) => center[axis] - cos * way[axis] + sin * scale * across[axis]) as unknown as Place;
  });
  return { center, radius, points };
}

function minus(a: Place, b: Place): Place {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

function dot(a: Place, b: Place): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross(a: Place, b: Place): Place {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}
