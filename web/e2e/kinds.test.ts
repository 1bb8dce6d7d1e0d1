// SPDX-License-Identifier: Apache-2.0
// Each kind of drawing looks as it did: a picture with one in each cell, compared with e2e/kept/kinds.jpg.

import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, type Tab } from "./browser.ts";
import { addressOf, compare, expectKept, isAlike, pictureOf, type Grid } from "./kept.ts";
import { freePort, WorldServer } from "./server.ts";

/** As kinds_probe.py draws. */
const cells: Grid = [8, 5];

let server: WorldServer;
let browser: Browser;
let tab: Tab;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/kinds_probe.py"], await freePort());
  browser = await Browser.start({ width: 960, height: 540, density: 1 });
  tab = await browser.open(server.url);
  await tab.drawn();
  // Once more, for the paths that the page has seen from their start.
  await tab.until("the script has stopped it", () => iota.paused && iota.time > 0.55);
  await tab.backToStart();
  // Not by a key until it runs, which it does for 0.6 s only: a busy page could miss that, and press again.
  await tab.page.evaluate(() => iota.page.commands.run("play"));
  await tab.until("it stays where the script stops it", () => iota.paused && iota.time > 0.55);
  await tab.eyeAtRest();
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

const take = () => pictureOf(tab, 640, 360);

it("all kinds look as they did", async () => {
  await expectKept(tab, "kinds", take, cells);
  expect(tab.complaints).toEqual([]);
});

/** What is wrong with one kind is seen in one of its cells. */
it.each(["marker", "staticShape", "line", "tube", "arrow", "axes", "label", "pointCloud", "shapeSet", "strut", "surface", "custom", "light", "body", "tie", "nail", "particleSet", "trace", "paint"])("a missing and a displaced %s is noticed", async (kind) => {
  const kept = addressOf("kinds");
  await expect.poll(async () => isAlike(await compare(tab, kept, await take(), cells))).toBe(true);
  const change = async (code: string) => tab.page.evaluate(`{ const view = iota.page.world.entities["${kind}"]; const root = view.root; ${code} }`);
  const notices = async (what: string) => expect(isAlike(await compare(tab, kept, await take(), cells)), what).toBe(false);
  if (kind === "paint") {
    await change("view.destroy(0)");
    return notices("unpainted");
  }
  await change("root.visible = false");
  await notices("missing");
  await change("root.visible = true");
  if (kind === "light" || kind === "trace") return;
  await change("root.position.x += 0.2");
  await notices("displaced");
  await change("root.position.x -= 0.2");
});
