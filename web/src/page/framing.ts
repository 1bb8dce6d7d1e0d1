// SPDX-License-Identifier: Apache-2.0
// Frames the scene: calculates its place and size and the first view of it, again for a new scene or a changed window.
// Light, ground and fog depend on it. A camera that the user has moved is not changed.

import { MathUtils } from "three";
import { addOutermost, fitView, shareOutside, standBack, type FittedView, type Frame } from "../navigate/framing.ts";
import type { Navigation } from "../navigate/navigation.ts";
import type { LinkState } from "../net/connection.ts";
import { Points, type Bounds } from "../scene/points.ts";
import type { EntityView } from "../scene/entities/entity.ts";
import type { World } from "../world/world.ts";
import type { PageListener } from "./events.ts";
import type { FramePart, Viewer } from "./viewer.ts";

/** The first view without a camera of the script: a little from the side and above. */
const usualYaw = 0.4;
const usualPitch = 0.24;
/** Fixed things count if they are near movable ones: up to this many times their size. */
const settingSize = 2.6;
const lookEverySeconds = 0.3;
/** Surroundings that are so many sizes of the scene away are not walked to. */
const farthestWalk = 40;
/** Largest number of sampled bodies. */
const mostBodies = 1500;
/** A change of size by this factor, or of place by this many sizes, is a new scene. */
const otherSize = 2.5;
const otherPlace = 3;
/** A scene is at least so large, in distances from the script's camera to its target: a single rocket that flies has another size. */
const smallest = 0.25;
/** Radius of the pins at nails, in sizes of the scene. */
const pinSize = 0.008;
/** Places that widened the view of a narrow window; enough for a motion's reach. */
const mostKept = 200;
/** In css px. */
const barHeight = 84;
const tallBarHeight = 150;
const narrowWidth = 560;
/** The standard screen, for which scripts choose their cameras. */
const usualSide = Math.tan(MathUtils.degToRad(21)) * (16 / 9);

export class Framing implements FramePart, PageListener {
  private readonly world_: World;
  private readonly viewer_: Viewer;
  private readonly navigation_: Navigation;
  private readonly points_ = new Points();
  private readonly setting_ = new Points();
  /** Points that have left the view and were added to it. */
  private readonly kept_ = new Points();
  private framed_: Bounds | null = null;
  private script_ = "";
  private wait_ = 0;
  private falling_ = false;
  /** The connection was lost since the last look: another scene is of another script, though that may have the same title. */
  private rejoined_ = false;
  /** The aspect ratio of the window for which the first view was calculated. */
  private aspect_ = 0;

  constructor(world: World, viewer: Viewer, navigation: Navigation) {
    this.world_ = world;
    this.viewer_ = viewer;
    this.navigation_ = navigation;
  }

  /** Moves to the first view of the present scene. */
  home(): void {
    this.kept_.clear();
    this.look_();
    this.frame_(true);
    this.navigation_.reset();
  }

  /** Brings all moving bodies into view, in the present direction. */
  showAll(): void {
    this.look_();
    const { yaw, pitch } = this.navigation_.goal;
    const view = fitView(this.points_, yaw, Math.max(pitch, 0.05), this.calcFrame_(1));
    if (view !== null) this.navigation_.goTo(view);
    this.viewer_.invalidate();
  }

  // --- PageListener

  changed(what: string): void {
    if (what !== "settings") return;
    const { title, hasCamera, cameraPosition, cameraTarget } = this.world_.settings;
    const script = JSON.stringify([title, hasCamera, cameraPosition, cameraTarget]);
    // Another script: the previous view is meaningless.
    if (script !== this.script_) this.framed_ = null;
    this.script_ = script;
  }

  link(state: LinkState): void {
    if (state !== "connected") this.rejoined_ = true;
  }

  // --- FramePart

