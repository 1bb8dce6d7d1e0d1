// SPDX-License-Identifier: Apache-2.0
// What a script hears of pointers: mouse, finger, gamepad, controllers, bare hands.

import { afterAll, beforeAll, expect, it } from "vitest";
import { Browser, small } from "./browser.ts";
import { HeadsetTab } from "./headset.ts";
import { freePort, WorldServer } from "./server.ts";

interface Told {
  readonly pointer: string;
  readonly at: readonly number[];
  readonly ahead: readonly number[];
  readonly trigger: number;
  readonly grip: number;
  readonly stick: readonly number[];
  readonly joints: number;
}

let server: WorldServer;

beforeAll(async () => {
  server = await WorldServer.start(["web/e2e/pointers_probe.py"], await freePort());
});

afterAll(async () => {
  await server?.stop();
});

async function hears(what: string, condition: (told: Told) => boolean): Promise<void> {
  await expect.poll(() => server.output.split("\n").some((line) => line.startsWith("{") && condition(JSON.parse(line) as Told)), { message: what }).toBe(true);
}

it("of the mouse: where it points, on what is there or beside the middle of the scene, and its button; and of a gamepad's sticks", async () => {
  const browser = await Browser.start(small);
  try {
    await browser.context.addInitScript(() => {
      const pad = { axes: [0.5, -0.25, 0, 0], buttons: [{ value: 0, pressed: false }, { value: 1, pressed: true }], connected: true };
      navigator.getGamepads = () => [pad as unknown as Gamepad];
    });
    const tab = await browser.open(server.url);
    await tab.eyeAtRest();
    const [x, y] = await tab.place(0);
    await tab.page.mouse.move(x, y);
    // The front of the ball.
    await hears("of the mouse on the ball", ({ pointer, at, trigger }) => pointer === "mouse" && Math.abs(at[2] - 0.3) < 0.02 && trigger === 0);
    await tab.page.mouse.down();
    await hears("of its button", ({ pointer, trigger }) => pointer === "mouse" && trigger === 1);
    await tab.page.mouse.up();
    await tab.page.mouse.move(x + 200, y);
    await hears("of the mouse beside it", ({ pointer, at, trigger }) => pointer === "mouse" && at[0] > 0.5 && Math.abs(at[2]) < 0.02 && trigger === 0);
    await hears("of the gamepad", ({ pointer, stick, grip }) => pointer === "gamepad" && stick[0] === 0.5 && stick[1] === 0.25 && grip === 1);
    expect(tab.complaints).toEqual([]);
  } finally {
    await browser.stop();
  }
});

it("of a finger", async () => {
  const browser = await Browser.start({ width: 390, height: 700, touch: true });
  try {
    const tab = await browser.open(server.url);
    await tab.eyeAtRest();
    await tab.touch("touchStart", [await tab.place(0)]);
    await hears("of the finger on the ball", ({ pointer, at, trigger }) => pointer.startsWith("touch") && Math.abs(at[2] - 0.3) < 0.05 && trigger === 1);
    await tab.lift();
  } finally {
    await browser.stop();
  }
});

it("of controllers with trigger, grip and stick, and of bare hands with 25 joints and a pinch", async () => {
  const browser = await Browser.start({ width: 400, height: 224 });
  try {
    const me = await HeadsetTab.open(browser, server.url);
    await me.enter();
    await me.point("right", [0.2, 1.3, -0.3], [0.2, 1.3, -5]);
    await me.button("right", "trigger", 0.5);
    await me.button("right", "squeeze", 1);
    await hears("of trigger and grip", ({ pointer, trigger, grip, ahead }) => pointer === "right" && trigger === 0.5 && grip === 1 && ahead[2] < -0.9);
    await me.button("right", "trigger", 0);
    await me.button("right", "squeeze", 0);
    await me.stick("left", 0.25, 0.5);
    await hears("of the stick", ({ pointer, stick }) => pointer === "left" && stick[0] === 0.25 && stick[1] === -0.5);
    await me.stick("left", 0, 0);
    await me.useHands(true);
    await me.pinch("right", 1);
    await hears("of a pinch", ({ pointer, trigger, joints }) => pointer === "right hand" && trigger > 0.9 && joints === 25);
    await me.pinch("right", 0);
    await hears("of its end", ({ pointer, trigger, joints }) => pointer === "right hand" && trigger < 0.1 && joints === 25);
    expect(me.tab.complaints).toEqual([]);
  } finally {
    await browser.stop();
  }
});
