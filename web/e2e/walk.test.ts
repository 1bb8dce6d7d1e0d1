// SPDX-License-Identifier: Apache-2.0
// A walk through the furnished laboratory of over 100 000 triangles ends at its walls, and at one that a script read from a GLB file.

import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, type Tab } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

let server: WorldServer;
let browser: Browser;
let tab: Tab;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/room_probe.py"], await freePort());
  browser = await Browser.start({ width: 320, height: 180 });
  tab = await browser.open(server.url);
  await tab.drawn();
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

/** How far the camera is outside of the box around all that is fixed, along x and z, m; below 0: inside. */
const outside = () => tab.page.evaluate(() => {
  const { viewer: { camera }, world: { entities } } = iota.page;
  let [left, right, near, far] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const mesh of entities.body.fixedMeshes()) {
    mesh.geometry.computeBoundingBox();
    const { min, max } = mesh.geometry.boundingBox!;
    left = Math.min(left, mesh.position.x + min.x);
    right = Math.max(right, mesh.position.x + max.x);
    near = Math.min(near, mesh.position.z + min.z);
    far = Math.max(far, mesh.position.z + max.z);
  }
  return Math.max(left - camera.position.x, camera.position.x - right, near - camera.position.z, camera.position.z - far);
});

/** By frames, as a slow machine draws few in a second. */
async function walk(key: string, seconds: number): Promise<void> {
  await tab.page.evaluate(([direction, time]) => {
    const { navigation } = iota.page;
    navigation.walk.set(direction === "d" ? 1 : direction === "a" ? -1 : 0, 0, direction === "w" ? 1 : direction === "s" ? -1 : 0);
    for (let at = 0; at < time; at += 0.05) navigation.update(0.05);
    navigation.walk.set(0, 0, 0);
  }, [key, seconds] as const);
}

it("ends at the walls, whichever way one goes", async () => {
  // The obstacles are fetched with the first step.
  await tab.page.keyboard.down("w");
  await tab.until("they are there", () => iota.page.navigation.walls?.constructor.name !== "Object" && iota.page.navigation.walls !== null);
  await tab.page.keyboard.up("w");
  expect(await outside()).toBeLessThan(0);
  for (const key of ["w", "a", "d", "w", "s"]) {
    await walk(key, 4);
    expect(await outside(), key).toBeLessThan(0);
  }
  // Where the laboratory is open: the wall from the file, at z = 3.5 m.
  await tab.page.evaluate(() => {
    iota.page.viewer.camera.position.set(0, 1.5, 2.5);
    iota.page.navigation.setHome({ pivot: [0, 1.5, 3.2], distance: 0.7, yaw: Math.PI, pitch: 0 });
    iota.page.navigation.jumpHome();
  });
  await walk("w", 4);
  expect(await tab.page.evaluate(() => iota.page.viewer.camera.position.z)).toBeLessThan(3.5);
  expect(await tab.page.evaluate(() => iota.page.viewer.camera.position.z), "it went on to it").toBeGreaterThan(3.3);
  expect(await tab.page.evaluate(() => {
    let triangles = 0;
    for (const { geometry } of iota.page.world.entities.body.fixedMeshes()) triangles += (geometry.index ?? geometry.getAttribute("position")).count / 3;
    return triangles;
  })).toBeGreaterThan(100_000);
  await tab.picture("walk");
  await tab.page.evaluate(() => { iota.page.navigation.walls = null; });
  await walk("w", 6);
  await walk("a", 6);
  expect(await outside(), "nothing stops who has no walls").toBeGreaterThan(0);
  expect(tab.complaints).toEqual([]);
});
