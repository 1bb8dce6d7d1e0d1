// SPDX-License-Identifier: Apache-2.0
// Ready parts of rigs, by a mouse: a button is pressed, a switch clicked, a drawer pulled towards the viewer.

import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, small, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

interface Told {
  readonly pressed: boolean;
  readonly on: boolean;
  readonly slide: number;
  /** Its z, m. */
  readonly ball: number;
  readonly paddles: number;
}

let server: WorldServer;
let browser: Browser;
let tab: Tab;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/rig_probe.py"], await freePort());
  browser = await Browser.start(small);
  tab = await browser.open(server.url);
  await tab.eyeAtRest();
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

const told = () => server.reports.at(-1) as Told;

/** Where a place of the world is in the window, css px. */
function onScreen(place: [number, number, number]): Promise<[number, number]> {
  return tab.page.evaluate((at) => {
    const point = iota.page.viewer.camera.position.clone().set(...at).project(iota.page.viewer.camera);
    return [((point.x + 1) / 2) * innerWidth, ((1 - point.y) / 2) * innerHeight] as [number, number];
  }, place);
}

it("a paddle at the mouse pushes a ball away", async () => {
  const begin = told().ball;
  const at = await onScreen([-0.1, 0.95, begin]);
  // It moves at the depth of what the mouse pointed at first.
  const point = async () => {
    await tab.page.mouse.move(at[0] - 2, at[1]);
    await tab.goOn(0.1);
    await tab.page.mouse.move(...at);
    await tab.goOn(0.3);
  };
  await point();
  expect(told().ball, "nobody has taken it").toBe(begin);
  await tab.page.keyboard.press("h");
  await point();
  await expect.poll(() => told().ball).toBeLessThan(begin - 0.02);
  expect(told().paddles).toBe(1);
  await tab.page.keyboard.press("h");
  await expect.poll(() => told().paddles).toBe(0);
});

it("a button is in as long as the mouse button is down on it", async () => {
  await tab.page.mouse.move(...await onScreen([-0.3, 1.2, 0.05]));
  await tab.page.mouse.down();
  await expect.poll(() => told().pressed).toBe(true);
  await tab.page.mouse.up();
  await expect.poll(() => told().pressed).toBe(false);
});

it("a click flips a switch", async () => {
  await tab.page.mouse.click(...await onScreen([0, 1.178, 0.062]));
  await expect.poll(() => told().on).toBe(true);
});

it("a drawer comes towards the viewer with the mouse", async () => {
  const from = await onScreen([0.3, 1.0, 0.032]);
  const to = await onScreen([0.3, 1.0, 0.232]);
  await tab.page.mouse.move(...from);
  await tab.page.mouse.down();
  for (let share = 0.25; share <= 1; share += 0.25) await tab.page.mouse.move(from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share);
  await expect.poll(() => Math.abs(told().slide - 0.2)).toBeLessThan(0.03);
  await tab.page.mouse.up();
  expect(tab.complaints).toEqual([]);
});
