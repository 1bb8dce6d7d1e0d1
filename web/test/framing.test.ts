// SPDX-License-Identifier: Apache-2.0
import { PerspectiveCamera, Vector3 } from "three";
import { afterEach, describe, expect, it, vi } from "vitest";
import { Navigation } from "../src/navigate/navigation.ts";
import { Framing } from "../src/page/framing.ts";
import type { Viewer } from "../src/page/viewer.ts";
import type { LinkState } from "../src/net/connection.ts";
import { addOutermost, dropOutside, fitView, shareOutside, standBack, viewAxes, type FittedView, type Frame } from "../src/navigate/framing.ts";
import { Points } from "../src/scene/points.ts";
import { body, bodyEntity, id, part, visual, TestWorld } from "./test_world.ts";

const frame: Frame = { side: 0.62, up: 0.34, down: 0.29 };

/** A number in 0..1 from a seed, the same in each run. */
function makeRandom(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 4294967296;
  };
}

function cloud(size: number, seed: number): Points {
  const random = makeRandom(seed);
  const points = new Points();
  for (let index = 0; index < 40; index++) {
    points.add(size * (random() * 3 + 5), size * (random() - 2), size * (random() * 0.5));
  }
  return points;
}

/** The largest share of the frame that a point takes up, to a side, up or down. */
function fullness({ xyz, count }: Points, view: NonNullable<ReturnType<typeof fitView>>): number {
  const [right, up, away] = viewAxes(view.yaw, view.pitch);
  let most = 0;
  for (let at = 0; at < 3 * count; at += 3) {
    const p = [0, 1, 2].map((axis) => xyz[at + axis] - view.pivot[axis]);
    const along = (axis: readonly number[]) => axis.reduce((sum, value, index) => sum + value * p[index], 0);
    const depth = view.distance - along(away);
    most = Math.max(most, Math.abs(along(right)) / (frame.side * depth), along(up) / (frame.up * depth), -along(up) / (frame.down * depth));
  }
  return most;
}

/** A world and its framing on a page of 1280 x 720. */
function framed(camera: PerspectiveCamera): { test: TestWorld; navigation: Navigation; framing: Framing } {
  vi.stubGlobal("innerWidth", 1280);
  vi.stubGlobal("innerHeight", 720);
  const test = new TestWorld();
  const navigation = new Navigation(camera);
  let size = 1;
  const viewer = {
    camera, get size() { return size; }, stage: { setScene: (__: unknown, radius: number) => void (size = radius) }, invalidate: () => {},
    renderer: { domElement: { height: 720 } }, presenting: false, filming: false, margins: { bottom: 84, right: 0 },
  };
  const framing = new Framing(test.world, viewer as unknown as Viewer, navigation);
  return { test, navigation, framing };
}

describe("a fitted view", () => {
  it("shows all points and is filled by them, at any size and from any side", () => {
    for (const size of [1e-9, 1e-3, 1, 1e3]) {
      for (let seed = 1; seed < 20; seed++) {
        const points = cloud(size, seed);
        const view = fitView(points, seed, 0.1 * (seed % 7) - 0.3, frame)!;
        expect(fullness(points, view)).toBeCloseTo(1, 6);
      }
    }
  });

  it("keeps what is narrower to the right free, and is filled all the same", () => {
    const points = cloud(1, 3);
    const narrow = { ...frame, right: 0.3 };
    const view = fitView(points, 0.4, 0.2, narrow)!;
    expect(shareOutside(points, { ...view, distance: view.distance * 1.001 }, narrow)).toBe(0);
    expect(shareOutside(points, { ...view, distance: view.distance * 0.98 }, narrow)).toBeGreaterThan(0);
    expect(view.distance).toBeGreaterThan(fitView(points, 0.4, 0.2, frame)!.distance);
  });

  it("scales with the scene", () => {
    const one = fitView(cloud(1, 3), 0.4, 0.2, frame)!;
    const tiny = fitView(cloud(1e-9, 3), 0.4, 0.2, frame)!;
    expect(tiny.distance / one.distance).toBeCloseTo(1e-9, 15);
  });

  it("is none without points, and leaves out points that are not finite", () => {
    const points = new Points();
    points.add(Number.NaN, 0, 0);
    points.add(Infinity, 0, 0);
    expect(points.bounds()).toBeNull();
    expect(fitView(points, 0, 0, frame)).toBeNull();
  });

  it("tells which share of the points is outside of it", () => {
    const points = cloud(1, 5);
    const view = fitView(points, 0.4, 0.2, frame)!;
    expect(shareOutside(points, { ...view, distance: view.distance * 1.001 }, frame)).toBe(0);
    expect(shareOutside(points, { ...view, pivot: [1e3, 0, 0] }, frame)).toBe(1);
  });
});

