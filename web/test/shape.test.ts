// SPDX-License-Identifier: Apache-2.0
import { Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { bodyDistance, bodyReach, makeGeometry, parseShape, placeShape, shapeDistance, shapeReach } from "../src/scene/shapes/shape.ts";

/** A box as a closed mesh: corners by the bits of their numbers. */
function boxMesh(x: number, y: number, z: number): { vertices: number[]; triangles: number[] } {
  const vertices = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((i) => [(i & 1 ? x : -x) / 2, (i & 2 ? y : -y) / 2, (i & 4 ? z : -z) / 2]);
  const faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
  return { vertices, triangles: faces.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]) };
}

const shapes = [
  parseShape({ kind: "sphere", sizes: [0.3] }),
  parseShape({ kind: "capsule", sizes: [0.1, 0.5] }),
  parseShape({ kind: "cylinder", sizes: [0.1, 0.5] }),
  parseShape({ kind: "torus", sizes: [0.2, 0.05, 0.3] }),
  parseShape({ kind: "box", sizes: [0.2, 0.3, 0.4] }),
  parseShape({ kind: "mesh", ...boxMesh(0.2, 0.3, 0.4) }),
];

describe("a shape of the scene description", () => {
  it("takes defaults for sizes that are left out", () => {
    const shape = parseShape({ kind: "capsule", sizes: [0.01, 0.1] });
    expect(shape).toMatchObject({ material: "paint", color: null, turn: 0, offset: [0, 0, 0], rotation: [0, 0, 0, 1] });
  });

  it.each([
    [null, /object/], [{ kind: "blob" }, /unknown shape "blob"/], [{ kind: "sphere", sizes: [1, 2] }, /sizes must be at most 1 numbers/],
    [{ kind: "sphere", sizes: ["1"] }, /sizes\[0\] must be a finite number/], [{ kind: "box", sizes: 3 }, /sizes must be at most 4 numbers/],
    [{ kind: "sphere", sizes: [1], rotation: [0, 0, 0, 0] }, /rotation must not be zero/],
    [{ kind: "mesh", vertices: [0, 0], triangles: [] }, /vertices of a mesh must be a list of numbers in threes/],
    [{ kind: "mesh", vertices: [0, 0, 0], triangles: [0, 0, 7] }, /names vertex 7, but there are 1/],
    [{ kind: "mesh", vertices: [0, 0, 0], triangles: Array(3 * 50_001).fill(0) }, /may have 50000 triangles/],
  ])("is refused with the name of the wrong field: %j", (json, reason) => {
    expect(() => parseShape(json)).toThrow(reason);
  });
});

describe("the distance function", () => {
  it("is zero on the surface, negative inside, positive outside", () => {
    expect(shapeDistance(shapes[0], 0.3, 0, 0)).toBeCloseTo(0, 9);
    expect(shapeDistance(shapes[1], 0.35, 0, 0)).toBeCloseTo(0, 9);
    expect(shapeDistance(shapes[2], 0.25, 0.05, 0)).toBeCloseTo(0, 9);
    expect(shapeDistance(shapes[2], 0.35, 0.1, 0)).toBeCloseTo(0.1, 9);
    expect(shapeDistance(shapes[3], 0.4, 0, 0)).toBeCloseTo(0, 9);
    expect(shapeDistance(shapes[3], 0, 0, 0)).toBeCloseTo(0.15, 9);
    expect(shapeDistance(shapes[4], 0, 0, 0)).toBeCloseTo(-0.1, 9);
  });

  it("of a mesh is that of the solid it encloses", () => {
    for (const [x, y, z] of [[0, 0, 0], [0.05, -0.1, 0.12], [0.3, 0, 0], [0.3, 0.3, 0.3], [0, 0.15, 0.5], [0.1, 0.1, 0]]) {
      expect(shapeDistance(shapes[5], x, y, z)).toBeCloseTo(shapeDistance(shapes[4], x, y, z), 6);
    }
    expect(shapeReach(shapes[5])).toBeCloseTo(shapeReach(shapes[4]), 6);
  });

  it("never grows faster than the way walked, so that marching along a ray cannot jump through", () => {
    let seed = 7;
    const random = () => ((seed = (seed * 16807) % 2147483647) / 2147483647) - 0.5;
    for (const shape of shapes) {
      for (let trial = 0; trial < 500; trial++) {
        const a = [random(), random(), random()] as const;
        const b = [a[0] + 0.1 * random(), a[1] + 0.1 * random(), a[2] + 0.1 * random()] as const;
        const way = Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
        expect(Math.abs(shapeDistance(shape, ...a) - shapeDistance(shape, ...b))).toBeLessThanOrEqual(way + 1e-12);
        if (shapeDistance(shape, ...a) < 0) expect(Math.hypot(...a)).toBeLessThanOrEqual(shapeReach(shape) + 1e-12);
      }
    }
  });
});

