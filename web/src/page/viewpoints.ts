// SPDX-License-Identifier: Apache-2.0
// Moves the camera to the script's viewpoints, with moving viewpoints, and after a body that the user follows.

import { MathUtils, Vector3 } from "three";
import type { Navigation } from "../navigate/navigation.ts";
import type { FittedView } from "../navigate/framing.ts";
import type { ViewpointEntity } from "../protocol/generated.ts";
import { moves, placeOf } from "../scene/anchors.ts";
import type { World } from "../world/world.ts";
import type { FramePart, Viewer } from "./viewer.ts";

export class Viewpoints implements FramePart {
  /** The followed body, -1: none. */
  followed = -1;

  private readonly world_: World;
  private readonly navigation_: Navigation;
  private readonly viewer_: Viewer;
  /** Slot of the present viewpoint, -1: none. */
  private at_ = -1;
  /** The count of the user's camera moves at that time: a further move ends it. */
  private moves_ = 0;
  private readonly eye_ = new Vector3();
  private readonly target_ = new Vector3();
  private readonly before_ = new Vector3();

  constructor(world: World, navigation: Navigation, viewer: Viewer) {
    this.world_ = world;
    this.navigation_ = navigation;
    this.viewer_ = viewer;
  }

  get count(): number {
    return this.world_.entities.viewpoint.size;
  }

  /** Name of the present viewpoint; empty for none. */
  get name(): string {
    return this.world_.entities.viewpoint.get(this.at_)?.name ?? "";
  }

  /** Moves to the viewpoint with an index from 0, if there is one. */
  go(number: number): void {
    const viewpoint = this.world_.entities.viewpoint.all().at(number);
    const view = viewpoint && this.viewOf_(viewpoint);
    if (viewpoint === undefined || view === null || view === undefined) return;
    this.followed = -1;
    this.at_ = viewpoint.id.slot;
    this.navigation_.goTo(view);
    this.moves_ = this.navigation_.moves;
    this.viewer_.invalidate();
  }

  /** Moves to the next viewpoint. */
  next(): void {
    const all = this.world_.entities.viewpoint.all();
    this.go((all.findIndex(({ id }) => id.slot === this.at_) + 1) % Math.max(all.length, 1));
  }

  /** Follows a body from now on, -1: none. */
  follow(body: number): void {
    this.at_ = -1;
    this.followed = body;
    this.placeOfBody_(body, this.before_);
  }

  update(): void {
    if (this.viewer_.presenting) return;
    if (this.followed >= 0) this.goAfter_();
    if (this.at_ < 0) return;
    const viewpoint = this.world_.entities.viewpoint.get(this.at_);
    if (viewpoint === undefined || this.navigation_.moves !== this.moves_) {
      this.at_ = -1;
      return;
    }
    if (!moves(viewpoint.eye) && !moves(viewpoint.target)) return;
    const view = this.viewOf_(viewpoint);
    if (view !== null) this.navigation_.jumpTo(view);
  }

  private goAfter_(): void {
    if (!this.placeOfBody_(this.followed, this.eye_)) {
      this.followed = -1;
      return;
    }
    this.navigation_.shift(this.target_.subVectors(this.eye_, this.before_));
    this.before_.copy(this.eye_);
  }

  private placeOfBody_(body: number, out: Vector3): boolean {
    const { entities, poses } = this.world_;
    if (body < 0 || !entities.body.has(body)) return false;
    out.fromArray(poses.position, 3 * body);
    return true;
  }

  private viewOf_({ eye, target }: ViewpointEntity): FittedView | null {
    const { poses } = this.world_;
    if (!placeOf(poses, eye, this.eye_) || !placeOf(poses, target, this.target_)) return null;
    const away = this.eye_.sub(this.target_);
    const distance = away.length();
    if (!(distance > 0)) return null;
    // The shorter direction.
    const yaw = Math.atan2(away.x, away.z);
    const turns = Math.round((this.navigation_.goal.yaw - yaw) / (2 * Math.PI));
    const pitch = Math.asin(MathUtils.clamp(away.y / distance, -1, 1));
    return { pivot: [this.target_.x, this.target_.y, this.target_.z], distance, yaw: yaw + 2 * Math.PI * turns, pitch };
  }
}
