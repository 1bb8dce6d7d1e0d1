// SPDX-License-Identifier: Apache-2.0
import { Matrix4, Object3D, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import type { Entry, ScriptCommand } from "../src/commands/command.ts";
import { Commands } from "../src/commands/commands.ts";
import { layoutPanel, panelWidth } from "../src/xr/panel_layout.ts";
import { standBefore, type Standing } from "../src/xr/standing.ts";

const settings: Standing = { ground: 0.5, eye: [3, 1.7, 4], target: [0.2, 1.5, 0] };

function stand(world: Standing, head: Matrix4): { head: Vector3; ahead: Vector3; rig: Object3D } {
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

  it("has the thing at eye height where there is no ground", () => {
    const { head } = stand({ ground: null, eye: [0, 1, 3], target: [0, 1, 0] }, new Matrix4().setPosition(0, 1.2, 0));
    expect(head.y).toBeCloseTo(1.15);
    expect(head.z).toBeGreaterThan(0.8);
  });
});

describe("the wrist panel's layout", () => {
  const page = (looks: number): Entry[] => [
    { name: "play", places: ["bar", "panel"], title: () => "Pause", sign: () => "M0 0", run: () => {} },
    { name: "speed", places: ["panel"], title: () => "Speed", options: ["1"], unit: "", value: () => "1", choose: () => {} },
    { name: "look", places: ["panel"], title: () => "Look", offered: () => looks > 1, run: () => {} },
    { name: "grid", keys: ["g"], title: () => "Grid", run: () => {} },
    { name: "leave", places: ["panel foot"], title: () => "Leave VR", run: () => {} },
  ];
  const action = (name: string, button: "a" | "b" | null): ScriptCommand => ({
    name: `action ${name}`, button, onBody: true, title: () => name, offered: () => false, run: () => {}, runOn: () => {},
  });
  const commandsOf = (looks: number, ...script: ScriptCommand[]): Commands => {
    const commands = new Commands();
    commands.add(...page(looks));
    commands.script = script;
    return commands;
  };

  it("has the commands of the panel and a button for each action, none over another or outside", () => {
    const actions = ["break", "join", "paint", "burn"].map((name) => action(name, name === "break" ? "b" : null));
    const { buttons, height, readings } = layoutPanel(commandsOf(2, ...actions));
    expect(buttons.map((button) => button.command.name)).toEqual([
      "play", "look", "action break", "action join", "action paint", "action burn", "leave",
    ]);
    expect(buttons.find((button) => button.command.name === "action break")?.badge).toBe("B");
    const all = [...buttons, ...readings];
    expect(all).toHaveLength(8);
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

  it("keeps the place of what is not offered now", () => {
    const play = (looks: number) => layoutPanel(commandsOf(looks)).buttons[0];
    expect(layoutPanel(commandsOf(1)).buttons.map((button) => button.command.name)).not.toContain("look");
    expect(play(1).x).toBe(play(2).x);
  });
});
