// SPDX-License-Identifier: Apache-2.0
// The study itself, with its timed break; the server killed and started again.

import { mkdtempSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Browser, small, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

const state = mkdtempSync(path.join(tmpdir(), "iota-state-"));
let port: number;
let server: WorldServer;
let browser: Browser;
let tab: Tab;

beforeAll(async () => {
  port = await freePort();
  server = await WorldServer.start(["chain"], port, state);
  browser = await Browser.start(small);
  tab = await browser.open(server.url);
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

describe("iota run chain", () => {
  it("falls apart and mends itself when it is asked to", async () => {
    await tab.page.keyboard.press("t");
    await tab.until("the chain falls apart", () => new Set(iota.articulates().values()).size === 2);
    await tab.until("the chain is whole again", () => new Set(iota.articulates().values()).size === 1);
  });

  it("is found again by an open page after the server was killed", async () => {
    await server.stop("SIGKILL");
    await tab.until("the page says so", () => !iota.connected && document.querySelector("#cards .card") !== null);
    await tab.untilShown();
    await tab.picture("server_gone");
    expect(await tab.page.evaluate(() => document.querySelector("#view")?.classList.contains("away"))).toBe(true);
    server = await WorldServer.start(["chain"], port, state);
    await tab.until("the page is back", () => iota.connected && iota.step > 5 && iota.time < 15);
    await tab.until("the card is gone", () => document.querySelector("#cards .card") === null);
    expect(await tab.page.evaluate(() => iota.bodies().length)).toBe(24);
    const before = await tab.page.evaluate(() => iota.step);
    await tab.until("the world moves", (was) => iota.step > was + 20, before);
  });

  it("takes the token out of the address bar, and a reload still knows it", async () => {
    expect(tab.page.url()).not.toContain("token");
    await tab.page.reload();
    await tab.until("the page is back", () => globalThis.iota?.connected && iota.step > 0);
    expect(tab.page.url()).not.toContain("token");
  });

  it("says why when the address has no valid token", async () => {
    const page = await browser.context.newPage();
    await page.goto(server.url.replace(/token=.*/, "token=wrong"));
    await page.waitForSelector(".card.error");
    expect(await page.textContent(".card.error")).toMatch(/token/);
    expect(await page.locator("#welcome").isVisible(), "it would lie on the card").toBe(false);
    await page.close();
  });
});
