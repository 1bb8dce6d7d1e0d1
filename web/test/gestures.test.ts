// SPDX-License-Identifier: Apache-2.0
import { beforeEach, describe, expect, it } from "vitest";
import { Gestures, Pointer, type GestureListener, type Grab } from "../src/interact/gestures.ts";
import { TestScene } from "./test_scene.ts";

class Log implements GestureListener {
  readonly lines: string[] = [];
  hoverChanged(pointer: Pointer, body: number): void { this.lines.push(`${pointer.name} hovers ${body}`); }
  grabStarted(grab: Grab): void { this.lines.push(`${grab.pointer.name} takes ${grab.body} as ${grab.hold}`); }
  grabMoved(grab: Grab): void { this.lines.push(`${grab.hold} to ${[...grab.target].map((value) => (Math.round(value * 100) / 100 + 0).toFixed(2)).join(" ")}`); }
  grabEnded(grab: Grab): void { this.lines.push(`${grab.hold} ends`); }
  pressedNothing(pointer: Pointer): void { this.lines.push(`${pointer.name} presses nothing`); }
  take(): string[] { return this.lines.splice(0); }
}

let scene: TestScene;
let log: Log;
let gestures: Gestures;
let pointer: Pointer;

function aim(x: number, y: number): void {
  const norm = Math.hypot(x, y, 1);
  pointer.direction.set([x / norm, y / norm, -1 / norm]);
}

beforeEach(() => {
  scene = new TestScene([{ kind: "sphere", sizes: [0.1] }, { kind: "sphere", sizes: [0.1] }]);
  scene.place(0, [0, 0, -2]);
  scene.place(1, [1, 0, -2]);
  log = new Log();
  gestures = new Gestures(scene, log);
  pointer = new Pointer("mouse");
  pointer.active = true;
  gestures.add(pointer);
});

describe("the gesture pipeline", () => {
  it("tells hover once, and again when it leaves", () => {
    gestures.updateAll();
    gestures.updateAll();
    aim(0.5, 0);
    gestures.updateAll();
    aim(0, 1);
    gestures.updateAll();
    expect(log.take()).toEqual(["mouse hovers 0", "mouse hovers 1", "mouse hovers -1"]);
  });

  it("notices that a body moves under a pointer that rests", () => {
    gestures.updateAll();
    scene.place(0, [0, 1, -2]);
    gestures.updateAll();
    expect(log.take()).toEqual(["mouse hovers 0", "mouse hovers -1"]);
  });

  it("drags in the plane that faces the viewer, whatever the body does meanwhile", () => {
    gestures.updateAll();
    pointer.pressed = true;
    gestures.update(pointer);
    scene.place(0, [0.5, 0.5, -2]);
    aim(0.2, 0);
    gestures.updateAll();
    pointer.pressed = false;
    gestures.update(pointer);
    // Grabbed at the front of the sphere, 1.9 m away: 0.2 of that is 0.38.
    expect(log.take().slice(0, 4)).toEqual(["mouse hovers 0", "mouse takes 0 as 1", "1 to 0.38 0.00 -1.90", "1 ends"]);
    expect(gestures.grabs).toHaveLength(0);
  });

  it("pushes away by depth, still under the pointer", () => {
    pointer.pressed = true;
    gestures.update(pointer);
    aim(0.2, 0);
    pointer.depth = 0.5;
    gestures.updateAll();
    expect(log.take().at(-1)).toBe("1 to 0.48 0.00 -2.40");
  });

  it("keeps the distance along a controller's ray", () => {
    pointer.drag = "ray";
    pointer.pressed = true;
    gestures.update(pointer);
    pointer.direction.set([1, 0, 0]);
    gestures.updateAll();
    expect(log.take().at(-1)).toBe("1 to 1.90 0.00 0.00");
  });

  it("prefers a body within reach of the hand to one on the ray", () => {
    pointer.tip.set([0.85, 0, -2]);
    pointer.nearReach = 0.1;
    gestures.updateAll();
    expect(pointer.near).toBe(true);
    pointer.pressed = true;
    gestures.update(pointer);
    pointer.tip.set([0.85, 0.3, -2]);
    gestures.updateAll();
    expect(log.take()).toEqual(["mouse hovers 1", "mouse takes 1 as 1", "1 to 0.90 0.30 -2.00"]);
  });

  it("accepts a pointer that appears at the moment of its press", () => {
    const pinch = new Pointer("left");
    gestures.add(pinch);
    pinch.active = pinch.pressed = true;
    gestures.update(pinch);
    expect(log.take()).toEqual(["left hovers 0", "left takes 0 as 1"]);
  });

  it("does not jerk a body that was only nearly hit", () => {
    pointer.tolerance = 0.1;
    aim(0.08, 0);
    pointer.pressed = true;
    gestures.update(pointer);
    gestures.updateAll();
    expect(log.take().filter((line) => line.startsWith("1 to"))).toEqual([]);
  });

  it("gives each hand its own hold, and ends it when the hand vanishes", () => {
    const other = new Pointer("touch 1");
    other.active = other.pressed = true;
    other.direction.set([0.447214, 0, -0.894427]);
    gestures.add(other);
    pointer.pressed = true;
    gestures.updateAll();
    expect(gestures.grabs.map((grab) => [grab.hold, grab.body])).toEqual([[1, 0], [2, 1]]);
    log.take();
    gestures.remove(other);
    expect(log.take()).toContain("2 ends");
    expect(gestures.grabs).toHaveLength(1);
  });

  it("lets go when a closed hand is not seen any more, and takes again what it meets when it comes back", () => {
    pointer.pressed = true;
    gestures.update(pointer);
    pointer.active = false;
    gestures.updateAll();
    expect(log.take()).toContain("1 ends");
    expect(gestures.grabs).toHaveLength(0);
    gestures.updateAll();
    expect(log.take()).toEqual([]);
    pointer.active = true;
    gestures.updateAll();
    expect(log.take()).toContain("mouse takes 0 as 2");
  });

  it("says when a press met nothing, and does not grab a body that comes by later", () => {
    aim(0, 1);
    pointer.pressed = true;
    gestures.update(pointer);
    aim(0, 0);
    gestures.updateAll();
    expect(log.take()).toEqual(["mouse presses nothing"]);
  });

  it("ends all grabs when the world is gone", () => {
    pointer.pressed = true;
    gestures.update(pointer);
    gestures.releaseAll();
    gestures.updateAll();
    expect(log.take().filter((line) => line.includes("ends") || line.includes("takes"))).toEqual(["mouse takes 0 as 1", "1 ends"]);
  });
});
