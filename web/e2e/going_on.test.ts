// SPDX-License-Identifier: Apache-2.0
// A world that is kept: a page draws it, its process is killed, and the page that comes back asks whether it goes on.

import { existsSync, mkdtempSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, small, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

const state = mkdtempSync(path.join(tmpdir(), "iota-state-"));
const kept = path.join(state, "kept");
let port: number;
let server: WorldServer;
let browser: Browser;
let tab: Tab;

const start = () => WorldServer.start(["chain", "--keep", kept], port, state);

beforeAll(async () => {
  port = await freePort();
  server = await start();
  browser = await Browser.start(small);
  tab = await browser.open(server.url);
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

const card = () => tab.page.locator("#cards .card", { has: tab.page.locator("h2:text-is('Go on where it was?')") });
const time = () => tab.page.evaluate(() => iota.page.world.time);

it("asks a host whether it goes on, with a picture of it, and begins anew if they say so", async () => {
  await expect.poll(() => existsSync(path.join(kept, "picture.png"))).toBe(true);
  await server.stop("SIGKILL");
  server = await start();
  await card().waitFor();
  const picture = card().locator("img");
  await expect.poll(() => picture.evaluate((image: HTMLImageElement) => image.naturalWidth)).toBeGreaterThan(100);
  await tab.untilShown();
  await tab.picture("going_on");
  const before = await time();
  expect(before, "since the start of the first process").toBeGreaterThan(4);
  await card().getByText("Begin anew").click();
  await expect.poll(time).toBeLessThan(before);
  expect(await card().count()).toBe(0);
});

it("does not ask those who may not reset it", async () => {
  await server.stop("SIGKILL");
  server = await start();
  const other = await browser.open(`${server.url}&role=viewer`);
  await other.page.locator("#cards .card", { hasText: "goes on where it was" }).waitFor();
  expect(await other.page.getByText("Begin anew").count()).toBe(0);
  await other.page.close();
});
