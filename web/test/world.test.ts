// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { ActionTarget, BodyKind, ControllerButton, type WorldSettings } from "../src/protocol/generated.ts";
import { body, bodyEntity, id, part, visual, TestWorld } from "./test_world.ts";

const link = visual(0, "link",
  part("capsule", [0.012, 0.1], { style: "rope", material: "rope" }),
  part("torus", [0.03, 0.008, 0.05], { style: "chain", material: "steel", turn: Math.PI / 2 }));
const weight = visual(1, "weight", part("sphere", [0.1]));

function settings(style: string): WorldSettings {
  return {
    type: "worldSettings", title: "chain", styles: ["rope", "chain"], style, hasCamera: true, cameraPosition: [0, 1, 3], cameraTarget: [0, 1, 0],
    hasGround: false, ground: 0, modules: [],
  };
}

function told(): TestWorld {
  const test = new TestWorld();
  test.join();
  test.world.take(settings("rope"));
  test.set("visual", link, weight);
  test.set("body", bodyEntity(0), bodyEntity(7, { odd: true, length: 0.2 }), bodyEntity(9, { visual: 1, kind: BodyKind.scripted }));
  test.poses([body(0, 1), body(7, 2), body(9, 3)]);
  return test;
}

describe("the world", () => {
  it("gives each body its shapes in the style that is shown", () => {
    const { world, changes } = told();
    const { body: bodies } = world.entities;
    expect(bodies.shapesOf(0)[0].shape.sizes[1]).toBeCloseTo(0.1, 6);
    expect(bodies.shapesOf(7)[0].shape.sizes[1]).toBeCloseTo(0.2, 6);
    world.setStyle("chain");
    expect(bodies.shapesOf(7)[0].rotation[0]).toBeCloseTo(Math.SQRT1_2, 5);
    expect(bodies.shapesOf(9)[0].shape.kind.name).toBe("sphere");
    world.setStyle("never heard of");
    expect(bodies.shapesOf(0)[0].shape.kind.name).toBe("capsule");
    expect(changes).toEqual(["look", "settings", "look", "look"]);
  });

  it("names bodies by the script's visuals and lets only dynamic ones be held", () => {
    const { world } = told();
    const { body: bodies } = world.entities;
    expect(bodies.nameOf(7)).toBe("link");
    expect(bodies.nameOf(8)).toBe("");
    expect([...bodies.pickable.subarray(0, bodies.pickableCount)]).toEqual([0, 7]);
  });

  it.each(["(solid)", "visual 3"])("names bodies of the visual %s, which no script has named, by the word for their shape", (name) => {
    const test = told();
    test.set("visual", visual(2, name, part("sphere", [0.1])));
    test.set("body", bodyEntity(4, { visual: 2 }));
    expect(test.world.entities.body.nameOf(4)).toBe("ball");
  });

  it("keeps the style that its own user chose when the script's style changes", () => {
    const { world } = told();
    world.take(settings("chain"));
    expect(world.style).toBe("chain");
    world.setStyle("rope");
    world.take(settings("chain"));
    expect(world.style).toBe("rope");
  });

  it("names an unknown kind of entity in one notice, and shows all others", () => {
    const test = told();
    for (let time = 0; time < 3; time++) test.world.take({ type: "entitiesSet", kind: "hologram", records: new Uint8Array(5) });
    test.world.take({ type: "entitiesDestroyed", kind: "hologram", ids: [id(1)] });
    expect(test.warnings).toHaveLength(1);
    expect(test.warnings[0]).toMatch(/hologram/);
    expect(test.world.entities.body.has(0)).toBe(true);
  });

  it("removes a body whose slot was used again and emptied between two messages, and keeps one that came later", () => {
    const test = told();
    expect(test.world.entities.body.has(0)).toBe(true);
    test.world.take({ type: "entitiesDestroyed", kind: "body", ids: [{ slot: 0, generation: 0 }] });
    expect(test.world.entities.body.has(0)).toBe(true);
    test.world.take({ type: "entitiesDestroyed", kind: "body", ids: [{ slot: 0, generation: 9 }] });
    expect(test.world.entities.body.has(0)).toBe(false);
  });

  it("leaves out a part that it cannot draw, and says why", () => {
    const test = told();
    test.set("visual", { ...weight, parts: [part("blob", [1]), part("sphere", [0.2])] });
    expect(test.warnings).toEqual([expect.stringMatching(/part of "weight".*"blob"/)]);
    expect(test.world.entities.body.shapesOf(9)).toHaveLength(1);
  });

  it("knows which bodies hang together", () => {
    const test = told();
    test.set("membership", { id: id(0), articulate: 2 }, { id: id(7), articulate: 2 }, { id: id(9), articulate: 3 });
    const { membership } = test.world.entities;
    const marked = new Float32Array(10);
    membership.fillAlong(7, marked, 1);
    expect([marked[0], marked[7], marked[9]]).toEqual([1, 1, 0]);
    test.destroy("membership", id(0));
    expect(membership.articulateOf(0)).toBe(-1);
  });

  it("keeps nails and particle sets, though it draws nothing for them", () => {
    const test = told();
    const anchor = { body: 0, point: [0, 0, 0] as [number, number, number] };
    test.set("nail", { id: id(2), at: anchor });
    test.set("particleSet", { id: id(3), active: true, capacity: 100 });
    const { nail, particleSet } = test.world.entities;
    expect([nail.get(2)?.at.body, particleSet.get(3)?.capacity]).toEqual([0, 100]);
    test.destroy("nail", id(2));
    expect(nail.size).toBe(0);
  });

  it("after a lost connection draws on the same entities, and drops those that are not sent again", () => {
    const test = told();
    const meshes = test.meshes();
    test.join();
    test.world.take(settings("rope"));
    test.set("visual", link, weight);
    test.set("body", bodyEntity(0), bodyEntity(9, { visual: 1, kind: BodyKind.scripted }));
    expect(test.goneBodies).toEqual([]);
    test.poses([body(0, 1), body(9, 3)]);
    expect(test.goneBodies).toEqual([7]);
    expect(test.meshes()).toEqual(meshes);
  });

  it("is described in full by its first poses, also again after a lost connection, so that no view is of a part of it", () => {
    const test = new TestWorld();
    expect(test.world.described).toBe(false);
    test.join();
    test.set("visual", link, weight);
    test.set("body", bodyEntity(0));
    expect(test.world.described).toBe(false);
    test.poses([body(0, 1)]);
    expect(test.world.described).toBe(true);
    test.join();
    test.world.take(settings("another world"));
    expect(test.world.described).toBe(false);
    test.poses([body(0, 1)]);
    expect(test.world.described).toBe(true);
  });

  it("takes the actions that the server sends", () => {
    const { world, changes } = told();
    const action = { name: "break", key: "b", label: "break", help: "", on: ActionTarget.body, button: ControllerButton.a };
    world.take({ type: "actions", actions: [action] });
    expect(world.actions).toEqual([action]);
    expect(changes.at(-1)).toBe("actions");
  });
});
