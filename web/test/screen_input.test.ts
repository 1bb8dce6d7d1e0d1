// SPDX-License-Identifier: Apache-2.0
// Taps and long presses on the canvas, as events of the browser that are handled late.

import { PerspectiveCamera } from "three";
import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Gestures } from "../src/interact/gestures.ts";
import { ScreenInput } from "../src/interact/screen_input.ts";
import { Navigation } from "../src/navigate/navigation.ts";
import { body, bodyEntity, part, visual, TestWorld } from "./test_world.ts";

const [width, height] = [800, 600];
let menus: number[];
let timers: (() => void)[];
let send: (type: "pointerdown" | "pointermove" | "pointerup", timeStamp: number, right?: number) => void;

beforeEach(() => {
  vi.useFakeTimers({ toFake: ["performance"] });
  vi.stubGlobal("innerWidth", width);
  vi.stubGlobal("innerHeight", height);
  timers = [];
  vi.stubGlobal("window", { setTimeout: (call: () => void) => timers.push(call), clearTimeout: () => {} });
  const test = new TestWorld();
  test.set("visual", visual(0, "ball", part("sphere", [0.3])));
  test.set("body", bodyEntity(7));
  test.poses([body(7, 5)]);
  const camera = new PerspectiveCamera(42, width / height);
  camera.position.set(5, 0, 3);
  const nothing = () => {};
  const gestures = new Gestures(test.world.entities.body, {
    hoverChanged: nothing, grabStarted: nothing, grabMoved: nothing, grabEnded: nothing, pressedNothing: nothing,
  });
  const listeners = new Map<string, (event: object) => void>();
  const canvas = { addEventListener: (type: string, listener: (event: object) => void) => listeners.set(type, listener), setPointerCapture: nothing };
  menus = [];
  new ScreenInput(canvas as unknown as HTMLCanvasElement, camera, gestures, new Navigation(camera), {
    clickNothing: nothing, openMenu: (hit) => menus.push(hit), closeMenu: () => menus.splice(0), active: nothing,
  });
  send = (type, timeStamp, right = 0) => listeners.get(type)?.({
    type, timeStamp, pointerType: "touch", pointerId: 1, button: 0, buttons: 0, clientX: width / 2 + right, clientY: height / 2, shiftKey: false,
    ctrlKey: false, metaKey: false,
  });
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

/** Two taps, the second some ms after the first, that are handled so many ms after each other. */
function tapTwice(apartMs: number, handledApartMs: number): void {
  for (const at of [1000, 1000 + apartMs]) {
    send("pointerdown", at);
    send("pointerup", at + 60);
    vi.advanceTimersByTime(handledApartMs);
  }
}

it("two quick taps on a body are a double tap, however late the page handles them", () => {
  tapTwice(200, 2000);
  expect(menus).toEqual([7]);
});

it("two slow taps are none, if the page handles both at once", () => {
  tapTwice(600, 0);
  expect(menus).toEqual([]);
});

it("a long press opens the actions, which a drag after it closes", () => {
  send("pointerdown", 1000);
  timers[0]();
  expect(menus).toEqual([7]);
  send("pointermove", 1600, 5);
  expect(menus, "a finger trembles").toEqual([7]);
  send("pointermove", 1620, 30);
  expect(menus).toEqual([]);
});
