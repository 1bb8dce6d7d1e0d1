// SPDX-License-Identifier: Apache-2.0
// What page and server carry: `npm run capacity`, after `make build`; part of `make bench`. Prints a table with the
// conditions; nothing here is a test, as times depend on the machine and its load.

import { spawnSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { availableParallelism, cpus, loadavg, tmpdir } from "node:os";
import path from "node:path";
import { decodeServerMessage, encodeClientMessage, MessageType, messageTypeOf, PROTOCOL_MAGIC, PROTOCOL_VERSION, Role } from "../src/protocol/generated.ts";
import { Browser, small, type Tab } from "./browser.ts";
import { HeadsetTab } from "./headset.ts";
import { freePort, WorldServer } from "./server.ts";

interface Row {
  readonly what: string;
  readonly value: number;
  readonly unit: string;
  readonly limit: number;
}

const rows: Row[] = [];
const add = (what: string, value: number, unit: string, limit: number) => {
  rows.push({ what, value, unit, limit });
  const shown = value >= 100 ? value.toFixed(0) : value.toPrecision(3);
  console.log(`${what.padEnd(66)} ${shown.padStart(9)} ${unit.padEnd(10)} ${(`< ${limit}`).padStart(9)}  ${value < limit ? "" : "MISSED"}`);
};
const median = (values: readonly number[]) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];

async function serving(what: readonly string[], environment: Readonly<Record<string, string>>, use: (server: WorldServer) => Promise<void>): Promise<void> {
  const server = await WorldServer.start(what, await freePort(), undefined, environment);
  try {
    await use(server);
  } finally {
    await server.stop();
  }
}

async function browsing(use: (browser: Browser) => Promise<void>): Promise<void> {
  const browser = await Browser.start({ ...small, shadows: true });
  try {
    await use(browser);
  } finally {
    await browser.stop();
  }
}

const rods = ["web/e2e/moving_probe.py"];

/** Files and bytes of a page on the wire, and its first paint. */
async function opening(): Promise<void> {
  await serving(rods, { IOTA_BODIES: "10" }, (server) => browsing(async (browser) => {
    const page = await browser.context.newPage();
    const cdp = await browser.context.newCDPSession(page);
    await cdp.send("Network.enable");
    let bytes = 0;
    cdp.on("Network.loadingFinished", ({ encodedDataLength }) => void (bytes += encodedDataLength));
    const paints: number[] = [];
    await page.goto(server.url);
    await page.waitForFunction(() => globalThis.iota?.connected);
    add("page, files on the wire", bytes / 1000, "kB", 170);
    await page.close();
    for (let trial = 0; trial < 5; trial++) {
      // Closed before its world is drawn: right after a page that was drawn in software, the next one took 0.2 to 3 s.
      const opened = await browser.context.newPage();
      await opened.goto(server.url);
      await opened.waitForFunction(() => performance.getEntriesByName("first-contentful-paint").length > 0);
      paints.push(await opened.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0].startTime));
      await opened.close();
    }
    add("page, first paint, median of 5", median(paints), "ms", 1000);
  }));
}

/** A client that only listens. */
class Listener {
  bytes = 0;
  poses = 0;
  readonly socket: WebSocket;

  constructor(url: string) {
    const { host, search } = new URL(url);
    this.socket = new WebSocket(`ws://${host}/ws${search}`);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => this.socket.send(encodeClientMessage({ type: "hello", magic: PROTOCOL_MAGIC, version: PROTOCOL_VERSION, world: "", role: Role.actor, name: "" }));
    this.socket.onmessage = ({ data }: MessageEvent<ArrayBuffer>) => {
      this.bytes += data.byteLength;
      if (messageTypeOf(data) === MessageType.poses) this.poses++;
      else decodeServerMessage(data);
    };
  }
}

/** Processor time of each thread of a process, s, by its id. */
function threadTimes(pid: number): Map<string, number> {
  return new Map(readdirSync(`/proc/${pid}/task`).map((task) => {
    const fields = readFileSync(`/proc/${pid}/task/${task}/stat`, "utf8").split(") ")[1].split(" ");
    return [task, (Number(fields[11]) + Number(fields[12])) / 100];
  }));
}

const seconds = (count: number) => new Promise((resolve) => setTimeout(resolve, 1000 * count));

