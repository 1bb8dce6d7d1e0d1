// SPDX-License-Identifier: Apache-2.0
import { BoxGeometry, Mesh, PerspectiveCamera, SphereGeometry, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { Navigation } from "../src/navigate/navigation.ts";
import { wallsOf } from "../src/page/walking.ts";
import { BodyKind, NO_BODY, NO_COLOR, type SurfaceEntity } from "../src/protocol/generated.ts";
import { Walls, type Obstacle } from "../src/scene/walls.ts";
import { body, bodyEntity, id, part, visual, TestWorld } from "./test_world.ts";

/** A room of 4 x 3 x 6 m about the origin, times `size`, of walls of 5 cm, turned; with a ball in the middle. */
function room(size: number): { walls: Walls; turned: (x: number, y: number, z: number) => Vector3 } {
  const turn = new Vector3(0, 1, 0);
  const turned = (x: number, y: number, z: number) => new Vector3(x, y, z).multiplyScalar(size).applyAxisAngle(turn, 0.6);
  const wall = (sizes: readonly [number, number, number], x: number, y: number, z: number) => {
    const mesh = new Mesh(new BoxGeometry(...(sizes.map((value) => size * value) as [number, number, number])));
    mesh.position.copy(turned(x, y, z));
    mesh.quaternion.setFromAxisAngle(turn, 0.6);
    return mesh;
  };
  const meshes = [
    ...[-1, 1].map((side) => wall([0.05, 3, 6], 2 * side, 0, 0)), ...[-1, 1].map((side) => wall([4, 0.05, 6], 0, 1.5 * side, 0)),
    ...[-1, 1].map((side) => wall([4, 3, 0.05], 0, 0, 3 * side)), new Mesh(new SphereGeometry(0.5 * size, 64, 48)),
  ];
  return { walls: new Walls(() => meshes), turned };
}

describe("walls", () => {
  it.each([1e-9, 1, 1e3])("let nobody out of a room of 4 x 3 x 6 times %s m, wherever and however fast they go", (size) => {
    const { walls, turned } = room(size);
    const radius = 0.2 * size;
    let seed = 7;
    const random = () => ((seed = (seed * 16807) % 2147483647) / 2147483647) - 0.5;
    const at = turned(1.2, 0, 1);
    for (let step = 0; step < 400; step++) {
      const way = turned(6 * random(), 6 * random(), 6 * random());
      walls.slide(at, way, radius);
      at.add(way);
      const inside = at.clone().divideScalar(size).applyAxisAngle(new Vector3(0, 1, 0), -0.6);
      expect(Math.abs(inside.x)).toBeLessThan(1.975 - 0.19);
      expect(Math.abs(inside.y)).toBeLessThan(1.475 - 0.19);
      expect(Math.abs(inside.z)).toBeLessThan(2.975 - 0.19);
      expect(inside.length()).toBeGreaterThan(0.5 + 0.18);
    }
  });

  it("are slid along, and stop nobody in the open", () => {
    const { walls, turned } = room(1);
    const at = turned(1.5, 0, 0);
    const way = turned(0.6, 0, 0.8);
    walls.slide(at, way, 0.2);
    const moved = way.applyAxisAngle(new Vector3(0, 1, 0), -0.6);
    expect(moved.x).toBeCloseTo(1.975 - 0.2 - 1.5, 2);
    expect(moved.z).toBeCloseTo(0.8, 1);
    const free = turned(0, 0, 0.7);
    walls.slide(turned(1.2, 0, 0), free, 0.2);
    expect(free.distanceTo(turned(0, 0, 0.7))).toBeLessThan(1e-12);
  });
});

/** Ten steps of 0.3 m, each `rise` m higher than the last, up along x from x = 1; and a ground. */
function stairs(rise: number): Walls {
  const meshes = Array.from({ length: 10 }, (_, step) => {
    const mesh = new Mesh(new BoxGeometry(0.3, rise * (step + 1), 2));
    mesh.position.set(1.15 + 0.3 * step, (rise * (step + 1)) / 2, 0);
    return mesh;
  });
  return new Walls(() => meshes, () => [], () => 0);
}

function walk(walls: Walls, at: Vector3, x: number, steps: number): void {
  for (let step = 0; step < steps; step++) {
    const way = new Vector3(x, 0, 0);
    walls.slide(at, way, 0.12);
    at.add(way);
  }
}

describe("stairs", () => {
  it.each([0.15, 0.4])("of %s m are climbed and descended at the same height of the eyes above them", (rise) => {
    const walls = stairs(rise);
    const at = new Vector3(0, 1.6, 0);
    walk(walls, at, 0.05, 78);
    expect(at.x).toBeCloseTo(3.9, 5);
    expect(at.y).toBeCloseTo(1.6 + 10 * rise, 3);
    walk(walls, at, -0.05, 78);
    expect(at.y).toBeCloseTo(1.6, 3);
  });

  it("of half a meter are not", () => {
    const at = new Vector3(0, 1.6, 0);
    walk(stairs(0.5), at, 0.05, 28);
    expect(at.toArray()).toEqual([expect.closeTo(1.4, 5), expect.closeTo(1.6, 5), expect.closeTo(0, 5)]);
  });

  it("do not stop a user who flies up and down in the open", () => {
    const at = new Vector3(0, 1.6, 0);
    const way = new Vector3(0, 0.1, 0);
    stairs(0.2).slide(at, way, 0.12);
    expect(way.distanceTo(new Vector3(0, 0.1, 0))).toBeLessThan(1e-12);
  });
});

/** A platform of 4 x `height` x 4 m over the ground, with its edge at x = 2. */
function platform(height: number): Walls {
  const mesh = new Mesh(new BoxGeometry(4, height, 4));
  mesh.position.set(0, height / 2, 0);
  return new Walls(() => [mesh], () => [], () => 0);
}

/** Walks from the middle of a platform along +x, with the eyes `eyes` m over it; heights of the eyes after each 20 ms. */
function walkOff(height: number, eyes: number, prepare: (navigation: Navigation) => void = () => undefined): number[] {
  const camera = new PerspectiveCamera();
  const navigation = new Navigation(camera);
  navigation.setScene([0, 3, 0], 2);
  navigation.walls = platform(height);
  navigation.setHome({ pivot: [1, height + eyes, 0], distance: 1, yaw: -Math.PI / 2, pitch: 0 });
  navigation.jumpHome();
  navigation.walk.set(0, 0, 1);
  prepare(navigation);
  return Array.from({ length: 200 }, (_, frame) => {
    if (frame === 100) navigation.walk.set(0, 0, 0);
    navigation.update(0.02);
    return camera.position.y;
  });
}

describe("an edge", () => {
  it("of a high platform is fallen off, as long as a fall takes, to the same height of the eyes", () => {
    const heights = walkOff(2, 1.6);
    expect(heights[20]).toBeCloseTo(3.6, 5);
    expect(heights.at(-1)).toBeCloseTo(1.6, 3);
    const [began, ended] = [heights.findIndex((y) => y < 3.59), heights.findIndex((y) => y < 1.61)];
    // The view follows with a delay of some hundredths of a second.
    expect(0.02 * (ended - began)).toBeCloseTo(Math.sqrt((2 * 2) / 9.81), 0);
  });

  it("does not happen to a user who looks from high above, flies, or goes up", () => {
    expect(walkOff(2, 5).at(-1)).toBeCloseTo(7, 5);
    expect(walkOff(2, 1.6, (navigation) => { navigation.flying = true; }).at(-1)).toBeCloseTo(3.6, 5);
    expect(walkOff(2, 1.6, (navigation) => { navigation.walk.y = 0.01; }).at(-1)).toBeGreaterThan(3.6);
  });
});

describe("static bodies", () => {
  /** A static box of 1 x 2 x 4 m about (4, 0, 0), turned by 45 degrees about y, and a movable ball at (8, 0, 0). */
  function made(): Walls {
    const tested = new TestWorld();
    const eighth = Math.PI / 8;
    tested.set("visual", visual(0, "wall", part("box", [1, 2, 4, 0])), visual(1, "ball", part("sphere", [1])));
    tested.set("body", bodyEntity(0, { kind: BodyKind.static }), bodyEntity(1, { visual: 1 }));
    tested.poses([body(0, 4, [0, Math.sin(eighth), 0, Math.cos(eighth)]), body(1, 8)]);
    return wallsOf(tested.world);
  }

  it("stop a walk, movable ones do not", () => {
    const walls = made();
    const at = new Vector3(2, 0, 0);
    walk(walls, at, 0.05, 60);
    // Its face is 0.5 m from its middle; the walker slides along it.
    expect((4 - at.x + at.z) * Math.SQRT1_2).toBeGreaterThan(0.5 + 0.11);
    const beyond = new Vector3(6, 0, 0);
    walk(walls, beyond, 0.05, 60);
    expect(beyond.x).toBeCloseTo(9, 5);
  });

  it("are met by a straight way at their surface, with its normal", () => {
    const met: Obstacle = { share: 0, normal: new Vector3() };
    made().meet(new Vector3(0, 0, 0), new Vector3(8, 0, 0), met);
    expect(8 * met.share).toBeCloseTo(4 - 0.5 * Math.SQRT2, 2);
    expect(met.normal.x).toBeCloseTo(-Math.SQRT1_2, 2);
    made().meet(new Vector3(0, 3, 0), new Vector3(8, 3, 0), met);
    expect(met.share).toBe(1);
  });

  it("of triangles are felt by these, not by the box around them", () => {
    const tested = new TestWorld();
    // Two walls at x = 3.5 and 4.5: the box around both would stop a walk between them.
    const at = [-0.5, 0.5].flatMap((x) => [x, -3, -9, x, -3, 9, x, 3, 9, x, 3, -9]);
    const mesh = { ...part("mesh", []), shape: { kind: "mesh", sizes: new Float32Array(0), vertices: Float32Array.from(at), triangles: Uint32Array.of(0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7) } };
    tested.set("visual", visual(0, "walls", mesh));
    tested.set("body", bodyEntity(0, { kind: BodyKind.static }));
    tested.poses([body(0, 4)]);
    const place = new Vector3(4, 0, 0);
    walk(wallsOf(tested.world), place, 0.05, 60);
    expect(place.x).toBeCloseTo(4.5 - 0.12, 2);
    walk(wallsOf(tested.world), place, -0.05, 60);
    expect(place.x).toBeCloseTo(3.5 + 0.12, 2);
  });

  it("are floors", () => {
    const walls = made();
    expect(walls.floorBelow(new Vector3(4, 5, 0))).toBeCloseTo(1, 2);
    expect(walls.floorBelow(new Vector3(1, 5, 0))).toBe(-Infinity);
  });
});

describe("surfaces, as those of a room from a file,", () => {
  const wall: SurfaceEntity = {
    id: id(0), at: { body: 1, point: [0, 0, 0] }, bodies: new Uint32Array(0), points: Float32Array.of(0, -3, -9, 0, -3, 9, 0, 3, 9, 0, 3, -9),
    triangles: Uint32Array.of(0, 1, 2, 0, 2, 3), coordinates: new Float32Array(0), material: "paint", color: NO_COLOR,
  };
  /** How far along x a walk from x = 2 gets before it. */
  function reached(surface: SurfaceEntity): number {
    const tested = new TestWorld();
    tested.set("visual", visual(0, "ball", part("sphere", [0.1])));
    tested.set("body", bodyEntity(0), bodyEntity(1, { kind: BodyKind.static, visual: NO_BODY }));
    tested.poses([body(0, 4), body(1, 4)]);
    tested.world.entities.surface.create(surface);
    tested.world.entities.surface.draw();
    const at = new Vector3(2, 0, 0);
    walk(wallsOf(tested.world), at, 0.05, 80);
    return at.x;
  }

  it("stop a walk from either side on a static body; those elsewhere, and those that bend, do not", () => {
    expect(reached(wall)).toBeCloseTo(4 - 0.12, 2);
    expect(reached({ ...wall, triangles: Uint32Array.of(0, 2, 1, 0, 3, 2) })).toBeCloseTo(4 - 0.12, 2);
    expect(reached({ ...wall, at: { body: 0, point: [0, 0, 0] } })).toBeCloseTo(6, 5);
    expect(reached({ ...wall, at: { body: NO_BODY, point: [4, 0, 0] } })).toBeCloseTo(6, 5);
    expect(reached({ ...wall, bodies: new Uint32Array(4).fill(NO_BODY) })).toBeCloseTo(6, 5);
  });
});

describe("a straight way", () => {
  it.each([1e-6, 1, 1e3])("meets the first wall of several at its face, in a world of %s m", (size) => {
    const { walls, turned } = room(size);
    const met: Obstacle = { share: 0, normal: new Vector3() };
    walls.meet(turned(1, 0, 0), turned(9, 0, 0), met);
    expect(8 * met.share).toBeCloseTo(0.975, 4);
    expect(met.normal.distanceTo(turned(-1 / size, 0, 0))).toBeLessThan(1e-3);
    walls.meet(turned(1, 0, 0), turned(1.5, 0, 0), met);
    expect(met.share).toBe(1);
  });
});
