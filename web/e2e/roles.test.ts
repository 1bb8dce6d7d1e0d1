// SPDX-License-Identifier: Apache-2.0
// A host, a guest and a viewer of one world: each finds what they may do, is told why not, and the host sends others away.

import { mkdirSync, writeFileSync } from "node:fs";
import path from "node:path";
import { afterAll, beforeAll, expect, it, vi } from "vitest";
import { Browser, distance, type Tab } from "./browser.ts";
import { HeadsetTab } from "./headset.ts";
import { artifacts, freePort, WorldServer } from "./server.ts";

let server: WorldServer;
const browsers: Browser[] = [];
let host: Tab;
let guest: Tab;
let viewer: Tab;

async function come(url: string, name: string): Promise<Tab> {
  // One each, as a browser stops the frames of a tab behind another one.
  const browser = await Browser.start({ width: 1000, height: 560, density: 1 });
  browsers.push(browser);
  const tab = await browser.open(`${url}&name=${name}`);
  await tab.page.locator("#panel .press").waitFor();
  return tab;
}

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/roles_probe.py"], await freePort());
  host = await come(server.url, "Hana");
  await vi.waitFor(() => expect(server.reports.length).toBeGreaterThan(0), 30_000);
  const links = server.reports[0] as { guest: string; viewer: string };
  guest = await come(links.guest, "Gil");
  viewer = await come(links.viewer, "Vera");
  for (const tab of [host, guest, viewer]) await tab.until("it knows all three", () => iota.clients().length === 3);
});

afterAll(async () => {
  for (const browser of browsers) await browser.stop();
  await server?.stop();
});

/** What can be pressed or changed, and the titles of what cannot. */
const controls = (tab: Tab) => tab.page.evaluate(() => {
  const all = [...document.querySelectorAll<HTMLButtonElement | HTMLSelectElement | HTMLInputElement>("#bar button, #bar select, #strip button, #panel button, #panel input")]
    .filter((element) => element.checkVisibility());
  const nameOf = (element: HTMLElement) => element.id || (element.closest("label")?.querySelector(".name") ?? element).firstChild!.textContent!;
  return {
    usable: all.filter((element) => !element.disabled).map(nameOf),
    refused: Object.fromEntries(all.filter((element) => element.disabled).map((element) => [nameOf(element), element.title || element.closest("label")!.title])),
  };
});

/** Selects the ball, so that its action is shown, with the mouse over the bar, which then stays. */
async function look(tab: Tab, name: string): Promise<Awaited<ReturnType<typeof controls>>> {
  await tab.page.evaluate(() => iota.select(iota.bodies()[0]));
  await tab.page.locator("#strip button").waitFor();
  await tab.page.mouse.move(300, 40);
  await tab.page.mouse.move(310, 40);
  await tab.untilShown();
  await tab.picture(`roles_${name}`);
  return controls(tab);
}

it("shows a host all controls as usable", async () => {
  const { usable, refused } = await look(host, "host");
  expect(refused).toEqual({});
  expect(usable).toEqual(expect.arrayContaining(["play", "step", "reset", "speed", "people", "open-help", "Push", "force", "again"]));
});

it("shows a guest that pause, step, reset and speed are the host's, and leaves the script's controls", async () => {
  const { usable, refused } = await look(guest, "guest");
  expect(refused).toEqual({
    play: "Pause: Only the host does that", step: "Single step: Only the host does that", reset: "Reset: Only the host does that",
    speed: "Speed ([ and ]): Only the host does that",
  });
  expect(usable).toEqual(expect.arrayContaining(["people", "open-help", "Push", "force", "again"]));
  await guest.page.keyboard.press(" ");
  await guest.page.getByText("Only the host does that").waitFor();
  await guest.page.keyboard.press("b");
  await expect.poll(() => server.reports.filter((report) => "pushed_by" in report).length).toBe(1);
  expect(await guest.page.evaluate(() => iota.paused)).toBe(false);
});

it("shows a viewer that they watch: no control but those of their own view", async () => {
  const { usable, refused } = await look(viewer, "viewer");
  expect(new Set(Object.keys(refused))).toEqual(new Set(["play", "step", "reset", "speed", "Push", "force", "again"]));
  expect(new Set(Object.values(refused).map((title) => title.replace(/^.*: /, "")))).toEqual(new Set(["You only watch this world"]));
  expect(usable).toEqual(["people", "open-help"]);
  await viewer.page.keyboard.press("b");
  await viewer.page.getByText("You only watch this world").first().waitFor();
  await viewer.page.keyboard.press("?");
  await viewer.page.locator("#help[open]").waitFor();
  await viewer.untilShown();
  await viewer.picture("roles_viewer_help");
  const help = await viewer.page.locator("#help").innerText();
  for (const missing of ["pause", "reset", "pulls", "Push", "slower"]) expect(help).not.toContain(missing);
  await viewer.page.keyboard.press("Escape");
});

