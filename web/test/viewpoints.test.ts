// SPDX-License-Identifier: Apache-2.0
import { PerspectiveCamera } from "three";
import { describe, expect, it, vi } from "vitest";
import { GamepadInput } from "../src/interact/gamepad.ts";
import { Navigation } from "../src/navigate/navigation.ts";
import type { Viewer } from "../src/page/viewer.ts";
import { Viewpoints } from "../src/page/viewpoints.ts";
import { NO_BODY, type Anchor } from "../src/protocol/generated.ts";
import { bodyEntity, id, packRotation, part, visual, TestWorld } from "./test_world.ts";

function make() {
  const test = new TestWorld();
  const camera = new PerspectiveCamera(42, 1.6);
  const navigation = new Navigation(camera);
  navigation.setScene([0, 1, 0], 10);
  const viewer = { presenting: false, invalidate: () => {} } as unknown as Viewer;
  const viewpoints = new Viewpoints(test.world, navigation, viewer);
  const frames = (count: number) => {
    for (let frame = 0; frame < count; frame++) {
      viewpoints.update();
      navigation.update(1 / 60);
    }
  };
  const carry = (x: number) => {
    for (let frame = 0; frame < 8; frame++) test.poses([], { farBodies: [{ body: 2, position: [x, 1, 0], rotation: packRotation([0, 0, 0, 1]) }] });
  };
  test.set("visual", visual(0, "ball", part("sphere", [0.1])));
  test.set("body", bodyEntity(2));
  carry(0);
  return { test, camera, navigation, viewpoints, frames, carry };
}

const at = (...point: [number, number, number]): Anchor => ({ body: NO_BODY, point });
const on = (...point: [number, number, number]): Anchor => ({ body: 2, point });

describe("viewpoints", () => {
  it("are gone to one after the other, until the user moves the camera", () => {
    const { test, camera, navigation, viewpoints, frames } = make();
    test.set("viewpoint", { id: id(0), name: "side", eye: at(5, 1, 0), target: at(0, 1, 0) }, { id: id(1), name: "top", eye: at(0, 9, 0.1), target: at(0, 1, 0) });
    viewpoints.next();
    frames(200);
    expect(camera.position.toArray().map((x) => Math.round(10 * x) / 10)).toEqual([5, 1, 0]);
    expect(viewpoints.name).toBe("side");
    viewpoints.next();
    frames(200);
    expect(camera.position.y).toBeCloseTo(9, 1);
    navigation.orbit(10, 0);
    frames(1);
    expect(viewpoints.name).toBe("");
    viewpoints.go(7);
    expect(viewpoints.name).toBe("");
  });

  it("on a body take the camera along at once", () => {
    const { test, camera, viewpoints, frames, carry } = make();
    test.set("viewpoint", { id: id(0), name: "driver", eye: on(0, 0.5, 2), target: on(0, 0.5, 0) });
    viewpoints.go(0);
    for (const x of [1, 3, 7]) {
      carry(x);
      frames(1);
      expect(camera.position.x).toBeCloseTo(x, 1);
      expect(camera.position.z).toBeCloseTo(2, 1);
    }
  });

  it("are left alone while a body is followed, which the user may look at from anywhere", () => {
    const { camera, navigation, viewpoints, frames, carry } = make();
    frames(200);
    const before = camera.position.clone();
    viewpoints.follow(2);
    carry(4);
    frames(1);
    expect(camera.position.x - before.x).toBeCloseTo(4, 1);
    expect(camera.position.z - before.z).toBeCloseTo(0, 1);
    navigation.orbit(100, 0);
    carry(5);
    frames(200);
    expect(viewpoints.followed).toBe(2);
    expect(navigation.goal.pivot[0]).toBeCloseTo(5, 1);
    viewpoints.follow(-1);
    carry(9);
    frames(10);
    expect(navigation.goal.pivot[0]).toBeCloseTo(5, 1);
  });
});

describe("a gamepad", () => {
  it("walks, looks around, and runs the script's actions once a press", () => {
    const { camera, navigation, frames } = make();
    const run = vi.fn();
    const pad = new GamepadInput(navigation, { script: [{ button: "a", run }] as never });
    const state = { axes: [0, 0, 0, 0], buttons: Array.from({ length: 8 }, () => ({ value: 0, pressed: false })) };
    const hold = (count: number) => {
      for (let frame = 0; frame < count; frame++) {
        pad.aim(1 / 60, state as unknown as Gamepad);
        frames(1);
      }
    };
    state.axes = [0.1, 0.1, -0.1, 0.05];
    hold(10);
    expect(navigation.walk.lengthSq()).toBe(0);
    frames(200);
    const before = camera.position.clone();
    state.axes = [1, 0, 0, 0];
    hold(60);
    state.axes = [0, 0, 0, 0];
    hold(1);
    expect(navigation.walk.lengthSq()).toBe(0);
    frames(200);
    // To the right of where it looks, at three quarters of the scene's size in a second.
    expect(camera.position.distanceTo(before)).toBeCloseTo(7.5, 0);
    const yaw = navigation.goal.yaw;
    state.axes = [0, 0, 1, 0];
    hold(30);
    expect(Math.abs(navigation.goal.yaw - yaw)).toBeGreaterThan(0.3);
    state.buttons[0] = { value: 1, pressed: true };
    hold(5);
    expect(run).toHaveBeenCalledTimes(1);
  });
});
