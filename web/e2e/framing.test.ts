// SPDX-License-Identifier: Apache-2.0
// The first picture shows the whole scene: drawn pixels are counted for studies, examples, and one scene at sizes from
// a molecule to a valley.

import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Browser, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

const tall = { width: 360, height: 640 };
const wide = { width: 640, height: 360 };

let browser: Browser;

beforeAll(async () => {
  browser = await Browser.start({ ...wide, density: 1 });
});

afterAll(async () => {
  await browser?.stop();
});

interface Drawn {
  /** Share of the picture's pixels. */
  readonly share: number;
  /** Bounds of the drawn pixels as shares of the picture: 0 .. 1. */
  readonly wide: number;
  readonly high: number;
  /** Whether drawn pixels touch the picture's edge. */
  readonly cut: boolean;
}

/** The pixels of bodies and statics: those that change when these are hidden. */
async function drawn(tab: Tab): Promise<Drawn> {
  return tab.page.evaluate(() => {
    const { viewer, world: { entities } } = iota.page;
    const { renderer } = viewer;
    const gl = renderer.getContext();
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const take = (): Uint8Array => {
      const pixels = new Uint8Array(4 * width * height);
      renderer.render(viewer.scene, viewer.camera);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      return pixels;
    };
    const roots = [entities.body.root, entities.staticShape.root, entities.tie.root, entities.particleSet.root];
    renderer.shadowMap.autoUpdate = false;
    const shown = take();
    for (const root of roots) root.visible = false;
    const hidden = take();
    for (const root of roots) root.visible = true;
    renderer.shadowMap.autoUpdate = true;
    let count = 0;
    let [left, right, low, top] = [width, -1, height, -1];
    for (let index = 0; index < width * height; index++) {
      const change = Math.max(...[0, 1, 2].map((channel) => Math.abs(shown[4 * index + channel] - hidden[4 * index + channel])));
      if (change < 12) continue;
      count++;
      const [x, y] = [index % width, Math.floor(index / width)];
      [left, right, low, top] = [Math.min(left, x), Math.max(right, x), Math.min(low, y), Math.max(top, y)];
    }
    const cut = left === 0 || low === 0 || right === width - 1 || top === height - 1;
    return { share: count / (width * height), wide: (right - left) / width, high: (top - low) / height, cut };
  });
}

async function open(url: string): Promise<Tab> {
  const tab = await browser.open(url);
  await tab.until("it has been drawn", () => !document.getElementById("view")!.classList.contains("waiting"));
  await tab.page.waitForTimeout(600);
  return tab;
}

describe("the first picture", () => {
  it("is filled by a scene of any size, in landscape and portrait", async () => {
    const server = await WorldServer.start(["web/e2e/sizes_probe.py"], await freePort());
    try {
      for (const size of ["1e-09", "1e-06", "0.001", "1", "30", "1000"]) {
        const tab = await open(`${server.url}&world=${size}`);
        for (const [shape, window] of Object.entries({ wide, tall })) {
          await tab.page.setViewportSize(window);
          await tab.page.waitForTimeout(1200);
          const seen = await drawn(tab);
          const what = `${size} m, ${shape}: ${JSON.stringify(seen)}`;
          expect(seen.share, what).toBeGreaterThan(0.003);
          expect(Math.max(seen.wide, seen.high), what).toBeGreaterThan(0.4);
          expect(seen.cut, what).toBe(false);
        }
        expect(tab.complaints).toEqual([]);
        await tab.page.setViewportSize(wide);
      }
    } finally {
      await server.stop();
    }
  }, 180_000);

  const scenes = [
    "chain", "cradle", "lab", "ladder", "mechanisms", "weather",
    ...["bridge", "explicit_particles", "pendulum"].map((name) => `examples/python/${name}.py`),
  ];
  it.each(scenes)("of %s shows it", async (what) => {
    const server = await WorldServer.start([what], await freePort());
    try {
      const tab = await open(server.url);
      let seen = await drawn(tab);
      // A page that starts slowly shows the first moments of a motion later than it frames them; the camera follows.
      for (let wait = 0; wait < 40 && !(seen.share > 0.004 && Math.max(seen.wide, seen.high) > 0.4); ++wait) {
        await tab.page.waitForTimeout(200);
        seen = await drawn(tab);
      }
      expect(seen.share, JSON.stringify(seen)).toBeGreaterThan(0.004);
      expect(Math.max(seen.wide, seen.high), JSON.stringify(seen)).toBeGreaterThan(0.4);
      expect(tab.complaints).toEqual([]);
    } finally {
      await server.stop();
    }
  });
});
