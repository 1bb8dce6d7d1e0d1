// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { Pointer } from "../src/interact/gestures.ts";
import { Events } from "../src/page/events.ts";
import { Selection } from "../src/page/selection.ts";
import { Role, type ClientMessage, type Id } from "../src/protocol/generated.ts";
import { body, bodyEntity, frame, id, part, visual, TestWorld } from "./test_world.ts";

/** A selection over two balls, 2 m apart on the x axis, and its messages to the server. */
class Bench extends TestWorld {
  readonly sent: ClientMessage[] = [];
  readonly selection: Selection;
  readonly pointer = new Pointer("mouse");
  readonly session: { role: Role };

  constructor(look = "ball") {
    super();
    const session = {
      clientId: 1, role: Role.host as Role,
      idOf: (slot: number): Id => this.world.entities.body.idOf(slot) ?? id(0, 0),
      select: (slot: number) => this.sent.push({ type: "select", body: session.idOf(slot) }),
      send: (message: ClientMessage) => this.sent.push(message),
    };
    this.session = session;
    this.selection = new Selection(this.world, session, { invalidate: () => {} }, new Events());
    this.selection.gestures.add(this.pointer);
    this.set("visual", visual(0, look, part("sphere", [0.2])));
    this.set("body", bodyEntity(0, { id: id(0, 3) }), bodyEntity(1, { id: id(1, 5) }));
    this.poses([body(0, 1), body(1, 3)]);
    this.pointer.active = true;
  }

  override bodyGone(slot: number): void {
    super.bodyGone(slot);
    this.selection.bodyGone(slot);
  }

  aim(x: number): void {
    this.pointer.origin.set([x, 0, 2]);
    this.selection.interact();
  }

  press(pressed: boolean): void {
    this.pointer.pressed = pressed;
    this.selection.interact();
  }
}

