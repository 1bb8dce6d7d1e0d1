// SPDX-License-Identifier: Apache-2.0
import { BoxGeometry, InstancedBufferAttribute, Matrix4, MeshStandardMaterial, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { InstancePool } from "../src/scene/instance_pool.ts";

function makePool(capacity: number, pieces = 1): InstancePool {
  return new InstancePool(new BoxGeometry(), new MeshStandardMaterial(), capacity, pieces);
}

function place(pool: InstancePool, index: number, x: number): void {
  pool.mesh.setMatrixAt(index, new Matrix4().makeTranslation(x, 0, 0));
}

function placeOf(pool: InstancePool, index: number): number {
  const matrix = new Matrix4();
  pool.mesh.getMatrixAt(index, matrix);
  return new Vector3().setFromMatrixPosition(matrix).x;
}

describe("a pool of instances", () => {
  it("grows in place: the mesh and the geometry stay, and so does what is drawn", () => {
    const pool = makePool(2);
    const { mesh } = pool;
    const { geometry } = mesh;
    for (let slot = 0; slot < 100; slot++) place(pool, pool.add(1000 + slot), slot);
    expect(pool.mesh).toBe(mesh);
    expect(mesh.geometry).toBe(geometry);
    expect([mesh.count, pool.count]).toEqual([100, 100]);
    expect([placeOf(pool, 0), placeOf(pool, 99)]).toEqual([0, 99]);
    expect([pool.members[0], pool.members[99]]).toEqual([1000, 1099]);
  });

  it("puts the last member in the place of a removed one, and says which", () => {
    const pool = makePool(4, 2);
    for (const slot of [7, 8, 9]) {
      const index = pool.add(slot);
      place(pool, 2 * index, slot);
      place(pool, 2 * index + 1, slot + 0.5);
    }
    expect(pool.remove(0)).toBe(9);
    expect([placeOf(pool, 0), placeOf(pool, 1)]).toEqual([9, 9.5]);
    expect(pool.remove(1)).toBe(-1);
    expect([pool.count, pool.mesh.count]).toEqual([1, 2]);
  });

  it("draws nothing of a new member before its matrices are written", () => {
    const pool = makePool(1);
    place(pool, pool.add(0), 5);
    pool.remove(0);
    pool.add(1);
    expect([...pool.matrices.subarray(0, 16)]).toEqual(Array(16).fill(0));
  });

  it("uploads only what is in use, once for each frame", () => {
    const pool = makePool(64, 2);
    pool.add(0);
    pool.upload();
    pool.upload();
    expect(pool.mesh.instanceMatrix.updateRanges).toEqual([{ start: 0, count: 32 }]);
    expect(pool.mesh.instanceMatrix.version).toBe(2);
    const tint = pool.mesh.geometry.getAttribute("tint") as InstancedBufferAttribute;
    expect(tint.version, "without tints").toBe(0);
    pool.uploadTints();
    expect([tint.version, tint.updateRanges]).toEqual([1, [{ start: 0, count: 8 }]]);
  });
});
