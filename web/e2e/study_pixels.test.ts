// SPDX-License-Identifier: Apache-2.0
// Studies show what they are about, counted in pixels at some of their moments.

import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, small, type Tab } from "./browser.ts";
import { drawn } from "./drawn.ts";
import { pictureOf } from "./kept.ts";
import { freePort, WorldServer } from "./server.ts";

let browser: Browser;

beforeAll(async () => {
  browser = await Browser.start({ ...small, density: 1, draws: "kept" });
});

afterAll(async () => {
  await browser?.stop();
});

async function at(study: string, seconds: number, look: (tab: Tab) => Promise<void>): Promise<void> {
  const environment = { IOTA_STUDY: study, IOTA_PAUSED: "1", IOTA_AFTER: String(seconds) };
  const server = await WorldServer.start(["web/e2e/study_probe.py"], await freePort(), undefined, environment);
  try {
    const tab = await browser.open(server.url, { begun: false });
    await tab.drawn();
    await tab.eyeAtRest();
    await look(tab);
    expect(tab.complaints).toEqual([]);
    await tab.page.goto("about:blank");
  } finally {
    await server.stop();
  }
}

type Rgb = readonly [number, number, number];

/** The colors of a picture of 320 x 180, row by row from above. */
async function colors(tab: Tab): Promise<Rgb[]> {
  const address = await pictureOf(tab, 320, 180);
  return tab.page.evaluate(async (source) => {
    const image = new Image();
    image.src = source;
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext("2d")!;
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    return Array.from({ length: data.length / 4 }, (_, index) => [data[4 * index], data[4 * index + 1], data[4 * index + 2]] as const);
  }, address);
}

const share = (pixels: readonly Rgb[], is: (color: Rgb) => boolean) => pixels.filter(is).length / pixels.length;
const light = (pixels: readonly Rgb[]) => pixels.reduce((sum, color) => sum + Math.max(...color), 0) / pixels.length;

it("a burst of the fireworks lights the meadow, and is gone two seconds later", async () => {
  const meadow: number[] = [];
  for (const seconds of [1.2, 1.75]) {
    await at("fireworks", seconds, async (tab) => {
      const all = await colors(tab);
      meadow.push(light(all.slice(-20 * 320)));
      if (seconds > 1.5) expect(share(all.slice(0, 90 * 320), (color) => Math.max(...color) > 140), "a star").toBeGreaterThan(5e-4);
    });
  }
  expect(meadow[1]).toBeGreaterThan(1.2 * meadow[0]);
});

it("the cloth is checked and matte: no white-out", async () => {
  await at("cloth", 2, async (tab) => {
    const all = await colors(tab);
    expect(share(all, ([r, g, b]) => r > 150 && r > 1.8 * g && r > 1.8 * b), "red").toBeGreaterThan(0.01);
    expect(share(all, (color) => Math.min(...color) > 248), "burnt out").toBeLessThan(1e-3);
  });
});

it("the fish of the story is found in the sea", async () => {
  await at("undersea", 9, async (tab) => {
    const all = await colors(tab);
    const orange = all.map(([r, g, b], index) => [index % 320, r > 130 && r > 1.5 * g && r > 2 * b] as const).filter(([, is]) => is);
    expect(orange.length, "pixels of it").toBeGreaterThan(8);
    const bubbles = all.filter((color) => Math.min(...color) > 235);
    expect(bubbles.length, "nothing outshines it").toBeLessThan(200);
  });
});

it("the shoal is near enough to see its fish", async () => {
  await at("shoal", 1, async (tab) => {
    const { share: fish } = await drawn(tab, ["body"]);
    expect(fish, "of the picture, by a thousand").toBeGreaterThan(0.06);
  });
});
