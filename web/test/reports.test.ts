// SPDX-License-Identifier: Apache-2.0
// Clicks and buttons, as they are told to a script, on a page that draws few pictures.

import { PerspectiveCamera } from "three";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Pointer } from "../src/interact/gestures.ts";
import { Events } from "../src/page/events.ts";
import { Reports } from "../src/page/reports.ts";
import { Selection } from "../src/page/selection.ts";
import type { PageParts } from "../src/page/page_parts.ts";
import { PointerKind, Role, type ClientMessage } from "../src/protocol/generated.ts";
import { body, bodyEntity, part, visual, TestWorld } from "./test_world.ts";

let told: ClientMessage[];
let world: TestWorld["world"];
let reports: Reports;
let selection: Selection;
let pointer: Pointer;

beforeEach(() => {
  vi.useFakeTimers({ toFake: ["performance"] });
  vi.advanceTimersByTime(1000);
  vi.stubGlobal("window", { addEventListener() {} });
  told = [];
  const tested = new TestWorld();
  world = tested.world;
  tested.set("visual", visual(0, "ball", part("sphere", [0.2])));
  tested.set("body", bodyEntity(0));
  tested.poses([body(0, 1)]);
  world.listens = { clicks: true, hovers: false, moves: false, keys: [] };
  const events = new Events();
  const session = {
    clientId: 1, role: Role.host, idOf: (slot: number) => world.entities.body.idOf(slot) ?? { slot: 0, generation: 0 }, select: () => {},
    send: (message: ClientMessage) => told.push(message),
  };
  selection = new Selection(world, session, { invalidate: () => {} }, events);
  events.add(selection);
  const viewer = { camera: new PerspectiveCamera(), lookDistance: () => 2, presenting: false };
  reports = new Reports({ world, session, gestures: selection.gestures, viewer, events } as unknown as PageParts);
  pointer = new Pointer("mouse");
  pointer.active = true;
  selection.gestures.add(pointer);
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

const clicks = () => told.filter((message) => message.type === "pointer" && message.kind === PointerKind.click).length;

/** An event of the mouse, at a place, that is handled some ms after it happened. */
function button(down: boolean, x: number, lateMs = 0): void {
  pointer.origin.set([x, 0, 2]);
  pointer.pressed = down;
  pointer.at = performance.now() - lateMs;
  selection.gestures.update(pointer);
}

describe.each([["a body", 1], ["nothing", 5]])("a click on %s", (_, x) => {
  it("is sent without waiting for a picture", () => {
    button(true, x);
    vi.advanceTimersByTime(100);
    button(false, x);
    expect(clicks()).toBe(1);
  });

  it("is one by when the user has pressed and released, whenever the page finds the time to look", () => {
    button(true, x);
    vi.advanceTimersByTime(900);
    button(false, x, 800);
    expect(clicks()).toBe(1);
  });

  it("is none where the button was down for long", () => {
    button(true, x, 800);
    vi.advanceTimersByTime(100);
    button(false, x);
    expect(clicks()).toBe(0);
  });
});

it("a press that ends with the connection is no click", () => {
  button(true, 1);
  vi.advanceTimersByTime(5000);
  selection.link("lost");
  button(false, 1);
  expect(clicks()).toBe(0);
});

describe("a script that listens to pointers", () => {
  const buttons = () => told.flatMap((message) => (message.type === "pointer" && message.kind === PointerKind.move ? [[message.name, ...message.buttons]] : []));

  beforeEach(async () => {
    vi.stubGlobal("navigator", { getGamepads: () => [] });
    world.listens = { clicks: false, hovers: false, moves: true, keys: [] };
    pointer.origin.set([1, 0, 2]);
    reports.interact();
    await import("../src/page/pointer_moves.ts");  // which the page fetches with the first such frame
    reports.interact();
    expect(buttons()).toEqual([["mouse", 0]]);
    told.length = 0;
  });

  it.each([["a body", 1], ["nothing", 5]])("is told of a press on %s between two frames", (_, x) => {
    button(true, x);
    button(false, x);
    reports.interact();
    expect(buttons()).toEqual([["mouse", 1], ["mouse", 0]]);
  });

  it.each([["a body", 1], ["nothing", 5]])("is told that a finger on %s was lifted, though it is no more then", (_, x) => {
    const finger = new Pointer("touch 1");
    finger.active = finger.pressed = true;
    finger.origin.set([x, 0, 2]);
    selection.gestures.add(finger);
    selection.gestures.update(finger);
    selection.gestures.remove(finger);
    expect(buttons()).toEqual([["touch 1", 1], ["touch 1", 0]]);
  });

  it("is told once that a controller is gone whose button was down", () => {
    const hand = new Pointer("right");
    hand.active = true;
    hand.buttons.push(0.3, 1);
    selection.gestures.add(hand);
    const frame = () => {
      vi.advanceTimersByTime(20);
      reports.interact();
    };
    frame();
    selection.gestures.remove(hand);
    for (let time = 0; time < 3; time++) frame();
    expect(buttons()).toEqual([["right", expect.closeTo(0.3), 1], ["right", 0, 0]]);
  });
});
