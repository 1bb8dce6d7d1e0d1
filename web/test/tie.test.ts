// SPDX-License-Identifier: Apache-2.0
import { Matrix4, Vector3, type InstancedMesh } from "three";
import { describe, expect, it } from "vitest";
import { NO_BODY, TieKind, type Anchor, type TieEntity } from "../src/protocol/generated.ts";
import { TieView } from "../src/scene/entities/tie.ts";
import { Visuals } from "../src/scene/entities/visual.ts";
import { makeCoil } from "../src/scene/shapes/coil.ts";
import { PoseBuffer } from "../src/scene/pose_buffer.ts";
import { id, part, visual } from "./test_world.ts";

const rope = 0;
const spring = 1;
const ellipsoid = 2;

function ties(...entries: Omit<TieEntity, "id">[]): { view: TieView; poses: PoseBuffer; pieces: () => { middle: Vector3; length: number }[] } {
  const poses = new PoseBuffer();
  poses.reserve(2);
  const visuals = new Visuals((title) => expect.unreachable(title));
  visuals.create(visual(rope, "rope", part("cylinder", [0.01, 0.1], { material: "rope" })));
  visuals.create(visual(spring, "spring", part("cylinder", [0.02, 0.1])));
  visuals.create(visual(ellipsoid, "ellipsoid", part("ellipsoid", [0.3, 0.06, 0.04])));
  const view = new TieView(poses, visuals);
  entries.forEach((entry, slot) => view.create({ id: id(slot), ...entry }));
  const pieces = () => {
    const mesh = view.root.children[0] as InstancedMesh;
    mesh.geometry.computeBoundingBox();
    const box = mesh.geometry.boundingBox!;
    return Array.from({ length: mesh.count }, (_, index) => {
      const matrix = new Matrix4();
      mesh.getMatrixAt(index, matrix);
      return {
        middle: new Vector3().setFromMatrixPosition(matrix),
        length: new Vector3().setFromMatrixColumn(matrix, 0).length() * (box.max.x - box.min.x),
      };
    });
  };
  return { view, poses, pieces };
}

const world = (x: number, y: number, z: number): Anchor => ({ body: NO_BODY, point: [x, y, z] });
const ropeOf = (length: number) => ({ kind: TieKind.rope, visual: rope, a: world(0, 0, 0), b: world(2, 0, 0), length });

describe("ties", () => {
  it("a spring is as long as its ends are apart, wherever its body goes", () => {
    const { view, poses, pieces } = ties({ kind: TieKind.spring, visual: spring, a: world(0, 1, 0), b: { body: 1, point: [0, 0.5, 0] }, length: 0.4 });
    view.draw();
    expect(pieces()[0].length).toBe(0); // its body has not been told of yet
    poses.known[1] = 1;
    poses.position.set([0.6, 0.5, 0.8], 3);
    poses.rotation.set([0, 0, 0, 1], 4);
    view.draw();
    expect(pieces()[0].middle.distanceTo(new Vector3(0.3, 1, 0.4))).toBeLessThan(1e-6);
    expect(pieces()[0].length).toBeCloseTo(1, 1);
    poses.rotation.set([1, 0, 0, 0], 4); // upside down: its point is below it now
    view.draw();
    expect(pieces()[0].middle.y).toBeCloseTo(0.5, 6);
  });

  it("an ellipsoid reaches from end to end of its spring, as wide as it was asked for", () => {
    const { view, pieces } = ties({ kind: TieKind.spring, visual: ellipsoid, a: world(0, 0, 0), b: world(0.5, 0, 0), length: 0.2 });
    view.draw();
    const mesh = view.root.children[0] as InstancedMesh;
    expect(pieces()[0].length).toBeCloseTo(0.5, 6);
    const { min, max } = mesh.geometry.boundingBox!;
    expect([max.y - min.y, max.z - min.z]).toEqual([expect.closeTo(0.06, 2), expect.closeTo(0.04, 2)]);
    expect(mesh.geometry.getAttribute("position").count).toBeGreaterThan(60);
  });

  it("a taut rope is straight, a slack one hangs through by about its length", () => {
    const taut = ties(ropeOf(2));
    taut.view.draw();
    for (const { middle } of taut.pieces()) expect(Math.abs(middle.y)).toBeLessThan(1e-9);
    const slack = ties(ropeOf(2.2));
    slack.view.draw();
    const pieces = slack.pieces();
    expect(Math.min(...pieces.map(({ middle }) => middle.y))).toBeLessThan(-0.3);
  });

  it("come and go one by one in one mesh, and the others stay where they are", () => {
    const { view, pieces } = ties(ropeOf(2), ropeOf(2.2), ropeOf(2));
    const [mesh] = view.root.children;
    view.destroy(0);
    view.create({ id: id(3), ...ropeOf(2.2) });
    view.draw();
    expect(view.root.children).toEqual([mesh]);
    const lowest = (tie: number) => Math.min(...pieces().slice(12 * tie, 12 * tie + 12).map(({ middle }) => middle.y));
    expect([0, 1, 2].map((tie) => lowest(tie) < -0.3)).toEqual([false, true, true]); // the last one took the first's place
  });

  it("a coil is as long and as wide as it was asked for", () => {
    const coil = makeCoil(0.02, 0.002, 0.3);
    coil.computeBoundingBox();
    const { min, max } = coil.boundingBox!;
    expect(max.x - min.x).toBeGreaterThan(0.295);
    expect(max.x - min.x).toBeLessThan(0.31);
    expect(max.y).toBeGreaterThan(0.019);
    expect(max.y).toBeLessThan(0.0225);
    expect(coil.getAttribute("normal").array.every(Number.isFinite)).toBe(true);
  });
});
