// SPDX-License-Identifier: Apache-2.0
import { Group, PerspectiveCamera, Vector3 } from "three";
import { expect, it, vi } from "vitest";
import { othersOf } from "../src/page/others.ts";
import type { PageParts } from "../src/page/page_parts.ts";
import type { FramePart } from "../src/page/viewer.ts";
import { Role } from "../src/protocol/generated.ts";
import { id, TestWorld } from "./test_world.ts";

it("the first other user is in the next picture, which is due when the code for others has come, even in a paused world", async () => {
  const { world } = new TestWorld();
  const parts: FramePart[] = [];
  /** The heads in each picture that was asked for. */
  const pictures: number[][][] = [];
  const draw = () => {
    for (const part of parts) part.draw?.(1 / 60, null);
    const heads = parts.flatMap((part) => (part as FramePart & { readonly root: Group }).root.children.filter(({ visible }) => visible));
    pictures.push(heads.map((person) => person.children[0].getWorldPosition(new Vector3()).toArray()));
  };
  const viewer = {
    camera: new PerspectiveCamera(), room: new Group(), presenting: false, size: 1, user: { head: null, hands: [] }, filming: false,
    add: (part: FramePart) => parts.push(part), invalidate: draw,
  };
  const others = othersOf({ world, session: { clientId: 1, send: () => {} }, viewer } as unknown as PageParts);
  const tell = (...clients: readonly number[]) => {
    world.take({ type: "clients", clients: clients.map((client) => ({ client, name: "", role: Role.actor, selected: id(0, 0) })) });
    others.changed?.("clients");
  };
  tell(1);
  await import("../src/page/people.ts");
  expect(parts, "alone").toEqual([]);
  world.take({ type: "people", people: [{ client: 2, stance: { head: [1, 2, 3], rotation: [0, 0, 0, 1], scale: 1, hands: new Float32Array() } }] });
  tell(1, 2);
  await vi.waitFor(() => expect(pictures).toEqual([[[1, 2, 3]]]));
  tell(1, 2, 3);
  expect(parts).toHaveLength(1);
});
