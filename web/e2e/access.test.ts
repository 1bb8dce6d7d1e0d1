// SPDX-License-Identifier: Apache-2.0
// Everybody reaches everything: by keyboard, at 200 % zoom, on a phone, and can read it.

import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Browser, type BrowserOptions, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

let server: WorldServer;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/entities_probe.py"], await freePort());
});

/** Of a test in a usual window, for the next one. */
let desk: { readonly browser: Browser; readonly tab: Tab } | null = null;

afterAll(async () => {
  await desk?.browser.stop();
  await server?.stop();
});

/** What can be pressed or changed on the page now, by what tells it from the others. */
const controls = () => [...document.querySelectorAll<HTMLElement>("button, select, input, summary")]
  .filter((element) => element.checkVisibility() && !(element as HTMLButtonElement).disabled)
  .map((element) => element.id || `${element.tagName} ${element.getAttribute("aria-label") ?? element.closest("label")?.textContent ?? element.textContent}`);

/** A page in a window, as it is at first. */
async function open(options: BrowserOptions): Promise<{ browser: Browser; tab: Tab }> {
  const browser = await Browser.start(options);
  const tab = await browser.open(server.url);
  // The panel comes with the page, but is hidden until the script's controls have come.
  await tab.until("world and controls are shown", () => !document.getElementById("view")!.classList.contains("waiting")
    && [...document.querySelectorAll("#panel:not([hidden]) button")].some(({ textContent }) => textContent === "throw"));
  // One of an error stays, however long the test takes.
  await tab.page.evaluate(() => iota.page.events.notice({ level: 2, title: "A card", text: "with some text", hint: "and what to try" }));
  return { browser, tab };
}

/** Visits the page in a browser of its own, with the script's controls and a card shown. */
async function visit(options: BrowserOptions, look: (tab: Tab) => Promise<void>): Promise<void> {
  const { browser, tab } = await open(options);
  try {
    await look(tab);
  } finally {
    await browser.stop();
  }
}

/** The same at a desk, in one page for all such tests. */
async function visitDesk(look: (tab: Tab) => Promise<void>): Promise<void> {
  desk ??= await open({ width: 1000, height: 640 });
  const { tab } = desk;
  await look(tab);
  if (await tab.page.locator("#help[open]").isVisible()) {
    await tab.page.keyboard.press("Escape");
    await tab.page.locator("#help[open]").waitFor({ state: "detached" });
  }
  await tab.page.evaluate(() => iota.select(-1));
}

/** Controls that are not wholly in the window or a part that scrolls, lie over each other, or are smaller than a finger. */
const misplaced = (least: number) => {
  const found: string[] = [];
  const boxes = [...document.querySelectorAll<HTMLElement>("#bar button, #bar select, #strip button, #cards button, #panel summary")]
    .filter((element) => element.checkVisibility()).map((element) => ({ name: element.id || element.textContent!, box: element.getBoundingClientRect() }));
  for (const { name, box } of boxes) {
    if (box.left < 0 || box.top < 0 || box.right > innerWidth + 0.5 || box.bottom > innerHeight + 0.5) found.push(`${name} is outside of the window`);
    if (box.height < least || (box.width < least && box.height < 2 * least)) found.push(`${name} is ${box.width} x ${box.height} px`);
  }
  boxes.forEach((one, index) => {
    for (const other of boxes.slice(index + 1)) {
      const across = Math.min(one.box.right, other.box.right) - Math.max(one.box.left, other.box.left);
      const down = Math.min(one.box.bottom, other.box.bottom) - Math.max(one.box.top, other.box.top);
      if (across > 0.5 && down > 0.5) found.push(`${one.name} lies over ${other.name}`);
    }
  });
  if (document.documentElement.scrollWidth > innerWidth) found.push("the page is wider than the window");
  return found;
};

