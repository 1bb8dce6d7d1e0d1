// SPDX-License-Identifier: Apache-2.0
import { Vector3, type BufferGeometry } from "three";
import { describe, expect, it } from "vitest";
import { lay } from "../src/scene/shapes/lay.ts";
import { makeGeometry, parseShape, setLay } from "../src/scene/shapes/shape.ts";
import { shapeList } from "../src/scene/shapes/shape_list.ts";

const mesh = { vertices: [-1, -1, -1, 1, -1, -1, 0, -1, 1, 0, 2, 0], triangles: [0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0] };

function imaged(kind: string): BufferGeometry {
  const sizes = shapeList.find(({ name }) => name === kind)!.sizes.map((name) => ({ radius: 0.5, length: 2, tube: 0.1, size_x: 2, size_y: 1, size_z: 3 })[name] ?? 0);
  return makeGeometry(parseShape({ kind, sizes, material: "paint#image", ...(kind === "mesh" ? mesh : {}) }), "fine");
}

/** Of each triangle that is not thin in the image: how far right and up in the image its corners are, and whether it is mirrored. */
function* pieces(geometry: BufferGeometry): Iterable<{ at: Vector3; normal: Vector3; mirrored: boolean }> {
  const { position, normal, uv } = geometry.attributes;
  const index = geometry.index?.array ?? Array.from({ length: position.count }, (_, corner) => corner);
  for (let first = 0; first < index.length; first += 3) {
    const corners = [index[first], index[first + 1], index[first + 2]];
    const [a, b, c] = corners.map((corner) => new Vector3(uv.getX(corner), uv.getY(corner), 0));
    const turn = b.clone().sub(a).cross(c.clone().sub(a)).z;
    if (Math.abs(turn) < 1e-5) continue;
    yield { at: new Vector3().fromBufferAttribute(position, corners[0]), normal: new Vector3().fromBufferAttribute(normal, corners[0]), mirrored: turn < 0 };
  }
}

describe("an image", () => {
  setLay(lay);

  it.each(["box", "mesh", "sphere", "ellipsoid", "cylinder", "capsule", "cone"])("is nowhere mirrored on a %s, seen from outside", (kind) => {
    const seen = [...pieces(imaged(kind))];
    expect(seen.length).toBeGreaterThan(3);
    expect(seen.filter(({ mirrored }) => mirrored)).toEqual([]);
  });

  it.each(["box", "mesh", "sphere", "cylinder", "cone"])("is within its borders and reaches them on a %s", (kind) => {
    const uv = imaged(kind).getAttribute("uv").array;
    expect(Math.min(...uv)).toBeGreaterThan(-0.02);
    expect(Math.max(...uv)).toBeLessThan(1.02);
    expect(Math.max(...uv)).toBeGreaterThan(0.97);
  });

  it("stands upright on the sides of a box", () => {
    const geometry = imaged("box");
    const { position, normal, uv } = geometry.attributes;
    for (let index = 0; index < position.count; index++) {
      if (Math.abs(normal.getY(index)) > 0.1 || Math.max(Math.abs(normal.getX(index)), Math.abs(normal.getZ(index))) < 0.999) continue;
      expect(uv.getY(index)).toBeCloseTo(position.getY(index) + 0.5, 5);
    }
  });

  it("has its upper edge at +x on a cylinder", () => {
    const { position, uv } = imaged("cylinder").attributes;
    for (let index = 0; index < position.count; index++) expect(uv.getY(index)).toBeCloseTo(position.getX(index) / 2 + 0.5, 5);
  });
});