describe("a script's camera in a narrow window", () => {
  const target = [6, -1, 0.2] as const;
  const eyeOf = ({ pivot, distance, yaw, pitch }: ReturnType<typeof standBack>) => pivot.map((value, axis) => value + distance * viewAxes(yaw, pitch)[2][axis]);

  it("counts only what the camera sees, not the other rooms of a building", () => {
    const points = new Points();
    const eye = [0, 2, 5] as const;
    const room = [[0, 1, 0], [1.5, 2, -1], [-2, 0.5, 1]] as const, others = [[20, 1, 0], [0, 1, 9], [-8, 1, 1], [0, 40, 0]] as const;
    for (const [x, y, z] of [...others, ...room]) points.add(x, y, z);
    dropOutside(points, eye, [0, 1, 0], { side: 1, up: 0.6, down: 0.6 });
    expect(Array.from(points.xyz.slice(0, 3 * points.count))).toEqual(room.flat());
  });

  it("keeps its place where all is in view", () => {
    const eye = [6, 2, 400] as const;
    const view = standBack(cloud(1, 3), eye, target, frame, 5);
    eyeOf(view).forEach((value, axis) => expect(value).toBeCloseTo(eye[axis], 9));
    expect(view.pivot).toEqual(target);
  });

  it("goes back no farther than it has to or may, with the scene in its middle, in the same direction, and is never lower", () => {
    for (const height of [-3, -1.2, -1, 0, 3]) {
      const eye = [6.5, height, 1.5] as const;
      const points = cloud(1, 7);
      const distance = Math.hypot(...eye.map((value, axis) => value - target[axis]));
      const near = standBack(points, eye, target, frame, 1.2);
      const all = standBack(points, eye, target, frame, 1e3);
      expect(near.distance).toBeLessThan(1.2001 * distance);
      expect(fullness(points, all)).toBeLessThan(1 + 1e-6);
      if (all.distance > 1.001 * distance) expect(fullness(points, all)).toBeCloseTo(1, 6);
      for (const view of [near, all]) {
        expect(eyeOf(view)[1]).toBeGreaterThan(height - 1e-9);
        expect(view.yaw).toBeCloseTo(Math.atan2(eye[0] - target[0], eye[2] - target[2]), 12);
        if (height >= target[1]) expect(view.pitch).toBeCloseTo(Math.asin((height - target[1]) / distance), 12);
      }
    }
  });

  it("keeps the horizon above the frame's lower edge when it looks up", () => {
    for (const height of [-3, -2, -1.2]) {
      const view = standBack(cloud(1, 7), [6.5, height, 1.5], target, frame, 1e3);
      expect(view.pitch).toBeLessThan(0);
      expect(Math.tan(-view.pitch)).toBeLessThan(frame.down);
    }
  });

  it("shows all points of a motion if it is told only the outermost ones at each time", () => {
    const eye = [6.5, 0, 1.5] as const;
    const kept = new Points();
    const all = new Points();
    let view = standBack(cloud(1, 1), eye, target, frame, 1e3);
    for (let seed = 1; seed < 20; seed++) {
      const now = cloud(1, seed);
      all.addAll(now);
      addOutermost(kept, now, view, frame);
      view = standBack(kept, eye, target, frame, 1e3);
    }
    expect(kept.count).toBe(19 * 4);
    expect(fullness(all, view)).toBeCloseTo(1, 6);
  });
});

