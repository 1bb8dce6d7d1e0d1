// SPDX-License-Identifier: Apache-2.0
// Thousands of copies of a shape, set by arrays: one draw call for each set, and no work while only its body moves.

import { Color, Group, Matrix4, Quaternion, Vector3 } from "three";
import type { ShapeSetEntity } from "../../protocol/generated.ts";
import { placeOf, turnOf } from "../anchors.ts";
import { InstancePool } from "../instance_pool.ts";
import { materialOf } from "../materials.ts";
import { readPart } from "../parts.ts";
import type { Points } from "../points.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import { makeGeometry } from "../shapes/shape.ts";
import type { EntityView } from "./entity.ts";

/** Above this number shapes are drawn coarsely, to limit the vertices. */
const mostFine = 100;
const mostCoarse = 3000;

interface ShapeSet {
  entity: ShapeSetEntity;
  readonly pool: InstancePool;
}

const one = new Vector3(1, 1, 1);

export class ShapeSetView implements EntityView<ShapeSetEntity> {
  readonly root = new Group();

  private readonly poses_: PoseBuffer;
  private readonly warn_: (title: string, text: string) => void;
  private readonly sets_ = new Map<number, ShapeSet>();
  private readonly place_ = new Vector3();
  private readonly turn_ = new Quaternion();
  private readonly size_ = new Vector3();
  private readonly own_ = new Matrix4();
  private readonly matrix_ = new Matrix4();
  private readonly color_ = new Color();

  constructor(poses: PoseBuffer, warn: (title: string, text: string) => void) {
    this.poses_ = poses;
    this.warn_ = warn;
  }

  create(entity: ShapeSetEntity): void {
    try {
      const shape = readPart(entity.part);
      const count = entity.places.length / 3;
      const detail = count <= mostFine ? "fine" : count <= mostCoarse ? "coarse" : "tiny";
      const pool = new InstancePool(makeGeometry(shape, detail), materialOf(shape), count).addTo(this.root);
      this.sets_.set(entity.id.slot, { entity, pool });
      this.write_(entity, pool);
    } catch (error) {
      this.warn_("A set of shapes cannot be drawn", error instanceof Error ? error.message : String(error));
    }
  }

  change(entity: ShapeSetEntity): void {
    const known = this.sets_.get(entity.id.slot);
    if (known === undefined || known.entity.places.length !== entity.places.length || !sameBytes(known.entity.part, entity.part)) {
      this.destroy(entity.id.slot);
      return this.create(entity);
    }
    known.entity = entity;
    this.write_(entity, known.pool);
  }

  destroy(slot: number): void {
    this.sets_.get(slot)?.pool.dispose();
    this.sets_.delete(slot);
  }

  draw(): void {
    for (const { entity: { at }, pool: { mesh, count } } of this.sets_.values()) {
      mesh.visible = count > 0 && placeOf(this.poses_, at, mesh.position) && turnOf(this.poses_, at.body, mesh.quaternion);
    }
  }

  addPlaces(points: Points): void {
    for (const { entity: { at, places }, pool: { mesh } } of this.sets_.values()) {
      if (placeOf(this.poses_, at, mesh.position) && turnOf(this.poses_, at.body, mesh.quaternion)) points.addSample(places, mesh.position, mesh.quaternion);
    }
  }

  private write_(entity: ShapeSetEntity, pool: InstancePool): void {
    const { places, rotations, scales, colors, part } = entity;
    const count = places.length / 3;
    const { place_: place, turn_: turn, size_: size, matrix_: matrix } = this;
    this.own_.compose(place.set(...part.offset), turn.set(...part.rotation), one);
    for (let index = pool.count; index < count; index++) pool.add(index);
    for (let index = 0; index < count; index++) {
      place.fromArray(places, 3 * index);
      if (rotations.length > 0) turn.fromArray(rotations, 4 * index).normalize();
      else turn.identity();
      if (scales.length === 3 * count) size.fromArray(scales, 3 * index);
      else size.setScalar(scales.length === 0 ? 1 : scales[scales.length === 1 ? 0 : index]);
      pool.mesh.setMatrixAt(index, matrix.compose(place, turn, size).multiply(this.own_));
      if (colors.length > 0) pool.setHue(index, this.color_.setHex(colors[colors.length === 1 ? 0 : index]));
    }
    if (colors.length === 0) pool.clearHues();
    pool.upload();
  }
}

function sameBytes(a: ShapeSetEntity["part"], b: ShapeSetEntity["part"]): boolean {
  const plain = (part: ShapeSetEntity["part"]) => JSON.stringify({
    ...part, shape: [part.shape.kind, [...part.shape.sizes], [...part.shape.vertices], [...part.shape.triangles]],
  });
  return a === b || plain(a) === plain(b);
}
