// SPDX-License-Identifier: Apache-2.0
import { BoxGeometry, Mesh, SphereGeometry, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { Walls } from "../src/scene/walls.ts";

/** A room of 4 x 3 x 6 m about the origin, times `size`, of walls of 5 cm, turned; with a ball in the middle. */
function room(size: number): { walls: Walls; turned: (x: number, y: number, z: number) => Vector3 } {
  const turn = new Vector3(0, 1, 0);
  const turned = (x: number, y: number, z: number) => new Vector3(x, y, z).multiplyScalar(size).applyAxisAngle(turn, 0.6);
  const wall = (sizes: readonly [number, number, number], x: number, y: number, z: number) => {
    const mesh = new Mesh(new BoxGeometry(...(sizes.map((value) => size * value) as [number, number, number])));
    mesh.position.copy(turned(x, y, z));
    mesh.quaternion.setFromAxisAngle(turn, 0.6);
    return mesh;
  };
  const meshes = [
    ...[-1, 1].map((side) => wall([0.05, 3, 6], 2 * side, 0, 0)), ...[-1, 1].map((side) => wall([4, 0.05, 6], 0, 1.5 * side, 0)),
    ...[-1, 1].map((side) => wall([4, 3, 0.05], 0, 0, 3 * side)), new Mesh(new SphereGeometry(0.5 * size, 64, 48)),
  ];
  return { walls: new Walls(() => meshes), turned };
}

describe("walls", () => {
  it.each([1e-9, 1, 1e3])("let nobody out of a room of 4 x 3 x 6 times %s m, wherever and however fast they go", (size) => {
    const { walls, turned } = room(size);
    const radius = 0.2 * size;
    let seed = 7;
    const random = () => ((seed = (seed * 16807) % 2147483647) / 2147483647) - 0.5;
    const at = turned(1.2, 0, 1);
    for (let step = 0; step < 400; step++) {
      const way = turned(6 * random(), 6 * random(), 6 * random());
      walls.slide(at, way, radius);
      at.add(way);
      const inside = at.clone().divideScalar(size).applyAxisAngle(new Vector3(0, 1, 0), -0.6);
      expect(Math.abs(inside.x)).toBeLessThan(1.975 - 0.19);
      expect(Math.abs(inside.y)).toBeLessThan(1.475 - 0.19);
      expect(Math.abs(inside.z)).toBeLessThan(2.975 - 0.19);
      expect(inside.length()).toBeGreaterThan(0.5 + 0.18);
    }
  });

  it("are slid along, and stop nobody in the open", () => {
    const { walls, turned } = room(1);
    const at = turned(1.5, 0, 0);
    const way = turned(0.6, 0, 0.8);
    walls.slide(at, way, 0.2);
    const moved = way.applyAxisAngle(new Vector3(0, 1, 0), -0.6);
    expect(moved.x).toBeCloseTo(1.975 - 0.2 - 1.5, 2);
    expect(moved.z).toBeCloseTo(0.8, 1);
    const free = turned(0, 0, 0.7);
    walls.slide(turned(1.2, 0, 0), free, 0.2);
    expect(free.distanceTo(turned(0, 0, 0.7))).toBeLessThan(1e-12);
  });
});