describe("another scene on the same page", () => {
  afterEach(() => void vi.unstubAllGlobals());

  /** Joins a world of two balls, so many m apart, without a camera of the script. */
  function join(test: TestWorld, framing: Framing, title: string, radius: number, [first, second]: readonly [number, number]): void {
    test.join();
    test.world.take({
      type: "worldSettings", title, styles: [], style: "", hasCamera: false, cameraPosition: [0, 0, 0], cameraTarget: [0, 0, 0], hasGround: false,
      ground: 0, modules: [],
    });
    framing.changed("settings");
    test.set("visual", visual(0, "ball", part("sphere", [radius])));
    test.set("body", bodyEntity(0), bodyEntity(1));
    test.poses([body(0, first), body(1, second)]);
  }

  type Scene = readonly [title: string, radius: number, places: readonly [number, number]];
  const camera = new PerspectiveCamera(42, 16 / 9);

  /** The last one's view on a page to which scenes come one after the other, and the view in which the user left the one before. */
  function show(link: LinkState, ...scenes: readonly Scene[]): { view: FittedView; left: FittedView } {
    const { test, navigation, framing } = framed(camera);
    let left = navigation.goal;
    for (const scene of scenes) {
      join(test, framing, ...scene);
      for (let frame = 0; frame < 100; frame++) {
        framing.update(1 / 30);
        navigation.update(1 / 30);
      }
      if (scene === scenes.at(-1)) break;
      navigation.orbit(200, 30);
      left = navigation.goal;
      framing.link(link);
    }
    camera.updateMatrixWorld();
    return { view: navigation.goal, left };
  }

  it("is not looked for on a page at rest", () => {
    vi.stubGlobal("innerWidth", 1280);
    vi.stubGlobal("innerHeight", 720);
    const test = new TestWorld();
    const viewer = {
      camera, size: 1, stage: { setScene: vi.fn() }, invalidate: () => {}, renderer: { domElement: { height: 720 } }, presenting: false, filming: false, margins: { bottom: 84, right: 0 },
      resting: false,
    };
    const framing = new Framing(test.world, viewer as unknown as Viewer, new Navigation(camera));
    join(test, framing, "one", 0.5, [0, 10]);
    const looks = (): number => {
      viewer.stage.setScene.mockClear();
      for (let frame = 0; frame < 90; frame++) framing.update(1 / 30);
      return viewer.stage.setScene.mock.calls.length;
    };
    expect(looks()).toBeGreaterThan(7);
    viewer.resting = true;
    expect(looks()).toBe(0);
    viewer.resting = false;
    expect(looks()).toBeGreaterThan(7);
  });

  it.each([["of another title", "other", "connected"], ["of another server, with the same title", "one", "lost"]] as const)("%s is framed as it would be alone, though the user has moved the camera before", (_, title, link) => {
    const [small, large] = [["one", 0.02, [4.9, 5.1]], [title, 0.5, [0, 10]]] as const;
    const { pivot, distance } = show(link, large).view;
    const { view } = show(link, small, large);
    expect(view.pivot).toEqual(pivot);
    expect(view.distance).toBe(distance);
    const corner = new Vector3(10.5, 0, 0).project(camera);
    expect(Math.abs(corner.x), "of the half width of the window").toBeGreaterThan(0.6);
    expect(Math.abs(corner.x)).toBeLessThan(1);
  });

  it("of a script that was changed a little and began again is seen as the user left it", () => {
    const { view, left } = show("lost", ["one", 0.5, [0, 10]], ["one", 0.6, [1, 9]]);
    expect(view).toEqual(left);
  });
});

