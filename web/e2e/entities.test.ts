// SPDX-License-Identifier: Apache-2.0
// Things that scripts draw besides bodies, as pixels at their expected places; the controls of the panel, clicks and
// keys, as received by the script; pictures. build/artifacts/page_entities.png is for inspection.

import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Browser, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

let server: WorldServer;
let browser: Browser;
let tab: Tab;
/** Slot of the ball that runs to and fro, and a place where it was drawn. */
const runner = 2;
let passed: Place;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/entities_probe.py"], await freePort());
  browser = await Browser.start({ width: 960, height: 540, density: 1, shadows: true, draws: "kept" });
  tab = await browser.open(server.url);
  await tab.drawn();
  await tab.until("its images are decoded", () => {
    let images = 0;
    iota.page.viewer.scene.traverse((item) => {
      const { map } = ((item as { material?: { map?: { image?: { width: number } } } }).material ?? {});
      if (map?.image?.width === 2) images++;
    });
    return images === 2;
  });
  const drawn = await tab.page.evaluate((runner) => ({ place: iota.bodyPosition(runner), time: iota.time }), runner);
  passed = drawn.place;
  await tab.until("the runner has gone on", (time) => iota.time > time + 0.8, drawn.time);
  await tab.picture("page_entities");
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

type Place = readonly [number, number, number];

/**
 * Color (0 .. 255) of the picture around a place of the world: the pixel within some px whose hue is nearest to what is wanted, once with
 * the entities of that kind and once without.
 */
