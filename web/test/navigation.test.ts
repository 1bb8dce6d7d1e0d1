// SPDX-License-Identifier: Apache-2.0
import { PerspectiveCamera, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { Navigation } from "../src/navigate/navigation.ts";

const size = 3;

function make() {
  const camera = new PerspectiveCamera(42, 1.6);
  const navigation = new Navigation(camera);
  navigation.setScene([0, 1, 0], size);
  const rest = () => {
    for (let frame = 0; frame < 400; frame++) navigation.update(1 / 60);
    camera.updateMatrixWorld();
  };
  rest();
  return { camera, navigation, rest, screen: (point: Vector3) => point.clone().project(camera) };
}

describe("zooming", () => {
  it.each([0.5, 0.8, 1.5])("by %s keeps the point under the pointer there", (factor) => {
    const { camera, navigation, screen, rest } = make();
    const depth = navigation.goal.distance;
    const pointer = [0.6, -0.4] as const;
    const along = new Vector3(...pointer, 0.5).unproject(camera).sub(camera.position);
    const ahead = camera.getWorldDirection(new Vector3());
    const point = along.multiplyScalar(depth / along.dot(ahead)).add(camera.position);
    expect(screen(point).x).toBeCloseTo(pointer[0], 6);
    navigation.zoom(factor, ...pointer);
    rest();
    expect(navigation.goal.distance).toBeCloseTo(depth * factor, 6);
    expect(screen(point).x).toBeCloseTo(pointer[0], 3);
    expect(screen(point).y).toBeCloseTo(pointer[1], 3);
  });

  it("ends before the point under the pointer, however fast the wheel turns", () => {
    const { camera, navigation, rest } = make();
    const place = new Vector3(0.2, 1.1, 0.3);
    for (let turn = 0; turn < 60; turn++) navigation.zoom(0.77, 0.1, 0.05, navigation.depthOf(place.toArray()));
    rest();
    expect(place.sub(camera.position).dot(camera.getWorldDirection(new Vector3()))).toBeGreaterThan(0.01 * size);
  });

  it("ends before the scene is passed through or lost from sight", () => {
    const { navigation, screen, rest } = make();
    for (let turn = 0; turn < 100; turn++) navigation.zoom(1.5);
    rest();
    const height = 2 * Math.abs(screen(new Vector3(0, 1 + size / 2, 0)).y - screen(new Vector3(0, 1, 0)).y);
    expect(height, "2 is the whole window").toBeGreaterThan(0.1);
    for (let turn = 0; turn < 200; turn++) navigation.zoom(0.7);
    rest();
    expect(navigation.goal.distance).toBeGreaterThan(0.01 * size);
  });
});

describe("reset", () => {
  it.each([1, 2.4, -3.3])("after %s turns goes back the short way, not through all of them", (turns) => {
    const { navigation, camera } = make();
    navigation.setHome(navigation.goal);
    const home = navigation.goal.yaw;
    navigation.goTo({ ...navigation.goal, yaw: home + turns * 2 * Math.PI });
    for (let frame = 0; frame < 400; frame++) navigation.update(1 / 60);
    navigation.reset();
    const place = new Vector3();
    let last = camera.position.clone(), way = 0;
    for (let frame = 0; frame < 400; frame++) {
      navigation.update(1 / 60);
      way += place.copy(camera.position).distanceTo(last);
      last = camera.position.clone();
    }
    expect(way).toBeLessThan(1.1 * Math.PI * navigation.goal.distance);
  });
});
