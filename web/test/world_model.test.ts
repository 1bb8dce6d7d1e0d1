// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { WorldModel, type Change } from "../src/scene/world_model.ts";

function makeModel(): { model: WorldModel; changes: Change[] } {
  const changes: Change[] = [];
  return { model: new WorldModel((change) => changes.push(change)), changes };
}

const classes = {
  link: {
    rope: { kind: "capsule", sizes: [0.012, 0.1], material: "rope" },
    chain: [{ kind: "torus", sizes: [0.03, 0.008, 0.05], material: "steel", turn: 1.5707963 }],
  },
  weight: { "*": { kind: "sphere", sizes: [0.1] } },
};

describe("the world model", () => {
  it("reads bodies and gives each its shapes in a look", () => {
    const { model, changes } = makeModel();
    model.setScene("classes", JSON.stringify(classes));
    model.setScene("bodies", JSON.stringify([
      { body: 0, class: "link", odd: 0, kind: "dynamic" }, { body: 7, class: "link", odd: 1, kind: "dynamic", length: 0.2 },
      { body: 9, class: "weight", odd: 0, kind: "scripted" },
    ]));
    expect(changes).toEqual(["bodies", "bodies"]);
    const odd = model.bodies.get(7);
    const weight = model.bodies.get(9);
    if (odd === undefined || weight === undefined) throw new Error("bodies are missing");
    expect(model.placedShapes(odd, "rope")[0].shape.sizes[1]).toBe(0.2);
    expect(model.placedShapes(odd, "chain")[0].rotation[0]).toBeCloseTo(Math.SQRT1_2, 5);
    expect(model.placedShapes(weight, "chain")[0].shape.kind.name).toBe("sphere");
    expect(model.shapesOfClass("link", "never heard of")[0].kind.name).toBe("capsule");
    expect(model.shapesOfClass("nothing", "rope")).toEqual([]);
  });

  it("keeps the old part when a new one is wrong, and says what", () => {
    const { model } = makeModel();
    model.setScene("classes", JSON.stringify(classes));
    expect(() => model.setScene("classes", '{"link": {"rope": {"kind": "blob"}}}')).toThrow(/unknown shape "blob"/);
    expect(() => model.setScene("classes", "{")).toThrow();
    expect(() => model.setScene("bodies", '[{"body": -1}]')).toThrow(/slot/);
    expect(model.shapesOfClass("link", "rope")).toHaveLength(1);
  });

  it("removes a key with null and does not mind keys it does not know", () => {
    const { model, changes } = makeModel();
    model.setScene("actions", '[{"name": "break", "key": "b", "on": "body", "button": "a"}]');
    expect(model.actions[0]).toMatchObject({ label: "break", button: "a", on: "body" });
    model.setScene("actions", "null");
    expect(model.actions).toEqual([]);
    model.setScene("of tomorrow", "{}");
    expect(changes).toEqual(["actions", "actions"]);
  });

  it("counts articulates as the server tells them", () => {
    const { model } = makeModel();
    model.setStructure({ type: "structure", structureVersion: 4, articulates: [{ body: 0, articulate: 2 }, { body: 1, articulate: 3 }] });
    expect(new Set(model.articulateOf.values()).size).toBe(2);
    expect(model.structureVersion).toBe(4);
  });
});
