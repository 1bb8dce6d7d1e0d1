// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { mixRotation, PoseBuffer, usualLateness } from "../src/scene/pose_buffer.ts";
import { body, frame, packRotation } from "./test_world.ts";

describe("the pose buffer", () => {
  it("draws between frames, one and a half intervals late", () => {
    const buffer = new PoseBuffer();
    for (let step = 0; step < 8; step++) buffer.push(frame(step, [body(0, step)]), 1000 + step * (1000 / 60));
    buffer.sample(1000 + 7 * (1000 / 60), 1 / 60);
    expect(buffer.position[0]).toBeCloseTo(7 - usualLateness, 1);
  });

  it("draws a held body at its newest pose", () => {
    const buffer = new PoseBuffer();
    for (let step = 0; step < 8; step++) {
      buffer.push(frame(step, [body(0, step), body(1, step)]), 1000 + step * (1000 / 60));
      buffer.lateness.goal[1] = 0;
      buffer.sample(1000 + step * (1000 / 60), 1);
    }
    expect(buffer.position[0]).toBeCloseTo(5.5, 1);
    expect(buffer.position[3]).toBeCloseTo(7, 1);
  });

  it("draws a body at its newest pose soon after it was taken, and eases it back", () => {
    const buffer = new PoseBuffer();
    for (let step = 0; step < 8; step++) {
      buffer.push(frame(step, [body(0, step)]), step * (1000 / 60));
      buffer.sample(step * (1000 / 60), 1 / 60);
    }
    const delay = () => buffer.lateness.now[0];
    expect(delay()).toBeCloseTo(usualLateness);
    buffer.lateness.goal[0] = 0;
    for (let picture = 0; picture < 3; picture++) buffer.sample(200, 1 / 60);
    expect(delay()).toBeLessThan(0.1 * usualLateness);
    buffer.lateness.goal[0] = usualLateness;
    for (let picture = 0; picture < 3; picture++) buffer.sample(200, 1 / 60);
    expect(delay()).toBeGreaterThan(0.3 * usualLateness);
    expect(delay()).toBeLessThan(0.6 * usualLateness);
  });

  it("draws all at their newest poses for a film, whenever they came", () => {
    const buffer = new PoseBuffer();
    buffer.exact = true;
    for (let step = 0; step < 5; step++) {
      buffer.push(frame(step, [body(0, step)]), 1000 + step * step * 33);
      buffer.sample(1000 + step * step * 33, 1 / 30);
      expect(buffer.position[0]).toBeCloseTo(step, 3);
    }
  });

  it("keeps poses that a frame does not list", () => {
    const buffer = new PoseBuffer();
    buffer.push(frame(0, [body(0, 1), body(3, 4)]), 0);
    for (let step = 1; step < 12; step++) buffer.push(frame(step, [body(0, 1 + step / 10)]), step * 16);
    buffer.sample(12 * 16, 0.016);
    expect(buffer.position[9]).toBeCloseTo(4, 3);
    expect([...buffer.known.subarray(0, 4)]).toEqual([1, 0, 0, 1]);
  });

  it("starts a new body where it is, not at the origin", () => {
    const buffer = new PoseBuffer();
    for (let step = 0; step < 4; step++) buffer.push(frame(step, [body(0, 1)]), step * 16);
    buffer.push(frame(4, [body(0, 1), body(1, 5)]), 64);
    buffer.sample(64, 0.016);
    expect(buffer.position[3]).toBeCloseTo(5, 3);
  });

  it("never mixes poses of two bodies that had the same slot", () => {
    const buffer = new PoseBuffer();
    for (let step = 0; step < 8; step++) buffer.push(frame(step, [body(0, 1)]), step * 16);
    buffer.forget(0);
    buffer.sample(8 * 16, 0.016);
    expect(buffer.known[0]).toBe(0);
    buffer.push(frame(8, [body(0, 5)]), 8 * 16);
    buffer.sample(8 * 16 + 1, 0.016);
    expect(buffer.position[0]).toBeCloseTo(5, 3);
  });

  it("takes bodies outside the box too, and no absurd slot", () => {
    const buffer = new PoseBuffer();
    const rotation = packRotation([0, 0, 0, 1]);
    buffer.push(frame(0, [body(0, 1)], {
      farBodies: [{ body: 2, position: [1000, 0, 0], rotation }, { body: 4_000_000_000, position: [0, 0, 0], rotation }],
    }), 0);
    buffer.sample(10, 0.016);
    expect(buffer.position[6]).toBeCloseTo(1000, 1);
    expect(buffer.capacity).toBeLessThan(1000);
  });

  it("never runs ahead of the newest frame, nor back", () => {
    const buffer = new PoseBuffer();
    let seed = 3;
    const jitter = () => ((seed = (seed * 16807) % 2147483647) / 2147483647 - 0.5) * 12;
    let before = -1;
    for (let step = 0; step < 120; step++) {
      const now = step * (1000 / 60) + jitter();
      buffer.push(frame(step % 600, [body(0, step / 12)]), now);
      buffer.sample(now + 1, 1 / 60);
      expect(buffer.position[0]).toBeLessThanOrEqual(step / 12 + 1e-3);
      if (step > 10) expect(buffer.position[0]).toBeGreaterThanOrEqual(before - 0.02);
      before = buffer.position[0];
    }
  });

  it("allocates no array once it is large enough", () => {
    const buffer = new PoseBuffer();
    const poses = frame(0, Array.from({ length: 100 }, (_, slot) => body(slot, 1)));
    buffer.push(poses, 0);
    const { position, rotation, known } = buffer;
    for (let step = 1; step < 50; step++) {
      buffer.push(poses, step * 16);
      buffer.sample(step * 16, 0.016);
    }
    expect(buffer.position).toBe(position);
    expect(buffer.rotation).toBe(rotation);
    expect(buffer.known).toBe(known);
  });

  it("decodes rotations to within a third of a degree", () => {
    let seed = 5;
    const random = () => ((seed = (seed * 16807) % 2147483647) / 2147483647) - 0.5;
    for (let trial = 0; trial < 200; trial++) {
      const raw = [random(), random(), random(), random()];
      const norm = Math.hypot(...raw);
      const q = raw.map((value) => value / norm);
      const buffer = new PoseBuffer();
      buffer.push(frame(0, [body(0, 0, q)]), 0);
      buffer.sample(100, 0.016);
      const dot = Math.abs(q.reduce((sum, value, axis) => sum + value * buffer.rotation[axis], 0));
      expect(2 * Math.acos(Math.min(1, dot))).toBeLessThan(0.006);
    }
  });
});

describe("mixing rotations", () => {
  it("goes the shorter way and stays a unit quaternion", () => {
    const a = Float32Array.from([0, 0, 0, 1]);
    const b = Float32Array.from([0, 0, -Math.SQRT1_2, -Math.SQRT1_2]);
    const out = new Float32Array(4);
    mixRotation(a, b, 0, 0.5, out);
    expect(Math.hypot(...out)).toBeCloseTo(1, 6);
    expect(Math.abs(out[2])).toBeCloseTo(Math.sin(Math.PI / 8), 3);
  });
});
