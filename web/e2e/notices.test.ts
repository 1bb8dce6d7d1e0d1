// SPDX-License-Identifier: Apache-2.0
// Cards of the script, with a place, a time and an id; and the budget of a step.

import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

let server: WorldServer;
let browser: Browser;
let tab: Tab;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/notices_probe.py"], await freePort());
  browser = await Browser.start({ width: 1000, height: 600, density: 1, draws: "asked" });
  tab = await browser.open(`${server.url}&name=Ada`);
  await tab.page.locator("#panel").waitFor();
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

const card = (title: string) => tab.page.locator("#cards .card", { has: tab.page.locator(`h2:text-is("${title}")`) });

it("cards lie on no label and no control, at any size of the window", async () => {
  for (const [width, height] of [[1000, 600], [640, 480], [390, 844]] as const) {
    await tab.page.setViewportSize({ width, height });
    await tab.until("the picture has the window's form", ([wide, high]) => Math.abs(iota.page.viewer.camera.aspect - wide / high) < 0.01, [width, height] as const);
    await tab.eyeAtRest();
    await tab.page.keyboard.press("1");
    await card("Free").waitFor();
    await tab.untilShown();
    const { box, others, label } = await tab.page.evaluate(() => {
      const others = [...document.querySelectorAll("#panel, #bar")].map((element) => element.getBoundingClientRect().toJSON() as DOMRect);
      const { label } = iota.page.world.entities;
      let shown: number[] = [];
      label.forEachBox(iota.page.viewer.camera, (left, top, wide, high) => { shown = [left, top, left + wide, top + high]; });
      return { box: document.querySelector("#cards .card")!.getBoundingClientRect().toJSON() as DOMRect, others, label: shown };
    });
    const all = [...others.map(({ left, top, right, bottom }) => [left, top, right, bottom]), label];
    for (const [left, top, right, bottom] of all) {
      const apart = box.left >= right || box.right <= left || box.top >= bottom || box.bottom <= top;
      expect(apart, `${width}: ${JSON.stringify(box)} on ${JSON.stringify([left, top, right, bottom])}`).toBe(true);
    }
    expect(label[3] - label[1], "a label is there").toBeGreaterThan(10);
    await tab.picture(`notices_${width}`);
    await tab.page.click("#cards .card button");
  }
  await tab.page.setViewportSize({ width: 1000, height: 600 });
});

it("cards are where the script says, are replaced and closed by their id, and go after their time", async () => {
  const { keyboard } = tab.page;
  await keyboard.press("2");
  await card("Left").waitFor();
  expect((await card("Left").boundingBox())!.x).toBeLessThan(40);
  await keyboard.press("3");
  await card("Left again").waitFor();
  expect(await card("Left").count()).toBe(0);
  expect((await card("Left again").boundingBox())!.y).toBeGreaterThan(300);
  await keyboard.press("4");
  await card("Left again").waitFor({ state: "detached" });
  await keyboard.press("5");
  await card("Soon over").waitFor();
  await card("Soon over").waitFor({ state: "detached", timeout: 3000 });
});

it("a user is shown the budget of a step, and bodies in the color of their level, by a key", async () => {
  await tab.until("the script knows where this user is", () => iota.page.world.people.length === 1);
  expect(await tab.page.locator("#meter").isVisible()).toBe(false);
  await tab.page.keyboard.press("i");
  await expect.poll(() => tab.page.textContent("#meter")).toMatch(/budget [^]* of 1000 ms[^]*6 full/);
  await tab.page.keyboard.press("6");
  await expect.poll(() => tab.page.textContent("#meter")).toMatch(/of 0.001 ms[^]*3 frozen[^]* to frozen, /);
  const tinted = () => tab.page.evaluate(() => {
    const { tintGoal_: goal } = iota.page.world.entities.body as unknown as { tintGoal_: Float32Array };
    return iota.bodies().map((body) => goal[4 * body + 3] > 0.5);
  });
  await expect.poll(tinted).toEqual([false, false, false, true, true, true]);
  await tab.picture("budget");
  await tab.page.keyboard.press("i");
  await expect.poll(tinted).not.toContain(true);
});

it("a user can say a name, which others see and the browser keeps", async () => {
  const other = await browser.open(server.url);
  await other.page.locator("#people").waitFor();
  expect(await other.page.evaluate(() => iota.page.world.clients.map(({ name }) => name).sort())).toEqual(["", "Ada"]);
  await other.page.keyboard.press(",");
  await other.page.fill("#own-name", "Grace");
  await other.page.keyboard.press("Enter");
  await tab.until("it has the name", () => iota.page.world.clients.some(({ name }) => name === "Grace"));
  const colors = await other.page.evaluate(() => [...document.querySelectorAll<HTMLElement>("#people-list .swatch")].map(({ style }) => style.background));
  expect(new Set(colors).size).toBe(2);
  await other.picture("people_list");
  await other.page.reload();
  await tab.until("it still has", () => iota.page.world.clients.length === 2 && iota.page.world.clients.some(({ name }) => name === "Grace"));
  expect(tab.complaints).toEqual([]);
});
