// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { Arc, arcPoints, farthestLanding, throwArc } from "../src/xr/arc.ts";

const level = [0, 0, -1];

describe("the arc of a teleport", () => {
  it("lands on the floor where a thrown stone would", () => {
    const arc = new Arc();
    throwArc([1, 1.2, 2], level, 0, arc);
    expect(arc.valid).toBe(true);
    const seconds = Math.sqrt((2 * 1.2) / 9.81);
    expect([...arc.landing]).toEqual([expect.closeTo(1, 6), 0, expect.closeTo(2 - 7 * seconds, 5)]);
  });

  it("starts at the hand, ends at the landing and never goes below the floor", () => {
    const arc = new Arc();
    throwArc([0.3, 1.4, 0], [0.6, 0.5, -Math.sqrt(1 - 0.61)], 0.25, arc);
    const point = (index: number) => [...arc.points.subarray(3 * index, 3 * index + 3)];
    expect(point(0)).toEqual([expect.closeTo(0.3, 6), expect.closeTo(1.4, 6), 0]);
    expect(point(arcPoints - 1).map((value, axis) => Math.abs(value - arc.landing[axis]))).toSatisfy((off: number[]) => off.every((value) => value < 1e-5));
    for (let index = 0; index < arcPoints; index++) expect(point(index)[1]).toBeGreaterThan(0.25 - 1e-5);
  });

  it("comes down at the user's feet when thrown straight up, and nowhere from below the floor", () => {
    const arc = new Arc();
    throwArc([1, 1.5, 1], [0, 1, 0], 0, arc);
    expect(arc.valid).toBe(true);
    expect(arc.landing[0]).toBe(1);
    throwArc([0, -0.1, 0], level, 0, arc);
    expect(arc.valid).toBe(false);
  });

  it("refuses places that are too far away", () => {
    const arc = new Arc();
    throwArc([0, 30, 0], level, 0, arc);
    expect(Math.abs(arc.landing[2])).toBeGreaterThan(farthestLanding);
    expect(arc.valid).toBe(false);
  });
});