  update(seconds: number): void {
    const { camera, renderer } = this.viewer_;
    const { body } = this.world_.entities;
    camera.getWorldPosition(body.eye);
    body.pixels = (renderer.domElement.height * camera.projectionMatrix.elements[5]) / 2;
    if (camera.aspect !== this.aspect_ && !this.viewer_.presenting) {
      this.aspect_ = camera.aspect;
      this.frame_(false);
    }
    this.wait_ -= seconds;
    // A page at rest has nothing new to look at.
    if (this.framed_ !== null && (this.wait_ > 0 || this.viewer_.resting) && !this.falling_) return;
    this.wait_ = lookEverySeconds;
    // A first look at a part of the scene would be kept: light and ground do not shrink at once.
    if (!this.world_.described || this.script_ === "") return;
    const bounds = this.look_();
    if (bounds === null) return;
    const isOther = this.framed_ === null || isAnother(bounds, this.framed_);
    const before = isOther && this.rejoined_ ? null : this.framed_;
    this.rejoined_ = false;
    if (isOther) {
      this.kept_.clear();
      this.framed_ = bounds;
    }
    const { hasCamera, cameraPosition: eye, cameraTarget: target } = this.world_.settings;
    const chosen = hasCamera ? smallest * Math.hypot(...eye.map((value, axis) => value - target[axis])) : 0;
    const size = Math.max(bounds.radius, chosen, 1e-12);
    this.viewer_.stage.setScene(bounds.center, size);
    this.world_.entities.body.size = this.viewer_.size;
    this.world_.entities.nail.pinRadius = pinSize * this.viewer_.size;
    this.navigation_.setScene(bounds.center, this.viewer_.size, Math.min(this.calcReach_(bounds.center), farthestWalk * size));
    if (before === null) {
      this.frame_(true);
      this.navigation_.jumpHome();
    } else if (isOther) {
      this.frame_(false);
    } else if (!this.navigation_.touched && !this.viewer_.presenting) {
      if (hasCamera) this.widen_();
      else this.follow_(bounds);
    }
  }

  // --- inside

  /** Keeps everything in view unless the script or the user has set the camera. */
  private follow_(bounds: Bounds): void {
    const view = this.calcView_(this.points_);
    const shown = this.navigation_.home;
    const frame = this.calcFrame_(1.04);
    const middle = new Points();
    middle.add(...bounds.center);
    // A scene that falls out of the picture is followed; parts that swing out of it widen the view.
    this.falling_ = shareOutside(middle, shown, this.calcFrame_(0.7)) > 0;
    if (this.falling_ && view !== null) {
      this.kept_.clear();
      this.framed_ = bounds;
      this.navigation_.setHome({ ...view, distance: Math.max(view.distance, shown.distance) });
      this.navigation_.follow();
      return;
    }
    const share = shareOutside(this.points_, shown, frame);
    // For a few that fly away, markers at the edge are shown instead.
    if (share === 0 || share > 0.5) return;
    this.kept_.addAll(this.points_);
    const reach = this.kept_.bounds();
    if (reach === null || this.framed_ === null || reach.radius > 2 * this.framed_.radius) {
      this.kept_.clear();
      return;
    }
    const larger = this.calcView_(this.kept_);
    if (this.kept_.count > 4000) this.kept_.clear();
    if (larger === null) return;
    this.navigation_.setHome(larger);
    this.navigation_.reset();
  }

  /** Brings what moves out of a narrow window into view, as far as the standard one would show it. */
  private widen_(): void {
    if (this.narrowness_ <= 1 || this.kept_.count >= mostKept) return;
    const { home } = this.navigation_;
    if (shareOutside(this.points_, home, this.calcFrame_(1.04)) === 0) return;
    addOutermost(this.kept_, this.points_, home, this.calcFrame_(1));
    this.frame_(false);
  }

  /** Width of the standard screen in widths of this one. */
  private get narrowness_(): number {
    const { camera } = this.viewer_;
    return usualSide / (Math.tan(MathUtils.degToRad(camera.fov / 2)) * camera.aspect);
  }

  /** Calculates the first view again; moves there if the user has not chosen another one, or if `always`. */
  private frame_(always: boolean): void {
    const view = this.calcHome_();
    if (view === null) return;
    this.navigation_.setHome(view);
    if ((always || !this.navigation_.touched) && !this.viewer_.presenting) this.navigation_.reset();
    this.viewer_.invalidate();
  }

