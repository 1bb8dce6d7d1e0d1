// SPDX-License-Identifier: Apache-2.0
import { Matrix4, Mesh, Vector3, type BufferGeometry, type InstancedMesh } from "three";
import { describe, expect, it } from "vitest";
import { FIRST_FRAME, NO_BODY, NO_COLOR, type Anchor, type StrutEntity } from "../src/protocol/generated.ts";
import { bodyEntity, id, packRotation, part, visual, TestWorld } from "./test_world.ts";

const origin: Anchor = { body: NO_BODY, point: [0, 0, 0] };
const bar = part("box", [2, 0.1, 0.1, 0]);

/** Volume enclosed by triangles that are counter-clockwise from outside. */
function volume(geometry: BufferGeometry): number {
  const position = geometry.getAttribute("position");
  const index = geometry.getIndex()!;
  const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
  let sum = 0;
  for (let at = 0; at < index.count; at += 3) {
    a.fromBufferAttribute(position, index.getX(at));
    b.fromBufferAttribute(position, index.getX(at + 1));
    c.fromBufferAttribute(position, index.getX(at + 2));
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

describe("a tube", () => {
  it("is closed, of its length and thickness, and seen from outside, whichever way it runs", () => {
    for (const end of [[3, 0, 0], [0, -3, 0], [1, 2, -2]]) {
      const { world } = new TestWorld();
      const { tube } = world.entities;
      tube.create({
        id: id(0), bodies: new Uint32Array(0), points: Float32Array.of(0, 0, 0, ...end.map((x) => x / 2), ...end), radius: 0.1, closed: false,
        material: "rope", color: NO_COLOR,
      });
      tube.draw();
      const [mesh] = tube.root.children as Mesh[];
      // A polygon of twelve sides for a circle.
      expect(volume(mesh.geometry)).toBeCloseTo(3 * 0.01 * 6 * Math.sin(Math.PI / 6), 3);
    }
  });
});

describe("a strut", () => {
  const made = (at: Anchor["point"], to: Anchor["point"]): StrutEntity => ({
    id: id(0), a: { ...origin, point: at }, b: { ...origin, point: to }, part: bar, length: 2,
  });
  const matrixOf = (world: TestWorld["world"]) => {
    const matrix = new Matrix4();
    (world.entities.strut.root.children[0] as InstancedMesh).getMatrixAt(0, matrix);
    return matrix;
  };

  it("reaches from one end to the other, and is not drawn where they are the same", () => {
    const { world } = new TestWorld();
    world.entities.strut.create(made([1, 1, 1], [1, 5, 1]));
    const ends = [-1, 1].map((x) => new Vector3(x, 0, 0).applyMatrix4(matrixOf(world)).toArray().map((value) => Math.round(1e6 * value) / 1e6));
    expect(ends).toEqual([[1, 1, 1], [1, 5, 1]]);
    world.entities.strut.change(made([1, 1, 1], [1, 1, 1]));
    expect(matrixOf(world).determinant()).toBe(0);
  });

  it("does not roll about its line at once, wherever that turns", () => {
    const { world } = new TestWorld();
    const side = new Vector3();
    const before = new Vector3();
    world.entities.strut.create(made([0, 0, 0], [-1, 1e-3, 0]));
    for (let step = 0; step <= 2000; step++) {
      // Through all octants, and straight through -x, where the shortest turn from +x is not unique.
      const t = (2 * Math.PI * step) / 500;
      const to: Anchor["point"] = [Math.cos(t) + 0, Math.sin(t) * Math.cos(0.3 * t), Math.sin(t) * Math.sin(0.3 * t)];
      world.entities.strut.change(made([0, 0, 0], to));
      side.setFromMatrixColumn(matrixOf(world), 1).normalize();
      if (step > 0) expect(side.angleTo(before)).toBeLessThan(0.05);
      before.copy(side);
    }
  });
});

describe("a thing on a frame", () => {
  it("goes with it, and with the body and the frames that it is on", () => {
    const test = new TestWorld();
    test.set("visual", visual(0, "ball", part("sphere", [0.1])));
    test.set("body", bodyEntity(3));
    test.poses([], { farBodies: [{ body: 3, position: [10, 0, 0], rotation: packRotation([0, 0, Math.SQRT1_2, Math.SQRT1_2]) }] });
    const { frame, marker } = test.world.entities;
    frame.create({ id: id(0), at: { body: 3, point: [1, 0, 0] }, rotation: [0, 0, Math.SQRT1_2, Math.SQRT1_2] });
    frame.create({ id: id(1), at: { body: FIRST_FRAME, point: [0, 2, 0] }, rotation: [0, 0, 0, 1] });
    marker.create({ id: id(0), body: FIRST_FRAME + 1, part: { ...bar, offset: [0, 0, 5] } });
    marker.draw();
    const matrix = new Matrix4();
    (marker.root.children[0] as InstancedMesh).getMatrixAt(0, matrix);
    const place = new Vector3().setFromMatrixPosition(matrix).toArray();
    // Body turned by 90 degrees, the frame by another 90: its y points to -y.
    [10, -1, 5].forEach((value, axis) => expect(place[axis]).toBeCloseTo(value, 1));
    frame.destroy(0);
    marker.draw();
    (marker.root.children[0] as InstancedMesh).getMatrixAt(0, matrix);
    expect(matrix.determinant()).toBe(0);
  });
});

describe("the color of a body", () => {
  it("is drawn, changes alone, is under a paint, and ends", () => {
    const test = new TestWorld();
    test.set("visual", visual(0, "bar", bar));
    test.set("body", bodyEntity(0, { color: 0xff0000 }), bodyEntity(1));
    const hue = (slot: number) => {
      test.update();
      const [mesh] = test.meshes();
      const hues = mesh.geometry.getAttribute("hue");
      return [hues.getX(slot), hues.getY(slot), hues.getZ(slot)].map(Math.round);
    };
    expect(hue(0)).toEqual([2, 1, 1]);
    expect(hue(1)).toEqual([0, 0, 0]);
    test.set("body", bodyEntity(1, { color: 0x00ff00 }));
    expect(hue(1)).toEqual([1, 2, 1]);
    test.set("paint", { id: id(0), bodies: Uint32Array.of(1), colors: Uint32Array.of(0x0000ff) });
    expect(hue(1)).toEqual([1, 1, 2]);
    test.destroy("paint", id(0));
    expect(hue(1)).toEqual([1, 2, 1]);
    test.set("body", bodyEntity(0), bodyEntity(1));
    expect([hue(0), hue(1)]).toEqual([[0, 0, 0], [0, 0, 0]]);
  });
});

describe("paint", () => {
  it("stays with its body when others come and go, and ends with it", () => {
    const test = new TestWorld();
    test.set("visual", visual(0, "bar", bar));
    test.set("body", ...[0, 1, 2].map((slot) => bodyEntity(slot)));
    test.set("paint", { id: id(0), bodies: Uint32Array.of(2), colors: Uint32Array.of(0xff0000) });
    const hues = () => {
      const [mesh] = test.meshes();
      const hue = mesh.geometry.getAttribute("hue");
      return Array.from({ length: mesh.count }, (_, index) => Math.round(hue.getX(index)));
    };
    test.update();
    expect(hues()).toEqual([0, 0, 2]);
    test.destroy("body", id(0));
    test.update();
    expect(hues()).toEqual([2, 0]);
    test.set("body", ...Array.from({ length: 40 }, (_, index) => bodyEntity(10 + index)));
    test.update();
    expect(hues().filter((hue) => hue === 2)).toHaveLength(1);
    test.destroy("paint", id(0));
    expect(hues().filter((hue) => hue === 2)).toHaveLength(0);
  });
});
