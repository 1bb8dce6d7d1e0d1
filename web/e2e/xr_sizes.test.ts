// SPDX-License-Identifier: Apache-2.0
// A headset in scenes from a molecule to a valley: the user stands before each as before a table, and holds its parts as well; the first
// view of low, small and huge studies; and the controls of a script on its panel.

import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Browser, runsAll } from "./browser.ts";
import { HeadsetTab } from "./headset.ts";
import { freePort, WorldServer } from "./server.ts";

let server: WorldServer;
let browser: Browser;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/sizes_probe.py"], await freePort());
  browser = await Browser.start({ width: 640, height: 320, density: 1 });
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

describe("a headset", () => {
  it.each([["1e-09", true], ["0.001", true], ["1", false], ["1000", true]].filter(([size]) => runsAll || size !== "0.001") as [string, boolean][])("in a world of %s m sees it whole and takes hold of it", async (size, isScaled) => {
    const me = await HeadsetTab.open(browser, `${server.url}&world=${size}`);
    await me.tab.drawn();
    await me.enter();
    await me.tab.until("the rods hang still", () => iota.step > 200);
    await me.tab.page.evaluate(() => iota.page.commands.run("home in vr"));
    await me.frames(3);
    const scene = await me.tab.page.evaluate(() => {
      const { stage, room } = iota.page.viewer;
      const middle = iotaXR!.toSpace(stage.middle.toArray());
      const head = iotaXR!.toSpace(iotaXR!.head());
      return { scale: room.scale.x, size: stage.size / room.scale.x, away: Math.hypot(...middle.map((value, axis) => value - head[axis])) };
    });
    expect(scene.scale === 1, JSON.stringify(scene)).toBe(!isScaled);
    if (isScaled) {
      expect(scene.size).toBeGreaterThan(0.45);
      expect(scene.size).toBeLessThan(1.2);
    }
    expect(scene.away).toBeGreaterThan(0.6);
    expect(scene.away).toBeLessThan(12);

    const body = 4;
    await me.pointAtBody("right", [0.2, 1.3, -0.3], body);
    await me.tab.until("the ray is on a rod", () => iotaXR!.inputs().some((input) => input.hovered >= 0));
    await me.picture(`xr-size-${size}`);
    await me.button("right", "trigger", 1);
    await me.tab.until("a rod is held", () => iota.held >= 0 && iota.holds().length === 1);
    const before = await me.tab.page.evaluate(() => iotaXR!.toSpace(iota.holds()[0].target));
    const target = await me.tab.page.evaluate(() => iotaXR!.toSpace(iota.bodyPosition(4)));
    await me.point("right", [0.2, 1.5, -0.3], [target[0], target[1] + 0.2, target[2]]);
    await me.tab.until("the hand has moved by 20 cm of the user's", (was) => {
      const now = iotaXR!.toSpace(iota.holds()[0].target);
      return Math.abs(Math.hypot(...now.map((value, axis) => value - was[axis])) - 0.2) < 0.06;
    }, before);
    await me.button("right", "trigger", 0);
    await me.tab.until("it is let go", () => iota.held === -1 && iota.holds().length === 0);
    expect(me.tab.complaints).toEqual([]);
    await me.tab.page.close();
  });

  it.each(runsAll ? ["cradle", "ladder", "mechanisms", "soft-molecule", "appendix-e2"] : ["cradle", "mechanisms", "appendix-e2"])("sees the study %s whole at first, and not small, and stays as high above the floor when it teleports", async (name) => {
    const study = await WorldServer.start([name], await freePort());
    try {
      const me = await HeadsetTab.open(browser, study.url);
      await me.tab.drawn();
      await me.enter();
      await me.frames(3);
      await me.picture(`xr-study-${name}`);
      const { farthest, across } = await me.tab.page.evaluate(() => {
        const eyes = iota.page.viewer.renderer.xr.getCamera().cameras;
        const places: { x: number; y: number }[][] = [];
        const corners = {
          add: (...corner: [number, number, number]) => places.push(eyes.map((eye) => eye.position.clone().set(...corner).project(eye))),
        };
        iota.page.world.entities.body.addPoints(corners as never);
        const along = (axis: "x" | "y") => places.map(([left]) => left[axis]);
        return {
          // In the eye that sees more of it.
          farthest: Math.max(...places.map((seen) => Math.min(...seen.map(({ x, y }) => Math.max(Math.abs(x), Math.abs(y)))))),
          across: Math.max(Math.max(...along("x")) - Math.min(...along("x")), Math.max(...along("y")) - Math.min(...along("y"))),
        };
      });
      expect(farthest, "1 is the edge of the view").toBeLessThan(1);
      expect(across, "2 is the whole view").toBeGreaterThan(0.25);
      const before = await me.tab.page.evaluate(() => iotaXR!.head());
      await me.point("left", [-0.2, 1.32, -0.38], [-0.6, 1.2, -1.5]);
      await me.stick("left", 0, -1);
      await me.tab.until("the arc lands", () => iotaXR!.landing() !== null);
      // A bench is a floor too.
      const floor = await me.tab.page.evaluate(() => iotaXR!.landing()![1] - iota.page.world.ground!);
      await me.stick("left", 0, 0);
      const { head: after, scale } = await me.tab.page.evaluate(() => ({ head: iotaXR!.head(), scale: iotaXR!.rig().scale }));
      expect(Math.hypot(after[0] - before[0], after[2] - before[2])).toBeGreaterThan(0.5 * scale);
      expect(Math.abs(after[1] - before[1] - floor)).toBeLessThan(1e-3 * scale);
      expect(me.tab.complaints).toEqual([]);
      const shown = await me.tab.page.evaluate(() => iotaXR!.headset.panel.layout.buttons.find(({ command }) => command.name === "size")!.command.title());
      expect(shown).toBe({ cradle: "4.4 : 1", ladder: "2.2 : 1", "appendix-e2": "1 : 45" }[name] ?? "1 : 1");
      await me.tab.page.close();
    } finally {
      await study.stop();
    }
  });

  it("is asked for 90 pictures a second at most, and for coarser pixels at the edge", async () => {
    const me = await HeadsetTab.open(browser, `${server.url}&world=1`, { shadows: true });
    const asked = await me.tab.page.evaluateHandle(() => {
      const rates: number[] = [];
      const own = XRSession.prototype.updateTargetFrameRate;
      XRSession.prototype.updateTargetFrameRate = function (rate) {
        rates.push(rate);
        return own.call(this, rate);
      };
      return rates;
    });
    await me.enter();
    expect(await asked.jsonValue()).toEqual([90]);
    expect(await me.tab.page.evaluate(() => iota.page.viewer.renderer.xr.getFoveation())).toBeCloseTo(0.6, 2);
    expect(me.tab.complaints).toEqual([]);
    await me.tab.page.close();
  });

  it("has the controls and plots of the script at the wrist", async () => {
    const entities = await WorldServer.start(["web/e2e/entities_probe.py"], await freePort());
    try {
      const me = await HeadsetTab.open(browser, entities.url);
      await me.enter();
      await me.pointAtPanel("right", [0.12, 1.38, -0.2], "less gravity");
      await me.click("right", "trigger");
      await expect.poll(() => entities.output).toContain('{"slider": 8.8');
      await me.pointAtPanel("right", [0.12, 1.38, -0.2], "control wind");
      await me.click("right", "trigger");
      await expect.poll(() => entities.output).toContain('{"checkbox": false}');
      // As much of the curve's color as a line across its plot has.
      await expect.poll(() => me.tab.page.evaluate(() => {
        const { board, layout: { plots: [{ plot, x, y, width, height }] } } = iotaXR!.headset.panel;
        const { data } = (board.mesh.material.map!.image as HTMLCanvasElement).getContext("2d")!.getImageData(x, y, width, height);
        const wanted = [16, 8, 0].map((shift) => (plot.colors[0] >> shift) & 255);
        let count = 0;
        for (let at = 0; at < data.length; at += 4) if (wanted.every((value, channel) => Math.abs(data[at + channel] - value) < 12)) count++;
        return count / width;
      }), { message: "pixels of the curve in a column" }).toBeGreaterThan(1);
      await me.picture("xr-controls");
      await me.tab.page.close();
    } finally {
      await entities.stop();
    }
  });
});