/** 1000 moving bodies for one client, and for eight. */
async function streams(): Promise<void> {
  await serving(rods, { IOTA_BODIES: "1000" }, async (server) => {
    const measure = async (count: number) => {
      const clients = Array.from({ length: count }, () => new Listener(server.url));
      while (clients.some(({ poses }) => poses < 30)) await seconds(0.1);
      for (const client of clients) client.bytes = client.poses = 0;
      const before = threadTimes(server.pid);
      const began = performance.now();
      await seconds(10);
      const passed = (performance.now() - began) / 1000;
      // The main thread steps the world, alone; of the others only the server's works.
      const busy = [...threadTimes(server.pid)].filter(([task]) => task !== String(server.pid)).map(([task, time]) => time - (before.get(task) ?? 0));
      for (const { socket } of clients) socket.close();
      return { passed, clients, busy: Math.max(...busy) / passed };
    };
    const one = await measure(1);
    const rate = one.clients[0].poses / one.passed;
    add(`1000 moving bodies, ${rate.toFixed(0)} frames a second: one client, at 60 a second`, (one.clients[0].bytes * 8 * 60) / one.clients[0].poses / 1e6, "Mbit/s", 6);
    const eight = await measure(8);
    const rates = eight.clients.map(({ poses }) => poses / eight.passed);
    add(`the same for 8 clients, ${Math.min(...rates).toFixed(0)} frames a second each: server's thread`, 100 * eight.busy, "% of core", 10);
  });
}

/** What the page's script takes of a frame, and of decoding its poses: medians, which a busy machine disturbs least. */
async function scriptMs(tab: Tab, frames: number): Promise<number> {
  const found = await tab.page.evaluate(async (count) => {
    const { timing } = iota.page.viewer;
    const keys = ["scriptMs", "decodeMs"] as const;
    // The page's figures are running means, each 5 % of the newest value: from two means follows the value.
    const before = { ...timing };
    const values = { scriptMs: [] as number[], decodeMs: [] as number[] };
    for (let frame = 0; frame < count; frame++) {
      await new Promise(requestAnimationFrame);
      for (const key of keys) if (timing[key] !== before[key]) values[key].push(before[key] + (timing[key] - before[key]) / 0.05);
      Object.assign(before, timing);
    }
    return values;
  }, frames);
  // No pose may have arrived meanwhile.
  return median(found.scriptMs) + (median(found.decodeMs) ?? 0);
}

/** Calls and triangles of a frame, with shadows, for all eyes. */
async function drawn(tab: Tab): Promise<{ calls: number; triangles: number }> {
  return tab.page.evaluate(async () => {
    const { renderer } = iota.page.viewer;
    const { info } = renderer;
    const own = renderer.render.bind(renderer);
    let pictures = 0;
    info.autoReset = false;
    renderer.render = (scene, camera) => {
      if (scene === iota.page.viewer.scene) pictures++;
      own(scene, camera);
    };
    info.reset();
    while (pictures < 10) await new Promise(requestAnimationFrame);
    const found = { calls: info.render.calls / pictures, triangles: info.render.triangles / pictures };
    renderer.render = own;
    info.autoReset = true;
    return found;
  });
}

async function pages(): Promise<void> {
  await serving(rods, { IOTA_BODIES: "1000" }, (server) => browsing(async (browser) => {
    const tab = await browser.open(server.url);
    add("1000 moving bodies on a flat page: script a frame", await scriptMs(tab, 100), "ms", 3);
  }));
  await serving(rods, { IOTA_BODIES: "2000" }, (server) => browsing(async (browser) => {
    const me = await HeadsetTab.open(browser, server.url);
    await me.enter();
    add("2000 moving bodies in an emulated headset: script a frame", await scriptMs(me.tab, 60), "ms", 3);
    const { calls, triangles } = await drawn(me.tab);
    add("the same: draw calls of both eyes", calls, "", 100);
    add("the same: triangles of both eyes", triangles, "", 750_000);
    // Drawing in software takes half a second a frame on all cores, which the script shares.
    const frameMs = await me.tab.page.evaluate(() => iota.frameMs);
    await me.tab.page.evaluate(() => {
      iota.page.viewer.renderer.render = () => undefined;
    });
    add(`the same without drawing, with which frames are ${frameMs.toFixed(0)} ms apart: script a frame`, await scriptMs(me.tab, 120), "ms", 3);
  }));
}

/** Particles of an emitter that pages show. */
async function particles(): Promise<void> {
  await serving(["web/e2e/sparks_probe.py"], {}, (server) => browsing(async (browser) => {
    const tab = await browser.open(server.url);
    await tab.until("10 000 particles are shown", () => iota.page.world.entities.particleSet.count >= 10_000, undefined, 120_000);
    add("10 000 particles on a flat page: script a frame", await scriptMs(tab, 60), "ms", 3);
  }));
}

/**
 * From the press on a body to a picture in which it has moved, ms: until the page has sent the press; the server has told that the
 * hand holds the body; it has sent a pose in which the body has moved; and the page has drawn it so.
 */
