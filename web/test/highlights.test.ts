// SPDX-License-Identifier: Apache-2.0
import { PerspectiveCamera } from "three";
import { expect, it } from "vitest";
import { forceText } from "../src/page/force_text.ts";
import { Highlights, others } from "../src/page/highlights.ts";
import type { Selection } from "../src/page/selection.ts";
import type { Session } from "../src/page/session.ts";
import type { Viewer } from "../src/page/viewer.ts";
import type { Outline } from "../src/scene/outline.ts";
import { palette } from "../src/scene/materials.ts";
import { body, bodyEntity, part, TestWorld, visual } from "./test_world.ts";

it("held bodies keep their material: each has one outline, in the color of who holds it", () => {
  const test = new TestWorld();
  test.join();
  test.set("visual", visual(0, "", part("sphere", [0.1])));
  test.set("body", ...[0, 1, 2].map((slot) => bodyEntity(slot)));
  const hold = (slot: number, client: number) => ({ body: slot, client, hold: 0, force: 3, point: [0, 0, 0] as [number, number, number], target: [0, 1, 0] as [number, number, number] });
  test.poses([body(0, 1), body(1, 2), body(2, 3)], { holds: [hold(1, 7), hold(0, 1), hold(0, 7)] });
  const grab = { body: 0, target: [0, 1, 0], startedAt: performance.now(), isGone: false };
  const selection = {
    hovered: 0, selected: 0, held: 0, several: new Set(), confirmedForce: () => 3,
    gestures: { grabs: [grab], grabbedPoint: () => undefined },
  };
  const highlights = new Highlights(test.world, { clientId: 1 } as Session, selection as unknown as Selection, { camera: new PerspectiveCamera() } as unknown as Viewer);
  highlights.interact();
  const bodies = test.world.entities.body as unknown as { outlines_: Outline[]; tintGoal_: Float32Array };
  const shown = bodies.outlines_.filter((outline) => outline.body >= 0).map((outline) => [outline.body, outline.material.color.getHexString()]);
  expect(shown).toEqual([[0, palette.held.getHexString()], [1, others[7 % others.length].getHexString()]]);
  expect([0, 1, 2].map((slot) => bodies.tintGoal_[4 * slot + 3])).toEqual([0, 0, 0]);
});

it("forces are told in two digits", () => {
  const told = [8.24, 0.42, 9.96, 99.6, 324, 515, 996, 2140, 35_200, 4.2e6, 3.3e-7].map(forceText);
  expect(told).toEqual(["8.2 N", "0.42 N", "10 N", "100 N", "320 N", "520 N", "1.0 kN", "2.1 kN", "35 kN", "4.2 MN", "330 nN"]);
});
