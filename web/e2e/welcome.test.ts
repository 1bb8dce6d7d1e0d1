// SPDX-License-Identifier: Apache-2.0
// The hint of the start has a place of its own, below what a view frames.

import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser } from "./browser.ts";
import { drawn } from "./drawn.ts";
import { freePort, WorldServer } from "./server.ts";

let browser: Browser;

beforeAll(async () => {
  browser = await Browser.start({ width: 640, height: 480, draws: "asked" });
});

afterAll(async () => {
  await browser?.stop();
});

const windows = [[640, 480], [390, 844], [1280, 720]] as const;

it("lies on nothing that is drawn, and on no control, at any size of the window", async () => {
  const server = await WorldServer.start(["web/e2e/subjects_probe.py"], await freePort(), undefined, { IOTA_SCENE: "button" });
  try {
    const tab = await browser.open(server.url);
    for (const [width, height] of windows) {
      await tab.page.setViewportSize({ width, height });
      await tab.until("the picture has the window's form", ([wide, high]) => Math.abs(iota.page.viewer.camera.aspect - wide / high) < 0.01, [width, height] as const);
      await tab.eyeAtRest();
      await tab.page.evaluate(() => document.getElementById("welcome")!.classList.remove("gone"));
      const { box, bar } = await tab.page.evaluate(() => {
        const [box, bar] = ["welcome", "bar"].map((id) => document.getElementById(id)!.getBoundingClientRect().toJSON() as DOMRect);
        return { box, bar };
      });
      const what = `${width} x ${height}: ${JSON.stringify(box)}`;
      expect(box.left >= 0 && box.top >= 0 && box.right <= width && box.bottom <= height, what).toBe(true);
      expect(box.left >= bar.right || box.bottom <= bar.top, what).toBe(true);
      const { low, cut, share } = await drawn(tab);
      expect(share, what).toBeGreaterThan(0.003);
      expect(cut, what).toBe(false);
      expect((1 - low) * height, `lowest drawn pixel; ${what}`).toBeLessThan(box.top);
      await tab.picture(`welcome_${width}`);
    }
    expect(tab.complaints).toEqual([]);
  } finally {
    await server.stop();
  }
});

it("says what the world is, and the sign for help stays when the bar hides", async () => {
  const server = await WorldServer.start(["web/e2e/study_probe.py"], await freePort(), undefined, { IOTA_STUDY: "cradle" });
  try {
    const tab = await browser.open(server.url);
    await tab.drawn();
    const about = tab.page.locator("#about");
    await about.waitFor();
    expect(await about.textContent()).toMatch(/^cradle of 24 mm balls as many leave/);
    await tab.page.evaluate(() => document.body.classList.add("idle"));
    await tab.untilShown();
    const seen = await tab.page.evaluate(() => Array.from(document.querySelectorAll("#bar > *"), (item) => [item.id, getComputedStyle(item).opacity]));
    expect(Object.fromEntries(seen)).toMatchObject({ "open-help": "1", reset: "0" });
    await tab.page.mouse.click(...(await tab.page.locator("#open-help").evaluate((item) => {
      const { left, top, width, height } = item.getBoundingClientRect();
      return [left + width / 2, top + height / 2] as const;
    })));
    await tab.page.locator("#help[open]").waitFor();
    expect(tab.complaints).toEqual([]);
  } finally {
    await server.stop();
  }
});
