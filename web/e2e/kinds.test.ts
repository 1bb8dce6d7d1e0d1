// SPDX-License-Identifier: Apache-2.0
// Each kind of drawing looks as it did: a picture with one in each cell, compared with e2e/kept/kinds.jpg.

import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, runsAll, type Tab } from "./browser.ts";
import { addressOf, compare, expectKept, isAlike, pictureOf, type Grid } from "./kept.ts";
import { freePort, WorldServer } from "./server.ts";

/** As kinds_probe.py draws. */
const cells: Grid = [8, 5];

let server: WorldServer;
let browser: Browser;
let tab: Tab;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/kinds_probe.py"], await freePort());
  browser = await Browser.start({ width: 960, height: 540, density: 1, shadows: true, draws: "kept" });
  tab = await browser.open(server.url);
  await tab.drawn();
  // Once more, for the paths that the page has seen from their start.
  await tab.until("the script has stopped it", () => iota.paused && iota.time > 0.55);
  await tab.reset();
  // Not by a key until it runs, which it does for 0.6 s only: a busy page could miss that, and press again.
  await tab.page.evaluate(() => iota.page.commands.run("play"));
  await tab.until("it stays where the script stops it", () => iota.paused && iota.time > 0.55);
  await tab.eyeAtRest();
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

const take = () => pictureOf(tab, 640, 360);

it("all kinds look as they did", async () => {
  await expectKept(tab, "kinds", take, cells);
  expect(tab.complaints).toEqual([]);
});

const kinds = ["marker", "line", "tube", "arrow", "axes", "label", "pointCloud", "shapeSet", "strut", "surface", "custom", "light", "body", "tie", "nail", "particleSet", "trace", "paint"];

/** What is wrong with one kind is seen in one of its cells. This tells of the comparison, not of the page: some of them usually. */
it.each(runsAll ? kinds : ["line", "light", "paint"])("a missing and a displaced %s is noticed", async (kind) => {
  const kept = addressOf("kinds");
  await expect.poll(async () => isAlike(await compare(tab, kept, await take(), cells))).toBe(true);
  const change = async (code: string) => tab.page.evaluate(`{ const view = iota.page.world.entities["${kind}"]; const root = view.root; ${code} }`);
  const notices = async (what: string) => expect(isAlike(await compare(tab, kept, await take(), cells)), what).toBe(false);
  if (kind === "paint") {
    await change("view.destroy(0)");
    return notices("unpainted");
  }
  await change("root.visible = false");
  await notices("missing");
  await change("root.visible = true");
  if (kind === "light" || kind === "trace") return;
  await change("root.position.x += 0.2");
  await notices("displaced");
  await change("root.position.x -= 0.2");
});

/** Changes of the picture by one spark before the sky, by the distance from its middle in radii. */
const ringsOf = (theme: "light" | "dark", hex: number, channels: number[]) => tab.page.evaluate(({ theme, hex, channels }) => {
  const { viewer: { renderer, scene, camera }, world: { entities: { particleSet } } } = iota.page;
  const radius = 0.03;
  const at = [0, 30, 0] as const;
  particleSet.setTheme(theme);
  particleSet.takeSparks({ count: 1, position: Float32Array.from(at), radius: Float32Array.of(radius), color: Uint32Array.of(hex) } as Parameters<typeof particleSet.takeSparks>[0]);
  const eye = camera.clone();
  eye.position.set(at[0], at[1], at[2] + 12 * radius);
  eye.rotation.set(0, 0, 0);
  eye.near = radius;
  eye.updateProjectionMatrix();
  const gl = renderer.getContext();
  const pixelsOf = (visible: boolean) => {
    particleSet.root.visible = visible;
    renderer.render(scene, eye);
    const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return pixels;
  };
  const [before, after] = [pixelsOf(false), pixelsOf(true)];
  particleSet.setTheme("light");
  const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const ball = height / 2 / (12 * Math.tan((eye.fov * Math.PI) / 360));  // px
  const within = (from: number, to: number) => {
    const changes: number[] = [];
    for (let pixel = 0; pixel < width * height; pixel++) {
      const away = Math.hypot((pixel % width) + 0.5 - width / 2, Math.floor(pixel / width) + 0.5 - height / 2) / ball;
      if (away > from && away < to) changes.push(...channels.map((channel) => after[4 * pixel + channel] - before[4 * pixel + channel]));
    }
    const [sum, least, most] = changes.reduce(([total, low, high], change) => [total + change, Math.min(low, change), Math.max(high, change)], [0, 255, -255]);
    return { mean: sum / changes.length, least, most };
  };
  return { ball: within(0, 0.8), edge: within(0.2, 1.15), near: within(1.15, 1.6), far: within(2, 2.6), beyond: within(3.1, 3.4) };
}, { theme, hex, channels });

it("sparks glow at night: around a ball, which covers what is behind it, is light that only adds to that, and fades", async () => {
  const rings = await ringsOf("dark", 0xffa020, [0, 1, 2]);
  expect(Math.max(-rings.ball.least, rings.ball.most), "the ball is seen").toBeGreaterThan(40);
  expect(rings.near.least, "nothing about it is darker").toBeGreaterThanOrEqual(-1);
  expect(rings.near.mean).toBeGreaterThan(4);
  expect(rings.far.mean).toBeGreaterThan(0.3);
  expect(rings.far.mean).toBeLessThan(0.7 * rings.near.mean);
  expect([rings.beyond.least, rings.beyond.most]).toEqual([0, 0]);
});

it("a spark by day has no rim: edge and halo are between its own color and that of the sky", async () => {
  const rings = await ringsOf("light", 0x2060ff, [0, 1]);  // less red and green than the sky
  expect(rings.ball.mean, "the ball is seen").toBeLessThan(-40);
  expect(rings.edge.most).toBeLessThanOrEqual(1);
  expect(rings.near.most).toBeLessThanOrEqual(1);
  expect([rings.beyond.least, rings.beyond.most]).toEqual([0, 0]);
});

