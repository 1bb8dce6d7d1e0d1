// SPDX-License-Identifier: Apache-2.0
import { BoxGeometry, Group, Mesh, MeshBasicMaterial, Vector3, type Object3D } from "three";
import { beforeEach, describe, expect, it, vi } from "vitest";
import { NO_BODY, type CustomEntity } from "../src/protocol/generated.ts";
import { CustomView, defineClass, type CustomClass } from "../src/scene/entities/custom.ts";
import type { CoverHit } from "../src/scene/pickable.ts";
import { Points } from "../src/scene/points.ts";
import { body, bodyEntity, id, TestWorld } from "./test_world.ts";

const half = Math.SQRT1_2;
let names = 0;
let name = "";
let tested: TestWorld;
let view: CustomView;

/** A box of 2 x 0.2 x 0.2 m along its x. */
const bar: CustomClass = { make: () => new Mesh(new BoxGeometry(2, 0.2, 0.2), new MeshBasicMaterial()) };

function object(extra: Partial<CustomEntity> = {}): CustomEntity {
  return { id: id(0), className: name, at: { body: 0, point: [0, 0, 0] }, rotation: [0, 0, 0, 1], values: "{}", ...extra };
}

function hitByRay(origin: readonly number[], direction: readonly number[]): CoverHit {
  const hit: CoverHit = { body: -1, distance: Infinity, localPoint: new Float32Array(3) };
  view.hitByRay(origin, direction, 0, hit);
  return hit;
}

function hitByPoint(point: readonly number[], reach: number): CoverHit {
  const hit: CoverHit = { body: -1, distance: reach, localPoint: new Float32Array(3) };
  view.hitByPoint(point, hit);
  return hit;
}

beforeEach(() => {
  name = `class ${names++}`;
  tested = new TestWorld();
  view = new CustomView(tested.world.poses, tested.world.marks, (slot) => slot === 0, (title, text) => tested.warn(title, text), () => {});
  tested.set("body", bodyEntity(0));
  // Turned by 90 degrees about z: its x is the world's y.
  tested.poses([body(0, 5, [0, 0, half, half])]);
});

describe("an object of the script's own class", () => {
  it("waits for its class, moves with its body, and is made anew for other values", () => {
    const made: unknown[] = [];
    view.create(object({ at: { body: 0, point: [1, 0, 0] }, values: '{"petals":7}' }));
    expect(view.count).toBe(0);
    defineClass(name, { make: (values) => { made.push(values); return new Group(); } });
    view.draw(0.016);
    expect(made).toEqual([{ petals: 7 }]);
    const [holder] = view.root.children as Object3D[];
    expect(holder.position.distanceTo(new Vector3(5, 1, 0))).toBeLessThan(0.01);
    view.change(object({ at: { body: 0, point: [2, 0, 0] }, values: '{"petals":7}' }));
    expect(made.length).toBe(1);
    view.change(object({ values: '{"petals":8}' }));
    expect(made[1]).toEqual({ petals: 8 });
    view.destroy(0);
    expect(view.root.children).toEqual([]);
  });

  it("is met at its triangles by rays and fingertips, and means its body", () => {
    defineClass(name, bar);
    view.create(object());
    view.draw(0);
    const hit = hitByRay([5, 0.9, 3], [0, 0, -1]);
    expect(hit.body).toBe(0);
    expect(hit.distance).toBeCloseTo(2.9, 2);
    // In the body's frame.
    [0.9, 0, 0.1].forEach((value, axis) => expect(hit.localPoint[axis]).toBeCloseTo(value, 2));
    expect(hitByRay([5.9, 0, 3], [0, 0, -1]).body).toBe(-1);
    const near = hitByPoint([5, 0.5, 0.25], 1);
    expect([near.body, Math.round(100 * near.distance)]).toEqual([0, 15]);
    expect(hitByPoint([5, 0.5, 0.25], 0.1).body).toBe(-1);
  });

  it("is met where its class says, even where its drawing is not", () => {
    defineClass(name, { ...bar, bounds: () => [[-1, -1, -1], [1, 1, 1]], distance: (_, [x, y, z]) => Math.hypot(x, y, z) - 0.7 });
    view.create(object());
    view.draw(0);
    expect(hitByRay([5, 0.9, 3], [0, 0, -1]).body).toBe(-1);
    expect(hitByRay([5.3, 0, 3], [0, 0, -1]).distance).toBeCloseTo(3 - Math.hypot(0.7, 0.3) + 0.12, 1);
    expect(hitByPoint([5, 0, 1], 1).distance).toBeCloseTo(0.3, 3);
  });

  it("gives way to nearer things, and to bodies that cannot be held", () => {
    defineClass(name, bar);
    view.create(object());
    view.draw(0);
    const hit: CoverHit = { body: 9, distance: 1, localPoint: new Float32Array(3) };
    view.hitByRay([5, 0, 3], [0, 0, -1], 0, hit);
    expect(hit.body).toBe(9);
    view.change(object({ at: { body: NO_BODY, point: [0, 0, 0] } }));
    view.draw(0);
    expect(hitByRay([0, 0, 3], [0, 0, -1]).body).toBe(-1);
  });

  it("adds its bounds to the picture: its own, or those that its class tells", () => {
    defineClass(name, bar);
    view.create(object());
    const points = new Points();
    view.addPlaces(points);
    expect(points.count).toBe(0);
    view.addMoving(points);
    const { center, radius } = points.bounds()!;
    expect(center[0]).toBeCloseTo(5, 2);
    expect(radius).toBeCloseTo(Math.hypot(1, 0.1, 0.1), 2);
    defineClass(name, { ...bar, bounds: () => [[-3, 0, 0], [3, 0, 0]] });
    points.clear();
    view.addMoving(points);
    expect(points.bounds()!.radius).toBeCloseTo(3, 2);
  });

  it("is told once when its body is pointed at, selected, held, and let go", () => {
    const told: string[] = [];
    defineClass(name, { ...bar, select: (_, mark) => void told.push(mark) });
    view.create(object());
    for (const marks of [{}, { hovered: 0 }, { hovered: 0 }, { hovered: 0, selected: 0, held: 0 }, { held: -1 }, { hovered: -1, selected: -1 }]) {
      Object.assign(tested.world.marks, marks);
      view.draw(0);
    }
    expect(told).toEqual(["hovered", "held", "selected", ""]);
  });

  it("whose class fails causes one notice, and the others go on", () => {
    let calls = 0;
    defineClass(name, { ...bar, draw: () => { calls++; throw new Error("no petals"); } });
    view.create(object());
    view.create(object({ id: id(1) }));
    view.draw(0);
    view.draw(0);
    expect(tested.warnings).toEqual([`draw of the class ${name} failed: Error: no petals`]);
    expect([calls, view.count]).toEqual([1, 2]);
    defineClass(name, { make: () => ({}) as Object3D });
    expect(view.count).toBe(0);
    expect(tested.warnings[1]).toContain("it returns no Object3D");
  });

  it("of a class that no module defines causes a notice", () => {
    vi.useFakeTimers();
    view.create(object());
    vi.advanceTimersByTime(6000);
    vi.useRealTimers();
    expect(tested.warnings).toEqual([`The class ${name} is not defined: No module of the script has called iota.define for it.`]);
  });

  it("needs a class that makes something", () => {
    expect(() => defineClass(name, {} as CustomClass)).toThrow("needs a function make");
  });
});
