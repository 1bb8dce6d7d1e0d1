// SPDX-License-Identifier: Apache-2.0
// The size of a page on the wire, and the time to its first paint; figures in build/artifacts/first_paint.json.

import { mkdirSync, writeFileSync } from "node:fs";
import path from "node:path";
import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, small } from "./browser.ts";
import { artifacts, freePort, probe, WorldServer } from "./server.ts";

declare global {
  // Frames in which the described world was not shown yet.
  var framesHidden: number;
}

let server: WorldServer;
let browser: Browser;

beforeAll(async () => {
  server = await WorldServer.start([probe], await freePort());
  browser = await Browser.start({ ...small, draws: "always" });
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

it("is under 170 kB on the wire, from one server, and shows something within a second", async () => {
  const page = await browser.context.newPage();
  const cdp = await browser.context.newCDPSession(page);
  await cdp.send("Network.enable");
  const bytes = new Map<string, number>();
  const urls = new Map<string, string>();
  cdp.on("Network.responseReceived", ({ requestId, response }) => urls.set(requestId, response.url));
  cdp.on("Network.loadingFinished", ({ requestId, encodedDataLength }) => bytes.set(requestId, encodedDataLength));
  await page.goto(server.url);
  await page.waitForFunction(() => globalThis.iota?.connected && !document.getElementById("view")!.classList.contains("waiting"), null, { polling: 20 });
  const { paint, drawn } = await page.evaluate(() => ({
    paint: performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? Infinity, drawn: performance.now(),
  }));
  const total = [...bytes.values()].reduce((sum, size) => sum + size, 0);
  const files = Object.fromEntries([...bytes].map(([id, size]) => [new URL(urls.get(id)!).pathname, size]));
  mkdirSync(artifacts, { recursive: true });
  writeFileSync(path.join(artifacts, "first_paint.json"), `${JSON.stringify({ paint_ms: paint, world_drawn_ms: drawn, bytes: total, files }, null, 2)}\n`);
  for (const url of urls.values()) expect(new URL(url).origin).toBe(new URL(server.url).origin);
  expect(total, JSON.stringify(files)).toBeLessThan(170_000);
  // A busy machine may be slow once.
  if (paint > 1000) await page.reload({ waitUntil: "load" });
  const again = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? Infinity);
  expect(Math.min(paint, again), "first paint, ms").toBeLessThan(1000);
  await page.close();
});

it("says that it opens the world, above a moving bar, until the world is drawn", async () => {
  const page = await browser.context.newPage();
  let pass = (): void => undefined;
  const passed = new Promise<void>((resolve) => {
    pass = resolve;
  });
  await page.route("**/*.js", async (route) => {
    await passed;
    await route.continue();
  });
  await page.goto(`${server.url}&shadows=none`, { waitUntil: "commit" });
  const loading = page.locator("#loading");
  await loading.waitFor();
  expect(await loading.textContent()).toBe("Opening the world");
  expect((await loading.locator("span").boundingBox())!.width).toBeGreaterThan(100);
  const moving = await page.evaluate(() => document.getAnimations().map(({ effect }) => (effect as KeyframeEffect).pseudoElement));
  expect(moving).toContain("::before");
  pass();
  await page.waitForFunction(() => globalThis.iota?.connected && iota.bodies().length > 0 && iota.step > 0);
  await loading.waitFor({ state: "hidden" });
  await page.close();
});

it("shows the world a few frames after its first poses, at once and not slowly", async () => {
  const page = await browser.context.newPage();
  await page.addInitScript(() => {
    globalThis.framesHidden = 0;
    const look = () => {
      const isHidden = document.getElementById("view")?.classList.contains("waiting") ?? true;
      if (globalThis.iota?.page.world.described && isHidden) globalThis.framesHidden++;
      requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  });
  await page.goto(server.url);
  await page.waitForFunction(() => globalThis.iota?.connected && !document.getElementById("view")!.classList.contains("waiting"));
  const { hidden, eased } = await page.evaluate(() => ({ hidden: framesHidden, eased: getComputedStyle(document.getElementById("view")!).transitionProperty }));
  expect(hidden).toBeLessThan(4);
  expect(eased).not.toMatch(/opacity|all/);
  await page.close();
});

it("paints before it prepares to draw, which takes long in software", async () => {
  const page = await browser.context.newPage();
  await page.addInitScript(() => {
    const own = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (this: HTMLCanvasElement, ...given: Parameters<typeof own>) {
      performance.mark("context");
      return own.apply(this, given);
    } as typeof own;
  });
  // A busy machine shows the first picture some frames later, but not each time.
  let earliest = Infinity;
  for (let trial = 0; trial < 3 && !(earliest < 0); trial++) {
    await page.goto(`${server.url}&shadows=none`);
    await page.waitForFunction(() => globalThis.iota?.connected && performance.getEntriesByName("first-contentful-paint").length > 0);
    const { paint, context } = await page.evaluate(() => ({
      paint: performance.getEntriesByName("first-contentful-paint")[0].startTime, context: performance.getEntriesByName("context")[0].startTime,
    }));
    earliest = Math.min(earliest, paint - context);
    await page.goto("about:blank");
  }
  expect(earliest, "first paint after the context, ms").toBeLessThan(0);
  await page.close();
});
