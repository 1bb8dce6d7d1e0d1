// SPDX-License-Identifier: Apache-2.0
// What the server sends leads to a new picture.

import { PerspectiveCamera, Scene, type WebGLRenderer } from "three";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Events } from "../src/page/events.ts";
import { Session } from "../src/page/session.ts";
import { Role, type ClientMessage, type PoseHold } from "../src/protocol/generated.ts";
import { body, bodyEntity, frame, part, visual, TestWorld } from "./test_world.ts";

let asked = 0;
let session: Session;

beforeEach(() => {
  vi.stubGlobal("window", { addEventListener() {} });
  vi.stubGlobal("document", { addEventListener() {} });
  const tested = new TestWorld();
  const viewer = {
    renderer: {} as WebGLRenderer, scene: new Scene(), camera: new PerspectiveCamera(), presenting: false,
    timing: { frameMs: 0, scriptMs: 0, renderMs: 0, decodeMs: 0 }, invalidate: () => void asked++,
  };
  session = new Session("", { world: "", role: Role.actor, name: "" }, tested.world, viewer, new Events());
  tested.join();
  tested.set("visual", visual(0, "ball", part("sphere", [0.1])));
  tested.set("body", bodyEntity(0));
});

afterEach(() => vi.unstubAllGlobals());

describe("an action", () => {
  it("on more bodies than a message holds is sent in several, about each body once", () => {
    const sent: ClientMessage[] = [];
    vi.spyOn(session.connection, "send").mockImplementation((message) => sent.push(message) > 0);
    vi.spyOn(session, "idOf").mockImplementation((slot) => ({ slot, generation: 1 }));
    const asked = Array.from({ length: 10_000 }, (_, slot) => slot);
    session.act("paint", asked);
    const bodies = sent.map((message) => (message.type === "action" ? [message.body, ...message.others] : []));
    expect(bodies.map(({ length }) => length)).toEqual([4096, 4096, 1808]);
    expect(bodies.flat().map(({ slot }) => slot)).toEqual(asked);
    sent.length = 0;
    session.act("paint", []);
    expect(sent).toEqual([{ type: "action", name: "paint", body: { slot: 0, generation: 0 }, others: [] }]);
  });
});

/** Whether a picture is due after poses of a step. */
function draws(step: number, holds: PoseHold[] = []): boolean {
  asked = 0;
  session.poses(frame(step, [body(0, 1)], { holds }), 16 * step);
  return asked > 0;
}

describe("poses", () => {
  it("of a world that stands still are drawn once, also at its very first step", () => {
    expect(draws(0)).toBe(true);
    expect(draws(0)).toBe(false);
    expect(draws(1)).toBe(true);
  });

  it("without the last hold of another user, in a world that stands still, take its spring out of the picture", () => {
    const hold: PoseHold = { client: 2, hold: 0, body: 0, point: [0, 0, 0], target: [0, 1, 0], force: 1 };
    draws(5, [hold]);
    expect(draws(5, [hold])).toBe(true);
    expect(draws(5), "it is gone").toBe(true);
    expect(draws(5)).toBe(false);
  });
});
