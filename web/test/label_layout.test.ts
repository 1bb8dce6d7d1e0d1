// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { liftApart, mostLifted, upAt, type Plate } from "../src/scene/label_layout.ts";

const [width, height] = [0.2, 0.04];

const plateAt = (x: number, y: number, z = -1): Plate => ({ direction: new Vector3(x, y, z).normalize(), width, height, lift: 0 });

/** Where it is drawn: sideways and up, for an eye that looks along -z. */
function drawn({ direction, lift }: Plate): readonly [number, number] {
  const at = direction.clone().addScaledVector(upAt(direction, new Vector3()), lift);
  return [at.x, at.y];
}

function covered(plates: readonly Plate[]): number {
  let count = 0;
  for (const [index, plate] of plates.entries()) {
    const [x, y] = drawn(plate);
    for (const other of plates.slice(index + 1)) {
      const [otherX, otherY] = drawn(other);
      // A little less than their size, as they are on a sphere.
      if (Math.abs(x - otherX) < 0.95 * width && Math.abs(y - otherY) < 0.9 * height) count++;
    }
  }
  return count;
}

describe("labels of a constant size", () => {
  it("that would cover each other can all be read, and none is far from its place", () => {
    const plates = [plateAt(0, 0), plateAt(0.05, 0.01), plateAt(-0.1, 0.005), plateAt(0.02, 0.03), plateAt(0.02, 0.03)];
    expect(covered(plates)).toBeGreaterThan(3);
    liftApart(plates);
    expect(covered(plates)).toBe(0);
    expect(Math.max(...plates.map(({ lift }) => lift))).toBeLessThan(plates.length * height);
  });

  it("that are apart stay where they are", () => {
    const plates = [plateAt(0, 0), plateAt(0.25, 0), plateAt(0, 0.05), plateAt(0, 0, 1)];
    liftApart(plates);
    expect(plates.map(({ lift }) => lift)).toEqual([0, 0, 0, 0]);
  });

  it("keep their order while they pass each other, and come back when there is room", () => {
    const [resting, moving] = [plateAt(0, 0), plateAt(0, 0.002)];
    const lifts: number[] = [];
    for (const y of [0.002, -0.002, -0.03, -0.06]) {
      moving.direction.set(0, y, -1).normalize();
      liftApart([resting, moving]);
      lifts.push(moving.lift);
    }
    expect(resting.lift).toBe(0);
    expect(lifts.slice(0, 3).every((lift, index) => lift > (index === 0 ? 0 : lifts[index - 1])), String(lifts)).toBe(true);
    expect(lifts[3]).toBe(0);
  });

  it("straight above the eye have a direction up too", () => {
    const plates = [plateAt(0, 1, 0), plateAt(0, 1, 1e-5)];
    liftApart(plates);
    expect(plates.map(({ lift }) => Number.isFinite(lift))).toEqual([true, true]);
  });

  it("are left alone where there are too many to be laid out in each frame", () => {
    const plates = Array.from({ length: mostLifted + 1 }, () => plateAt(0, 0));
    liftApart(plates);
    expect(plates.every(({ lift }) => lift === 0)).toBe(true);
  });
});
