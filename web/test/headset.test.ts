// SPDX-License-Identifier: Apache-2.0
import { Matrix4, Object3D, Quaternion, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import type { Entry, ScriptCommand } from "../src/commands/command.ts";
import { Commands } from "../src/commands/commands.ts";
import { WidgetKind, type PlotEntity, type WidgetEntity } from "../src/protocol/generated.ts";
import { controlRows } from "../src/xr/controls.ts";
import { ratioOf } from "../src/xr/headset_commands.ts";
import { layoutPanel, panelWidth } from "../src/xr/panel_layout.ts";
import { fitScale, standBefore, type Standing } from "../src/xr/standing.ts";
import { isWatched } from "../src/xr/wrist_panel.ts";

const settings: Standing = { scale: 1, ground: 0.5, eye: [3, 1.7, 4], target: [0.2, 1.5, 0] };

function stand(world: Standing, head: Matrix4, raised = 0): { head: Vector3; ahead: Vector3; rig: Object3D } {
  const rig = new Object3D();
  standBefore(world, head.elements, raised, rig);
  rig.updateMatrixWorld();
  const seen = new Matrix4().multiplyMatrices(rig.matrixWorld, head);
  return { rig, head: new Vector3().setFromMatrixPosition(seen), ahead: new Vector3().setFromMatrixColumn(seen, 2).negate() };
}

describe("where a user stands at first", () => {
  it("is before the thing on the camera's side, nearer than that, facing it, wherever the head is and looks", () => {
    for (const turn of [0, 1, -2.5]) {
      const { head, ahead, rig } = stand(settings, new Matrix4().makeRotationY(turn).setPosition(0.7, 1.6, -0.4));
      const away = new Vector3(head.x - 0.2, 0, head.z);
      expect(away.length()).toBeGreaterThan(0.6 * Math.hypot(2.8, 4));
      expect(away.length()).toBeLessThan(0.9 * Math.hypot(2.8, 4));
      expect(away.clone().normalize().dot(new Vector3(2.8, 0, 4).normalize())).toBeCloseTo(1);
      expect(ahead.dot(away.normalize())).toBeCloseTo(-1);
      expect(rig.position.y).toBe(0.5);
      expect(head.y).toBeCloseTo(2.1);
    }
  });

  it("is as far from a thing of any size, and as high, in the user's own meters", () => {
    const real = stand(settings, new Matrix4().setPosition(0.3, 1.6, 0));
    for (const scale of [1e-9, 1e-3, 1e3]) {
      const times = (values: readonly number[]) => values.map((value) => scale * value) as [number, number, number];
      const head = new Matrix4().setPosition(0.3, 1.6, 0);
      const rig = new Object3D();
      standBefore({ scale, ground: scale * 0.5, eye: times(settings.eye), target: times(settings.target) }, head.elements, 0, rig);
      const room = new Object3D();
      room.scale.setScalar(scale);
      rig.add(room);
      rig.updateMatrixWorld();
      const seen = new Vector3().setFromMatrixPosition(head).applyMatrix4(room.matrixWorld).divideScalar(scale);
      expect(seen.distanceTo(real.head)).toBeLessThan(1e-6);
    }
    expect([1e-9, 0.5, 1.5, 4, 15, 1e3].map(fitScale)).toEqual([1e-9 / 2, 0.25, 1, 1, 1, 1e3 / 2]);
  });

  it("is farther from a wide thing, but not much farther than the camera of the script", () => {
    const away = (toShow: number) => {
      const { head } = stand({ scale: 1, ground: 0, eye: [0, 1, 2], target: [0, 1, 0], toShow }, new Matrix4().setPosition(0, 1.6, 0));
      return head.z;
    };
    expect([0, 1.2, 2.2, 9].map(away)).toEqual([1.5, 1.5, 2.2, 2.6].map((z) => expect.closeTo(z, 9) as number));
  });

  it("has the thing at eye height where there is no ground", () => {
    const { head } = stand({ scale: 1, ground: null, eye: [0, 1, 3], target: [0, 1, 0] }, new Matrix4().setPosition(0, 1.2, 0));
    expect(head.y).toBeCloseTo(1.15);
    expect(head.z).toBeGreaterThan(0.8);
  });
});

describe("the height of the eyes at first", () => {
  const head = new Matrix4().setPosition(0, 1.6, 0);
  /** Of a scene whose center is at a height, seen from a distance: height of the eyes above the ground, and angle from them down to the center, rad. */
  const eyes = (scale: number, height: number, away: number, raised = 0, at = head) => {
    const rig = new Object3D();
    standBefore({ scale, ground: 0.3, eye: [0, 0.3 + height, away], target: [0, 0.3 + height, 0] }, at.elements, raised, rig);
    const above = rig.position.y + scale * at.elements[13] - 0.3;
    return { above, down: Math.atan2(above - height, rig.position.z + scale * at.elements[14]) };
  };

  it("is the user's own where that shows the scene, or its foot if it is tall", () => {
    expect(eyes(1, 1.1, 4).above).toBeCloseTo(1.6);
    expect(eyes(1, 5, 9).above).toBeCloseTo(1.6);
    expect(eyes(0.1, 0.2, 2).above).toBeCloseTo(0.16);
  });

  it("comes down to a low scene, so that it is in view, but not to the ground, on which hands would lie", () => {
    const low = eyes(1, 0.6, 2.4);
    expect(low.above).toBeGreaterThan(0.7);
    expect((low.down * 180) / Math.PI).toBeCloseTo(16.7, 1);
    for (const scale of [1, 0.2]) expect(eyes(scale, 0, 0.5).above).toBeCloseTo(0.6 * scale);
  });

  it("is that of a standing user for a seated one", () => {
    const sitting = new Matrix4().setPosition(0, 1.2, 0);
    for (const [height, away] of [[1.1, 4], [0.6, 2.4]]) {
      expect(eyes(1, height, away, 0.4, sitting).above).toBeCloseTo(eyes(1, height, away).above);
    }
    expect(eyes(1, 1.1, 4, 0, sitting).above).toBeCloseTo(1.2);
  });

  it("is that of a small scene high above the ground", () => {
    expect(eyes(0.1, 1.2, 2).above).toBeCloseTo(1.2 + 0.1 * 0.15);
  });
});

it("the ratio of sizes is written as on a map", () => {
  expect([1, 0.24, 45.5, 2e-9, 1.25].map(ratioOf)).toEqual(["1 : 1", "4.2 : 1", "1 : 46", "5e8 : 1", "1 : 1.3"]);
});

describe("the back of the left hand is looked at as a watch", () => {
  const eyes = new Vector3(0, 1.6, 0);
  const lookAt = (from: Vector3, to: Vector3) => new Matrix4().lookAt(from, to, new Vector3(0, 1, 0)).setPosition(from);
  /** `turn`: of the hand, whose fingers are along -z and whose back is along y. */
  const hand = (at: readonly [number, number, number], turn: Quaternion) => new Matrix4().makeRotationFromQuaternion(turn).setPosition(...at);
  const above = (at: Matrix4) => new Vector3().setFromMatrixPosition(at).add(new Vector3(0, 0.15, 0));
  const watched = (at: Matrix4, looksTo: Vector3, before: boolean) => isWatched(at, above(at), lookAt(eyes, looksTo), before);
  const ahead = new Vector3(0, 1.5, -2);
  /** The wrist of a relaxed bare hand whose ray points ahead, as a headset tells it: bent up by 30 degrees. */
  const relaxed = new Quaternion().setFromRotationMatrix(new Matrix4().set(
    0.962, 0.001, -0.274, 0, -0.138, 0.865, -0.483, 0, 0.237, 0.502, 0.832, 0, 0, 0, 0, 1,
  ));
  /** Fingers to the right, and the back to the eyes as far as `share`. */
  const atAWatch = (share: number) => {
    const at: [number, number, number] = [-0.1, 1.3, -0.35];
    const tilt = Math.atan2(0.35, 0.3) * share;
    return hand(at, new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), tilt).multiply(new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), -Math.PI / 2)));
  };

  it("where its arm is across and the user looks there", () => {
    const at = atAWatch(1);
    expect(watched(at, above(at), false)).toBe(true);
    expect(watched(at, new Vector3(2, 1.6, -1), true)).toBe(false);
    expect(watched(atAWatch(-0.5), above(at), true)).toBe(false);
  });

  it("not where it points ahead or works, with or without a controller, whether or not it was before", () => {
    for (const turn of [new Quaternion(), relaxed]) {
      for (const height of [1.1, 1.3, 1.45]) {
        const at = hand([-0.2, height, -0.4], turn);
        expect(watched(at, above(at), false), `${height} m, looked at`).toBe(false);
        expect(watched(at, ahead, true), `${height} m, with the eyes ahead, after it was`).toBe(false);
      }
    }
  });

  it("goes on a little further than it begins, so that it does not flicker", () => {
    const turned = [1, 0.7, 0.5, 0.3, 0, -0.3].map(atAWatch);
    const states = (before: boolean) => turned.map((at) => watched(at, above(at), before));
    const [begins, goesOn] = [states(false), states(true)];
    expect(goesOn.filter(Boolean).length).toBeGreaterThan(begins.filter(Boolean).length);
    begins.forEach((does, index) => expect(does && !goesOn[index]).toBe(false));
  });
});

