// SPDX-License-Identifier: Apache-2.0
import { Color, InstancedMesh, Matrix4, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { PoseSparkColumns } from "../src/protocol/generated.ts";
import { ParticleSetView } from "../src/scene/entities/particle_set.ts";

function columns(sparks: readonly { at: [number, number, number]; radius: number; color: number }[]): PoseSparkColumns {
  const out = new PoseSparkColumns();
  out.reserve(sparks.length);
  sparks.forEach((spark, index) => {
    out.position.set(spark.at, 3 * index);
    out.radius[index] = spark.radius;
    out.color[index] = spark.color;
  });
  out.count = sparks.length;
  return out;
}

describe("sparks", () => {
  it("are drawn where the newest frame has them, in their size and color", () => {
    const view = new ParticleSetView();
    view.takeSparks(columns([{ at: [1, 2, 3], radius: 0.5, color: 0xff8000 }, { at: [4, 5, 6], radius: 0, color: 0x204060 }]));
    const mesh = view.root.children[0] as InstancedMesh;
    expect(mesh.count).toBe(2);
    expect(mesh.visible).toBe(true);
    const matrix = new Matrix4();
    mesh.getMatrixAt(0, matrix);
    expect(new Vector3().setFromMatrixPosition(matrix).toArray()).toEqual([1, 2, 3]);
    expect(new Vector3().setFromMatrixScale(matrix).x).toBeCloseTo(0.5);
    mesh.getMatrixAt(1, matrix);
    expect(new Vector3().setFromMatrixScale(matrix).x).toBeGreaterThan(0); // of a size that nobody told
    const color = new Color();
    mesh.getColorAt(0, color);
    expect(color.getHex()).toBe(0xff8000);
    mesh.getColorAt(1, color);
    expect(color.getHex()).toBe(0x204060);
  });

  it("come in thousands and go without a trace", () => {
    const view = new ParticleSetView();
    view.takeSparks(columns([{ at: [0, 0, 0], radius: 1, color: 0 }]));
    const [mesh] = view.root.children;
    view.takeSparks(columns(Array.from({ length: 5000 }, () => ({ at: [0, 1, 0] as [number, number, number], radius: 1, color: 0 }))));
    expect(view.root.children).toEqual([mesh]);
    expect((view.root.children[0] as InstancedMesh).count).toBe(5000);
    view.takeSparks(columns([]));
    expect((view.root.children[0] as InstancedMesh).visible).toBe(false);
  });
});
