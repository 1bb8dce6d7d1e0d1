// SPDX-License-Identifier: Apache-2.0
import { Matrix4, Object3D, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import type { Input } from "../src/xr/input.ts";
import { WorldGrab } from "../src/xr/world_grab.ts";

type Place = readonly [number, number, number];

function made(scale: number) {
  const [rig, room] = [new Object3D(), new Object3D()];
  rig.add(room);
  rig.position.set(3, -1, 2).multiplyScalar(scale);
  rig.rotation.y = 0.7;
  room.scale.setScalar(scale);
  rig.updateMatrixWorld();
  const hands = [0, 1].map(() => ({
    pointer: { pressed: true, grab: null as object | null }, tracked: true, hasBody: true, board: null, rayLocal: new Matrix4(),
  }));
  const move = (...places: readonly Place[]) => places.forEach((place, index) => hands[index].rayLocal.setPosition(...place));
  const grab = new WorldGrab(rig, room);
  return { rig, room, hands, move, update: () => grab.update(hands as unknown as Input[], scale), grab };
}

describe("both hands on nothing", () => {
  it("keep the points under them there, at any scale", () => {
    for (const scale of [1e-9, 1, 1e3]) {
      const { rig, room, move, update } = made(scale);
      move([-0.2, 1.2, -0.4], [0.3, 1.1, -0.5]);
      expect(update()).toBe(false);
      const held = [new Vector3(-0.2, 1.2, -0.4), new Vector3(0.3, 1.1, -0.5)].map((place) => place.applyMatrix4(room.matrixWorld));
      // Apart by twice as much, turned by a third of a circle, and elsewhere: a similarity, so that both can stay.
      const turned = [new Vector3(-0.2, 1.2, -0.4), new Vector3(0.3, 1.1, -0.5)].map((place) => place.applyAxisAngle(new Vector3(0, 1, 0), 2.1).multiplyScalar(2).add(new Vector3(0.1, -1, 0.3)));
      move(turned[0].toArray(), turned[1].toArray());
      expect(update()).toBe(true);
      expect(room.scale.x / scale).toBeCloseTo(0.5, 6);
      turned.forEach((place, index) => expect(place.clone().applyMatrix4(room.matrixWorld).distanceTo(held[index]) / scale).toBeLessThan(1e-6));
      expect(rig.rotation.x).toBe(0);
    }
  });

  it("take hold anew after one has let go, and none does while it holds a body", () => {
    const { rig, hands, move, update, grab } = made(1);
    move([-0.2, 1.2, -0.4], [0.3, 1.1, -0.5]);
    update();
    hands[1].pointer.pressed = false;
    expect(update()).toBe(false);
    expect(grab.active).toBe(false);
    const before = rig.position.clone();
    hands[1].pointer.pressed = true;
    move([-0.4, 1.2, -0.4], [0.6, 1.1, -0.5]);
    update();
    expect(rig.position.distanceTo(before)).toBe(0);
    hands[0].pointer.grab = {};
    move([-0.1, 1.2, -0.4], [0.9, 1.1, -0.5]);
    expect(update()).toBe(false);
    expect(rig.position.distanceTo(before)).toBe(0);
  });

  it("do not shrink the user out of the scene", () => {
    const { room, move, update } = made(1);
    move([-0.4, 1, 0], [0.4, 1, 0]);
    update();
    move([-0.02, 1, 0], [0.02, 1, 0]);
    update();
    expect(room.scale.x).toBeCloseTo(20, 6);
    for (let time = 0; time < 5; time++) {
      move([-0.02, 1, 0], [0.02, 1, 0]);
      update();
    }
    expect(room.scale.x).toBeLessThanOrEqual(40);
  });
});
