// SPDX-License-Identifier: Apache-2.0
import { BufferAttribute, BufferGeometry, Color, Matrix4, Object3D, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { Hit, pickRay } from "../src/interact/picking.ts";
import { Points } from "../src/scene/points.ts";
import { body, bodyEntity, id, packRotation, part, visual, TestWorld } from "./test_world.ts";

const link = visual(0, "link", part("capsule", [0.05, 0.1]), part("sphere", [0.06], { offset: [0.1, 0, 0] }));

function told(count: number): TestWorld {
  const test = new TestWorld();
  test.join();
  test.set("visual", link);
  test.set("body", ...Array.from({ length: count }, (_, slot) => bodyEntity(slot)));
  test.set("membership", ...Array.from({ length: count }, (_, slot) => ({ id: id(slot), articulate: 0 })));
  test.poses(Array.from({ length: count }, (_, slot) => body(slot, (10 * slot) / count)));
  return test;
}

/** How many geometries and objects three.js made while `act` ran: it numbers them. */
function madeBy(act: () => void): { geometries: number; objects: number } {
  const numbers = () => ({ geometry: new BufferGeometry().id, object: new Object3D().id });
  const [first, second] = [numbers(), numbers()];
  act();
  const last = numbers();
  const between = (key: "geometry" | "object") => (last[key] - second[key]) / (second[key] - first[key]) - 1;
  return { geometries: between("geometry"), objects: between("object") };
}

function placeOf(test: TestWorld, mesh: number, instance: number): Vector3 {
  const matrix = new Matrix4();
  test.meshes()[mesh].getMatrixAt(instance, matrix);
  return new Vector3().setFromMatrixPosition(matrix);
}

describe("bodies", () => {
  it("are drawn with one mesh for each part of a visual, at their places", () => {
    const test = told(3);
    expect(test.meshes().map((mesh) => mesh.count)).toEqual([3, 3]);
    expect(placeOf(test, 0, 1).x).toBeCloseTo(10 / 3, 3);
    expect(placeOf(test, 1, 1).x).toBeCloseTo(10 / 3 + 0.1, 3);
  });

  it("a cut of ten thousand makes no mesh and no geometry", () => {
    expect(madeBy(() => [new BufferGeometry(), new Object3D(), new Object3D()])).toEqual({ geometries: 1, objects: 2 });
    const count = 10_000;
    const test = told(count);
    const made = madeBy(() => {
      test.set("membership", ...Array.from({ length: count / 2 }, (_, slot) => ({ id: id(slot), articulate: 1 })));
      test.destroy("body", id(count / 2));
      test.set("body", bodyEntity(count / 2, { id: id(count / 2, 2), length: 0.05 }), bodyEntity(count, { length: 0.05 }));
      test.poses([body(count / 2, 5), body(count, 5.1)]);
    });
    expect(made).toEqual({ geometries: 0, objects: 0 });
    expect(test.meshes().map((mesh) => mesh.count)).toEqual([count + 1, count + 1]);
  });

  it("send their tints to the GPU only while these change", () => {
    const test = told(3);
    const version = () => (test.meshes()[0].geometry.getAttribute("tint") as BufferAttribute).version;
    expect(version()).toBe(0);
    const red = new Color(1, 0, 0);
    const shown: number[] = [];
    for (let frame = 0; frame < 60; frame++) {
      test.world.entities.body.setTint(1, red, 0.5);
      test.poses([body(1, (frame % 50) / 10)]);
      shown.push(version());
    }
    expect(shown[0]).toBe(1);
    expect(shown[5]).toBe(6);
    const settled = shown.at(-1);
    expect(test.meshes()[0].geometry.getAttribute("tint").getW(1)).toBeCloseTo(0.5, 3);
    for (let frame = 0; frame < 300; frame++) {
      test.world.entities.body.setTint(1, red, 0.5);
      test.poses([body(1, (frame % 50) / 10)]);
    }
    const still = version();
    test.world.entities.body.setTint(1, red, 0.5);
    test.poses([body(1, 3)]);
    expect(version()).toBe(still);
    expect(still).toBeLessThan(settled! + 300);
    test.world.entities.body.clearTints();
    test.poses([body(1, 3)]);
    expect(version()).toBe(still + 1);
  });

  it("that come and go leave the others where they are", () => {
    const test = told(5);
    test.destroy("body", id(1), id(3));
    test.set("body", bodyEntity(0, { length: 0.3 }));
    test.poses([]);
    const drawn = [0, 1, 2].map((instance) => placeOf(test, 0, instance).x).toSorted((a, b) => a - b);
    expect(drawn.map((x) => Math.round(x))).toEqual([0, 4, 8]);
  });

  it("grow where nothing is, and not where they come off another one", () => {
    const test = told(1);
    const size = (instance: number): number => {
      const matrix = new Matrix4();
      test.meshes()[0].getMatrixAt(instance, matrix);
      return new Vector3().setFromMatrixColumn(matrix, 1).length();
    };
    const begun = size(0);
    for (let frame = 0; frame < 12; frame++) test.poses([body(0, 0)]);
    expect(begun).toBeLessThan(0.2 * size(0));
    // The first of these hangs on the second one only.
    test.set("body", bodyEntity(1), bodyEntity(2), bodyEntity(3));
    test.poses([body(0, 0), body(1, 0.1), body(2, 0.05), body(3, 4)]);
    expect(size(1)).toBeCloseTo(size(0), 6);
    expect(size(2)).toBeCloseTo(size(0), 6);
    expect(size(3)).toBeLessThan(0.2 * size(0));
  });

  it("may have any slot", () => {
    const test = told(1);
    const slot = 70_000;
    test.set("body", bodyEntity(slot));
    test.poses([], { farBodies: [{ body: slot, position: [3, 0, -2], rotation: packRotation([0, 0, 0, 1]) }] });
    const { body: bodies } = test.world.entities;
    expect(bodies.has(slot)).toBe(true);
    const hit = new Hit();
    expect(pickRay(bodies, [3, 0, 0], [0, 0, -1], 0.01, 10, hit)).toBe(true);
    expect(hit.body).toBe(slot);
    expect(placeOf(test, 0, 1).toArray()).toEqual([3, 0, -2]);
  });

  it("of another generation take nothing over from the body that had their slot", () => {
    const test = told(2);
    const { body: bodies } = test.world.entities;
    test.set("body", bodyEntity(1, { id: id(1, 2) }));
    expect(test.goneBodies).toEqual([1]);
    test.update();
    expect(bodies.has(1)).toBe(false); // not before its own first pose
    expect(pickRay(bodies, [5, 0, 2], [0, 0, -1], 0.05, 10, new Hit())).toBe(false);
    expect([bodies.slotOf(id(1, 1)), bodies.slotOf(id(1, 2))]).toEqual([-1, 1]);
    test.poses([body(1, 9)]);
    expect(bodies.position[3]).toBeCloseTo(9, 3);
  });

  it("are not destroyed by a late word about their predecessor", () => {
    const test = told(2);
    test.set("body", bodyEntity(1, { id: id(1, 2) }));
    test.destroy("body", id(1, 1));
    expect(test.world.entities.body.slotOf(id(1, 2))).toBe(1);
  });

  it("are drawn anew where a visual changes, and only those", () => {
    const test = told(2);
    test.set("visual", visual(1, "ball", part("sphere", [0.1])));
    test.set("body", bodyEntity(2, { visual: 1 }));
    const [, , ball] = test.meshes();
    test.set("visual", { ...link, parts: [part("box", [0.1, 0.1, 0.1, 0])] });
    expect(test.meshes().map((mesh) => mesh.count)).toEqual([1, 2]);
    expect(test.meshes()[0]).toBe(ball);
  });

  it("have the script's name, else that of their class, and another name moves nothing", () => {
    const test = told(2);
    const { body: bodies } = test.world.entities;
    expect([0, 1, 2].map((slot) => bodies.nameOf(slot))).toEqual(["link", "link", ""]);
    const places = test.meshes()[0].instanceMatrix;
    const members = [...test.meshes()].map((mesh) => mesh.count);
    const made = madeBy(() => test.set("body", bodyEntity(1, { name: "left arm" })));
    expect([0, 1].map((slot) => bodies.nameOf(slot))).toEqual(["link", "left arm"]);
    expect([0, 1].map((slot) => bodies.ownNameOf(slot))).toEqual(["", "left arm"]);
    expect(bodies.renamed).toBe(1);
    expect(made).toEqual({ geometries: 0, objects: 0 });
    expect(test.meshes()[0].instanceMatrix).toBe(places);
    expect(test.meshes().map((mesh) => mesh.count)).toEqual(members);
    test.set("body", bodyEntity(1, { name: "left arm" }), bodyEntity(0, { length: 0.3 }));
    expect(bodies.renamed).toBe(1);
  });

  it("have the same corners for the first view in any detail", () => {
    const test = told(1);
    const { body: view } = test.world.entities;
    const corners = (away: number) => {
      view.eye.set(away, 0, 0);
      for (let frame = 0; frame < 10; frame++) {
        view.update(0.016, frame * 16);
        view.draw(0.016);
      }
      const points = new Points();
      view.addCorners(points, 0);
      return { vertices: test.meshes()[0].geometry.getAttribute("position").count, places: points.xyz.slice(0, 3 * points.count) };
    };
    const [near, far] = [corners(0.5), corners(1000)];
    expect(near.vertices).toBeGreaterThan(far.vertices);
    expect(near.places).toEqual(far.places);
    expect(Math.max(...near.places)).toBeCloseTo(0.16, 3);
  });

  it("wait for a visual that comes after them", () => {
    const test = told(1);
    test.set("body", bodyEntity(4, { visual: 8 }));
    test.poses([body(4, 2)]);
    expect(test.world.entities.body.has(4)).toBe(false);
    test.set("visual", visual(8, "late", part("sphere", [0.1])));
    expect(test.world.entities.body.has(4)).toBe(true);
  });
});

describe("thousands of bodies", () => {
  it("have few triangles each, however near they are", () => {
    const trianglesOf = (count: number) => {
      const test = told(count);
      const view = test.world.entities.body;
      for (let frame = 0; frame < 20; frame++) {
        view.update(0.016, frame * 16);
        view.draw(0.016);
      }
      return test.meshes().reduce((sum, { geometry }) => sum + geometry.index!.count / 3, 0);
    };
    const few = trianglesOf(10);
    expect(few).toBeGreaterThan(300);
    expect(2000 * trianglesOf(2000)).toBeLessThan(250_000);
  });
});
