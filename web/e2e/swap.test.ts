// SPDX-License-Identifier: Apache-2.0
// A structure that stands in for a thing fades in while the thing fades out, and back.

import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, small } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

let server: WorldServer;
let browser: Browser;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/swap_probe.py"], await freePort());
  browser = await Browser.start({ ...small, density: 1, draws: "asked" });
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

it("no picture of a swap differs from the one before by more than a fifth of what the swap changes", async () => {
  const tab = await browser.open(server.url, { begun: false });
  await tab.drawn();
  await tab.eyeAtRest();
  for (const bodies of [1, 4]) {
    await tab.page.evaluate(() => {
      const { body } = iota.page.world.entities;
      body.draw = () => undefined;  // only this test draws
    });
    await tab.page.keyboard.press("k");
    await tab.until("the swap", (count) => {
      const { body } = iota.page.world.entities;
      return [...body.slots()].filter((slot) => body.canHold(slot)).length === count;
    }, bodies);
    const { steps, all } = await tab.page.evaluate(async () => {
      const { viewer: { renderer, scene, camera }, world: { entities: { body } } } = iota.page;
      const gl = renderer.getContext();
      const take = (seconds: number): Uint8Array => {
        body.update(seconds, performance.now());  // as the page does before each picture: lists the bodies that are drawn
        Object.getPrototypeOf(body).draw.call(body, seconds);
        renderer.render(scene, camera);
        const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
        gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        return pixels;
      };
      const difference = (a: Uint8Array, b: Uint8Array): number => {
        let sum = 0;
        for (let at = 0; at < a.length; at++) if (at % 4 < 3) sum += Math.abs(a[at] - b[at]);
        return sum / a.length;
      };
      const pictures = [take(0)];
      for (let frame = 0; frame < 24; frame++) pictures.push(take(1 / 60));
      return {
        steps: pictures.slice(1).map((picture, index) => difference(picture, pictures[index])),
        all: difference(pictures[0], pictures.at(-1)!),
      };
    });
    expect(all, "something changes").toBeGreaterThan(0.3);
    expect(Math.max(...steps)).toBeLessThan(0.2 * all);
    expect(steps.at(-1), "it is over").toBe(0);
  }
  expect(tab.complaints).toEqual([]);
});
