// SPDX-License-Identifier: Apache-2.0
// The hint of the start, over worlds that hang from nails.

import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

let browser: Browser;

beforeAll(async () => {
  browser = await Browser.start({ width: 640, height: 480 });
});

afterAll(async () => {
  await browser?.stop();
});

const windows = [[640, 480], [390, 844], [1280, 720]] as const;

// In the probe the page chooses the view, with the nail near the upper edge; in the study the script does.
it.each([["web/e2e/sizes_probe.py", "&world=1"], ["chain", ""]])("of %s covers no nail and not the middle", async (what, query) => {
  const server = await WorldServer.start([what], await freePort());
  try {
    const tab = await browser.open(`${server.url}${query}`);
    for (const [width, height] of windows) {
      await tab.page.setViewportSize({ width, height });
      await tab.until("the picture has the window's form", ([wide, high]) => Math.abs(iota.page.viewer.camera.aspect - wide / high) < 0.01, [width, height] as const);
      await tab.eyeAtRest();
      await tab.page.evaluate(() => document.getElementById("welcome")!.classList.remove("gone"));
      const look = () => tab.page.evaluate(() => {
        const { left, right, top, bottom } = document.getElementById("welcome")!.getBoundingClientRect();
        const { camera } = iota.page.viewer;
        const places: [number, number][] = [[innerWidth / 2, innerHeight / 2]];
        iota.page.world.entities.nail.forEachPlace((place) => {
          const { x, y } = place.clone().project(camera);
          places.push([((1 + x) / 2) * innerWidth, ((1 - y) / 2) * innerHeight]);
        });
        const bar = document.getElementById("bar")!.getBoundingClientRect();
        return {
          box: [left, right, top, bottom], places, inside: left >= 0 && top >= 0 && right <= innerWidth && bottom <= bar.top,
          covered: places.filter(([x, y]) => x > left - 8 && x < right + 8 && y > top - 8 && y < bottom + 8).length,
        };
      });
      await expect.poll(async () => {
        const { covered, inside } = await look();
        return covered === 0 && inside;
      }, { message: `${width} x ${height}: ${JSON.stringify(await look())}` }).toBe(true);
      expect((await look()).places.length, "a nail is there").toBeGreaterThan(1);
      await tab.picture(`welcome_${query === "" ? "chain" : "rods"}_${width}`);
    }
    expect(tab.complaints).toEqual([]);
    await tab.page.goto("about:blank");
  } finally {
    await server.stop();
  }
}, 120_000);
