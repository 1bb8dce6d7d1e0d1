// SPDX-License-Identifier: Apache-2.0
import { DirectionalLight, PointLight, SpotLight, Vector3 } from "three";
import { beforeEach, describe, expect, it } from "vitest";
import { LightKind, NO_BODY, NO_COLOR, type LightEntity } from "../src/protocol/generated.ts";
import { LightView } from "../src/scene/entities/light.ts";
import { body, bodyEntity, id, TestWorld } from "./test_world.ts";

const inWorld = (x: number, y: number, z: number) => ({ body: NO_BODY, point: [x, y, z] as [number, number, number] });

function lamp(slot: number, kind: LightKind, extra: Partial<LightEntity> = {}): LightEntity {
  return { id: id(slot), kind, at: inWorld(0, 2, 0), to: inWorld(0, 2, 0), color: NO_COLOR, intensity: 1, reach: 0, angle: 0.4, shadow: false, ...extra };
}

let tested: TestWorld;
let view: LightView;
const lamps = () => view.root.children.filter((child) => "isLight" in child);

beforeEach(() => {
  tested = new TestWorld();
  view = new LightView(tested.world.poses, () => 2);
});

describe("a lamp", () => {
  it("is as bright at its reach as the page's own, and falls with the square of the distance", () => {
    view.create(lamp(0, LightKind.point, { reach: 3, intensity: 0.5 }));
    view.create(lamp(1, LightKind.point));
    view.draw();
    const [near, usual] = lamps() as PointLight[];
    // Irradiance is intensity / distance^2 (three.js, decay 2).
    expect(near.intensity / 3 ** 2).toBeCloseTo(0.5 * 3.2, 6);
    expect(usual.intensity / 2 ** 2).toBeCloseTo(3.2, 6);
    expect(near.decay).toBe(2);
  });

  it("of a spot points down, or where it is told", () => {
    view.create(lamp(0, LightKind.spot));
    view.create(lamp(1, LightKind.spot, { to: inWorld(5, 2, 0) }));
    view.draw();
    const ways = (lamps() as SpotLight[]).map(({ position, target }) => new Vector3().subVectors(target.position, position).normalize().toArray());
    expect(ways).toEqual([[0, -1, 0], [1, 0, 0]]);
  });

  it("of the sun is equally bright everywhere, and its shadows cover the scene", () => {
    view.create(lamp(0, LightKind.sun, { to: inWorld(0, 0, 0), shadow: true }));
    view.draw();
    const [sun] = lamps() as DirectionalLight[];
    expect(sun.intensity).toBeCloseTo(3.2, 6);
    expect(sun.shadow.camera.right).toBe(3);
    expect(sun.position.length()).toBeGreaterThan(2);
    expect(sun.shadow.camera.far).toBeGreaterThan(sun.position.length() + 2);
  });

  it("moves with its body, and is dark while that has no place", () => {
    tested.set("body", bodyEntity(0));
    view.create(lamp(0, LightKind.point, { at: { body: 0, point: [0, 1, 0] } }));
    view.draw();
    const [light] = lamps() as PointLight[];
    expect(light.intensity).toBe(0);
    tested.poses([body(0, 4)]);
    view.draw();
    expect(light.intensity).toBeGreaterThan(0);
    expect(light.position.x).toBeCloseTo(4, 2);
    expect(light.position.y).toBeCloseTo(1, 2);
  });

  it("that is gone is dark and used again, as another number of lamps compiles all materials anew", () => {
    view.create(lamp(0, LightKind.point));
    view.draw();
    const [first] = lamps();
    view.destroy(0);
    expect((first as PointLight).intensity).toBe(0);
    view.create(lamp(0, LightKind.point, { color: 0xff0000 }));
    view.draw();
    expect(lamps()).toEqual([first]);
    expect((first as PointLight).color.getHex()).toBe(0xff0000);
    for (let slot = 0; slot < 40; slot++) {
      view.create(lamp(1, slot % 2 === 0 ? LightKind.spot : LightKind.sun));
      view.destroy(1);
    }
    expect(lamps().length).toBeLessThanOrEqual(8);
  });
});
