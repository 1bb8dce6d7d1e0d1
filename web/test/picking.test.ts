// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { Hit, pickPoint, pickRay } from "../src/interact/picking.ts";
import { BodyKind, NO_BODY, NO_COLOR } from "../src/protocol/generated.ts";
import { TestScene } from "./test_scene.ts";
import { body, bodyEntity, id, part, visual, TestWorld } from "./test_world.ts";

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
    const scene = new TestScene(Array.from({ length: 8 }, () => ({ kind: "capsule", sizes: [0.05, 0.3] })));
    for (let trial = 0; trial < 15; trial++) {
      for (let body = 0; body < 8; body++) {
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
  });
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

describe("a surface over bodies", () => {
  /** Balls of 5 cm at x = 2, 4, 6, 8 and z = 0; the last one is static. */
  const made = () => {
    const told = new TestWorld();
    told.join();
    told.set("visual", visual(0, "ball", part("sphere", [0.05])));
    told.set("body", ...[0, 1, 2].map((slot) => bodyEntity(slot)), bodyEntity(3, { kind: BodyKind.static }));
    told.poses([2, 4, 6, 8].map((x, slot) => body(slot, x)));
    return told.world.entities;
  };
  const down = [0, -1, 0];
  const cloth = { id: id(0), at: { body: NO_BODY, point: [0, 0, 0] as [number, number, number] }, coordinates: new Float32Array(0), material: "paint", color: NO_COLOR };

  it("is taken by a ray and by a hand at the nearest body that can be held", () => {
    const entities = made();
    // A strip from ball to ball, half a meter above them, as wide as a meter.
    const points = [2, 4, 6, 8].flatMap((_, slot) => [[slot, -0.5], [slot, 0.5]]);
    const triangles = [0, 1, 2].flatMap((span) => [2 * span, 2 * span + 1, 2 * span + 2, 2 * span + 1, 2 * span + 3, 2 * span + 2]);
    entities.surface.create({
      ...cloth, bodies: Uint32Array.from(points, ([slot]) => slot), points: Float32Array.from(points.flatMap(([, z]) => [0, 0.5, z])),
      triangles: Uint32Array.from(triangles),
    });
    entities.surface.draw();
    const hit = new Hit();
    for (const [x, slot] of [[2.6, 0], [3.4, 1], [5.2, 2], [7.8, 2]] as const) {
      expect(pickRay(entities.body, [x, 5, 0.2], down, 0.01, 100, hit), `at ${x}`).toBe(true);
      expect([hit.body, hit.localPoint[1]]).toEqual([slot, 0.5]);
      expect(hit.distance).toBeCloseTo(4.5, 3);
      expect(pickPoint(entities.body, [x, 0.58, 0.2], 0.1, hit)).toBe(true);
      expect(hit.body).toBe(slot);
      expect(hit.distance).toBeCloseTo(0.08, 3);
    }
    expect(pickRay(entities.body, [3, 5, 0.7], down, 0.01, 100, hit)).toBe(false);
    expect(pickPoint(entities.body, [3, 0.7, 0.2], 0.1, hit)).toBe(false);
    // From below a ball is nearer than the cloth over it.
    expect(pickRay(entities.body, [4, -5, 0], [0, 1, 0], 0.01, 100, hit)).toBe(true);
    expect(hit.distance).toBeCloseTo(4.95, 3);
  });

  it("is one body's where it is rigid, at the place that was hit", () => {
    const entities = made();
    entities.surface.create({
      ...cloth, at: { body: 1, point: [0, 0.5, 0] }, bodies: new Uint32Array(0), points: Float32Array.of(-1, 0, -1, 1, 0, -1, 0, 0, 2),
      triangles: Uint32Array.of(0, 1, 2),
    });
    entities.surface.draw();
    const hit = new Hit();
    expect(pickRay(entities.body, [4.3, 5, 0.1], down, 0.01, 100, hit)).toBe(true);
    expect(hit.body).toBe(1);
    [0.3, 0.5, 0.1].forEach((value, axis) => expect(hit.localPoint[axis]).toBeCloseTo(value, 2));
    entities.surface.destroy(0);
    expect(pickRay(entities.body, [4.3, 5, 0.1], down, 0.01, 100, hit)).toBe(false);
  });

  it("is a tube as thick as it is drawn, and a little more for a finger", () => {
    const entities = made();
    entities.tube.create({
      id: id(0), bodies: Uint32Array.of(0, 1, 2, 3), points: Float32Array.of(0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0), radius: 0.1, closed: false,
      material: "rope", color: NO_COLOR,
    });
    entities.tube.draw();
    const hit = new Hit();
    for (const [x, slot] of [[2.8, 0], [3.4, 1], [6.9, 2], [7.8, 2]] as const) {
      expect(pickRay(entities.body, [x, 5, 0.09], down, 0, 100, hit), `at ${x}`).toBe(true);
      expect([hit.body, hit.localPoint[1]]).toEqual([slot, 1]);
      expect(pickPoint(entities.body, [x, 1, 0.15], 0.06, hit)).toBe(true);
      expect(hit.body).toBe(slot);
    }
    expect(pickRay(entities.body, [3, 5, 0.14], down, 0, 100, hit)).toBe(false);
    expect(pickRay(entities.body, [3, 5, 0.14], down, 0.02, 100, hit)).toBe(true);
  });
});
