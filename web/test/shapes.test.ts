// SPDX-License-Identifier: Apache-2.0
// Every shape: the page's distances are the engine's (tests/shapes/samples.json), and the drawn triangles agree with
// them.

import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { parseShape, shapeDistance, shapeReach, makeGeometry } from "../src/scene/shapes/shape.ts";
import { boxOfGeometry } from "../src/scene/points.ts";
import { shapeList } from "../src/scene/shapes/shape_list.ts";
import type { Detail } from "../src/scene/shapes/kind.ts";

interface Sample {
  readonly scale: number;
  readonly kind: string;
  readonly sizes: readonly number[];
  readonly vertices?: readonly number[][];
  readonly triangles?: readonly number[][];
  readonly points: readonly [number, number, number][];
  readonly distances: readonly number[];
}

const root = new URL("../../", import.meta.url);
const samples = JSON.parse(readFileSync(new URL("tests/shapes/samples.json", root), "utf8")) as Sample[];
const listed = JSON.parse(readFileSync(new URL("protocol/shapes.json", root), "utf8")) as { shapes: { name: string; sizes: string[] }[] };

function shapeOf(sample: Sample) {
  return parseShape({ ...sample, vertices: sample.vertices?.flat(), triangles: sample.triangles?.flat() });
}

describe("the list of shapes", () => {
  it("is that of the protocol, with the same sizes in the same order", () => {
    expect(shapeList.map(({ name, sizes }) => ({ name, sizes }))).toEqual(listed.shapes);
  });
});

describe.each(samples.map((sample) => [`${sample.kind} of ${sample.sizes.join(" ")} at ${sample.scale} m`, sample] as const))("a %s", (_, sample) => {
  const shape = shapeOf(sample);

  it("has the distances that the engine has", () => {
    sample.points.forEach((point, index) => {
      // The page keeps the vertices of a mesh as floats.
      const digits = sample.kind === "mesh" ? 6 : 9;
      expect(shapeDistance(shape, ...point) / sample.scale).toBeCloseTo(sample.distances[index] / sample.scale, digits);
    });
  });

  it("holds all of its points within its reach", () => {
    for (const point of sample.points) {
      if (shapeDistance(shape, ...point) <= 0) expect(Math.hypot(...point)).toBeLessThanOrEqual(shapeReach(shape) * (1 + 1e-6));
    }
  });

  it("fills its box, whatever the detail", () => {
    const { low, high } = shape.kind.box(shape);
    if (sample.kind === "half_space") {
      expect(low).toEqual([-Infinity, -Infinity, -Infinity]);
      return;
    }
    for (const point of sample.points) {
      if (shapeDistance(shape, ...point) > 0) continue;
      point.forEach((at, axis) => {
        expect(at).toBeGreaterThanOrEqual(low[axis] - 1e-6 * sample.scale);
        expect(at).toBeLessThanOrEqual(high[axis] + 1e-6 * sample.scale);
      });
    }
    const drawn = boxOfGeometry(makeGeometry(shape, "fine"));
    for (const axis of [0, 1, 2]) {
      expect(Math.abs(drawn.low[axis] - low[axis]) / sample.scale).toBeLessThan(0.04); // a cone's rim has a bevel
      expect(Math.abs(drawn.high[axis] - high[axis]) / sample.scale).toBeLessThan(0.04); // a cone's rim has a bevel
    }
  });

  it.each(["fine", "coarse"] as const)("is drawn where it is, %s", (detail: Detail) => {
    const geometry = makeGeometry(shape, detail);
    const position = geometry.getAttribute("position");
    const normal = geometry.getAttribute("normal");
    const size = sample.kind === "half_space" ? 1000 : sample.scale; // of what is drawn
    const apart: number[] = [];
    for (let index = 0; index < position.count; index++) {
      const at = [position.getX(index), position.getY(index), position.getZ(index)] as const;
      apart.push(Math.abs(shapeDistance(shape, ...at)) / size);
      expect(Math.hypot(normal.getX(index), normal.getY(index), normal.getZ(index))).toBeCloseTo(1, 3);
    }
    expect(position.count).toBeGreaterThan(3);
    expect(Math.max(...apart)).toBeLessThan(0.01); // a bevel, see sweep.ts
    expect(geometry.getAttribute("uv").count).toBe(position.count);
    // Seen from outside, triangles are counter-clockwise: the enclosed volume is positive.
    const index = geometry.getIndex();
    const corner = (k: number) => index?.getX(k) ?? k;
    let volume = 0;
    for (let k = 0; k < (index?.count ?? position.count); k += 3) {
      const [a, b, c] = [corner(k), corner(k + 1), corner(k + 2)];
      const p = [a, b, c].map((v) => [position.getX(v), position.getY(v), position.getZ(v)].map((x) => x / sample.scale));
      volume += (p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) + p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) + p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0])) / 6;
    }
    if (sample.kind !== "half_space") expect(volume).toBeGreaterThan(0.1);
    geometry.dispose();
  });
});
