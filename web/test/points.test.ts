// SPDX-License-Identifier: Apache-2.0
import { Quaternion, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { Points } from "../src/scene/points.ts";

describe("sample points of a scene", () => {
  it("turn places first and then move them", () => {
    const points = new Points();
    // A quarter turn about z takes x to y.
    points.addSample([1, 0, 0], new Vector3(10, 0, 0), new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), Math.PI / 2));
    expect(points.count).toBe(1);
    [10, 1, 0].forEach((value, axis) => expect(points.xyz[axis]).toBeCloseTo(value, 12));
  });

  it("are few for many places, and span about their extent", () => {
    const points = new Points();
    const places = Array.from({ length: 30_000 }, (_, index) => (index % 3 === 0 ? index / 30_000 : 0));
    points.addSample(places);
    expect(points.count).toBeLessThanOrEqual(400);
    expect(points.bounds()!.radius).toBeGreaterThan(0.49);
  });

  it("leave out places that are not finite", () => {
    const points = new Points();
    points.addSample([0, 0, 0, Number.NaN, 0, 0, 1, 1, 1]);
    expect(points.count).toBe(2);
  });
});
