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
  it("are round where there are few, and few triangles where there are many", () => {
    expect(pins(3).triangles / 3).toBeGreaterThan(400);
    for (const count of [3, 100, 101, 500, 501, 2000]) {
      const { drawn, triangles } = pins(count);
      expect(drawn).toBe(count);
      expect(triangles, `of ${count}`).toBeLessThan(75_000);
    }
  });
});
