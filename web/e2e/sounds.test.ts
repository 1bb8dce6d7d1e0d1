// SPDX-License-Identifier: Apache-2.0
// Sounds of a script and of effects come from where they are, measured at both ears; files that are no sound or last too long are
// told of.

import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Browser, small, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

let server: WorldServer;
let browser: Browser;
let tab: Tab;

/** Listens to all that goes to the loudspeakers: `ears` are an analyzer for each. */
const listen = () => {
  const ears: AnalyserNode[] = [];
  const usual = AudioNode.prototype.connect as (this: AudioNode, to: AudioNode, ...more: unknown[]) => AudioNode;
  const seen = new WeakMap<BaseAudioContext, ChannelSplitterNode>();
  AudioNode.prototype.connect = function connect(this: AudioNode, to: AudioNode, ...more: unknown[]) {
    if (to === this.context.destination) {
      let splitter = seen.get(this.context);
      if (splitter === undefined) {
        splitter = this.context.createChannelSplitter(2);
        seen.set(this.context, splitter);
        for (const side of [0, 1]) {
          // A third of a second, for a page that is busy for so long.
          const ear = new AnalyserNode(this.context, { fftSize: 16384 });
          usual.call(splitter, ear, side);
          ears.push(ear);
        }
      }
      usual.call(this, splitter);
    }
    return usual.call(this, to, ...more);
  } as typeof AudioNode.prototype.connect;
  (globalThis as { ears?: AnalyserNode[] }).ears = ears;
};

/** The loudest that the left and the right ear hear from a key on, until both are quiet again. */
async function heard(key: string): Promise<{ left: number; right: number }> {
  await tab.page.evaluate(() => {
    const store = globalThis as { ears?: AnalyserNode[]; peaks?: number[]; watching?: boolean };
    store.peaks = [0, 0];
    if (store.watching) return;
    store.watching = true;
    const samples = new Float32Array(16384);
    setInterval(() => store.ears!.forEach((ear, side) => {
      ear.getFloatTimeDomainData(samples);
      for (const sample of samples) store.peaks![side] = Math.max(store.peaks![side], Math.abs(sample));
    }), 20);
  });
  await tab.page.keyboard.press(key);
  const loud = () => (globalThis as { peaks?: number[] }).peaks!.some((peak) => peak > 1e-4);
  await tab.until(`something is heard after ${key}`, loud);
  await tab.until("it is quiet again", () => {
    const samples = new Float32Array(16384);
    return (globalThis as { ears?: AnalyserNode[] }).ears!.every((ear) => {
      ear.getFloatTimeDomainData(samples);
      return samples.every((sample) => Math.abs(sample) < 1e-6);
    });
  });
  const [left, right] = await tab.page.evaluate(() => (globalThis as { peaks?: number[] }).peaks!);
  return { left, right };
}

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/sounds_probe.py"], await freePort());
  browser = await Browser.start(small);
  await browser.context.addInitScript(listen);
  tab = await browser.open(server.url);
  await tab.until("the script listens to keys, and its sound is known", () => iota.page.world.listens.keys.includes("a") && iota.page.world.entities.sound.size === 1);
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

describe("a sound", () => {
  it("of a file is heard at the very first gesture, and is louder at the ear on its side", async () => {
    const left = await heard("a");
    const right = await heard("d");
    const middle = await heard("s");
    expect(left.left, JSON.stringify(left)).toBeGreaterThan(2 * left.right);
    expect(right.right, JSON.stringify(right)).toBeGreaterThan(2 * right.left);
    expect(middle.left / middle.right, JSON.stringify(middle)).toBeCloseTo(1, 1);
  });

  it("is fainter from afar: in proportion to the distance beyond its reach", async () => {
    const near = await heard("s");
    const far = await heard("w");
    // 3 m and 303 m away.
    expect(near.left / far.left).toBeGreaterThan(70);
    expect(near.left / far.left).toBeLessThan(150);
  });

  it("of an impact comes from its place too", async () => {
    // To the right: what has no place comes from the left channel alone here.
    const right = await heard("i");
    expect(right.right, JSON.stringify(right)).toBeGreaterThan(1.5 * right.left);
  });

  it("that the browser cannot decode, or that lasts too long, is told of in one line, and the others go on", async () => {
    const cards = tab.page.locator("#cards .card");
    await tab.page.keyboard.press("x");
    await cards.filter({ hasText: "cannot decode" }).waitFor();
    await tab.page.keyboard.press("y");
    await cards.filter({ hasText: "65 s, more than 60" }).waitFor();
    expect((await heard("a")).left).toBeGreaterThan(0.01);
    expect(tab.complaints.filter((text) => !text.includes("blob:"))).toEqual([]);
  });
});
