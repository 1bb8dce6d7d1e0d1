// SPDX-License-Identifier: Apache-2.0
// A phone or headset comes in over the network, by https with the server's own certificate.

import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Browser, small, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

let server: WorldServer;
let browser: Browser;
let tab: Tab;

beforeAll(async () => {
  server = await WorldServer.start(["chain", "--lan"], await freePort());
  const found = /https:\/\/\S+/.exec(server.output);
  if (found === null) throw new Error(`no address for other machines:\n${server.output}`);
  browser = await Browser.start({ ...small, trustsAll: true });
  tab = await browser.open(found[0]);
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

describe("iota run chain --lan", () => {
  it("shows a moving world at the address of the network", async () => {
    await tab.until("the world moves", () => iota.connected && iota.step > 20);
    expect(new URL(tab.page.url()).protocol).toBe("https:");
  });

  it("is a secure context there, which WebXR asks for", async () => {
    expect(await tab.page.evaluate(() => isSecureContext && "xr" in navigator)).toBe(true);
  });
});
