// SPDX-License-Identifier: Apache-2.0
// Light and matter, by pixels: what metal mirrors agrees with what is seen around it, and the ground ends without a line.

import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { Browser, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

type Rgb = readonly [number, number, number];

let browser: Browser;
let server: WorldServer;
let tab: Tab;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/matter_probe.py"], await freePort());
  browser = await Browser.start({ width: 640, height: 360, density: 1, shadows: true, draws: "kept" });
  tab = await browser.open(server.url, { begun: false });
  await tab.drawn();
});

afterAll(async () => {
  expect(tab.complaints).toEqual([]);
  await browser?.stop();
  await server?.stop();
});

afterEach(() => chooseLook("light"));

/** Light or dark by the system, or the script's own sky and ground. */
async function chooseLook(look: string): Promise<void> {
  await tab.page.emulateMedia({ colorScheme: look === "dark" ? "dark" : "light" });
  const own = (wanted: boolean) => tab.until("the script's look is as wanted", (on) => iota.page.world.entities.stage.all().length > 0 === on, wanted);
  const isOwn = await tab.page.evaluate(() => iota.page.world.entities.stage.all().length > 0);
  if (isOwn !== (look === "script")) await tab.page.keyboard.press("n");
  await own(look === "script");
}

/** The pixels at places, in a picture without bodies; perhaps with a mirror in it, the ball of 0.3 m on the origin. */
async function colors(points: readonly (readonly [number, number, number])[], mirror: boolean): Promise<Rgb[]> {
  return tab.page.evaluate(([places, isMirror]) => {
    const { viewer, world: { entities } } = iota.page;
    const { renderer, scene, camera } = viewer;
    const { Mesh, MeshStandardMaterial, SphereGeometry, Vector3 } = iota.three;
    const ball = new Mesh(new SphereGeometry(0.3, 64, 32), new MeshStandardMaterial({ color: "#fff", metalness: 1, roughness: 0 }));
    ball.position.set(0, 0.3, 0);
    entities.body.root.visible = false;
    if (isMirror) scene.add(ball);
    viewer.drawFilmFrame();
    const gl = renderer.getContext();
    const pixel = new Uint8Array(4);
    const found = places.map((place) => {
      const clip = new Vector3(...place).project(camera);
      gl.readPixels(((clip.x + 1) / 2) * gl.drawingBufferWidth, ((clip.y + 1) / 2) * gl.drawingBufferHeight, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      return [pixel[0], pixel[1], pixel[2]] as const;
    });
    scene.remove(ball);
    entities.body.root.visible = true;
    return found;
  }, [points, mirror] as const);
}

/** Brightness of each row of pixels of a picture without bodies, from its lower end: means over the picture's left third. */
async function rows(of: Tab): Promise<{ rows: number[]; horizon: number }> {
  return of.page.evaluate(() => {
    const { viewer, world: { entities } } = iota.page;
    const { renderer, camera } = viewer;
    const kinds = [entities.body, entities.tie, entities.nail];
    for (const { root } of kinds) root.visible = false;
    viewer.drawFilmFrame();
    for (const { root } of kinds) root.visible = true;
    const gl = renderer.getContext();
    const [width, height] = [Math.floor(gl.drawingBufferWidth / 3), gl.drawingBufferHeight];
    const pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const level = camera.getWorldDirection(camera.position.clone()).setY(0).add(camera.position).project(camera);
    return {
      rows: Array.from({ length: height }, (_, row) => {
        let sum = 0;
        for (let at = 4 * width * row; at < 4 * width * (row + 1); at += 4) sum += 0.3 * pixels[at] + 0.6 * pixels[at + 1] + 0.1 * pixels[at + 2];
        return sum / width;
      }),
      horizon: ((level.y + 1) / 2) * height,
    };
  });
}

/** How far a row within an eighth of the picture from the horizon is brighter, or darker, than rows on both sides of it. */
function bandOf({ rows: all, horizon }: { rows: number[]; horizon: number }): number {
  const reach = Math.round(all.length / 8);
  const near = all.slice(Math.max(0, Math.round(horizon) - reach), Math.round(horizon) + reach + 1);
  const most = (values: number[]) => near.map((_, at) => {
    const [below, above] = [values.slice(0, at + 1), values.slice(at)];
    return Math.min(values[at] - Math.min(...below), values[at] - Math.min(...above));
  });
  return Math.max(...most(near), ...most(near.map((value) => -value)));
}

it("a face that is lit from the side has the color that was given to it", async () => {
  await chooseLook("light");
  const seen = await tab.page.evaluate(() => {
    const { renderer, camera } = iota.page.viewer;
    iota.page.viewer.drawFilmFrame();
    const gl = renderer.getContext();
    const pixel = new Uint8Array(4);
    const clip = new iota.three.Vector3(0.45, 0.08, 0.9).project(camera);
    gl.readPixels(((clip.x + 1) / 2) * gl.drawingBufferWidth, ((clip.y + 1) / 2) * gl.drawingBufferHeight, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    return Array.from(pixel.subarray(0, 3));
  });
  // It is "#2f6fb0". With too much light from all around it was as pale as "#4688bf".
  for (const [channel, given] of [0x2f, 0x6f, 0xb0].entries()) expect(Math.abs(seen[channel] - given), seen.join()).toBeLessThan(16);
});

it("is shown in a world in which nothing can move, too, with what metal mirrors", async () => {
  const still = await WorldServer.start(["web/e2e/still_probe.py"], await freePort());
  const page = await browser.context.newPage();
  try {
    await page.goto(still.url);
    await page.waitForFunction(() => globalThis.iota?.connected && !iota.page.viewer.hidden);
    expect(await page.evaluate(() => iota.page.viewer.scene.environment === null)).toBe(false);
  } finally {
    await page.close();
    await still.stop();
  }
});

it("plastic has a highlight, in which the soft box above it is mirrored", async () => {
  await chooseLook("light");
  const [brightest, usual] = await tab.page.evaluate(() => {
    const { renderer } = iota.page.viewer;
    iota.page.viewer.drawFilmFrame();
    const gl = renderer.getContext();
    const [x, y] = iota.screenPosition(1)!;
    const scale = renderer.getPixelRatio();
    const side = 44;
    const pixels = new Uint8Array(4 * side * side);
    gl.readPixels(Math.round(x * scale) - side / 2, Math.round((innerHeight - y) * scale) - side / 2, side, side, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    // Of the red ball, green and blue come from what it mirrors.
    const whiteness = Array.from({ length: side * side }, (_, at) => Math.min(pixels[4 * at + 1], pixels[4 * at + 2])).toSorted((a, b) => a - b);
    return [whiteness.at(-20)!, whiteness[whiteness.length / 2]];
  });
  expect(brightest).toBeGreaterThan(2 * usual);
});

describe.each(["light", "dark", "script"])("in the %s look", (look) => {
  it("a mirror shows the ground and the sky in their colors", async () => {
    await chooseLook(look);
    // Where the ball mirrors what is in front of it, and the sky 5 degrees above the horizon.
    const apart = async () => {
      const seen = await colors([[0, 0, 1.2], [0, 1.62, -6.76]], false);
      const mirrored = await colors([[0, 0.3, 0.3], [-0.2655, 0.3945, 0.102]], true);
      return Math.max(...seen.flatMap((color, at) => color.map((value, channel) => Math.abs(value - mirrored[at][channel]))));
    };
    await expect.poll(async () => Math.ceil(await apart()), { message: "of 255" }).toBeLessThan(8);
  });

  it("no band lies between ground and sky", async () => {
    await chooseLook(look);
    await expect.poll(async () => bandOf(await rows(tab)).toFixed(1), { message: "of 255" }).toMatch(/^[0-2]\.\d$/);
  });
});

it("no band lies between ground and sky in a small world and a large one", async () => {
  const sizes = await WorldServer.start(["web/e2e/sizes_probe.py"], await freePort());
  try {
    for (const size of ["1e-09", "1000"]) {
      const other = await browser.open(`${sizes.url}&world=${size}`);
      await other.drawn();
      for (const look of ["light", "dark"] as const) {
        await other.page.emulateMedia({ colorScheme: look });
        await expect.poll(async () => bandOf(await rows(other)).toFixed(1), { message: `${size} m, ${look}` }).toMatch(/^[0-2]\.\d$/);
      }
      expect(other.complaints).toEqual([]);
      await other.page.close();
    }
  } finally {
    await sizes.stop();
  }
});
