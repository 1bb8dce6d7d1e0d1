// SPDX-License-Identifier: Apache-2.0
// Fixed shapes without physics: a beam, a stand.

import { Group, Matrix4, type Mesh } from "three";
import type { StaticShapeEntity } from "../../protocol/generated.ts";
import { InstancePool } from "../instance_pool.ts";
import { materialOf } from "../materials.ts";
import { addCorners, type Points } from "../points.ts";
import { readPart } from "../parts.ts";
import { makeGeometry } from "../shapes/shape.ts";
import type { EntityView } from "./entity.ts";

export class StaticShapeView implements EntityView<StaticShapeEntity> {
  readonly root = new Group();

  private readonly shown_ = new Map<number, InstancePool>();
  private readonly warn_: (title: string, text: string) => void;

  /** `warn` is called for a shape that cannot be drawn. */
  constructor(warn: (title: string, text: string) => void) {
    this.warn_ = warn;
  }

  create({ id: { slot }, part }: StaticShapeEntity): void {
    try {
      const shape = readPart(part);
      // One instance, so that static shapes and bodies share a program.
      const pool = new InstancePool(makeGeometry(shape, "fine"), materialOf(shape), 1).addTo(this.root);
      pool.mesh.setMatrixAt(pool.add(slot), new Matrix4());
      pool.mesh.position.set(...shape.offset);
      pool.mesh.quaternion.set(...shape.rotation);
      pool.upload();
      this.shown_.set(slot, pool);
    } catch (error) {
      this.warn_("A static shape cannot be drawn", error instanceof Error ? error.message : String(error));
    }
  }

  change(entity: StaticShapeEntity): void {
    this.destroy(entity.id.slot);
    this.create(entity);
  }

  /** Calls `take` with the corners of each finite shape; the points are only valid during the call. */
  forEachCorners(points: Points, take: (points: Points) => void): void {
    for (const { mesh } of this.shown_.values()) {
      mesh.updateMatrixWorld();
      points.clear();
      addCorners(points, mesh.geometry, mesh.matrixWorld);
      take(points);
    }
  }

  /** Each with its own place and turn. */
  *meshes(): Iterable<Mesh> {
    for (const { mesh } of this.shown_.values()) yield mesh;
  }

  destroy(slot: number): void {
    this.shown_.get(slot)?.dispose();
    this.shown_.delete(slot);
  }
}