it("lets a viewer turn the view by a drag on a body, which stays where it is, and select it by a click", async () => {
  const [body] = await viewer.page.evaluate(() => iota.bodies());
  await viewer.page.evaluate(() => iota.select(-1));
  const at = await viewer.place(body);
  const [before, eye] = [await viewer.position(body), await viewer.eyeAtRest()];
  await viewer.page.mouse.move(...at);
  await viewer.page.mouse.down();
  await viewer.page.mouse.move(at[0] + 120, at[1], { steps: 4 });
  await viewer.until("the view turns", (from) => Math.hypot(...iota.page.viewer.camera.position.toArray().map((value, axis) => value - from[axis])) > 0.2, eye);
  await viewer.page.mouse.up();
  expect(await viewer.page.evaluate(() => [iota.held, iota.holds().length])).toEqual([-1, 0]);
  expect(distance(await viewer.position(body), before)).toBeLessThan(1e-3);
  await viewer.page.evaluate(() => iota.select(-1));
  await viewer.clickAt(await viewer.place(body));
  await viewer.until("it is selected", (id) => iota.selected === id, body);
});

it("dims what a viewer may not do on the wrist panel of a headset, where a press tells why", async () => {
  const browser = await Browser.start({ width: 400, height: 224 });
  browsers.push(browser);
  const { viewer: link } = server.reports[0] as { viewer: string };
  const me = await HeadsetTab.open(browser, `${link}&name=Vic`);
  await me.enter();
  await me.lookAtWrist();
  const picture = await me.tab.page.evaluate(() => (iotaXR!.headset.panel.board.mesh.material.map!.image as HTMLCanvasElement).toDataURL("image/png"));
  mkdirSync(artifacts, { recursive: true });
  writeFileSync(path.join(artifacts, "roles_wrist.png"), Buffer.from(picture.split(",")[1], "base64"));
  const refused = await me.tab.page.evaluate(() => {
    const { board, layout } = iotaXR!.headset.panel;
    const names: string[] = [];
    layout.buttons.forEach(({ command }, index) => {
      if ((command.refusal?.() ?? "") === "" && command.enabled?.() !== false) return;
      names.push(command.name);
      board.press(index);
    });
    return names;
  });
  expect(new Set(refused)).toEqual(new Set(["play", "step", "reset", "slower", "faster", "action push", "less force", "more force", "control again"]));
  await me.tab.page.getByText("You only watch this world").waitFor({ state: "attached" });
  expect(await host.page.evaluate(() => iota.paused)).toBe(false);
  expect(server.reports.filter((report) => !("guest" in report) && !("pushed_by" in report))).toEqual([]);
  await browser.stop();
  await host.until("Vic has left", () => iota.clients().length === 3);
});

it("shows the list of people wholly in the window of a phone", async () => {
  const browser = await Browser.start({ width: 390, height: 700, density: 1, touch: true });
  browsers.push(browser);
  const tab = await browser.open(`${server.url}&name=${"Somebody with a very long name ".repeat(2)}`);
  await tab.page.locator("#panel").waitFor();
  await tab.page.evaluate(() => document.getElementById("welcome")!.classList.remove("gone"));
  await tab.until("the welcome is beside the controls", () => {
    const [welcome, panel] = ["welcome", "panel"].map((id) => document.getElementById(id)!.getBoundingClientRect());
    return welcome.height > 0 && (welcome.right <= panel.left || welcome.top >= panel.bottom);
  });
  // A touch brings the bar back.
  await tab.page.touchscreen.tap(30, 400);
  await tab.page.tap("#people");
  await tab.page.locator("#people-list button").first().waitFor();
  await tab.untilShown();
  await tab.picture("roles_people_phone");
  const { left, top, right, bottom } = await tab.page.locator("#people-list").evaluate((element) => element.getBoundingClientRect().toJSON() as DOMRect);
  expect([left >= 0, top >= 0, right <= 390, bottom <= 700]).toEqual([true, true, true, true]);
  const low = await tab.page.locator("#people-list button").evaluateAll((buttons) => buttons.filter((button) => button.getBoundingClientRect().right > innerWidth).length);
  expect(low, "buttons beyond the edge").toBe(0);
  await browser.stop();
  await host.until("it has left", () => iota.clients().length === 3);
});

it("lets the host send a guest away by two presses, whose page then stays away", async () => {
  await guest.press("#people");
  await guest.page.locator("#people-list").waitFor();
  expect(await guest.page.locator("#people-list").innerText()).toMatch(/Hana\s+host\s+guest, you\s+Vera\s+watches/);
  expect(await guest.page.inputValue("#own-name")).toBe("Gil");
  expect(await guest.page.locator("#people-list button").count()).toBe(0);
  await guest.picture("roles_people_of_guest");
  await host.press("#people");
  const away = host.page.getByRole("button", { name: "Send away: Gil" });
  await away.waitFor();
  await host.untilShown();
  await host.picture("roles_people");
  await away.click();
  const sure = host.page.getByRole("button", { name: "Press again to send away: Gil" });
  await sure.waitFor();
  expect(await host.page.evaluate(() => iota.clients().length), "one press is not enough").toBe(3);
  await sure.click();
  await host.until("Gil is gone", () => iota.clients().length === 2);
  await guest.page.getByText("the host has sent you away").waitFor();
  await guest.picture("roles_sent_away");
  // Longer than the longest pause between two attempts.
  await guest.page.waitForTimeout(6000);
  expect(await host.page.evaluate(() => iota.clients().map(({ name }) => name))).toEqual(["Hana", "Vera"]);
  expect(await host.page.locator("#people-list").innerText()).not.toContain("Gil");
  expect(host.complaints).toEqual([]);
});
