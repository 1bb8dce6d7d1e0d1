// SPDX-License-Identifier: Apache-2.0
import { Color, PMREMGenerator, Scene, type WebGLRenderer } from "three";
import { afterEach, expect, it, vi } from "vitest";
import { Reflections } from "../src/scene/reflections.ts";

type Drawn = ReturnType<PMREMGenerator["fromScene"]>;

/** Counts drawings, which need a graphics card. */
const drawing = () => (
  vi.spyOn(PMREMGenerator.prototype, "fromScene").mockImplementation(() => ({ texture: {}, dispose: () => {} }) as unknown as Drawn)
);

afterEach(() => void vi.restoreAllMocks());

it("what surfaces mirror is drawn again only when a color or a light has changed", () => {
  const draw = drawing();
  const sky = { horizon: { value: new Color("#d5d7d7") }, zenith: { value: new Color("#8ea7bb") } };
  const reflections = new Reflections({ toneMappingExposure: 1 } as WebGLRenderer, sky);
  const scene = new Scene();
  /** Sets the light and the ground, and draws ten pictures. Returns how often it has drawn in all. */
  const after = (light: number, ground: string | null) => {
    reflections.set(light, ground === null ? null : new Color(ground));
    for (let picture = 0; picture < 10; picture++) reflections.update(scene);
    return draw.mock.calls.length;
  };
  expect(after(1, null)).toBe(1);
  expect(after(1, null)).toBe(1);
  expect(after(0.5, null)).toBe(2);
  expect(after(0.5, "#c9c0b2")).toBe(3);
  expect(after(0.5, "#c9c0b2")).toBe(3);
  sky.zenith.value.set("#0d1013");
  expect(after(0.5, "#c9c0b2")).toBe(4);
});

it("colors that change in each picture are drawn in each fifth", () => {
  const draw = drawing();
  const sky = { horizon: { value: new Color() }, zenith: { value: new Color() } };
  const reflections = new Reflections({ toneMappingExposure: 1 } as WebGLRenderer, sky);
  for (let picture = 0; picture < 20; picture++) {
    reflections.set(1 + picture, null);
    reflections.update(new Scene());
  }
  expect(draw).toHaveBeenCalledTimes(4);
});
