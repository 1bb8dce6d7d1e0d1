// SPDX-License-Identifier: Apache-2.0
// Long questions and long answers: both are read in full on the page, and what is typed is an answer, not a key of the world.

import { expect, it } from "vitest";
import { Browser } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

it("a long question is read in full, and so is an answer of several lines, on a phone too", async () => {
  const server = await WorldServer.start(["web/e2e/questions_probe.py"], await freePort());
  const browser = await Browser.start({ width: 390, height: 844 });
  try {
    const tab = await browser.open(server.url);
    const { page } = tab;
    const panel = page.locator("#panel");
    if (!(await panel.evaluate((element) => (element as HTMLDetailsElement).open))) await panel.locator("summary").click();
    const field = panel.locator("textarea");
    const name = panel.locator(".question .name").first();
    const seen = await name.evaluate((element) => ({ wide: element.clientWidth === 0 || element.scrollWidth <= element.clientWidth, right: element.getBoundingClientRect().right }));
    expect(seen.wide).toBe(true);
    expect(seen.right).toBeLessThanOrEqual(390);
    const [inside, box, choice] = await Promise.all([panel.boundingBox(), field.boundingBox(), panel.locator(".question select").boundingBox()]);
    for (const control of [box!, choice!]) {
      expect(control.width, "as wide as the panel").toBeGreaterThan(0.8 * inside!.width);
      expect(control.x + control.width).toBeLessThanOrEqual(inside!.x + inside!.width);
    }
    await field.fill(`most of them. ${"x".repeat(400)}`);
    await field.press("End");
    await field.press("Enter");
    await field.pressSequentially(" . r?");
    expect(await page.locator("#help[open]").count(), "? is a letter here").toBe(0);
    await panel.locator("input[type=checkbox]").click();
    await panel.locator("button", { hasText: "send my answers" }).click();
    await expect.poll(() => server.report).not.toBeNull();
    const [[question, answer]] = Object.entries(server.report as unknown as Record<string, string>);
    expect(question).toContain("what about the others");
    expect(answer).toMatch(/^most of them\. x{400}\n \. r\?$/);
    expect(tab.complaints).toEqual([]);
  } finally {
    await browser.stop();
    await server.stop();
  }
});
