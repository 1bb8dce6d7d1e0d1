// SPDX-License-Identifier: Apache-2.0
// The first picture of each study is as the kept one, e2e/kept/study_*.jpg.

import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Browser, runsAll, small, type Tab } from "./browser.ts";
import { addressOf, compare, expectKept, isAlike, pictureOf } from "./kept.ts";
import { freePort, studyNames, WorldServer } from "./server.ts";

let browser: Browser;

beforeAll(async () => {
  browser = await Browser.start({ ...small, density: 1, shadows: true, draws: "kept" });
});

afterAll(async () => {
  await browser?.stop();
});

const take = (tab: Tab) => pictureOf(tab, 320, 180);

/** A page of the study, which stays at its start. */
async function withStart(study: string, look: (tab: Tab) => Promise<void>): Promise<void> {
  const server = await WorldServer.start(["web/e2e/study_probe.py"], await freePort(), undefined, { IOTA_STUDY: study, IOTA_PAUSED: "1" });
  try {
    const tab = await browser.open(server.url, { begun: false });
    await tab.drawn();
    await tab.eyeAtRest();
    await look(tab);
    expect(tab.complaints).toEqual([]);
  } finally {
    await server.stop();
  }
}

describe("the first picture", () => {
  it.each(runsAll ? studyNames() : ["lab", "undersea"])("of %s is the kept one", async (study) => {
    await withStart(study, (tab) => expectKept(tab, `study_${study}`, () => take(tab)));
  }, 300_000);

  it("is not the kept one where something is missing, black or elsewhere", async () => {
    await withStart("cradle", async (tab) => {
      const kept = addressOf("study_cradle");
      const alike = async () => isAlike(await compare(tab, kept, await take(tab)));
      await expect.poll(alike).toBe(true);
      const bodies = (change: string) => tab.page.evaluate(`{ const { root } = iota.page.world.entities.body; ${change} }`);
      await bodies("root.visible = false");
      expect(await alike(), "missing").toBe(false);
      await bodies("root.visible = true; root.traverse(({ material }) => material?.color?.multiplyScalar(0))");
      expect(await alike(), "black").toBe(false);
      await tab.page.reload();
      await tab.drawn();
      await tab.eyeAtRest();
      await expect.poll(alike).toBe(true);
      await bodies("root.position.x = 0.3 * iota.page.viewer.size");
      expect(await alike(), "elsewhere").toBe(false);
    });
  });
});