describe("the view of a running scene", () => {
  afterEach(() => void vi.unstubAllGlobals());

  /** The views, one a look, of four balls, the last of which goes along a way; x in m. */
  async function watch(way: (time: number) => number, others: readonly number[] = [1, 2, 3], hangs = false): Promise<FittedView[]> {
    await import("../src/page/ways.ts"); // which the page fetches when it needs it
    const { test, navigation, framing } = framed(new PerspectiveCamera(42, 16 / 9));
    test.join();
    test.world.take({
      type: "worldSettings", title: "", styles: [], style: "", hasCamera: false, cameraPosition: [0, 0, 0], cameraTarget: [0, 0, 0], hasGround: hangs,
      ground: -30, modules: [],
    });
    framing.changed("settings");
    test.set("visual", visual(0, "ball", part("sphere", [0.1])));
    const all = [...others.keys(), others.length];
    if (hangs) {
      test.set("membership", ...all.map((slot) => ({ id: id(slot), articulate: 0 })));
      test.set("nail", { id: id(0), at: { body: 0, point: [0, 0, 0] } });
    }
    test.set("body", ...all.map((slot) => bodyEntity(slot)));
    const views: FittedView[] = [];
    for (let time = 0; time < 9; time += 0.3) {
      test.poses(all.map((slot) => body(slot, others[slot] ?? way(time))));
      test.poses(all.map((slot) => body(slot, others[slot] ?? way(time))));
      framing.update(0.3);
      navigation.update(0.3);
      await new Promise((resolve) => setTimeout(resolve));
      views.push(navigation.goal);
    }
    return views;
  }

  it("stays where it is while one of four things goes away", async () => {
    const [first, ...later] = await watch((time) => Math.min(3.5 + 0.7 * time, 9.9));
    for (const view of later) expect(view).toEqual(first);
  });

  it("is widened once for one that swings out of it", async () => {
    const views = await watch((time) => 4 + 1.6 * Math.sin(2 * time));
    const seen = new Set(views.map(({ distance }) => distance.toFixed(6)));
    expect(views.at(-1)!.distance).toBeGreaterThan(views[0].distance);
    expect(seen.size).toBeLessThan(5);
    expect(views.at(-1)).toEqual(views[18]);
  });

  it("reaches from the nail of a chain down to where its end comes to rest", async () => {
    const rest = new Points();
    rest.add(1, -1.35, 0);
    const [held, free] = [await watch(() => 1.3, [1, 1.1, 1.2], true), await watch(() => 1.3, [1, 1.1, 1.2])];
    expect(shareOutside(rest, held[0], frame)).toBe(0);
    expect(shareOutside(rest, free[0], frame)).toBe(1);
  });

  /** A lone ball in a picture of 60 frames a second: its place in it in each, from -1 to 1, and the camera's. */
  function watchOne(place: (time: number) => [number, number, number], seconds: number, held = -1): { seen: Vector3[]; eyes: Vector3[] } {
    const camera = new PerspectiveCamera(42, 16 / 9);
    const { test, navigation, framing } = framed(camera);
    test.join();
    test.world.take({
      type: "worldSettings", title: "", styles: [], style: "", hasCamera: false, cameraPosition: [0, 0, 0], cameraTarget: [0, 0, 0], hasGround: false,
      ground: 0, modules: [],
    });
    framing.changed("settings");
    test.set("visual", visual(0, "ball", part("sphere", [0.1])));
    test.set("body", bodyEntity(0));
    test.world.marks.held = held;
    const [seen, eyes]: [Vector3[], Vector3[]] = [[], []];
    for (let time = 0; time < seconds; time += 1 / 60) {
      const boxMin = place(time);
      test.poses([body(0, 0)], { boxMin, boxMax: [boxMin[0] + 1, boxMin[1] + 1, boxMin[2] + 1] });
      framing.update(1 / 60);
      navigation.update(1 / 60);
      camera.updateMatrixWorld();
      seen.push(new Vector3().fromArray(test.world.poses.position).project(camera));
      eyes.push(camera.position.clone());
    }
    return { seen, eyes };
  }

  it.each([
    ["at 2 m/s", (time: number) => 2 * time, 0], ["at 20 m/s", (time: number) => 20 * time, 0], ["at 200 m/s", (time: number) => 200 * time, 0],
    ["that falls", () => 0, 9.81],
  ])("keeps a lone thing %s well inside the picture", (_, way, gravity) => {
    for (const { x, y, z } of watchOne((time) => [way(time), (-gravity * time * time) / 2, 0], 4).seen.slice(90)) {
      expect(Math.max(Math.abs(x), Math.abs(y))).toBeLessThan(0.5);
      expect(z).toBeLessThan(1);
    }
  });

  it("is back with a lone thing at once when that returns from very far away", () => {
    const { seen } = watchOne((time) => [time < 1 || time > 2 ? 0 : 1e6, 0, 0], 3);
    for (const { x, y } of seen.slice(-30)) expect(Math.hypot(x, y)).toBeLessThan(0.5);
  });

  it("rests while a hand of this page holds the thing, which goes where the camera's pointer is", () => {
    const { eyes } = watchOne((time) => [time, 0, 0], 2, 0);
    for (const eye of eyes) expect(eye.distanceTo(eyes[0])).toBeLessThan(1e-9);
  });

  it("follows the only thing", async () => {
    const views = await watch((time) => 0.5 + time, []);
    expect(views.at(-1)!.pivot[0]).toBeGreaterThan(8);
  });
});
