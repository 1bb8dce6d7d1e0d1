// SPDX-License-Identifier: Apache-2.0
import { expect, it } from "vitest";
import { NO_BODY, NO_COLOR, type SurfaceEntity } from "../src/protocol/generated.ts";
import { Points } from "../src/scene/points.ts";
import { id, TestWorld } from "./test_world.ts";

/** A skin around the origin, of radius 2. */
const skin: SurfaceEntity = {
  id: id(0), at: { body: NO_BODY, point: [0, 0, 0] }, bodies: new Uint32Array(4).fill(NO_BODY),
  points: Float32Array.of(2, 0, 0, -2, 0, 0, 0, 2, 0, 0, -2, 0), triangles: Uint32Array.of(0, 2, 1, 0, 1, 3), coordinates: new Float32Array(0),
  material: "paint", color: NO_COLOR,
};

it("what is drawn in the world is in the picture with all its points, what is on bodies comes with these", () => {
  const { surface } = new TestWorld().world.entities;
  const points = new Points();
  surface.create(skin);
  surface.addPlaces(points);
  expect(points.bounds()).toMatchObject({ center: [0, 0, 0], lowest: -2 });
  points.clear();
  surface.change({ ...skin, bodies: Uint32Array.of(3, NO_BODY, NO_BODY, NO_BODY) });
  surface.addPlaces(points);
  expect(points.count).toBe(0);
});
