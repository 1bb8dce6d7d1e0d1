// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { boxOf, makeItem, settingOf, withoutFar, type Item } from "../src/page/subject.ts";
import { circleThrough } from "../src/page/ways.ts";
import { Points } from "../src/scene/points.ts";

type Place = readonly [number, number, number];

/** A box with a center and sizes. */
function box(slot: number, [x, y, z]: Place, [a, b, c]: Place, moves = true): Item {
  const points = new Points();
  points.add(x - a / 2, y - b / 2, z - c / 2);
  points.add(x + a / 2, y + b / 2, z + c / 2);
  return makeItem(points, 0, slot, moves)!;
}

const slots = (items: readonly Item[]) => items.map(({ slot }) => slot).sort((a, b) => a - b);

describe("the subject of a view", () => {
  it("is without one thing that has gone far from the others, and with one that is only a little farther", () => {
    const stack = [0, 1, 2].map((k) => box(k, [k, 0, 0], [1, 1, 1]));
    expect(slots(withoutFar([...stack, box(3, [90, 0, 0], [1, 1, 1])]))).toEqual([0, 1, 2]);
    expect(slots(withoutFar([...stack, box(3, [6, 0, 0], [1, 1, 1])]))).toEqual([0, 1, 2, 3]);
  });

  it("is without a tenth of many things, and with all of two or of planets around a sun", () => {
    const many = [...Array(40).keys()].map((k) => box(k, [k % 7, 0, k / 7], [1, 1, 1]));
    const gone = [40, 41, 42].map((k) => box(k, [500 + k, 0, 9 * k], [1, 1, 1]));
    expect(withoutFar([...many, ...gone])).toHaveLength(40);
    expect(withoutFar([many[0], gone[0]])).toHaveLength(2);
    expect(withoutFar([0, 0.39, 0.72, 1, 1.52, 5.2, 9.5, 19, 30].map((far, k) => box(k, [far, 0, 0], [0.1, 0.1, 0.1])))).toHaveLength(9);
  });

  it("has the pedestal of a small knob and what is beside it, but neither a wide floor nor the walls of a room", () => {
    const knob = [box(0, [0, 1.02, 0], [0.06, 0.03, 0.06])];
    const pedestal = box(1, [0, 0.5, 0], [0.3, 1, 0.3], false);
    const lamp = box(2, [0.5, 1.1, 0], [0.1, 0.1, 0.1], false);
    const floor = box(3, [0, -0.05, 0], [2, 0.1, 2], false);
    expect(slots(settingOf(knob, [pedestal, lamp, floor], true))).toEqual([1, 2]);
    expect(slots(settingOf(knob, [pedestal, lamp, floor], false))).toEqual([]);
    const crate = [box(0, [0, 0.5, 0], [1, 1, 1])];
    const walls = [[3, 0], [-3, 0], [0, 3], [0, -3]].map(([x, z], k) => box(k + 1, [x, 1.5, z], [x === 0 ? 6 : 0.1, 3, z === 0 ? 6 : 0.1], false));
    expect(settingOf(crate, walls, true)).toHaveLength(0);
    expect(settingOf(crate, walls.slice(0, 2), true)).toHaveLength(2);
    expect(settingOf(crate, [box(1, [0, 1.5, 0], [6, 3, 6], false)], true), "a room of one piece").toHaveLength(0);
  });

  it("has a box around all of it", () => {
    const { low, high, center } = boxOf([box(0, [0, 0, 0], [2, 2, 2]), box(1, [4, 1, 0], [2, 2, 2])]);
    expect([low, high, center]).toEqual([[-1, -1, -1], [5, 2, 1], [2, 0.5, 0]]);
  });
});

describe("the circle through three places", () => {
  it("has each of them at its radius", () => {
    const places: Place[] = [0.3, 0.8, 1.9].map((angle) => [5 + 2 * Math.cos(angle), 1, 2 * Math.sin(angle)]);
    const circle = circleThrough(places[0], places[1], places[2])!;
    expect(circle.radius).toBeCloseTo(2, 9);
    circle.center.forEach((value, axis) => expect(value).toBeCloseTo([5, 1, 0][axis], 9));
    for (const point of circle.points) expect(Math.hypot(point[0] - 5, point[1] - 1, point[2])).toBeCloseTo(2, 9);
  });

  it("is none for places on a line", () => {
    expect(circleThrough([0, 0, 0], [1, 1, 0], [3, 3, 0])).toBeNull();
  });
});