/** Texts whose contrast is below 4.5 before whatever the world shows behind them. */
const faint = () => {
  const parse = (text: string) => (text.match(/[\d.]+/g) ?? []).map(Number);
  const over = ([r, g, b, a = 1]: number[], below: number[]) => [r, g, b].map((value, index) => a * value + (1 - a) * below[index]);
  const light = (color: number[]) => {
    const [r, g, b] = color.map((value) => (value / 255 <= 0.03928 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const found: string[] = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node !== null; node = walker.nextNode()) {
    const element = node.parentElement!;
    if (node.textContent!.trim() === "" || !element.checkVisibility() || element.closest("script, style, option, :disabled") !== null) continue;
    for (const world of [[0, 0, 0], [255, 255, 255]]) {
      const layers: number[][] = [];
      for (let at: HTMLElement | null = element; at !== null && at !== document.body; at = at.parentElement) layers.push(parse(getComputedStyle(at).backgroundColor));
      const behind = layers.reduceRight((below, layer) => (layer.length < 3 ? below : over(layer, below)), world);
      const ink = over(parse(getComputedStyle(element).color), behind);
      const [low, high] = [light(ink), light(behind)].sort((a, b) => a - b);
      const contrast = (high + 0.05) / (low + 0.05);
      if (contrast < 4.5) found.push(`${node.textContent!.trim().slice(0, 30)}: ${contrast.toFixed(2)} before ${world[0]}`);
    }
  }
  return found;
};

describe("the page", () => {
  it("is reached by the keyboard alone, with a ring around what has the focus", async () => {
    await visitDesk(async (tab) => {
      const wanted = new Set(await tab.page.evaluate(controls));
      expect(wanted.size).toBeGreaterThan(10);
      const unmarked: string[] = [];
      const presses = 2 * wanted.size;
      for (let press = 0; press < presses && wanted.size > 0; press++) {
        await tab.page.keyboard.press("Tab");
        const [name, ring] = await tab.page.evaluate(() => {
          const element = document.activeElement as HTMLElement;
          const style = getComputedStyle(element);
          const label = element.id || `${element.tagName} ${element.getAttribute("aria-label") ?? element.closest("label")?.textContent ?? element.textContent}`;
          return [label, style.outlineStyle !== "none" && parseFloat(style.outlineWidth) > 0] as const;
        });
        if (wanted.delete(name) && !ring) unmarked.push(name);
      }
      expect([...wanted]).toEqual([]);
      expect(unmarked).toEqual([]);
    });
  });

  it.each([false, true])("can be read before any world (dark: %s)", async (dark) => {
    await visitDesk(async (tab) => {
      await tab.page.emulateMedia({ colorScheme: dark ? "dark" : "light" });
      await tab.page.keyboard.press("?");
      await tab.page.locator("#help[open]").waitFor();
      await tab.untilShown();
      expect(await tab.page.evaluate(faint)).toEqual([]);
    });
  });

  it("tells a screen reader what each of its controls, panels and pictures is", async () => {
    await visitDesk(async (tab) => {
      await tab.page.evaluate(() => iota.select(iota.bodies()[0]));
      await tab.page.keyboard.press("?");
      await tab.page.locator("#help[open]").waitFor();
      const cdp = await tab.page.context().newCDPSession(tab.page);
      const { nodes } = await cdp.send("Accessibility.getFullAXTree");
      const named = ["button", "slider", "checkbox", "combobox", "textbox", "dialog", "toolbar", "img", "image", "menu", "Canvas", "DisclosureTriangle"];
      const seen = nodes.filter(({ ignored, role }) => !ignored && named.includes(String(role?.value)));
      // While the dialog is open, the rest is out of reach; both are looked at.
      await tab.page.keyboard.press("Escape");
      await tab.page.locator("#help[open]").waitFor({ state: "detached" }).catch(() => {});
      const { nodes: others } = await cdp.send("Accessibility.getFullAXTree");
      seen.push(...others.filter(({ ignored, role }) => !ignored && named.includes(String(role?.value))));
      const roles = new Set(seen.map(({ role }) => String(role?.value)));
      for (const role of ["button", "slider", "checkbox", "combobox", "textbox", "dialog", "toolbar"]) expect(roles, role).toContain(role);
      expect(seen.filter(({ name }) => String(name?.value ?? "").trim() === "").map(({ role, backendDOMNodeId }) => `${String(role?.value)} ${backendDOMNodeId}`)).toEqual([]);
    });
  });

  it.each([["at 200 % zoom", { width: 500, height: 320 }], ["on a phone", { width: 390, height: 844, touch: true }]])("has its help, its script's controls and its cards wholly in the window, or they scroll: %s", async (_, options) => {
    await visit(options, async (tab) => {
      const outside = (selector: string) => tab.page.evaluate((chosen) => {
        const found: string[] = [];
        const element = document.querySelector<HTMLElement>(chosen)!;
        const { left, top, right, bottom } = element.getBoundingClientRect();
        if (left < -0.5 || top < -0.5 || right > innerWidth + 0.5 || bottom > innerHeight + 0.5) found.push(`${chosen}: ${[left, top, right, bottom].map(Math.round).join(" ")}`);
        const scrolls = (each: HTMLElement) => ["auto", "scroll"].includes(getComputedStyle(each).overflowY);
        if (element.scrollHeight > element.clientHeight + 2 && ![element, ...element.querySelectorAll<HTMLElement>("*")].some(scrolls)) found.push(`${chosen} is cut off`);
        return found;
      }, selector);
      await tab.untilShown();
      const panel = tab.page.locator("#panel");
      if (!(await panel.evaluate((element) => (element as HTMLDetailsElement).open))) await panel.locator("summary").click();
      await tab.untilShown();
      expect(await outside("#panel")).toEqual([]);
      expect(await outside("#cards .card")).toEqual([]);
      await tab.page.keyboard.press("?");
      await tab.page.locator("#help[open]").waitFor();
      await tab.untilShown();
      expect(await outside("#help")).toEqual([]);
    });
  });

  it.each([["at 200 % zoom", { width: 640, height: 360 }, 24], ["on a phone", { width: 390, height: 844, touch: true }, 40], ["on a phone that lies", { width: 844, height: 390, touch: true }, 40]])("has all its controls %s", async (name, options, least) => {
    await visit(options, async (tab) => {
      await tab.untilShown();
      await tab.picture(`page_access_${name.replaceAll(/\W+/g, "_")}`);
      expect(await tab.page.evaluate(misplaced, least)).toEqual([]);
    });
  });
});
