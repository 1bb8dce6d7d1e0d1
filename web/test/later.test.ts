// SPDX-License-Identifier: Apache-2.0
import { expect, it } from "vitest";
import type { EntityView } from "../src/scene/entities/entity.ts";
import { Later } from "../src/scene/entities/later.ts";
import { id } from "./test_world.ts";

it("entities whose code comes late are drawn when it has come, in their last state, even if nothing else changes then", async () => {
  const calls: string[] = [];
  const view: EntityView<{ id: ReturnType<typeof id>; text: string }> = {
    create: ({ id: { slot }, text }) => calls.push(`${slot} is ${text}`), change: () => {}, destroy: () => {},
  };
  let come: (made: typeof view) => void = () => {};
  const later = new Later<{ id: ReturnType<typeof id>; text: string }>(() => new Promise<typeof view>((resolve) => { come = resolve; }), () => calls.push("a picture is due"));
  later.create({ id: id(0), text: "red" });
  later.create({ id: id(1), text: "blue" });
  later.change({ id: id(0), text: "green" });
  later.destroy(1);
  expect(calls).toEqual([]);
  come(view);
  await new Promise(setImmediate);
  expect(calls).toEqual(["0 is green", "a picture is due"]);
});