describe("the wrist panel's layout", () => {
  const page = (styles: number): Entry[] => [
    { name: "play", places: ["bar", "panel"], title: () => "Pause", sign: () => "M0 0", run: () => {} },
    { name: "speed", places: ["panel"], title: () => "Speed", options: ["1"], unit: "", value: () => "1", choose: () => {} },
    { name: "style", places: ["panel"], title: () => "Style", offered: () => styles > 1, run: () => {} },
    { name: "grid", keys: ["g"], title: () => "Grid", run: () => {} },
    { name: "leave", places: ["panel foot"], title: () => "Leave VR", run: () => {} },
  ];
  const action = (name: string, button: "a" | "b" | null): ScriptCommand => ({
    name: `action ${name}`, button, onBody: true, title: () => name, offered: () => false, run: () => {}, runOn: () => {},
  });
  const commandsOf = (styles: number, ...script: ScriptCommand[]): Commands => {
    const commands = new Commands();
    commands.add(...page(styles));
    commands.script = script;
    return commands;
  };

  it("has the commands of the panel and a button for each action, none over another or outside", () => {
    const actions = ["break", "join", "paint", "burn"].map((name) => action(name, name === "break" ? "b" : null));
    const { buttons, height, readings } = layoutPanel(commandsOf(2, ...actions));
    expect(buttons.map((button) => button.command.name)).toEqual([
      "play", "style", "action break", "action join", "action paint", "action burn", "leave",
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

  it("keeps the places of commands that are not offered now", () => {
    const play = (styles: number) => layoutPanel(commandsOf(styles)).buttons[0];
    expect(layoutPanel(commandsOf(1)).buttons.map((button) => button.command.name)).not.toContain("style");
    expect(play(1).x).toBe(play(2).x);
  });

  it("turns over where there are more rows than fit, and shows each of them once", () => {
    const actions = Array.from({ length: 50 }, (_, index) => action(`act${index}`, null));
    let leaf = 0;
    const turn = (to: number) => { leaf = to; };
    const seen: string[] = [];
    const first = layoutPanel(commandsOf(1, ...actions), {}, 0, turn);
    do {
      const { buttons, height } = layoutPanel(commandsOf(1, ...actions), {}, leaf, turn);
      expect(height).toBeLessThanOrEqual(first.height);
      seen.push(...buttons.map(({ command }) => command.name).filter((name) => name.startsWith("action")));
      const { command } = buttons.find((button) => button.command.name === "next leaf")!;
      if ("run" in command) command.run();
    } while (leaf !== 0);
    expect(seen).toEqual(actions.map(({ name }) => name));
    expect(first.readings.map(({ command }) => command.title())).toContain("1 of 3");
    expect(layoutPanel(commandsOf(1, ...actions.slice(0, 21))).buttons.map(({ command }) => command.name)).not.toContain("next leaf");
  });

  const plotOf = (label: string): PlotEntity => ({
    id: { slot: 0, generation: 1 }, label, unit: "", seconds: 1, curves: [""], colors: new Uint32Array(1), times: new Float32Array(), values: new Float32Array(),
  });

  it("has the script's plots below its actions and controls, none over another or outside", () => {
    const { plots, buttons, height } = layoutPanel(commandsOf(1, action("break", null)), { plots: ["speed", "height", "force"].map(plotOf) });
    expect(plots.map(({ plot }) => plot.label)).toEqual(["speed", "height", "force"]);
    const named = (name: string) => buttons.find(({ command }) => command.name === name)!;
    for (const one of plots) {
      expect(one.x).toBeGreaterThan(0);
      expect(one.x + one.width).toBeLessThan(panelWidth);
      expect(one.y).toBeGreaterThan(named("action break").y + named("action break").height);
      expect(one.y + one.height).toBeLessThan(named("leave").y);
      expect(named("leave").y).toBeLessThan(height);
      for (const other of plots) {
        const apart = other.x >= one.x + one.width || one.x >= other.x + other.width || other.y >= one.y + one.height || one.y >= other.y + other.height;
        expect(other === one || apart).toBe(true);
      }
    }
  });

  it("turns over to the plots that do not fit, no leaf being taller than without them", () => {
    const actions = Array.from({ length: 18 }, (_, index) => action(`act${index}`, null));
    const labels = ["a", "b", "c", "d", "e", "f", "g"];
    const tallest = layoutPanel(commandsOf(1, ...actions, action("last", null))).height;
    const leaves = [0, 1].map((leaf) => layoutPanel(commandsOf(1, ...actions), { plots: labels.map(plotOf) }, leaf));
    expect(leaves.map(({ plots }) => plots.length)).toEqual([0, 6]);
    const more = layoutPanel(commandsOf(1, ...actions), { plots: labels.map(plotOf) }, 2);
    expect([...leaves, more].flatMap(({ plots }) => plots.map(({ plot }) => plot.label))).toEqual(labels);
    for (const { height } of [...leaves, more]) expect(height).toBeLessThanOrEqual(tallest);
  });

  it("has the script's controls, which do what their presses say", () => {
    const changes: [string, number][] = [];
    const made = (kind: WidgetKind, label: string, extra: Partial<WidgetEntity> = {}): WidgetEntity => ({
      id: { slot: 0, generation: 1 }, kind, label, help: "", unit: "", value: 0, minimum: 0, maximum: 0, step: 0, text: "", options: [], enabled: true, client: 0, ...extra,
    });
    const rows = controlRows([
      made(WidgetKind.slider, "gravity", { minimum: 0, maximum: 20, value: 9.5, unit: "m/s²" }),
      made(WidgetKind.slider, "count", { minimum: 1, maximum: 5, value: 5, step: 1 }),
      made(WidgetKind.checkbox, "wind", { value: 1 }), made(WidgetKind.button, "throw"),
      made(WidgetKind.choice, "material", { options: ["steel", "wood"], value: 1 }),
      made(WidgetKind.slider, "fixed", { maximum: 1, enabled: false }),
    ], ({ label }, value) => changes.push([label, value]));
    const { buttons, readings } = layoutPanel(commandsOf(1), { controls: rows });
    expect(readings.map(({ command }) => command.title())).toContain("gravity: 9.5 m/s²");
    const press = (name: string) => {
      const { command } = buttons.find((button) => button.command.name === name)!;
      if ("run" in command) command.run();
    };
    for (const name of ["more gravity", "less gravity", "more count", "less count", "control wind", "control throw", "control material"]) press(name);
    expect(changes).toEqual([["gravity", 10.5], ["gravity", 8.5], ["count", 5], ["count", 4], ["wind", 0], ["throw", 0], ["material", 0]]);
    expect(buttons.find(({ command }) => command.name === "control wind")!.command.active?.()).toBe(true);
    expect(buttons.find(({ command }) => command.name === "more fixed")!.command.enabled?.()).toBe(false);
  });
});
