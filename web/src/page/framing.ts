// SPDX-License-Identifier: Apache-2.0
// Frames what is there: works out where the scene is and how large, and the first view of it, and does so again when another scene
// comes or the window changes. Light, ground and fog follow. A camera that the user has moved is left alone.

import { MathUtils } from "three";
import { fitView, shareOutside, type FittedView, type Frame } from "../navigate/framing.ts";
import type { Navigation } from "../navigate/navigation.ts";
import { Points, type Bounds } from "../scene/points.ts";
import type { EntityView } from "../scene/entities/entity.ts";
import type { World } from "../world/world.ts";
import type { PageListener } from "./events.ts";
import type { FramePart, Viewer } from "./viewer.ts";

/** The first view without a camera of the script: a little from the side and above. */
const usualYaw = 0.4;
const usualPitch = 0.24;
/** Things that do not move count as far as they are near what does: up to this many times its size. */
const settingSize = 2.6;
const lookEverySeconds = 0.3;
/** At most so many bodies are looked at. */
const mostBodies = 1500;
/** A scene that is so many times larger or smaller, or so many sizes away, is another one. */
const otherSize = 2.5;
const otherPlace = 3;
/** Radius of the pins at nails, in sizes of the scene. */
const pinSize = 0.008;
/** In css px. */
const barHeight = 84;
const tallBarHeight = 150;
const narrowWidth = 560;
/** The usual screen, for which scripts choose their cameras. */
const usualSide = Math.tan(MathUtils.degToRad(21)) * (16 / 9);

export class Framing implements FramePart, PageListener {
  private readonly world_: World;
  private readonly viewer_: Viewer;
  private readonly navigation_: Navigation;
  private readonly points_ = new Points();
  private readonly setting_ = new Points();
  /** What has left the view that is shown, and has been added to it. */
  private readonly kept_ = new Points();
  private framed_: Bounds | null = null;
  private script_ = "";
  private wait_ = 0;
  private falling_ = false;

  constructor(world: World, viewer: Viewer, navigation: Navigation) {
    this.world_ = world;
    this.viewer_ = viewer;
    this.navigation_ = navigation;
    window.addEventListener("resize", () => this.frame_(false));
  }

  /** Goes to the first view of what is there now. */
  home(): void {
    this.kept_.clear();
    this.look_();
    this.frame_(true);
    this.navigation_.reset();
  }

  /** Brings all that moves into view, from where the user looks now. */
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
    // Another script: the view of the one before means nothing.
    if (script !== this.script_) this.framed_ = null;
    this.script_ = script;
  }

  // --- FramePart

  update(seconds: number): void {
    const { camera, renderer } = this.viewer_;
    const { body } = this.world_.entities;
    camera.getWorldPosition(body.eye);
    body.pixels = (renderer.domElement.height * camera.projectionMatrix.elements[5]) / 2;
    this.wait_ -= seconds;
    if (this.framed_ !== null && this.wait_ > 0 && !this.falling_) return;
    this.wait_ = lookEverySeconds;
    const bounds = this.look_();
    if (bounds === null || this.script_ === "") return;
    const before = this.framed_;
    const isOther = before === null || isAnother(bounds, before);
    if (isOther) {
      this.kept_.clear();
      this.framed_ = bounds;
    }
    const size = Math.max(bounds.radius, 1e-12);
    this.viewer_.stage.setScene(bounds.center, size);
    this.world_.entities.body.size = this.viewer_.size;
    this.world_.entities.nail.pinRadius = pinSize * this.viewer_.size;
    this.navigation_.setScene(bounds.center, this.viewer_.size);
    if (before === null) {
      this.frame_(true);
      this.navigation_.jumpHome();
    } else if (isOther) {
      this.frame_(false);
    } else if (!this.navigation_.touched && !this.world_.settings.hasCamera && !this.viewer_.presenting) {
      this.follow_(bounds);
    }
  }

  // --- inside

  /** Without a camera of the script and while the user leaves it alone, the camera keeps all in view. */
  private follow_(bounds: Bounds): void {
    const view = this.calcView_(this.points_);
    const shown = this.navigation_.home;
    const frame = this.calcFrame_(1.04);
    const middle = new Points();
    middle.add(...bounds.center);
    // What falls out of the picture as a whole is followed; what swings out of it makes it larger.
    this.falling_ = shareOutside(middle, shown, this.calcFrame_(0.7)) > 0;
    if (this.falling_ && view !== null) {
      this.kept_.clear();
      this.framed_ = bounds;
      this.navigation_.setHome({ ...view, distance: Math.max(view.distance, shown.distance) });
      this.navigation_.follow();
      return;
    }
    const share = shareOutside(this.points_, shown, frame);
    // A few that fly off are pointed at from the edge instead.
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

  /** Works out the first view anew; goes there if the user has not chosen another one, or if `always`. */
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
    const away = [eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]];
    const distance = Math.max(Math.hypot(...away), 1e-12);
    const yaw = Math.atan2(away[0], away[2]);
    const pitch = Math.asin(away[1] / distance);
    // A narrow window sees as much from side to side as the usual one, as far as there is something.
    const side = Math.tan(MathUtils.degToRad(this.viewer_.camera.fov / 2)) * this.viewer_.camera.aspect;
    const fit = fitView(this.points_, yaw, pitch, this.calcFrame_(1));
    const farther = Math.min((distance * usualSide) / side, fit?.distance ?? 0);
    if (fit !== null && farther > distance * 1.05) return { ...fit, distance: farther };
    return { pivot: [target[0], target[1], target[2]], distance, yaw, pitch };
  }

  private calcView_(points: Points): FittedView | null {
    const view = fitView(points, usualYaw, usualPitch, this.calcFrame_(1));
    if (view === null) return null;
    // A single point has no size of its own.
    return { ...view, distance: Math.max(view.distance, 1.6 * this.viewer_.size) };
  }

  /** The part of the picture that neither the bar nor the edges take; `larger` than that by a factor. */
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

  /** Gathers the corners of what is there and returns its bounds; null while there is nothing. */
  private look_(): Bounds | null {
    const { points_: points, setting_: setting, world_: { entities, ground } } = this;
    const every = Math.ceil(entities.body.count / mostBodies);
    points.clear();
    entities.body.addPoints(points, true, every);
    if (points.count === 0) entities.particleSet.addPoints(points);
    if (points.count === 0) entities.body.addPoints(points, false, every);
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
    entities.body.addPoints(setting, false, every);
    take(setting);
    setting.clear();
    this.addDrawn_(setting);
    take(setting);
    entities.staticShape.forEachCorners(setting, take);
    bounds = points.bounds()!;
    // The place below, where the shadow is.
    if (ground !== null && ground < bounds.lowest && bounds.lowest - ground < 1.5 * bounds.radius) {
      points.add(bounds.center[0], ground, bounds.center[2]);
      bounds = points.bounds()!;
    }
    return bounds;
  }

  /** Adds what the script draws beside bodies. */
  private addDrawn_(points: Points): void {
    for (const view of Object.values<EntityView<never>>(this.world_.entities)) view.addPlaces?.(points);
  }
}

function isAnother(now: Bounds, before: Bounds): boolean {
  const apart = Math.hypot(...now.center.map((value, axis) => value - before.center[axis]));
  return now.radius > otherSize * before.radius || now.radius * otherSize < before.radius || apart > otherPlace * before.radius;
}