async function colorAt(kind: string, place: Place, wanted: Place): Promise<{ shown: number[]; hidden: number[] }> {
  return tab.page.evaluate(([name, at, color]) => {
    const { viewer, world } = iota.page;
    const { renderer, camera } = viewer;
    const gl = renderer.getContext();
    const { root } = (world.entities as unknown as Record<string, { root: { visible: boolean } }>)[name];
    const clip = viewer.camera.position.clone().set(...at).project(camera);
    const reach = 4;
    const x = Math.round(((clip.x + 1) / 2) * gl.drawingBufferWidth) - reach;
    const y = Math.round(((clip.y + 1) / 2) * gl.drawingBufferHeight) - reach;
    const side = 2 * reach + 1;
    const pixels = new Uint8Array(4 * side * side);
    const take = (): number[] => {
      renderer.render(viewer.scene, camera);
      gl.readPixels(x, y, side, side, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      let best: number[] = [];
      let least = Infinity;
      for (let index = 0; index < side * side; index++) {
        const pixel = [...pixels.subarray(4 * index, 4 * index + 3)];
        const [size, wantedSize] = [Math.hypot(...pixel) || 1, Math.hypot(...color)];
        const apart = Math.hypot(...pixel.map((value, channel) => value / size - color[channel] / wantedSize));
        if (apart < least) [best, least] = [pixel, apart];
      }
      return best;
    };
    const visible = root.visible;
    const shown = take();
    root.visible = false;
    const hidden = take();
    root.visible = visible;
    return { shown, hidden };
  }, [kind, place, wanted] as const);
}

/** Difference of two colors in hue and saturation, without brightness. */
function apart(a: readonly number[], b: readonly number[]): number {
  const [sizeA, sizeB] = [Math.hypot(...a) || 1, Math.hypot(...b) || 1];
  return Math.hypot(...a.map((value, channel) => value / sizeA - b[channel] / sizeB));
}

describe("what a script draws", () => {
  it.each<[string, string, Place, Place]>([
    ["a thick line", "line", [-1.35, 0.58, 0], [208, 64, 43]],
    ["a thin closed line", "line", [-1.4, 0.8, 0], [63, 127, 208]],
    ["an arrow along a vector", "arrow", [-0.75, 0.5, 0], [47, 157, 146]],
    ["a thick arrow", "arrow", [-0.72, 1.12, 0], [138, 79, 176]],
    ["x of axes", "axes", [0.05, 0.3, 0], [208, 64, 43]],
    ["y of axes", "axes", [-0.2, 0.6, 0], [76, 154, 82]],
    ["z of axes", "axes", [-0.2, 0.3, 0.3], [63, 127, 208]],
    ["the first of many points", "pointCloud", [0.5, 0.3, 0], [0, 102, 0]],
    ["the last of many points", "pointCloud", [0.78, 0.72, 0], [255, 102, 255]],
    ["a label of a height", "label", [0.65, 1.1, 0], [208, 64, 43]],
    ["a box of wood", "marker", [1.1, 0.3, 0.12], [173, 127, 89]],
    ["a green cone", "marker", [1.45, 0.75, 0.08], [76, 154, 82]],
    ["a tube", "tube", [-1.3, 1.58, 0.04], [76, 154, 82]],
    ["a strut", "strut", [-0.7, 1.6, 0.03], [208, 64, 43]],
    ["a surface, from behind as from before", "surface", [-0.2, 1.5, 0], [63, 127, 208]],
    ["the first of a set of shapes", "shapeSet", [0.2, 1.65, 0.05], [138, 79, 176]],
    ["the second, after the set was moved", "shapeSet", [0.35, 1.65, 0.06], [242, 163, 36]],
    ["a thing on a frame, after that was moved", "marker", [0.6, 1.45, 0.05], [47, 157, 146]],
    ["the upper left of an image on a box", "marker", [1.03, 1.57, 0.15], [76, 153, 82]],
    ["its lower right", "marker", [1.17, 1.43, 0.15], [204, 178, 0]],
    ["the lower left of an image that is four times on a surface", "surface", [1.4375, 1.3875, 0], [0, 0, 204]],
    ["its upper right", "surface", [1.6625, 1.6125, 0], [204, 0, 0]],
    ["a skin, between the places that it is around", "surface", [0.98, 0.2, 0.98], [76, 154, 82]],
    ["and beside one of them", "surface", [0.84, 0.2, 0.95], [76, 154, 82]],
    ["a painted body of wood", "body", [-1.0, 0.2, 1.0], [138, 79, 176]],
    ["a body that has its color by name", "body", [-1.3, 0.2, 1.0], [46, 139, 87]],
  ])("%s is where it belongs, in its color", async (_, kind, place, color) => {
    const { shown, hidden } = await colorAt(kind, place, color);
    expect(apart(shown, color), `${shown} in place of ${color}`).toBeLessThan(0.3);
    expect(apart(hidden, color) - apart(shown, color), `${hidden} without it`).toBeGreaterThan(0.1);
  });

  it("a thick line casts a shadow on the ground, as a body does", async () => {
    const light = await tab.page.evaluate(() => {
      const { viewer: { renderer, scene, camera }, world: { entities } } = iota.page;
      const gl = renderer.getContext();
      // Along the key light, from the middle of the line to the ground.
      const clip = camera.position.clone().set(0.5 - (0.35 * 0.55) / 1.35, 0, 0.9 - (0.35 * 0.75) / 1.35).project(camera);
      const x = Math.round(((clip.x + 1) / 2) * gl.drawingBufferWidth);
      const y = Math.round(((clip.y + 1) / 2) * gl.drawingBufferHeight);
      const pixels = new Uint8Array(4 * 9);
      const take = () => {
        renderer.render(scene, camera);
        gl.readPixels(x - 1, y - 1, 3, 3, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        return pixels.reduce((sum, value, index) => (index % 4 === 3 ? sum : sum + value), 0) / 27;
      };
      const shown = take();
      entities.line.root.castShadow = false;
      const without = take();
      entities.line.root.castShadow = true;
      return { shown, without };
    });
    expect(light.shown / light.without, JSON.stringify(light)).toBeLessThan(0.9);
  });

  it("a path goes where its body was drawn", async () => {
    const color = [242, 163, 36] as const;
    const { shown, hidden } = await colorAt("trace", passed, color);
    expect(apart(shown, color), `${shown} in place of ${color}`).toBeLessThan(0.3);
    expect(apart(hidden, color)).toBeGreaterThan(0.4);
  });
});

describe("the panel of controls", () => {
  it.each([[960, 540], [420, 480]])("leaves the bar and the figures free in a window of %s x %s", async (width, height) => {
    await tab.page.setViewportSize({ width, height });
    await tab.until("it ends above them", () => {
      const panel = document.getElementById("panel") as HTMLDetailsElement;
      // It folds where the window becomes narrow.
      panel.open = true;
      const { bottom, height } = panel.getBoundingClientRect();
      const tops = ["bar", "meter"].map((id) => document.getElementById(id)!.getBoundingClientRect()).filter((box) => box.width > 0).map(({ top }) => top);
      return height > 100 && tops.length > 0 && bottom <= Math.min(...tops);
    });
    await tab.page.setViewportSize({ width: 960, height: 540 });
  });
});

describe("the script hears", () => {
  const told = async (text: string) => {
    await expect.poll(() => server.output, { message: `"${text}" is told to the script` }).toContain(text);
  };

  it("of a slider, a check box, a choice, a text and a button, each by mouse or keyboard", async () => {
    const panel = tab.page.locator("#panel");
    await panel.getByLabel("gravity").focus();
    await tab.page.keyboard.press("End");
    await told('{"slider": 20.0}');
    await panel.getByLabel("wind").click();
    await told('{"checkbox": false}');
    await panel.getByLabel("material").selectOption("glass");
    await told('{"choice": "glass"}');
    await panel.getByLabel("name").fill("Zoë");
    await tab.page.keyboard.press("Enter");
    await told('{"text": "Zo\\u00eb"}');
    await panel.getByRole("button", { name: "throw" }).click();
    await told('{"button": true}');
    await panel.getByRole("img", { name: "Plot of wave" }).waitFor();
  });

  it("of clicks on a body and on nothing, and of its keys", async () => {
    await tab.clickAt(await tab.place(0));
    await told('{"click": ');
    // The front of the ball, 12 cm before its middle.
    expect(/"click": \[(\S+), (\S+), (\S+)\]/.exec(server.output)!.slice(1).map(Number)[2]).toBeCloseTo(1.01, 1);
    await tab.clickAt([200, 80]);
    await told('{"missed": ');
    await tab.page.keyboard.press("k");
    await told('{"key": "k"}');
  });

  it("of a key that was the page's, and the help says so", async () => {
    await tab.page.keyboard.press("?");
    const help = tab.page.locator("#help[open]");
    await expect.poll(() => help.textContent()).toContain("i is this world's key here");
    expect(await help.locator("kbd").allTextContents()).not.toContain("i");
    await tab.page.keyboard.press("Escape");
    await help.waitFor({ state: "detached" });
  });

  it("of its keys while a slider, a check box or a button has the focus, but not of what is written into a text", async () => {
    const count = () => server.output.split('{"key": "k"}').length - 1;
    const panel = tab.page.locator("#panel");
    let heard = count();
    for (const control of [panel.getByLabel("gravity"), panel.getByLabel("wind"), panel.getByRole("button", { name: "throw" })]) {
      await control.focus();
      await tab.page.keyboard.press("k");
      heard++;
      await expect.poll(count).toBe(heard);
    }
    await panel.getByLabel("name").focus();
    await tab.page.keyboard.type("kk");
    await tab.page.keyboard.press("Enter");
    await told('{"text": "Zo\\u00ebkk"}');
    await panel.getByLabel("gravity").focus();
    await tab.page.keyboard.press("k");
    await expect.poll(count).toBe(heard + 1);
  });

  it("gives the world its surroundings, and takes them back", async () => {
    const light = async () => tab.page.evaluate(() => {
      const { viewer: { renderer, scene, camera } } = iota.page;
      const gl = renderer.getContext();
      const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
      const pixels = new Uint8Array(4 * width * height);
      renderer.render(scene, camera);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      return pixels.reduce((sum, value, index) => (index % 4 === 3 ? sum : sum + value), 0) / (3 * width * height);
    });
    const day = await light();
    expect(day).toBeGreaterThan(150);
    await tab.page.keyboard.press("n");
    await tab.until("it is night", () => iota.page.world.entities.stage.size === 1);
    await tab.picture("page_night");
    await expect.poll(light).toBeLessThan(70);
    await tab.page.keyboard.press("n");
    await tab.until("it is day", () => iota.page.world.entities.stage.size === 0);
    await expect.poll(async () => Math.abs((await light()) - day)).toBeLessThan(3);
  });

  it("of a lamp that it switches on: its light is on the ground below it, and nowhere else", async () => {
    const red = (x: number, z: number) => tab.page.evaluate(([px, pz]) => {
      const { viewer: { renderer, scene, camera } } = iota.page;
      const gl = renderer.getContext();
      renderer.render(scene, camera);
      const clip = camera.position.clone().set(px, 0, pz).project(camera);
      const pixels = new Uint8Array(4);
      const at = [clip.x * gl.drawingBufferWidth, clip.y * gl.drawingBufferHeight].map((value, axis) => Math.round((value + [gl.drawingBufferWidth, gl.drawingBufferHeight][axis]) / 2));
      gl.readPixels(at[0], at[1], 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      return pixels[0] / pixels[2];
    }, [x, z] as const);
    const before = [await red(-0.4, 1.2), await red(0.6, 1.2)];
    await tab.page.keyboard.press("l");
    await expect.poll(() => red(-0.4, 1.2), { timeout: 30_000 }).toBeGreaterThan(1.1 * before[0]);
    expect(await red(0.6, 1.2)).toBeLessThan(1.04 * before[1]);
    await tab.picture("page_lamp");
    await tab.page.keyboard.press("l");
    await expect.poll(() => red(-0.4, 1.2), { timeout: 30_000 }).toBeLessThan(1.04 * before[0]);
  });

  it("of a picture that it asks for, and a user takes one by a key", async () => {
    await tab.page.keyboard.press("i");
    // Independent of the page's resolution.
    await told('{"screenshot": [960, 540]}');
    // The script has drawn a red curtain just before it asked.
    const middle = await tab.page.evaluate(async (address) => {
      const image = new Image();
      image.src = address;
      await image.decode();
      const context = Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("2d")!;
      context.drawImage(image, -image.width / 2, -image.height / 2);
      return [...context.getImageData(0, 0, 1, 1).data];
    }, `data:image/png;base64,${/"curtain": "([^"]+)"/.exec(server.output)![1]}`);
    expect(middle[0], JSON.stringify(middle)).toBeGreaterThan(2 * middle[2]);
    await tab.page.evaluate(() => (document.activeElement as HTMLElement).blur());
    const [file] = await Promise.all([tab.page.waitForEvent("download"), tab.page.keyboard.press("p")]);
    expect(file.suggestedFilename()).toBe("entities.png");
    const saved = path.join(mkdtempSync(path.join(tmpdir(), "iota-picture-")), "picture.png");
    await file.saveAs(saved);
    const png = readFileSync(saved);
    expect([png.toString("latin1", 1, 4), png.readUInt32BE(16), png.readUInt32BE(20)]).toEqual(["PNG", 960, 540]);
    expect(tab.complaints).toEqual([]);
  });
});
