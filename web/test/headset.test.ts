// SPDX-License-Identifier: Apache-2.0
import { Matrix4, Object3D, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import type { ActionEntry, WorldSettings } from "../src/scene/world_model.ts";
import { layoutPanel, panelWidth } from "../src/xr/panel_layout.ts";
import { standBefore } from "../src/xr/standing.ts";

const settings: WorldSettings = {
  title: "", looks: [], look: "", dt: 0, ground: 0.5, camera: { position: [3, 1.7, 4], target: [0.2, 1.5, 0] },
};

function stand(world: WorldSettings, head: Matrix4): { head: Vector3; ahead: Vector3; rig: Object3D } {
  const rig = new Object3D();
  standBefore(world, head.elements, rig);
  rig.updateMatrixWorld();
  const seen = new Matrix4().multiplyMatrices(rig.matrixWorld, head);
  return { rig, head: new Vector3().setFromMatrixPosition(seen), ahead: new Vector3().setFromMatrixColumn(seen, 2).negate() };
}

describe("where a user stands at first", () => {
  it("is a step before the thing on the camera's side, facing it, wherever the head is and looks", () => {
    for (const turn of [0, 1, -2.5]) {
      const { head, ahead, rig } = stand(settings, new Matrix4().makeRotationY(turn).setPosition(0.7, 1.6, -0.4));
      const away = new Vector3(head.x - 0.2, 0, head.z);
      expect(away.length()).toBeGreaterThan(0.85);
      expect(away.length()).toBeLessThan(1.65);
      expect(away.clone().normalize().dot(new Vector3(2.8, 0, 4).normalize())).toBeCloseTo(1);
      expect(ahead.dot(away.normalize())).toBeCloseTo(-1);
      expect(rig.position.y).toBe(0.5);
      expect(head.y).toBeCloseTo(2.1);
    }
  });

  it("has the thing at eye height where there is no ground, and needs no camera", () => {
    const { head } = stand({ ...settings, ground: null, camera: null }, new Matrix4().setPosition(0, 1.2, 0));
    expect(head.y).toBeCloseTo(1.15);
    expect(head.z).toBeGreaterThan(0.8);
  });
});

describe("the wrist panel's layout", () => {
  const action = (name: string, button: "a" | "b" | null): ActionEntry => ({ name, key: "", label: name, help: "", on: "body", button });

  it("has the page's bar and a button for each action, none over another or outside", () => {
    const actions = ["break", "join", "paint", "burn"].map((name) => action(name, name === "break" ? "b" : null));
    const { buttons, height, speed } = layoutPanel(actions, true, "rope");
    const names = buttons.map((button) => button.name);
    for (const name of ["play", "step", "reset", "slower", "faster", "look", "go", "leave"]) expect(names).toContain(name);
    expect(names.filter((name) => name.startsWith("action "))).toHaveLength(4);
    expect(buttons.find((button) => button.name === "action break")?.badge).toBe("B");
    const all = [...buttons, speed];
    for (const one of all) {
      expect(one.x).toBeGreaterThan(0);
      expect(one.x + one.width).toBeLessThan(panelWidth);
      expect(one.y + one.height).toBeLessThan(height);
      for (const other of all) {
        if (other === one) continue;
        const apart = other.x >= one.x + one.width || one.x >= other.x + other.width || other.y >= one.y + one.height || one.y >= other.y + other.height;
        expect(apart).toBe(true);
      }
    }
  });

  it("offers no look where there is only one", () => {
    expect(layoutPanel([], false, "rope").buttons.map((button) => button.name)).not.toContain("look");
  });
});
