// SPDX-License-Identifier: Apache-2.0
// Each panel of the page and of the headset is as the kept one, e2e/kept/panel_*.png.

import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Browser, type BrowserOptions, type Tab } from "./browser.ts";
import { HeadsetTab } from "./headset.ts";
import { addressOf, compare, expectKept, isAlike, type Grid } from "./kept.ts";
import { freePort, probe, WorldServer } from "./server.ts";

/** About one button to a cell. */
const barGrid: Grid = [6, 1];

let chain: WorldServer;
let things: WorldServer;

beforeAll(async () => {
  chain = await WorldServer.start([probe], await freePort());
  things = await WorldServer.start(["web/e2e/entities_probe.py"], await freePort());
});

afterAll(async () => {
  await leaveAll();
  await chain?.stop();
  await things?.stop();
});

/** Without the world behind it, and without times, which differ. */
const alone = "#view, #away { visibility: hidden } body { background: #8a8f94 !important } #meter { color: transparent !important }";

async function panel(tab: Tab, selector: string): Promise<string> {
  await tab.untilShown();
  const png = await tab.page.locator(selector).screenshot({ animations: "disabled", caret: "hide" });
  return `data:image/png;base64,${png.toString("base64")}`;
}

/** A page for all tests of a world with the same window. */
interface Visited {
  readonly browser: Browser;
  readonly tab: Tab;
}
const visited = new Map<string, Visited>();

async function leaveAll(): Promise<void> {
  for (const { browser } of visited.values()) await browser.stop();
  visited.clear();
}

async function open(server: WorldServer, options: BrowserOptions): Promise<Visited> {
  const browser = await Browser.start({ ...options, density: 1 });
  const tab = await browser.open(server.url);
  await tab.drawn();
  await tab.page.evaluate((rules) => {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(rules);
    document.adoptedStyleSheets = [sheet];
  }, alone);
  return { browser, tab };
}

async function visit(server: WorldServer, { dark, ...options }: BrowserOptions, look: (tab: Tab) => Promise<void>): Promise<void> {
  const key = JSON.stringify([server.port, options]);
  // The pictures are of a world without other pages, which the bar would show.
  if (!visited.has(key)) await leaveAll();
  const { tab } = visited.get(key) ?? visited.set(key, await open(server, options)).get(key)!;
  await tab.page.emulateMedia({ colorScheme: dark === true ? "dark" : "light" });
  // The world at its start, so that plots are empty and all is whole.
  await tab.pause(true);
  await tab.reset();
  await look(tab);
  expect(tab.complaints).toEqual([]);
  await tab.page.keyboard.press("Escape");
  await tab.page.evaluate(() => {
    iota.select(-1);
    for (const close of document.querySelectorAll<HTMLElement>("#cards .card button[aria-label=Close]")) close.click();
  });
  await goOn(tab);
}

/** The next page waits for a world that has begun. */
async function goOn(tab: Tab): Promise<void> {
  await tab.pause(false);
  await tab.until("the world has begun", () => iota.step > 0);
}

describe("the page", () => {
  it.each([["light", false, 1000, 640], ["dark", true, 1000, 640], ["phone", false, 390, 844]] as const)("has its bar, actions, help and card as they were: %s", async (name, dark, width, height) => {
    await visit(chain, { width, height, dark, touch: name === "phone" }, async (tab) => {
      const seen = async (what: string, selector: string, grid: Grid) => expectKept(tab, `panel_${what}_${name}`, () => panel(tab, selector), grid);
      await tab.page.mouse.move(300, 40);
      await tab.page.locator("#bar button:visible").first().waitFor();
      await seen("bar", "#bar", barGrid);
      await tab.page.evaluate(() => iota.select(iota.bodies()[5]));
      await tab.page.locator("#strip button").first().waitFor();
      await seen("actions", "#strip", [4, 1]);
      await tab.page.keyboard.press("?");
      await tab.page.locator("#help[open]").waitFor();
      await seen("help", "#help", [6, 8]);
      await tab.page.keyboard.press("Escape");
      await tab.page.evaluate(() => iota.page.events.notice({ level: 2, title: "The action 'push' failed", text: "ZeroDivisionError: division by zero (chain.py, line 12)", hint: "The world continues." }));
      await seen("card", "#cards .card", [6, 3]);
    });
  });

  it.each([["light", false], ["dark", true]] as const)("has the script's controls and plot as they were: %s", async (name, dark) => {
    await visit(things, { width: 1000, height: 640, dark }, async (tab) => {
      await tab.page.locator("#panel").getByRole("img", { name: "Plot of wave" }).waitFor();
      await expectKept(tab, `panel_controls_${name}`, () => panel(tab, "#panel"), [4, 8]);
    });
  });

  it("shows a menu at a body after a long press of a finger", async () => {
    await visit(chain, { width: 390, height: 844, touch: true }, async (tab) => {
      // A finger needs the world, which the picture is without.
      const hidden = await tab.page.evaluateHandle(() => document.adoptedStyleSheets.splice(0));
      await tab.touch("touchStart", [await tab.freezeInView(5)]);
      await tab.page.waitForSelector("#menu .action");
      await tab.lift();
      await tab.page.evaluate((sheets) => void document.adoptedStyleSheets.push(...sheets), hidden);
      await expectKept(tab, "panel_menu", () => panel(tab, "#menu"), [2, 2]);
    });
  });
});

it("a panel that lacks a button is noticed", async () => {
  await visit(chain, { width: 1000, height: 640 }, async (tab) => {
    await tab.page.mouse.move(300, 40);
    await tab.page.locator("#bar button:visible").first().waitFor();
    const alike = async () => isAlike(await compare(tab, addressOf("panel_bar_light"), await panel(tab, "#bar"), barGrid));
    await expect.poll(alike).toBe(true);
    await tab.page.evaluate(() => {
      document.getElementById("step")!.style.visibility = "hidden";
    });
    expect(await alike()).toBe(false);
  });
});

describe("the headset", () => {
  beforeAll(leaveAll);

  it.each([["actions", () => chain], ["controls", () => things]] as const)("has its wrist panel as it was: %s", async (name, server) => {
    const browser = await Browser.start({ width: 400, height: 224 });
    const me = await HeadsetTab.open(browser, server().url);
    try {
      await me.tab.pause(true);
      await me.tab.reset();
      await me.enter();
      await me.lookAtWrist();
      await expectKept(me.tab, `panel_wrist_${name}`, () => me.tab.page.evaluate(() => {
        const { map } = iotaXR!.headset.panel.board.mesh.material;
        return (map!.image as HTMLCanvasElement).toDataURL("image/png");
      }), [8, 8]);
    } finally {
      await goOn(me.tab);
      await browser.stop();
    }
  });
});
