// SPDX-License-Identifier: Apache-2.0
// A phone: one finger drags a link or orbits, two pinch, a long press opens the actions.

import { afterAll, beforeAll, beforeEach, describe, expect, it } from "vitest";
import { Browser, distance, type Place, type Tab } from "./browser.ts";
import { freePort, probe, WorldServer } from "./server.ts";

let server: WorldServer;
let browser: Browser;
let tab: Tab;

beforeAll(async () => {
  server = await WorldServer.start([probe], await freePort());
  browser = await Browser.start({ width: 390, height: 844, touch: true });
  tab = await browser.open(server.url);
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

beforeEach(async () => {
  await tab.lift();
  await tab.page.keyboard.press("Escape");
  await tab.pause(false);
  await tab.reset();
});

const eye = (): Promise<number[]> => tab.page.evaluate(() => iota.page.viewer.camera.position.toArray());

describe("on a phone", () => {
  it("one finger on a link drags it", async () => {
    const body = 10;
    const [x, y] = await tab.freezeInView(body);
    await tab.touch("touchStart", [[x + 6, y]]);
    await tab.until("the link is held", (id) => iota.held === id, body);
    await tab.pause(false);
    for (let step = 1; step <= 6; step++) await tab.touch("touchMove", [await tab.slack([x + 6, y], 0.06 * step)]);
    await tab.until("the link has come to the finger", (id) => {
      const [hold] = iota.holds();
      return hold !== undefined && Math.hypot(...iota.bodyPosition(id).map((value, axis) => value - hold.target[axis])) < 0.15;
    }, body);
    await tab.picture("phone_drag");
    await tab.lift();
    await tab.until("it is let go", () => iota.held === -1 && iota.holds().length === 0);
  });

  it("a finger that rests on a link and then drags closes the actions, and sees the force", async () => {
    const body = 10;
    const [x, y] = await tab.freezeInView(body);
    await tab.touch("touchStart", [[x + 6, y]]);
    await tab.page.locator("#menu").waitFor();
    await tab.pause(false);
    for (let step = 1; step <= 3; step++) await tab.touch("touchMove", [await tab.slack([x + 6, y], 0.06 * step)]);
    expect(await tab.page.locator("#menu").isVisible()).toBe(false);
    await expect.poll(() => tab.page.locator("#hint").innerText()).toMatch(/ N$/);
    await tab.lift();
  });

  it("one finger selects several where that is switched on", async () => {
    await tab.freeze();
    await tab.page.evaluate(() => { document.getElementById("select-several")!.click(); });
    const places = await Promise.all([0, 23].map((link) => tab.place(link)));
    const [x, y] = [[0, 1].map((axis) => Math.min(...places.map((place) => place[axis])) - 60), [0, 1].map((axis) => Math.max(...places.map((place) => place[axis])) + 40)];
    await tab.touch("touchStart", [[x[0], x[1]]]);
    await tab.touch("touchMove", [[x[0] + 20, x[1] + 20]]);
    await tab.touch("touchMove", [[y[0], y[1]]]);
    await tab.lift();
    await tab.until("all links are selected", () => iota.page.selection.actionBodies.length === 24);
    await tab.page.evaluate(() => { document.getElementById("select-several")!.click(); });
  });

  it("one finger on nothing orbits, two pinch", async () => {
    await tab.freeze();
    const nothing: Place = [330, 700];
    const before = await eye();
    await tab.touch("touchStart", [nothing]);
    for (let step = 1; step <= 5; step++) await tab.touch("touchMove", [[nothing[0] - 20 * step, nothing[1]]]);
    await tab.lift();
    await tab.eyeAtRest();
    const orbited = await eye();
    expect(distance(before, orbited)).toBeGreaterThan(0.3);
    const range = async () => tab.page.evaluate(() => iota.page.viewer.camera.position.length());
    const far = await range();
    await tab.touch("touchStart", [[60, 700], [330, 700]]);
    for (let step = 1; step <= 5; step++) await tab.touch("touchMove", [[60 + 20 * step, 700], [330 - 20 * step, 700]]);
    await tab.lift();
    await tab.eyeAtRest();
    expect(await range()).toBeGreaterThan(far * 1.2);
    await tab.page.keyboard.press("Home");
    await tab.eyeAtRest();
  });

  it("a long press opens the actions, and a tap on one breaks the chain", async () => {
    const place = await tab.freezeInView(8);
    await tab.touch("touchStart", [place]);
    await tab.page.waitForSelector("#menu .action");
    await tab.lift();
    await tab.picture("phone_actions");
    const size = await tab.page.locator("#menu .action").first().boundingBox();
    expect(size?.height).toBeGreaterThanOrEqual(44);
    await tab.page.tap("#menu .action:has-text('break')");
    await tab.pause(false);
    await tab.until("there are two parts", () => new Set(iota.articulates().values()).size === 2);
    expect(tab.complaints).toEqual([]);
  });
});
