// SPDX-License-Identifier: Apache-2.0
// Nothing of the page lies on what it is about: the panel and the bar on bodies, cards on each other, a label on the next control.

import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

let server: WorldServer;
let browser: Browser;
let tab: Tab;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/cover_probe.py"], await freePort());
  browser = await Browser.start({ width: 1280, height: 720, density: 0.5 });
  tab = await browser.open(server.url);
  await tab.page.locator("#panel").waitFor();
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

async function resize(width: number, height: number): Promise<void> {
  await tab.page.setViewportSize({ width, height });
  await tab.until("the picture has the window's form", ([wide, high]) => Math.abs(iota.page.viewer.camera.aspect - wide / high) < 0.01, [width, height] as const);
  await tab.eyeAtRest();
}

/** Bodies whose middle a press does not hit. */
const covered = () => tab.page.evaluate(() => iota.bodies().filter((body) => {
  const at = iota.screenPosition(body);
  return at === null || document.elementFromPoint(...at)?.id !== "view";
}));

it("the panel covers no body in the first view", async () => {
  for (const [width, height] of [[1280, 720], [1000, 600]] as const) {
    await resize(width, height);
    expect(await covered(), `${width}`).toEqual([]);
  }
});

it("the buttons for a selected body do not cover it in a low window, and the last of them can be reached", async () => {
  for (const [width, height] of [[900, 500], [700, 450], [600, 400], [500, 350], [844, 390]] as const) {
    await resize(width, height);
    for (const body of await tab.page.evaluate(() => iota.bodies())) {
      await tab.page.evaluate((chosen) => iota.select(chosen), body);
      await tab.page.locator("#strip .about").waitFor();
      expect(await covered(), `${width}, ${body} selected`).toEqual([]);
    }
    await tab.page.mouse.move(5, 5); // an idle page hides them
    const last = tab.page.locator("#strip .action").last();
    await last.scrollIntoViewIfNeeded();
    await last.click({ trial: true });
    await tab.page.evaluate(() => iota.select(-1));
  }
});

it("cards lie on no other card", async () => {
  for (const [width, height] of [[1280, 720], [800, 500], [390, 844]] as const) {
    await resize(width, height);
    await tab.page.keyboard.press("6");
    await tab.page.locator('#cards h2:text-is("Card 5")').waitFor();
    const boxes = await tab.page.evaluate(() => [...document.querySelectorAll("#cards .card")].map((card) => card.getBoundingClientRect().toJSON() as DOMRect));
    expect(boxes.length).toBeGreaterThan(1);
    for (const [index, one] of boxes.entries()) {
      for (const other of boxes.slice(index + 1)) {
        const apart = one.left >= other.right || one.right <= other.left || one.top >= other.bottom || one.bottom <= other.top;
        expect(apart, `${width}: ${JSON.stringify([one, other])}`).toBe(true);
      }
    }
    await tab.page.evaluate(() => document.querySelectorAll<HTMLElement>("#cards [aria-label=Close]").forEach((close) => close.click()));
  }
});

it("a long label of a button stays within the button", async () => {
  await resize(1280, 720);
  const { inner, outer } = await tab.page.locator("#panel .press").evaluate((button) => ({ inner: button.scrollHeight, outer: button.clientHeight }));
  expect(inner).toBeLessThanOrEqual(outer);
  expect(outer, "more than one line").toBeGreaterThan(45);
  expect(tab.complaints).toEqual([]);
});