/** Runs `look` on the stage alone, without the drawings; `pixelsOf` draws it for a camera and reads the picture. */
const readerCode = `
  const { viewer: { renderer, scene, camera, stage }, world: { entities } } = iota.page;
  const gl = renderer.getContext();
  const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const hidden = Object.values(entities).map((view) => view.root).filter((root) => root?.visible);
  for (const root of hidden) root.visible = false;
  const key = stage.root.children.find((light) => light.isDirectionalLight);
  const pixelsOf = (eye) => {
    renderer.render(scene, eye);
    const pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return pixels;
  };
  try { return look(); } finally { for (const root of hidden) root.visible = true; }
`;
const look = async <Result>(code: string): Promise<Result> => tab.page.evaluate(`(() => { const look = () => { ${code} }; ${readerCode} })()`);

it("the sky is dithered: neighbors differ by one step where its color changes, in place of bands", async () => {
  const { most, share } = await look<{ most: number; share: number }>(`
    const eye = camera.clone();
    eye.position.set(0, 30, 0);
    eye.rotation.set(0.35, 0, 0);
    eye.fov = 4;
    eye.updateProjectionMatrix();
    const pixels = pixelsOf(eye);
    let [most, differing] = [0, 0];
    for (let row = 0; row < height; row++) {
      for (let column = 1; column < width; column++) {
        const at = 4 * (row * width + column);
        const change = Math.abs(pixels[at] - pixels[at - 4]);
        most = Math.max(most, change);
        if (change > 0) differing++;
      }
    }
    return { most, share: differing / (width * height) };
  `);
  expect(most).toBe(1);
  expect(share).toBeGreaterThan(0.15);
});

it("the edge of a shadow is soft, over some texels of its map", async () => {
  const texels = await look<number>(`
    const { Mesh, BoxGeometry, MeshStandardMaterial, Vector3 } = iota.three;
    const light = key.position.clone().sub(key.target.position).normalize();
    const texel = (key.shadow.camera.right - key.shadow.camera.left) / key.shadow.mapSize.x;
    // A plate near the middle of the lit ball; its edge at +x is parallel to the picture's columns.
    const above = 20 * texel;
    const plate = new Mesh(new BoxGeometry(200 * texel, 2 * texel, 200 * texel), new MeshStandardMaterial());
    plate.castShadow = true;
    const ground = stage.ground.position.y;
    plate.position.set(key.target.position.x, ground + above, key.target.position.z);
    scene.add(plate);
    const side = light.x > 0 ? -1 : 1;  // away from the light: not below the plate
    const edge = new Vector3(plate.position.x + 100 * side * texel, ground, plate.position.z).addScaledVector(new Vector3(light.x, 0, light.z), -above / light.y);
    const eye = camera.clone();
    eye.position.copy(edge);
    eye.position.y = ground + 15 * texel;
    eye.up.set(0, 0, -1);
    eye.lookAt(edge.x, ground, edge.z);
    eye.near = texel;
    eye.updateProjectionMatrix();
    const shown = pixelsOf(eye);
    plate.castShadow = false;
    const lit = pixelsOf(eye);
    scene.remove(plate);
    plate.geometry.dispose();
    plate.material.dispose();
    const shares = Array.from({ length: width }, (_, column) => {
      let [sum, all] = [0, 0];
      for (let row = 0; row < height; row++) {
        sum += shown[4 * (row * width + column)];
        all += lit[4 * (row * width + column)];
      }
      return sum / all;
    });
    const [dark, bright] = [Math.min(...shares), Math.max(...shares)];
    const within = shares.filter((share) => share > dark + 0.1 * (bright - dark) && share < dark + 0.9 * (bright - dark)).length;
    const texelPixels = (width / camera.aspect / 2 / Math.tan((camera.fov * Math.PI) / 360)) / 15;
    return bright - dark > 0.1 ? within / texelPixels : -(bright - dark) - 1;
  `);
  expect(texels).toBeGreaterThan(3);
  expect(texels).toBeLessThan(30);
});

it("metal reflects the soft boxes of a studio, without any lamp", async () => {
  const { brightest, middle } = await look<{ brightest: number; middle: number }>(`
    const { Mesh, SphereGeometry, MeshStandardMaterial } = iota.three;
    const lamps = stage.root.children.filter((light) => light.isLight);
    for (const lamp of lamps) lamp.visible = false;
    const ball = new Mesh(new SphereGeometry(0.1, 48, 32), new MeshStandardMaterial({ color: "#b9bec3", metalness: 1, roughness: 0.3 }));
    ball.position.set(0, 30, 0);
    scene.add(ball);
    const eye = camera.clone();
    eye.position.set(0, 30, 0.16);
    eye.rotation.set(0, 0, 0);
    eye.near = 0.01;
    eye.updateProjectionMatrix();
    const pixels = pixelsOf(eye);
    scene.remove(ball);
    ball.geometry.dispose();
    ball.material.dispose();
    for (const lamp of lamps) lamp.visible = true;
    const values = [];
    for (let row = 0; row < height; row++) {
      for (let column = 0; column < width; column++) {
        if (Math.hypot(column - width / 2, row - height / 2) < 0.45 * height) values.push(pixels[4 * (row * width + column) + 1]);
      }
    }
    values.sort((a, b) => a - b);
    return { brightest: values[Math.floor(0.99 * values.length)], middle: values[Math.floor(0.5 * values.length)] };
  `);
  expect(brightest).toBeGreaterThan(150);
  expect(brightest).toBeGreaterThan(1.5 * middle);
});
