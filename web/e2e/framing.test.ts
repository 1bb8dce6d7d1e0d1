// SPDX-License-Identifier: Apache-2.0
// The first picture shows the whole scene: drawn pixels are counted for studies, examples, and one scene at sizes from
// a molecule to a valley.

import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Browser, type Tab } from "./browser.ts";
import { drawn } from "./drawn.ts";
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
