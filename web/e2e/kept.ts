// SPDX-License-Identifier: Apache-2.0
// Kept pictures, e2e/kept/NAME.jpg (what is drawn in three dimensions) or .png (panels): what was drawn once, was looked at, and is drawn again. `npm run looks` makes them anew.

import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { expect } from "vitest";
import type { Tab } from "./browser.ts";

const folder = path.join(import.meta.dirname, "kept");
const renews = process.env["RENEW_LOOKS"] === "1";

/** How far two pictures differ, both at a quarter of their size, so that edges and grain do not count. */
export interface Difference {
  /** Of a channel, of 255. */
  readonly mean: number;
  /** Of the pixels, how many differ by more than `far` in a channel. */
  readonly share: number;
  /** Column and row of the cell that differs most; the others are of it. */
  readonly cell: readonly [number, number];
}

/** In one cell. */
const most = { mean: 8, share: 0.04 };
const far = 36;

export function isAlike({ mean, share }: Difference): boolean {
  return mean <= most.mean && share <= most.share;
}

/** Columns and rows in which a picture is compared: the cell that differs most counts. */
export type Grid = readonly [number, number];
const usualGrid: Grid = [4, 3];

/** Waits until a picture (data: address, JPEG or PNG) is as the kept one; keeps it if the tests run to renew them. */
export async function expectKept(tab: Tab, name: string, take: () => Promise<string>, grid = usualGrid): Promise<void> {
  if (renews) {
    // What is fetched or decoded late is in the second one.
    let before = await take();
    for (let trial = 0; trial < 20; trial++) {
      const now = await take();
      const isStill = (await compare(tab, before, now)).share === 0;
      before = now;
      if (isStill && trial > 2) break;
    }
    const ending = before.startsWith("data:image/png") ? "png" : "jpg";
    mkdirSync(folder, { recursive: true });
    writeFileSync(path.join(folder, `${name}.${ending}`), Buffer.from(before.slice(before.indexOf(",") + 1), "base64"));
  }
  const kept = addressOf(name);
  await expect.poll(async () => {
    const difference = await compare(tab, kept, await take(), grid);
    return isAlike(difference) ? "alike" : `${name}: ${JSON.stringify(difference)}`;
  }).toBe("alike");
}

export function addressOf(name: string): string {
  for (const [ending, type] of [["jpg", "jpeg"], ["png", "png"]]) {
    const file = path.join(folder, `${name}.${ending}`);
    if (existsSync(file)) return `data:image/${type};base64,${readFileSync(file).toString("base64")}`;
  }
  throw new Error(`there is no kept picture ${name}; make it by: npm run looks`);
}

export async function compare(tab: Tab, one: string, other: string, grid = usualGrid): Promise<Difference> {
  return tab.page.evaluate(async ([a, b, limit, [columns, rows]]) => {
    const [before, after] = await Promise.all([a, b].map(async (address) => {
      const image = new Image();
      image.src = address;
      await image.decode();
      return image;
    }));
    if (before.width !== after.width || before.height !== after.height) return { mean: 255, share: 1, cell: [0, 0] };
    const [width, height] = [Math.ceil(before.width / 4), Math.ceil(before.height / 4)];
    const [x, y] = [before, after].map((image) => {
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [width, height];
      const context = canvas.getContext("2d", { willReadFrequently: true })!;
      context.imageSmoothingQuality = "high";
      context.drawImage(image, 0, 0, width, height);
      return context.getImageData(0, 0, width, height).data;
    });
    const sums = Array.from({ length: columns * rows }, () => ({ sum: 0, far: 0, pixels: 0 }));
    for (let at = 0; at < x.length; at += 4) {
      const [column, row] = [(at / 4) % width, Math.floor(at / 4 / width)];
      const cell = sums[Math.floor((row * rows) / height) * columns + Math.floor((column * columns) / width)];
      const apart = [0, 1, 2].map((channel) => Math.abs(x[at + channel] - y[at + channel]));
      cell.sum += (apart[0] + apart[1] + apart[2]) / 3;
      cell.pixels++;
      if (Math.max(...apart) > limit) cell.far++;
    }
    const all = sums.map(({ sum, far: count, pixels }, index) => ({
      mean: sum / pixels, share: count / pixels, cell: [index % columns, Math.floor(index / columns)] as [number, number],
    }));
    return all.reduce((worst, each) => (each.share + each.mean / 100 > worst.share + worst.mean / 100 ? each : worst));
  }, [one, other, far, grid] as const);
}

/** The drawn world, at its full resolution and then reduced to this size, without what the page has around it. */
export async function pictureOf(tab: Tab, width: number, height: number): Promise<string> {
  return tab.page.evaluate(async ([wide, high]) => {
    const image = new Image();
    image.src = await iota.filmFrame();
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [wide, high];
    const context = canvas.getContext("2d")!;
    context.imageSmoothingQuality = "high";
    context.drawImage(image, 0, 0, wide, high);
    return canvas.toDataURL("image/jpeg", 0.85);
  }, [width, height] as const);
}
