// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { Hit, pickPoint, pickRay } from "../src/interact/picking.ts";
import { TestScene } from "./test_scene.ts";

const forward = [0, 0, -1];

describe("picking with a ray", () => {
  it("finds the nearer of two bodies, with point and place in its frame", () => {
    const scene = new TestScene([{ kind: "sphere", sizes: [0.1] }, { kind: "sphere", sizes: [0.1] }]);
    scene.place(0, [0, 0, -3]);
    scene.place(1, [0, 0, -2], [0, Math.SQRT1_2, 0, Math.SQRT1_2]);
    const hit = new Hit();
    expect(pickRay(scene, [0, 0, 0], forward, 0, 100, hit)).toBe(true);
    expect(hit.body).toBe(1);
    expect(hit.distance).toBeCloseTo(1.9, 3);
    expect(hit.point[2]).toBeCloseTo(-1.9, 3);
    // A quarter turn about y takes the body's -x to the world's +z.
    expect(hit.localPoint[0]).toBeCloseTo(-0.1, 3);
    expect(hit.localPoint[2]).toBeCloseTo(0, 3);
  });

  it("goes through the hole of a ring, unless the tolerance is as wide", () => {
    const scene = new TestScene([{ kind: "torus", sizes: [0.1, 0.01] }]);
    scene.place(0, [0, 0, -1]);
    const hit = new Hit();
    expect(pickRay(scene, [0, 0, 0], forward, 0.01, 100, hit)).toBe(false);
    expect(pickRay(scene, [0, 0, 0], forward, 0.12, 100, hit)).toBe(true);
    expect(Math.hypot(hit.localPoint[0], hit.localPoint[1])).toBeLessThan(0.111);
  });

  it("prefers a true hit behind to a near miss before it", () => {
    const scene = new TestScene([{ kind: "sphere", sizes: [0.1] }, { kind: "sphere", sizes: [0.1] }]);
    scene.place(0, [0.12, 0, -1]);
    scene.place(1, [0, 0, -3]);
    const hit = new Hit();
    expect(pickRay(scene, [0, 0, 0], forward, 0.05, 100, hit)).toBe(true);
    expect(hit.body).toBe(1);
  });

  it("catches a thin rod with a finger's tolerance and takes hold on its surface", () => {
    const scene = new TestScene([{ kind: "capsule", sizes: [0.002, 0.2] }]);
    scene.place(0, [0, 0.02, -2]);
    const hit = new Hit();
    expect(pickRay(scene, [0, 0, 0], forward, 0.004, 100, hit)).toBe(false);
    expect(pickRay(scene, [0, 0, 0], forward, 0.02, 100, hit)).toBe(true);
    expect(Math.hypot(hit.localPoint[1], hit.localPoint[2])).toBeCloseTo(0.002, 4);
  });

  it("finds nothing behind the eye or beyond the farthest distance", () => {
    const scene = new TestScene([{ kind: "sphere", sizes: [0.1] }]);
    scene.place(0, [0, 0, 2]);
    expect(pickRay(scene, [0, 0, 0], forward, 0.01, 100, new Hit())).toBe(false);
    scene.place(0, [0, 0, -20]);
    expect(pickRay(scene, [0, 0, 0], forward, 0, 10, new Hit())).toBe(false);
  });

  it("agrees with a fine brute-force march for random bodies and rays", () => {
    let seed = 11;
    const random = () => ((seed = (seed * 16807) % 2147483647) / 2147483647) - 0.5;
    const scene = new TestScene(Array.from({ length: 12 }, () => ({ kind: "capsule", sizes: [0.05, 0.3] })));
    for (let trial = 0; trial < 60; trial++) {
      for (let body = 0; body < 12; body++) {
        const q = [random(), random(), random(), random()];
        const norm = Math.hypot(...q);
        scene.place(body, [2 * random(), 2 * random(), -2 + 2 * random()], q.map((value) => value / norm));
      }
      const d = [0.5 * random(), 0.5 * random(), -1];
      const norm = Math.hypot(...d);
      const direction = d.map((value) => value / norm);
      const slow = scene.slowPick(direction, 6);
      const hit = new Hit();
      const found = pickRay(scene, [0, 0, 0], direction, 0, 6, hit);
      expect(found ? hit.body : -1).toBe(slow);
    }
  }, 120_000);
});

describe("picking with a hand", () => {
  it("finds the nearest surface within reach and puts the hold onto it", () => {
    const scene = new TestScene([{ kind: "sphere", sizes: [0.1] }, { kind: "box", sizes: [0.1, 0.1, 0.1] }]);
    scene.place(0, [0.3, 0, 0]);
    scene.place(1, [-0.1, 0, 0]);
    const hit = new Hit();
    expect(pickPoint(scene, [0, 0, 0], 0.04, hit)).toBe(false);
    expect(pickPoint(scene, [0, 0, 0], 0.06, hit)).toBe(true);
    expect(hit.body).toBe(1);
    expect(hit.localPoint[0]).toBeCloseTo(0.05, 3);
  });
});
