// SPDX-License-Identifier: Apache-2.0
import { Matrix4, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { buttonAt, pointOnPlate, Poke, rayOnPlate, Spot, type Plate } from "../src/xr/plate.ts";

/** 0.2 m x 0.1 m, 1000 px a meter, at a place and turned about the vertical. */
function makePlate(x: number, y: number, z: number, turn: number): Plate {
  return { matrix: new Matrix4().makeRotationY(turn).setPosition(x, y, z).elements, width: 0.2, height: 0.1, density: 1000 };
}

describe("a panel in the world", () => {
  const spot = new Spot();

  it("is met by a ray at the pixel it points to", () => {
    const plate = makePlate(1, 1.5, -1, 0);
    expect(rayOnPlate(plate, [1.05, 1.52, 0], [0, 0, -1], spot)).toBe(true);
    expect(spot.x).toBeCloseTo(150);
    expect(spot.y).toBeCloseTo(30);
    expect(spot.distance).toBeCloseTo(1);
    expect(rayOnPlate(plate, [1.11, 1.5, 0], [0, 0, -1], spot)).toBe(false);
  });

  it("is met when turned, and never from behind, along its plane or backwards", () => {
    const plate = makePlate(0, 1, 0, Math.PI / 2);
    const middle = new Vector3(0, 1.01, 0.03);
    const origin = new Vector3(2, 1.5, 0.4);
    const direction = middle.clone().sub(origin).normalize();
    expect(rayOnPlate(plate, origin.toArray(), direction.toArray(), spot)).toBe(true);
    expect(spot.x).toBeCloseTo(70);
    expect(spot.y).toBeCloseTo(40);
    expect(spot.distance).toBeCloseTo(origin.distanceTo(middle));
    expect(rayOnPlate(plate, origin.toArray(), direction.clone().negate().toArray(), spot)).toBe(false);
    expect(rayOnPlate(plate, [-2, 1, 0], [1, 0, 0], spot)).toBe(false);
    expect(rayOnPlate(plate, [0.1, 1, 0], [0, 0, 1], spot)).toBe(false);
  });

  it("knows how far a fingertip is before or behind it", () => {
    const plate = makePlate(0, 0, -1, 0);
    expect(pointOnPlate(plate, [0, 0, -0.97], spot)).toBe(true);
    expect(spot.distance).toBeCloseTo(0.03);
    expect(pointOnPlate(plate, [0, 0.02, -1.01], spot)).toBe(true);
    expect(spot.distance).toBeCloseTo(-0.01);
    expect(pointOnPlate(plate, [0, 0.2, -0.97], spot)).toBe(false);
  });

  it("finds the button at a place, wider for a finger", () => {
    const buttons = [{ x: 10, y: 10, width: 50, height: 20 }, { x: 70, y: 10, width: 50, height: 20 }];
    expect(buttonAt(buttons, 60, 30)).toBe(0);
    expect(buttonAt(buttons, 64, 20)).toBe(-1);
    expect(buttonAt(buttons, 66, 20, 5)).toBe(1);
  });
});

describe("a fingertip on a panel", () => {
  const press = (heights: number[]): number => {
    const poke = new Poke();
    return heights.filter((height) => poke.update(true, height)).length;
  };

  it("presses once when it comes through, and again only after it has left", () => {
    expect(press([0.05, 0.02, 0.004, -0.002, -0.01, 0.002, -0.004])).toBe(1);
    expect(press([0.05, 0.01, -0.01, 0.03, -0.01])).toBe(2);
  });

  it("presses even when a fast finger is seen only far before and just behind", () => {
    expect(press([0.1, -0.02])).toBe(1);
  });

  it("does not press from behind, sideways or from far away", () => {
    expect(press([-0.03, -0.01, 0.005, -0.01])).toBe(0);
    expect(press([0.4, -0.2])).toBe(0);
    const poke = new Poke();
    expect([poke.update(false, 0.02), poke.update(true, -0.01)]).toEqual([false, false]);
  });

  it("says which button it means only while it is near", () => {
    const poke = new Poke();
    poke.update(true, 0.3);
    expect(poke.near).toBe(false);
    poke.update(true, 0.05);
    expect(poke.near).toBe(true);
    poke.update(false, 0.05);
    expect(poke.near).toBe(false);
  });
});
