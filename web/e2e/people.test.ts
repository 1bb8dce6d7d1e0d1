// SPDX-License-Identifier: Apache-2.0
// Two users of one world: each sees where the other looks from, with a name; nobody after the other has left.

import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, type Tab } from "./browser.ts";
import { freePort, probe, WorldServer } from "./server.ts";

let server: WorldServer;
let browsers: Browser[];
let ada: Tab;
let bo: Tab;

beforeAll(async () => {
  server = await WorldServer.start([probe], await freePort());
  // One each, as a browser stops the frames of a tab behind another one.
  browsers = [await Browser.start({ width: 640, height: 360, density: 1 }), await Browser.start()];
  ada = await browsers[0].open(`${server.url}&name=Ada`);
  bo = await browsers[1].open(`${server.url}&name=Bo`);
});

afterAll(async () => {
  for (const browser of browsers ?? []) await browser.stop();
  await server?.stop();
});

/** Names over the heads that a tab draws. */
const names = (tab: Tab) => tab.page.evaluate(() => {
  const { clients, entities: { label } } = iota.page.world;
  return clients.map(({ client }) => label.textOf(-client)).filter((text) => text !== undefined);
});

it("are seen by each other with their names, where they look from", async () => {
  // Who looks from the same place is not drawn.
  await ada.until("it knows where both are", () => iota.page.world.people.length === 2);
  await expect.poll(() => names(ada)).toEqual([]);
  // The first view of a page would replace an earlier one.
  await bo.until("Bo sees the world", () => !iota.page.viewer.hidden);
  // Bo goes to the other side of the chain, a little aside.
  await bo.page.evaluate(() => {
    const { navigation } = iota.page;
    navigation.goTo({ ...navigation.goal, yaw: navigation.goal.yaw + 2.6 });
  });
  await ada.until("Bo has a name", () => {
    const { clients, entities: { label } } = iota.page.world;
    return clients.some(({ client }) => label.textOf(-client) === "Bo");
  });
  await bo.until("Ada has a name", () => {
    const { clients, entities: { label } } = iota.page.world;
    return clients.some(({ client }) => label.textOf(-client) === "Ada");
  });
  const eye = await bo.eyeAtRest();
  await ada.until("the head is where Bo's eyes are", (place) => {
    const { world: { people }, session: { clientId } } = iota.page;
    const head = people.find(({ client }) => client !== clientId)?.stance.head;
    return head !== undefined && Math.hypot(...head.map((value, axis) => value - place[axis])) < 1e-3;
  }, eye);
  await ada.picture("page_people");
});

it("are gone when they have left", async () => {
  await browsers[1].stop();
  await ada.until("Bo is gone", () => iota.page.world.people.length === 1 && iota.page.world.clients.length === 1);
  await ada.until("and so is the name", () => {
    const { label } = iota.page.world.entities;
    return [...Array(9).keys()].every((client) => label.textOf(-client) === undefined);
  });
  expect(ada.complaints).toEqual([]);
});
