// SPDX-License-Identifier: Apache-2.0
import { BoxGeometry, Group, Mesh, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { Walls } from "../src/scene/walls.ts";
import type { Input } from "../src/xr/input.ts";
import { Locomotion } from "../src/xr/locomotion.ts";

function block(size: readonly [number, number, number], at: readonly [number, number, number]): Mesh {
  const mesh = new Mesh(new BoxGeometry(...size));
  mesh.position.set(...at);
  return mesh;
}

/** Aims from 1.4 m above the ground along +x; where that lands, if it does. */
function aim(...meshes: readonly Mesh[]): { valid: boolean; landing: number[] } {
  const locomotion = new Locomotion(new Group(), new Group());
  locomotion.walls = new Walls(() => meshes, () => [], () => 0);
  const pointer = { origin: new Float32Array([0, 1.4, 0]), direction: new Float32Array([1, 0, 0]) };
  locomotion.aiming = { tracked: true, pointer } as unknown as Input;
  locomotion.draw(0, 0);
  return { valid: locomotion.arc.valid, landing: [...locomotion.arc.landing] };
}

// A throw at 7 m/s falls 1.4 m in 0.534 s: it lands 3.74 m away.
const free = 7 * Math.sqrt((2 * 1.4) / 9.81);

describe("a teleport", () => {
  it("lands on the ground in the open", () => {
    const { valid, landing } = aim(block([1, 1, 1], [2, 0.5, 5]));
    expect(valid).toBe(true);
    expect(landing[0]).toBeCloseTo(free, 3);
  });

  it("does not go through a wall", () => {
    const { valid, landing } = aim(block([0.1, 3, 4], [2, 1.5, 0]));
    expect(valid).toBe(false);
    expect(landing[0]).toBeCloseTo(1.95, 2);
  });

  it("lands on a platform", () => {
    const { valid, landing } = aim(block([4, 0.5, 4], [4, 0.25, 0]));
    expect(valid).toBe(true);
    expect(landing[1]).toBeCloseTo(0.5, 3);
    expect(landing[0]).toBeCloseTo(7 * Math.sqrt((2 * 0.9) / 9.81), 1);
  });

  it("does not land on a steep roof", () => {
    const roof = block([4, 0.1, 4], [4, 1, 0]);
    roof.quaternion.setFromAxisAngle(new Vector3(0, 0, 1), Math.PI / 4);
    expect(aim(roof).valid).toBe(false);
  });
});
