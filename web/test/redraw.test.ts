// SPDX-License-Identifier: Apache-2.0
import { expect, it } from "vitest";
import { Redraw } from "../src/page/redraw.ts";

/** How many of some frames are drawn. */
function drawn(redraw: Redraw, frames: number, seconds: number): number {
  let count = 0;
  for (let frame = 0; frame < frames; frame++) if (redraw.isDue(seconds)) count++;
  return count;
}

it("a page that does not change stops drawing, and begins again with a change", () => {
  const redraw = new Redraw();
  expect(drawn(redraw, 1000, 1 / 60)).toBe(Math.ceil(0.7 * 60));
  expect(drawn(redraw, 1000, 1 / 60)).toBe(0);
  redraw.ask();
  expect(drawn(redraw, 1000, 1 / 60)).toBeGreaterThan(0);
});

it("long frames, which count as short ones for what eases, are drawn until all of it has ended", () => {
  const redraw = new Redraw();
  // A ring of light at a break lasts for 0.55 s, and a frame of any length takes at most 0.1 s of it.
  expect(drawn(redraw, 100, 0.1)).toBeGreaterThan(5);
});

it("a frame that takes longer than all easing is drawn", () => {
  const redraw = new Redraw();
  drawn(redraw, 100, 0.1);
  redraw.ask();
  expect(drawn(redraw, 10, 5)).toBe(1);
});

it("a page rests after its last picture, until the next change", () => {
  const redraw = new Redraw();
  expect(redraw.isResting).toBe(false);
  drawn(redraw, 1000, 1 / 60);
  expect(redraw.isResting).toBe(true);
  redraw.ask();
  expect(redraw.isResting).toBe(false);
});
