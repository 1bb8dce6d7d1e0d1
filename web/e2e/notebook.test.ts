// SPDX-License-Identifier: Apache-2.0
// A world in a cell of a notebook: a frame in a page of another port.

import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Browser } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

let notebook: WorldServer;
let browser: Browser;

beforeAll(async () => {
  notebook = await WorldServer.start(["web/e2e/notebook_probe.py"], await freePort());
  browser = await Browser.start({ width: 640, height: 520 });
});

afterAll(async () => {
  await browser?.stop();
  await notebook?.stop();
});

describe("a cell of a notebook", () => {
  it("shows a world that lives and can be held", async () => {
    const page = await browser.context.newPage();
    await page.goto(notebook.url);
    await expect.poll(() => page.frames().length).toBe(2);
    const frame = page.frames()[1];
    await frame.waitForFunction(() => globalThis.iota?.connected && !document.getElementById("view")!.classList.contains("waiting"));
    await frame.waitForFunction(() => iota.step > 120);
    await page.mouse.move(300, 300);
    await frame.evaluate(() => iota.page.commands.run("play"));
    await frame.waitForFunction(() => iota.paused);
    // The drawn poses come to rest a little later.
    await expect.poll(() => frame.evaluate(async () => {
      const before = iota.bodyPosition(5).join();
      for (let count = 0; count < 3; count++) await new Promise(requestAnimationFrame);
      return iota.bodyPosition(5).join() === before;
    })).toBe(true);
    const [x, y] = await frame.evaluate(() => iota.screenPosition(5)!);
    const box = (await page.locator("iframe").boundingBox())!;
    await page.mouse.move(box.x + x, box.y + y);
    await page.mouse.down();
    await frame.waitForFunction(() => iota.held >= 0 && iota.holds().length === 1);
    await page.mouse.up();
    await page.close();
  });

  it("shows nothing of a world whose token it does not know", async () => {
    const page = await browser.context.newPage();
    const refused: string[] = [];
    page.on("console", (message) => refused.push(message.text()));
    await page.goto(notebook.url.replace("/?", "/stranger?"));
    await expect.poll(() => refused.join(" ")).toContain("frame-ancestors");
    expect(await page.frames()[1].evaluate(() => globalThis.iota === undefined)).toBe(true);
    await page.close();
  });
});
