// SPDX-License-Identifier: Apache-2.0
// Each script of the first hour shows its subject: in the first picture, and to who comes after 5 s and after a minute.

import { readdirSync } from "node:fs";
import path from "node:path";
import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, runsAll } from "./browser.ts";
import { drawn } from "./drawn.ts";
import { freePort, WorldServer } from "./server.ts";

const scripts = readdirSync(path.join(import.meta.dirname, "../../examples/first_hour"))
  .filter((name) => name.endsWith(".py")).map((name) => name.slice(0, -3));
/** Usually these stand for all. */
const some = ["button", "door", "plug"];
/** The picture has room for the circles that these go along, and they are a part of it at most times. */
const sweeping = ["aspirin", "double_pendulum", "planets"];
/** After so many seconds; a day of the planets is a second. */
const times = runsAll ? [0, 5, 60] : [0];

let browser: Browser;

beforeAll(async () => {
  browser = await Browser.start({ width: 640, height: 480, draws: "asked" });
});

afterAll(async () => {
  await browser?.stop();
});

it.each(scripts.filter((name) => runsAll || some.includes(name)).flatMap((name) => times.map((after) => [name, after] as const)))(
  "%s shows its subject after %i s", async (name, after) => {
    const server = await WorldServer.start(["web/e2e/first_hour_probe.py"], await freePort(), undefined, { IOTA_SCRIPT: name, IOTA_AFTER: String(after) });
    try {
      const tab = await browser.open(server.url, { begun: false });
      await tab.drawn();
      await tab.eyeAtRest();
      const [all, moving] = [await drawn(tab), await drawn(tab, ["body", "tie"])];
      const what = JSON.stringify({ all, moving });
      expect(Math.max(all.wide, all.high), what).toBeGreaterThan(sweeping.includes(name) ? 0.25 : 0.4);
      expect(moving.share, `what moves is seen; ${what}`).toBeGreaterThan(2e-4);
      expect(moving.cut, what).toBe(false);
      const [labels, sizes] = await tab.page.evaluate(() => {
        const { world: { entities: { label } }, viewer: { camera } } = iota.page;
        const boxes: DOMRect[] = [];
        label.forEachBox(camera, (left, top, width, height) => boxes.push(new DOMRect(left, top, width, height)));
        return [boxes.filter(({ left, right, top, bottom }) => left >= 0 && right <= innerWidth && top >= 0 && bottom <= innerHeight).length, boxes.length];
      });
      expect(labels, "labels are in the picture").toBe(sizes);
      await tab.picture(`first_hour_${name}_${after}`);
      expect(tab.complaints).toEqual([]);
      await tab.page.goto("about:blank");
    } finally {
      await server.stop();
    }
  },
);