describe("the selection", () => {
  it("names bodies to the server by slot and generation", () => {
    const bench = new Bench();
    bench.aim(3);
    bench.press(true);
    expect(bench.sent).toMatchObject([{ type: "select", body: id(1, 5) }, { type: "grabStart", body: id(1, 5) }]);
  });

  it("of a viewer takes hold of nothing: a press selects, and a drag is for the camera", () => {
    const bench = new Bench();
    bench.session.role = Role.viewer;
    bench.aim(3);
    bench.press(true);
    bench.aim(1);
    expect(bench.sent).toEqual([{ type: "select", body: id(1, 5) }]);
    expect(bench.pointer.grab).toBeNull();
    bench.press(false);
    bench.selection.adding = true;
    bench.press(true);
    expect([bench.selection.selected, [...bench.selection.several]]).toEqual([1, [0]]);
  });

  it("is told to the server again after a lost connection, and its holds end", () => {
    const bench = new Bench();
    bench.aim(3);
    bench.press(true);
    bench.sent.length = 0;
    bench.selection.link("lost");
    expect(bench.sent).toMatchObject([{ type: "grabEnd" }]);
    bench.selection.link("connected");
    expect(bench.sent.slice(1)).toEqual([{ type: "select", body: id(1, 5) }]);
  });

  it("passes a pulse of the script to the hand that it names", () => {
    const bench = new Bench();
    const felt: [string, number, number][] = [];
    for (const name of ["left", "right"]) {
      const hand = new Pointer(name);
      hand.pulse = (strength, milliseconds) => felt.push([name, strength, milliseconds]);
      bench.selection.gestures.add(hand);
    }
    bench.selection.pulse("left", 0.75, 0.25);
    expect(felt).toEqual([["left", 0.75, 250]]);
    bench.selection.pulse("", 0.5, 0.1);
    expect(felt.map(([name]) => name)).toEqual(["left", "left", "right"]);
  });

  it("does not pass to another body that gets the slot of a selected one", () => {
    const bench = new Bench();
    bench.selection.select(1);
    bench.set("body", bodyEntity(1, { id: id(1, 6) }));
    expect(bench.selection.selected).toBe(-1);
    expect(bench.sent.at(-1)).toEqual({ type: "select", body: id(0, 0) });
  });

  it("ends the hold of a body that is gone, and does not hold the next one in its slot", () => {
    const bench = new Bench();
    bench.aim(3);
    bench.press(true);
    bench.set("body", bodyEntity(1, { id: id(1, 6) }));
    bench.poses([body(1, 3)]);
    bench.selection.update();
    expect(bench.selection.held).toBe(-1);
    expect(bench.sent.filter((message) => message.type === "grabEnd")).toHaveLength(1);
    bench.aim(3.1); // the hand goes on, closed
    expect(bench.sent.filter((message) => message.type === "grabMove")).toEqual([]);
  });

  it("pulls a particle by its center, which a press without a motion leaves where it is", () => {
    const bench = new Bench("(particle)");
    bench.aim(3.1);
    bench.press(true);
    const sent = bench.sent.at(-1)!;
    if (sent.type !== "grabStart") throw new Error(sent.type);
    expect(sent.localPoint).toEqual([0, 0, 0]);
    const [x] = sent.target;
    expect(x).toBeCloseTo(3, 3);
    bench.aim(3.1);
    expect(bench.sent.at(-1), "no motion").toBe(sent);
    bench.aim(3.6);
    const moved = bench.sent.at(-1)!;
    expect(moved.type === "grabMove" && moved.target[0] - x).toBeCloseTo(0.5, 5);
  });

  it("takes the target to where the server's hold acts, if the look does not tell it", () => {
    const bench = new Bench();
    bench.aim(3);
    bench.press(true);
    const [{ hold }] = bench.selection.gestures.grabs;
    bench.poses([body(0, 1), body(1, 3)], { holds: [{ client: 1, hold, body: 1, point: [3, 0, 0], target: [3, 0, 0.2], force: 2 }] });
    bench.selection.update();
    bench.aim(3);
    const sent = bench.sent.at(-1)!;
    expect(sent.type === "grabMove" && Math.abs(sent.target[2])).toBeLessThan(2e-3);
  });

  it("goes on holding the body that absorbed the held one, as the server does", () => {
    const bench = new Bench();
    bench.aim(3);
    bench.press(true);
    const [grab] = bench.selection.gestures.grabs;
    const { hold } = grab;
    bench.destroy("body", id(1, 5));
    bench.selection.update(); // a picture before the poses come
    expect(bench.selection.held).toBe(-1);
    bench.poses([body(0, 1)], { holds: [{ client: 1, hold, body: 0, point: [1.5, 0, 0], target: [3, 0, 0], force: 2 }] });
    bench.selection.update();
    expect(bench.selection.held).toBe(0);
    const at = new Float32Array(3);
    bench.selection.gestures.grabbedPoint(grab, at);
    expect(Math.hypot(at[0] - 1.5, at[1], at[2]), "m from where the server holds it").toBeLessThan(1e-6);
    bench.aim(3.5);
    expect(bench.sent.at(-1)).toMatchObject({ type: "grabMove", hold });
    expect(bench.sent.filter((message) => message.type === "grabEnd")).toEqual([]);
  });

  it("goes on holding the part that was taken from the held body, which still exists", () => {
    const bench = new Bench();
    bench.aim(3);
    bench.press(true);
    const [grab] = bench.selection.gestures.grabs;
    const { hold } = grab;
    bench.set("body", bodyEntity(2, { id: id(2, 1) }));
    const turned = [0, 0, Math.SQRT1_2, Math.SQRT1_2];  // by 90 degrees about z
    bench.world.takePoses(frame(9, [body(1, 3), body(2, 7, turned)], {
      structureVersion: 2, holds: [{ client: 1, hold, body: 2, point: [7, 0.1, 0], target: [7, 0.5, 0], force: 2 }],
    }), 200);
    bench.selection.update(); // before the first picture of the new body
    bench.update();
    const { selection } = bench;
    expect([selection.held, selection.actionBodies, selection.selected]).toEqual([2, [2], 2]);
    const at = new Float32Array(3);
    selection.gestures.grabbedPoint(grab, at);
    expect(Math.hypot(at[0] - 7, at[1] - 0.1, at[2]), "m from where the server holds it").toBeLessThan(2e-3);
    bench.press(false);
    expect(bench.sent.filter(({ type }) => type === "grabEnd")).toEqual([{ type: "grabEnd", hold }]);
    expect(bench.sent.filter(({ type }) => type === "select").at(-1)).toEqual({ type: "select", body: id(2, 1) });
    expect(selection.actionBodies, "after the hand has let go").toEqual([2]);
  });

  it("leaves what the user selected meanwhile, and several, selected when the held part goes to another body", () => {
    for (const select of [(selection: Selection) => selection.select(0), (selection: Selection) => selection.selectMany([1, 0])]) {
      const bench = new Bench();
      bench.aim(3);
      bench.press(true);
      select(bench.selection);
      const { selected, several } = bench.selection;
      const [{ hold }] = bench.selection.gestures.grabs;
      bench.set("body", bodyEntity(2));
      bench.poses([body(0, 1), body(1, 3), body(2, 7)], { holds: [{ client: 1, hold, body: 2, point: [7, 0, 0], target: [7, 0, 0], force: 0 }] });
      bench.selection.update();
      expect([bench.selection.held, bench.selection.selected, bench.selection.several]).toEqual([2, selected, several]);
    }
  });

  it("keeps the held point in its place when an edit moves the origin of its body", () => {
    const bench = new Bench();
    bench.aim(3);
    bench.press(true);
    const [grab] = bench.selection.gestures.grabs;
    const { hold } = grab;
    bench.poses([body(1, 3)], { holds: [{ client: 1, hold, body: 1, point: [3, 0, 0.2], target: [3, 0, 0.2], force: 0 }] });
    bench.selection.update();
    bench.poses([body(1, 4)], { structureVersion: 2, holds: [{ client: 1, hold, body: 1, point: [3, 0, 0], target: [3, 0, 0], force: 0 }] });
    bench.selection.update();
    expect(grab.localPoint[0], "m from the origin, which is 1 m from the held point").toBeCloseTo(-1, 3);
  });

  it("points at nothing where the body that was pointed at is gone", () => {
    const bench = new Bench();
    bench.aim(3);
    expect(bench.selection.hovered).toBe(1);
    bench.destroy("body", id(1, 5));
    expect(bench.selection.hovered).toBe(-1);
    expect(bench.selection.actionBody).toBe(-1);
  });

  it("names a body that took the slot of another by its own generation", () => {
    const bench = new Bench();
    bench.set("body", bodyEntity(1, { id: id(1, 6) }));
    bench.poses([body(1, 3)]);
    bench.aim(3);
    bench.press(true);
    expect(bench.sent.at(-1)).toMatchObject({ type: "grabStart", body: id(1, 6) });
  });

  it("goes from body to body, round and round", () => {
    const bench = new Bench();
    const selected: number[] = [];
    for (let time = 0; time < 3; time++) {
      bench.selection.selectNext(1);
      selected.push(bench.selection.selected);
    }
    expect(selected).toEqual([0, 1, 0]);
  });

  it("is added to by each press while several are selected", () => {
    const bench = new Bench();
    const { selection } = bench;
    const take = (x: number) => {
      bench.aim(x);
      bench.press(true);
      bench.press(false);
    };
    selection.adding = true;
    take(1);
    take(3);
    expect(selection.actionBodies).toEqual([0, 1]);
    take(1);
    expect(selection.actionBodies).toEqual([1]);
    selection.adding = false;
    take(1);
    expect(selection.actionBodies).toEqual([0]);
  });

  it("may be of several bodies, which an action is about, and which go one by one", () => {
    const bench = new Bench();
    const { selection } = bench;
    selection.selectMany([1, 0, 1]);
    expect([selection.selected, [...selection.several], selection.actionBodies]).toEqual([1, [0], [1, 0]]);
    expect(bench.sent.filter(({ type }) => type === "select")).toEqual([{ type: "select", body: id(1, 5) }]);
    bench.aim(1);
    bench.press(true);
    expect(selection.actionBodies).toEqual([1, 0]);
    bench.press(false);
    selection.toggle(1);
    expect([selection.selected, selection.several.size]).toEqual([0, 0]);
    selection.toggle(1);
    expect(selection.actionBodies).toEqual([0, 1]);
    bench.destroy("body", id(0, 3));
    expect([selection.selected, selection.several.size]).toEqual([1, 0]);
    selection.select(-1);
    expect(selection.actionBodies).toEqual([]);
  });
});