async function grabParts(tab: Tab): Promise<{ sent: number; held: number; moved: number; drawn: number }[]> {
  const times = [];
  for (let trial = 0; trial < 15; trial++) {
    const [x, y] = await tab.place(4);
    await tab.page.mouse.move(x, y);
    times.push(await tab.page.evaluate(async ([fromX, fromY]) => {
      const canvas = document.getElementById("view")!;
      const { session, world, viewer } = iota.page;
      const frame = () => new Promise(requestAnimationFrame);
      const send = (type: string, dx: number, dy: number) => canvas.dispatchEvent(new PointerEvent(type, {
        clientX: fromX + dx, clientY: fromY + dy, pointerId: 1, pointerType: "mouse", button: 0, buttons: 1, isPrimary: true, bubbles: true,
      }));
      iota.page.commands.run("play");
      while (iota.paused) await frame();
      const at = { sent: 0, held: 0, moved: 0, drawn: 0 };
      const own = { send: session.send.bind(session), poses: session.poses.bind(session) };
      const first = (part: keyof typeof at, reached: boolean) => {
        if (reached && at[part] === 0) at[part] = performance.now() - began;
      };
      const from = iota.bodyPosition(4);
      const isAway = ([bx, by, bz]: ArrayLike<number> & Iterable<number>) => Math.hypot(bx - from[0], by - from[1], bz - from[2]) >= 1e-3 * viewer.size;
      const newest = new Float32Array(3);
      session.send = (message) => {
        own.send(message);
        first("sent", message.type === "grabStart");
      };
      session.poses = (poses, now) => {
        own.poses(poses, now);
        world.poses.newestPosition(4, newest);
        first("held", world.holdCount > 0);
        first("moved", at.held > 0 && isAway(newest));
      };
      const began = performance.now();
      send("pointerdown", 0, 0);
      send("pointermove", 60, -30);
      while (at.drawn === 0 && performance.now() - began < 5000) {
        await frame();
        first("drawn", isAway(iota.bodyPosition(4)));
      }
      Object.assign(session, own);
      send("pointerup", 60, -30);
      iota.page.commands.run("play");
      while (!iota.paused) await frame();
      return at;
    }, [x, y] as const));
  }
  return times;
}

async function grabs(): Promise<void> {
  await serving(["web/e2e/chain_probe.py"], {}, (server) => browsing(async (browser) => {
    const tab = await browser.open(server.url);
    await tab.freezeInView(4);
    const frameMs = () => tab.page.evaluate(() => iota.frameMs);
    const told = async (what: string, times: Awaited<ReturnType<typeof grabParts>>) => {
      const parts = (["sent", "held", "moved", "drawn"] as const).map((part) => `${part} ${median(times.map((time) => time[part])).toFixed(1)}`);
      console.log(`  ${what}, ms after the press: ${parts.join(", ")}; frames are ${(await frameMs()).toFixed(0)} apart`);
    };
    const times = await grabParts(tab);
    add("from a press to visible motion, median of 15", median(times.map(({ drawn: time }) => time)), "ms", 50);
    await told("with drawing", times);
    await tab.page.evaluate(() => {
      iota.page.viewer.renderer.render = () => undefined;
    });
    const without = await grabParts(tab);
    add("the same without drawing, as a fast GPU leaves it", median(without.map(({ drawn: time }) => time)), "ms", 50);
    await told("without drawing", without);
  }));
}

function film(): void {
  const folder = mkdtempSync(path.join(tmpdir(), "iota-film-"));
  try {
    const began = performance.now();
    const iota = path.resolve(import.meta.dirname, "..", "..", ".venv", "bin", "iota");
    const done = spawnSync(iota, ["record", "chain", "-o", path.join(folder, "chain.mp4"), "--seconds", "10", "--size", "640x480"], { encoding: "utf8" });
    if (done.status !== 0) throw new Error(done.stderr);
    add("film of the chain, 10 s at 640 x 480, 30 frames a second", (performance.now() - began) / 1000, "s", 60);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

const machine = `${availableParallelism()} cores of ${cpus()[0]?.model ?? "?"}, load ${loadavg()[0].toFixed(1)}`;
console.log(`Loopback, headless Chromium that draws with llvmpipe in software at 320 x 180 px; ${machine}`);
const parts = { opening, streams, pages, particles, grabs, film };
const wanted = process.argv.slice(2);
for (const [name, part] of Object.entries(parts)) if (wanted.length === 0 || wanted.includes(name)) await part();
console.log(`load at the end ${loadavg()[0].toFixed(1)}`);
const results = process.env["IOTA_RESULTS"];
if (results !== undefined) writeFileSync(results, `${JSON.stringify({ machine, rows }, null, 2)}\n`);
