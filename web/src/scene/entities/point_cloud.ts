// SPDX-License-Identifier: Apache-2.0
// Point clouds: thousands of balls, one draw call for each cloud.

import { Group, Quaternion, Vector3 } from "three";
import type { PointCloudEntity } from "../../protocol/generated.ts";
import { placeOf, turnOf } from "../anchors.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import type { Points } from "../points.ts";
import { Strokes } from "../strokes.ts";
import type { EntityView } from "./entity.ts";

interface Cloud {
  entity: PointCloudEntity;
  readonly strokes: Strokes;
}

export class PointCloudView implements EntityView<PointCloudEntity> {
  readonly root = new Group();

  private readonly poses_: PoseBuffer;
  private readonly clouds_ = new Map<number, Cloud>();
  private readonly place_ = new Vector3();
  private readonly turn_ = new Quaternion();

  constructor(poses: PoseBuffer) {
    this.poses_ = poses;
  }

  create(entity: PointCloudEntity): void {
    const cloud: Cloud = { entity, strokes: new Strokes() };
    this.clouds_.set(entity.id.slot, cloud);
    this.root.add(cloud.strokes.mesh);
    this.write_(cloud);
  }

  change(entity: PointCloudEntity): void {
    const cloud = this.clouds_.get(entity.id.slot);
    if (cloud === undefined) return this.create(entity);
    cloud.entity = entity;
    this.write_(cloud);
  }

  destroy(slot: number): void {
    this.clouds_.get(slot)?.strokes.dispose();
    this.clouds_.delete(slot);
  }

  draw(): void {
    for (const { entity: { at }, strokes: { mesh, count } } of this.clouds_.values()) {
      mesh.visible = count > 0 && placeOf(this.poses_, at, this.place_) && turnOf(this.poses_, at.body, mesh.quaternion);
      mesh.position.copy(this.place_);
    }
  }

  /** Adds a sample of the points, world, m, for the camera's framing. */
  addPlaces(points: Points): void {
    for (const { entity: { at, points: own } } of this.clouds_.values()) {
      if (turnOf(this.poses_, at.body, this.turn_) && placeOf(this.poses_, at, this.place_)) points.addSample(own, this.place_, this.turn_);
    }
  }

  private write_({ entity: { points, radii, colors }, strokes }: Cloud): void {
    const count = points.length / 3;
    strokes.clear();
    strokes.reserve(count);
    for (let index = 0; index < count; index++) {
      const radius = radii[radii.length === count ? index : 0];
      const color = colors[colors.length === count ? index : 0];
      const [x, y, z] = [points[3 * index], points[3 * index + 1], points[3 * index + 2]];
      strokes.add(x, y, z, x, y, z, radius, radius, color);
    }
    strokes.upload();
  }
}
