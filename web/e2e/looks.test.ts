// SPDX-License-Identifier: Apache-2.0
// Each kind of entity looks as it did: tiles of a picture, compared with e2e/looks.png. Where a change is meant, run it with
// RENEW_LOOKS=1 and look at the new picture.

import { readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

const golden = path.join(import.meta.dirname, "looks.png");
const tile = 80;
/** Mean difference of a channel, of 255, and share of pixels that differ by more than 40. The pattern of the floor lies where it likes. */
const most = { mean: 14, share: 0.02 };
const inRow = 6;

type Place = readonly [number, number, number];
const places: readonly (readonly [string, Place])[] = [
  ["thick line", [-1.35, 0.5, 0]], ["thin line", [-1.4, 0.95, 0]], ["arrow", [-0.72, 0.6, 0]], ["thick arrow", [-0.75, 1.1, 0]],
  ["axes", [-0.1, 0.35, 0]], ["points", [0.65, 0.5, 0]], ["box of wood", [1.1, 0.3, 0]], ["glass", [1.45, 0.3, 0]], ["torus of steel", [1.1, 0.8, 0]],
  ["cone", [1.45, 0.8, 0]], ["tube", [-1.3, 1.55, 0]], ["strut", [-0.7, 1.6, 0]], ["surface", [-0.2, 1.55, 0]], ["set of shapes", [0.28, 1.65, 0]],
  ["pyramid on a frame", [0.6, 1.5, 0]], ["painted body", [-1.0, 0.2, 0.9]], ["brass ball and shadow", [0, 0.12, 0.9]], ["shadow of a line", [0.42, 0.1, 0.8]],
];

let server: WorldServer;
let browser: Browser;
let tab: Tab;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/entities_probe.py"], await freePort());
  browser = await Browser.start({ width: 960, height: 540, density: 1, shadows: true, draws: "kept" });
  tab = await browser.open(server.url);
  await tab.drawn();
  await tab.until("its moving things have come some way", () => iota.time > 0.6);
  // The ball that runs about is where it began.
  await tab.freeze();
  await tab.reset();
  await tab.freeze();
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

/** All tiles side by side, as a PNG, and how each differs from the one kept. */
async function compare(kept: string | null): Promise<{ sheet: string; apart: { mean: number; share: number }[] }> {
  return tab.page.evaluate(async ([around, side, columns, address]) => {
    const { viewer: { renderer, scene, camera }, world: { entities } } = iota.page;
    const gl = renderer.getContext();
    const usual = renderer.getPixelRatio();
    const canvas = document.createElement("canvas");
    canvas.width = side * columns;
    canvas.height = side * Math.ceil(around.length / columns);
    const context = canvas.getContext("2d", { willReadFrequently: true })!;
    const pixels = new Uint8Array(4 * side * side);
    renderer.setPixelRatio(1);
    entities.trace.root.visible = false;
    const at = (index: number) => [(index % columns) * side, Math.floor(index / columns) * side] as const;
    around.forEach((place, index) => {
      renderer.render(scene, camera);
      const clip = camera.position.clone().set(...place).project(camera);
      const x = Math.round(((clip.x + 1) / 2) * gl.drawingBufferWidth - side / 2);
      const y = Math.round(((clip.y + 1) / 2) * gl.drawingBufferHeight - side / 2);
      gl.readPixels(x, y, side, side, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      const image = context.createImageData(side, side);
      for (let row = 0; row < side; row++) image.data.set(pixels.subarray(4 * side * row, 4 * side * (row + 1)), 4 * side * (side - 1 - row));
      context.putImageData(image, ...at(index));
    });
    entities.trace.root.visible = true;
    renderer.setPixelRatio(usual);
    const apart: { mean: number; share: number }[] = [];
    if (address !== null) {
      const image = new Image();
      image.src = address;
      await image.decode();
      const before = document.createElement("canvas");
      before.width = canvas.width;
      before.height = canvas.height;
      const other = before.getContext("2d", { willReadFrequently: true })!;
      other.drawImage(image, 0, 0);
      around.forEach((_, index) => {
        const [a, b] = [context, other].map((each) => each.getImageData(...at(index), side, side).data);
        let [sum, far] = [0, 0];
        for (let pixel = 0; pixel < a.length; pixel += 4) {
          const differences = [0, 1, 2].map((channel) => Math.abs(a[pixel + channel] - b[pixel + channel]));
          sum += differences.reduce((total, value) => total + value, 0) / 3;
          if (Math.max(...differences) > 40) far++;
        }
        apart.push({ mean: sum / (side * side), share: far / (side * side) });
      });
    }
    return { sheet: canvas.toDataURL("image/png"), apart };
  }, [places.map(([, place]) => place), tile, inRow, kept] as const);
}

it("looks as it did", async () => {
  if (process.env["RENEW_LOOKS"] === "1") {
    const { sheet } = await compare(null);
    writeFileSync(golden, Buffer.from(sheet.slice(sheet.indexOf(",") + 1), "base64"));
  }
  const kept = `data:image/png;base64,${readFileSync(golden).toString("base64")}`;
  await expect.poll(async () => {
    const { apart } = await compare(kept);
    return places.flatMap(([name], index) => (apart[index].mean > most.mean || apart[index].share > most.share ? [`${name}: ${JSON.stringify(apart[index])}`] : []));
  }).toEqual([]);
});

it("notices a missing part", async () => {
  const kept = `data:image/png;base64,${readFileSync(golden).toString("base64")}`;
  const without = async (kinds: readonly string[], visible: boolean) => tab.page.evaluate(([names, shown]) => {
    for (const name of names) (iota.page.world.entities as unknown as Record<string, { root: { visible: boolean } }>)[name].root.visible = shown;
  }, [kinds, visible] as const);
  const kinds = ["line", "arrow", "axes", "pointCloud", "marker", "tube", "strut", "surface", "shapeSet", "body"] as const;
  await without(kinds, false);
  const { apart } = await compare(kept);
  await without(kinds, true);
  const same = places.flatMap(([name], index) => (apart[index].mean > most.mean || apart[index].share > most.share ? [] : [`${name}: ${JSON.stringify(apart[index])}`]));
  expect(same).toEqual([]);
});
