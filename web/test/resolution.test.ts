// SPDX-License-Identifier: Apache-2.0
// The resolution of the drawing, for a made-up viewer.

import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Resolution } from "../src/page/resolution.ts";
import type { Viewer } from "../src/page/viewer.ts";

const timing = { frameMs: 16 };
const resize = vi.fn<(width: number, height: number, ratio: number) => void>();
const viewer = { timing, resize, presenting: false, filming: false, renderer: { xr: { addEventListener: () => {} } } };
let resolution: Resolution;

/** Frames of a tenth of a second each, of which drawing takes so long; the resolution afterwards. */
function drawFor(seconds: number, frameMs: number): number {
  timing.frameMs = frameMs;
  for (let frame = 0; frame < Math.round(seconds * 10); frame++) resolution.draw(0.1);
  return resize.mock.lastCall![2];
}

beforeEach(() => {
  vi.stubGlobal("window", { addEventListener: () => {} });
  vi.stubGlobal("document", { visibilityState: "visible" });
  for (const [name, value] of Object.entries({ innerWidth: 800, innerHeight: 600, devicePixelRatio: 1 })) vi.stubGlobal(name, value);
  Object.assign(viewer, { presenting: false, filming: false });
  resolution = new Resolution(viewer as unknown as Viewer);
});

afterEach(() => {
  vi.unstubAllGlobals();
  resize.mockReset();
});

it("stays while drawing is slow for a moment only", () => {
  for (let times = 0; times < 5; times++) {
    expect(drawFor(1, 50)).toBe(1);
    expect(drawFor(0.1, 16)).toBe(1);
  }
});

it("sinks in steps while drawing stays slow, down to a half", () => {
  expect(drawFor(1.6, 50)).toBeCloseTo(0.8);
  expect(drawFor(1.3, 50)).toBeCloseTo(0.8);
  expect(drawFor(0.5, 50)).toBeCloseTo(0.64);
  expect(drawFor(30, 50)).toBeCloseTo(0.512);
});

it("is left alone by films, headsets and hidden pages", () => {
  viewer.filming = true;
  expect(drawFor(5, 50)).toBe(1);
  Object.assign(viewer, { filming: false, presenting: true });
  expect(drawFor(5, 50)).toBe(1);
  viewer.presenting = false;
  vi.stubGlobal("document", { visibilityState: "hidden" });
  expect(drawFor(5, 50)).toBe(1);
});