describe("a shape on a body", () => {
  it("is turned about x on odd bodies only", () => {
    const link = parseShape({ kind: "torus", sizes: [0.05, 0.01], turn: Math.PI / 2 });
    const even = [placeShape(link, false, null)];
    const odd = [placeShape(link, true, null)];
    expect(bodyDistance(even, 0, 0.05, 0)).toBeCloseTo(-0.01, 9);
    expect(bodyDistance(odd, 0, 0.05, 0)).toBeGreaterThan(0.03);
    expect(bodyDistance(odd, 0, 0, 0.05)).toBeCloseTo(-0.01, 9);
  });

  it("takes the body's length for rods, not for links", () => {
    const rod = parseShape({ kind: "capsule", sizes: [0.01, 0.1] });
    const link = parseShape({ kind: "torus", sizes: [0.05, 0.01] });
    expect(placeShape(rod, false, 0.3).shape.sizes).toEqual([0.01, 0.3]);
    expect(placeShape(link, false, 0.3).shape).toBe(link);
  });

  it("reaches as far as its offset and size", () => {
    const ball = parseShape({ kind: "sphere", sizes: [0.1], offset: [0, 0.2, 0] });
    expect(bodyReach([placeShape(ball, false, null)])).toBeCloseTo(0.3, 9);
  });
});

describe("the triangles of a box", () => {
  const box = parseShape({ kind: "box", sizes: [0.2, 0.3, 0.4, 0.02] });

  it.each([["tiny", 12], ["coarse", 44]] as const)("that is %s on the screen are %i, closed and seen from outside", (detail, count) => {
    const geometry = makeGeometry(box, detail);
    const [index, position] = [geometry.index!, geometry.getAttribute("position")];
    expect(index.count / 3).toBe(count);
    expect(position.count).toBe(24);
    let volume = 0;
    const open = new Set<string>();
    for (let corner = 0; corner < index.count; corner += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => new Vector3().fromBufferAttribute(position, index.getX(corner + k)));
      volume += a.dot(b.clone().cross(c)) / 6;
      const names = [a, b, c].map((place) => place.toArray().map((value) => value.toFixed(6)).join());
      for (const [from, to] of [[0, 1], [1, 2], [2, 0]]) {
        if (!open.delete(`${names[to]} ${names[from]}`)) open.add(`${names[from]} ${names[to]}`);
      }
    }
    expect(open.size).toBe(0);
    expect(volume).toBeGreaterThan(0.97 * 0.2 * 0.3 * 0.4);
    expect(volume).toBeLessThan(1.001 * 0.2 * 0.3 * 0.4);
  });

  it("keep a rounding that is part of its form, however small the box is on the screen", () => {
    const count = (rounding: number) => makeGeometry(parseShape({ kind: "box", sizes: [0.2, 0.3, 0.4, rounding] }), "tiny").index!.count / 3;
    expect([count(0.01), count(0.06)]).toEqual([12, 44]);
  });
});
