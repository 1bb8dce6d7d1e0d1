// SPDX-License-Identifier: Apache-2.0
// A page that stays open does not grow: `tools/soak.py page`, after `make build`. For IOTA_PAGE_MINUTES (30) a page
// shows 500 moving bodies while a mouse takes one of them again and again. Thirty times it prints the page's heap after
// a collection, its nodes, listeners, geometries and textures, and the server's memory. Exit code 1 if any of them is
// larger in the second half of the run than in the first, without its first tenth.

import { readFileSync } from "node:fs";
import { Browser, small } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

const minutes = Number(process.env["IOTA_PAGE_MINUTES"] ?? 30);
const measurements = 30;
/** Caches fill and code is compiled meanwhile. */
const settleMinutes = minutes / 10;

interface Sizes {
  readonly heapKb: number;
  readonly nodes: number;
  readonly listeners: number;
  readonly geometries: number;
  readonly textures: number;
  readonly programs: number;
  readonly serverKb: number;
}

/** What may be added, from scatter alone. */
const slack: Sizes = { heapKb: 512, nodes: 20, listeners: 4, geometries: 0, textures: 0, programs: 0, serverKb: 4096 };

function residentKb(pid: number): number {
  const found = /VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, "utf8"));
  if (found === null) throw new Error(`process ${pid} has no resident memory`);
  return Number(found[1]);
}

const server = await WorldServer.start(["web/e2e/moving_probe.py"], await freePort(), undefined, { IOTA_BODIES: "500" });
const browser = await Browser.start({ ...small, shadows: true });
let failed = false;
try {
  const tab = await browser.open(server.url);
  const { page } = tab;
  const cdp = await browser.context.newCDPSession(page);
  await cdp.send("Performance.enable");

  const measure = async (): Promise<Sizes> => {
    // The second collection takes what the first one's finalizers released.
    for (let pass = 0; pass < 2; pass++) await cdp.send("HeapProfiler.collectGarbage");
    const metrics = new Map((await cdp.send("Performance.getMetrics")).metrics.map(({ name, value }) => [name, value]));
    const drawn = await page.evaluate(() => {
      const { memory, programs } = iota.page.viewer.renderer.info;
      return { geometries: memory.geometries, textures: memory.textures, programs: programs?.length ?? 0 };
    });
    return {
      heapKb: Math.round(metrics.get("JSHeapUsedSize")! / 1024), nodes: metrics.get("Nodes")!, listeners: metrics.get("JSEventListeners")!,
      ...drawn, serverKb: residentKb(server.pid),
    };
  };

  const began = performance.now();
  const elapsed = () => (performance.now() - began) / 60_000;
  const rows: { readonly minute: number; readonly sizes: Sizes }[] = [];
  for (let body = 0; elapsed() < minutes; body = (body + 37) % 500) {
    const at = await tab.place(body);
    await page.mouse.move(...at);
    await page.mouse.down();
    await page.mouse.move(at[0] + 40, at[1] - 20, { steps: 5 });
    await page.mouse.up();
    await page.waitForTimeout(2000);
    if (elapsed() < ((rows.length + 1) * minutes) / measurements) continue;
    const row = { minute: elapsed(), sizes: await measure() };
    rows.push(row);
    console.log(`minute ${row.minute.toFixed(1)}: ${JSON.stringify(row.sizes)}`);
  }
  const largest = (from: number, to: number, key: keyof Sizes) => (
    Math.max(...rows.filter(({ minute }) => minute >= from && minute < to).map(({ sizes }) => sizes[key]))
  );
  const middle = minutes / 2;
  for (const key of Object.keys(slack) as (keyof Sizes)[]) {
    const [early, late] = [largest(settleMinutes, middle, key), largest(middle, Infinity, key)];
    const grows = !(late <= early + slack[key]);
    failed ||= grows;
    console.log(`${grows ? "GROWS " : "steady"} ${key}: ${early}, later ${late}`);
  }
  const { step, complaints } = { step: await page.evaluate(() => iota.step), complaints: tab.complaints };
  console.log(`${step} steps shown in ${elapsed().toFixed(1)} minutes; complaints of the page: ${complaints.length === 0 ? "none" : complaints.join("; ")}`);
  failed ||= complaints.length > 0;
} finally {
  await browser.stop();
  await server.stop();
}
process.exitCode = failed ? 1 : 0;