  private calcHome_(): FittedView | null {
    const { hasCamera, cameraPosition: eye, cameraTarget: target } = this.world_.settings;
    if (!hasCamera) {
      this.points_.addAll(this.kept_);
      return this.calcView_(this.points_);
    }
    // A narrow window shows the same width as the standard one, up to that of the scene.
    this.setting_.clear();
    this.setting_.addAll(this.points_);
    this.setting_.addAll(this.kept_);
    this.addDrawn_(this.setting_);
    return standBack(this.setting_, eye, target, this.calcFrame_(1), this.narrowness_);
  }

  private calcView_(points: Points): FittedView | null {
    const view = fitView(points, usualYaw, usualPitch, this.calcFrame_(1));
    if (view === null) return null;
    // A single point has no size.
    return { ...view, distance: Math.max(view.distance, 1.6 * this.viewer_.size) };
  }

  /** The part of the picture without bar and edges, enlarged by the factor `larger`. */
  private calcFrame_(larger: number): Frame {
    const { camera } = this.viewer_;
    const up = Math.tan(MathUtils.degToRad(camera.fov / 2));
    const bar = this.viewer_.filming ? 0.06 : (innerWidth < narrowWidth ? tallBarHeight : barHeight) / innerHeight;
    return {
      side: Math.min(0.9 * larger, 1) * up * camera.aspect,
      up: Math.min(0.88 * larger, 1) * up,
      down: Math.max(Math.min((1 - 2 * bar) * larger, 1), 0.3) * up,
    };
  }

  /** Collects the corners of the scene and returns its bounds; null if it is empty. */
  private look_(): Bounds | null {
    const { points_: points, setting_: setting, world_: { entities, ground } } = this;
    const every = Math.ceil(entities.body.count / mostBodies);
    points.clear();
    entities.body.addPoints(points, every);
    if (points.count === 0) entities.particleSet.addPoints(points);
    if (points.count === 0) entities.body.forEachSetting(setting, (corners) => { points.addAll(corners); }, every);
    for (const view of Object.values<EntityView<never>>(entities)) view.addMoving?.(points);
    if (points.count === 0) this.addDrawn_(points);
    let bounds = points.bounds();
    if (bounds === null) return null;
    const most = settingSize * Math.max(bounds.radius, 1e-12);
    const moving = bounds;
    const take = (corners: Points) => {
      const its = corners.bounds();
      if (its === null) return;
      const apart = Math.hypot(...its.center.map((value, axis) => value - moving.center[axis]));
      if (apart + its.radius < most) points.addAll(corners);
    };
    setting.clear();
    this.addDrawn_(setting);
    // One by one: a single thing far away leaves the others counted.
    const [middleX, middleY, middleZ] = moving.center;
    for (let at = 0; at < 3 * setting.count; at += 3) {
      const x = setting.xyz[at];
      const y = setting.xyz[at + 1];
      const z = setting.xyz[at + 2];
      if (Math.hypot(x - middleX, y - middleY, z - middleZ) < most) points.add(x, y, z);
    }
    entities.body.forEachSetting(setting, take, every);
    bounds = points.bounds()!;
    // The place of the shadow below.
    if (ground !== null && ground < bounds.lowest && bounds.lowest - ground < 1.5 * bounds.radius) {
      points.add(bounds.center[0], ground, bounds.center[2]);
      bounds = points.bounds()!;
    }
    return bounds;
  }

  /** From a place to the farthest corner of what is fixed, m. */
  private calcReach_([x, y, z]: readonly [number, number, number]): number {
    let reach = 0;
    this.world_.entities.body.forEachSetting(this.setting_, ({ xyz, count }) => {
      for (let at = 0; at < 3 * count; at += 3) reach = Math.max(reach, Math.hypot(xyz[at] - x, xyz[at + 1] - y, xyz[at + 2] - z));
    });
    return reach;
  }

  /** Adds things that the script draws besides bodies. */
  private addDrawn_(points: Points): void {
    for (const view of Object.values<EntityView<never>>(this.world_.entities)) view.addPlaces?.(points);
  }
}

function isAnother(now: Bounds, before: Bounds): boolean {
  const apart = Math.hypot(...now.center.map((value, axis) => value - before.center[axis]));
  return now.radius > otherSize * before.radius || now.radius * otherSize < before.radius || apart > otherPlace * before.radius;
}

