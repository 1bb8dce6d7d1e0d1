// SPDX-License-Identifier: Apache-2.0
import { InstancedMesh, type Object3D } from "three";
import { describe, expect, it } from "vitest";
import { NO_BODY } from "../src/protocol/generated.ts";
import { id, TestWorld } from "./test_world.ts";

function pins(count: number): { readonly drawn: number; readonly triangles: number } {
  const test = new TestWorld();
  test.join();
  test.set("nail", ...Array.from({ length: count }, (_, slot) => ({ id: id(slot), at: { body: NO_BODY, point: [slot, 0, 0] as [number, number, number] } })));
  const { nail } = test.world.entities;
  nail.draw();
  const meshes: InstancedMesh[] = [];
  nail.root.traverse((object: Object3D) => void (object instanceof InstancedMesh && meshes.push(object)));
  const [{ count: drawn, geometry }] = meshes;
  return { drawn, triangles: (drawn * geometry.index!.count) / 3 };
}

describe("pins at nails", () => {
  it("are written again only when one has changed, or is on something that can move", () => {
    const test = new TestWorld();
    test.join();
    const at = (slot: number, x: number, on = NO_BODY) => ({ id: id(slot), at: { body: on, point: [x, 0, 0] as [number, number, number] } });
    const { nail } = test.world.entities;
    const written = (): number => {
      nail.draw();
      const meshes: InstancedMesh[] = [];
      nail.root.traverse((object: Object3D) => void (object instanceof InstancedMesh && meshes.push(object)));
      return meshes[0].instanceMatrix.version;
    };
    test.set("nail", at(0, 1), at(1, 2));
    expect([written(), written()]).toEqual([1, 1]);
    test.set("nail", at(1, 3));
    expect([written(), written()]).toEqual([2, 2]);
    nail.pinRadius *= 2;
    expect([written(), written()]).toEqual([3, 3]);
    test.destroy("nail", id(0));
    expect([written(), written()]).toEqual([4, 4]);
    test.set("nail", at(2, 0, 5));
    expect([written(), written(), written()]).toEqual([5, 6, 7]);
    test.destroy("nail", id(2));
    expect([written(), written()]).toEqual([8, 8]);
  });

  it("are round where there are few, and few triangles where there are many", () => {
    expect(pins(3).triangles / 3).toBeGreaterThan(400);
    for (const count of [3, 100, 101, 500, 501, 2000]) {
      const { drawn, triangles } = pins(count);
      expect(drawn).toBe(count);
      expect(triangles, `of ${count}`).toBeLessThan(75_000);
    }
  });
});
