// SPDX-License-Identifier: Apache-2.0
// Frames the scene: calculates its place and size and the first view of it, again for a new scene or a changed window.
// Light, ground and fog depend on it. The view stays with what most of the scene is: it is widened for what swings out of it, and does
// not follow single things that go away. A camera that the user has moved is not changed.

import { MathUtils } from "three";
import { addOutermost, distanceToShow, fitView, shareOutside, standBack, dropOutside, viewAxes, type FittedView, type Frame } from "../navigate/framing.ts";
import type { Navigation } from "../navigate/navigation.ts";
import type { LinkState } from "../net/connection.ts";
import { BodyKind } from "../protocol/generated.ts";
import { Points, type Bounds } from "../scene/points.ts";
import type { EntityView } from "../scene/entities/entity.ts";
import type { World } from "../world/world.ts";
import type { PageListener } from "./events.ts";
import { apart, boxOf, makeItem, settingOf, settingSize, withoutFar, type Item, type Place } from "./subject.ts";
import type { Ways } from "./ways.ts";
import type { FramePart, Viewer } from "./viewer.ts";

/** The first view without a camera of the script: a little from the side and above. */
const usualYaw = 0.4;
const usualPitch = 0.24;
const lookEverySeconds = 0.3;
/** Surroundings that are so many sizes of the scene away are not walked to. */
const farthestWalk = 40;
/** Largest number of sampled bodies. */
const mostBodies = 1500;
/** After a lost connection, a change of size by this factor, or of place by this many sizes, is a new scene. */
const otherSize = 2.5;
const otherPlace = 3;
/** Labels and moving things count up to so many sizes of the scene from its middle. */
const labelSize = 24;
const nearSize = 2.5;
/** A thing that leaves the view widens it, up to so many times its size; a circle that a thing goes along may be larger. */
const widest = 2;
const widestCircle = 3;
/** So many of the things may leave the view before it is widened at once: a single one may be on its way to far away. */
const few = 0.1;
/** A followed scene has room to move in. */
const followDistance = 1.6;
/** A thing that has stayed in the middle of the picture for so long is not followed any more, s. */
const followSeconds = 0.5;
/** In s: from then on a thing that is far away has gone there. */
const goneAfter = 5;
/** A scene is at least so large, in distances from the script's camera to its target: a single rocket that flies has another size. */
const smallest = 0.25;
/** Radius of the pins at nails, in sizes of the scene. */
const pinSize = 0.008;
/** The size of a scene for its pins is at most this share of the distance from the script's camera to its target. */
const nearShare = 0.6;
/** The longest chain whose length at rest is looked for; a net is shorter than all its parts. */
const mostLinks = 20;
/** After so many looks in a row a smaller scene is another one. */
const mostSmall = 10;
/** Looks before the first picture. */
const mostEarly = 30;
/** Places that widened the view of a narrow window; enough for a motion's reach. */
const mostKept = 200;
/** The standard screen, for which scripts choose their cameras. */
const usualSide = Math.tan(MathUtils.degToRad(21)) * (16 / 9);

export class Framing implements FramePart, PageListener {
  private readonly world_: World;
  private readonly viewer_: Viewer;
  private readonly navigation_: Navigation;
  /** Corners of all things, in the order of the items, and places of drawings after them. */
  private readonly points_ = new Points();
  private readonly setting_ = new Points();
  /** The points of the first view, and those that widen it. */
  private readonly base_ = new Points();
  private readonly kept_ = new Points();
  /** All that moves; and the part of it that belongs to the scene and has not gone away. */
  private moving_: readonly Item[] = [];
  private members_: readonly Item[] = [];
  /** Slots of the fixed bodies that are part of the scene, and the middle and size of what moves in it at first. */
  private chosen_: ReadonlySet<number> = new Set();
  private fixed_: readonly Item[] = [];
  private core_ = { center: [0, 0, 0] as readonly [number, number, number], radius: 1 };
  /** Size of the whole scene, with what stands. */
  private whole_ = 0;
  private ways_: Ways | null = null;
  private asked_ = false;
  private early_ = 0;
  private framed_: Bounds | null = null;
  private script_ = "";
  private wait_ = 0;
  /** Looks in a row at which the scene was much smaller. */
  private small_ = 0;
  private updated_ = 0;
  /** Since the followed things have left the middle of the picture, s; where it was then, and where they were last. */
  private stayed_ = Infinity;
  private anchor_: FittedView | null = null;
  private last_: Place = [0, 0, 0];
  /** The connection was lost since the last look: another scene is of another script, though that may have the same title. */
  private rejoined_ = false;
  /** The aspect ratio of the window for which the first view was calculated. */
  private aspect_ = 0;
  private margin_ = 0;

  constructor(world: World, viewer: Viewer, navigation: Navigation) {
    this.world_ = world;
    this.viewer_ = viewer;
    this.navigation_ = navigation;
  }

  /** Moves to the first view of the present scene. */
  home(): void {
    this.begin_(this.look_(true));
    this.frame_(true);
    this.navigation_.reset();
  }

  /** Brings all moving bodies into view, in the present direction. */
  showAll(): void {
    this.look_(false);
    this.setting_.clear();
    for (const item of this.moving_) this.addItem_(item, this.setting_);
    this.setting_.addAll(this.base_);
    const { yaw, pitch } = this.navigation_.goal;
    const view = fitView(this.setting_, yaw, Math.max(pitch, 0.05), this.calcFrame_(1));
    if (view !== null) this.navigation_.goTo(view);
    this.viewer_.invalidate();
  }

  /** How far from the middle of the first view, on the level, all bodies that move are within a view of this tangent to both sides, m. */
  stepToShow(side: number): number {
    this.setting_.clear();
    for (const item of this.members_) if (item.slot >= 0) this.addItem_(item, this.setting_);
    this.dropUnseen_(this.setting_);
    return distanceToShow(this.setting_, { ...this.navigation_.home, pitch: 0 }, { side, up: Infinity, down: Infinity });
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

  update(seconds: number, now?: number): void {
    const { camera, renderer } = this.viewer_;
    const { body } = this.world_.entities;
    camera.getWorldPosition(body.eye);
    body.pixels = (renderer.domElement.height * camera.projectionMatrix.elements[5]) / 2;
    const { margins: { bottom, right } } = this.viewer_;
    if ((camera.aspect !== this.aspect_ || bottom + right !== this.margin_) && !this.viewer_.presenting) {
      this.aspect_ = camera.aspect;
      this.margin_ = bottom + right;
      this.frame_(false);
    }
    // In real time: a frame that took long is told as a short one.
    const elapsed = now === undefined ? seconds : (now - this.updated_) / 1000;
    this.wait_ -= elapsed;
    this.updated_ = now ?? 0;
    // A thing that moves before the page shows its first picture widens it, unless a view was chosen already.
    const isEarly = this.viewer_.hidden && !this.navigation_.touched && this.framed_ !== null && this.early_ < mostEarly;
    if (isEarly) {
      this.early_++;
      this.wait_ = 0;
    }
    // A page at rest has nothing new to look at.
    if (this.framed_ !== null && (this.wait_ > 0 || this.viewer_.resting) && !this.isFollowing_) return;
    this.wait_ = lookEverySeconds;
    // A first look at a part of the scene would be kept: light and ground do not shrink at once.
    if (!this.world_.described || this.script_ === "") return;
    const seen = this.look_(this.framed_ === null);
    const { framed_: framed } = this;
    // A thing that swings is small at times.
    this.small_ = framed !== null && seen !== null && seen.radius * otherSize < framed.radius ? this.small_ + 1 : 0;
    const isOther = framed === null || seen === null || !this.stays_ || this.small_ > mostSmall || (this.rejoined_ && isAnother(seen, framed));
    const bounds = isOther ? this.look_(true) : seen;
    if (bounds === null) return;
    const before = isOther && this.rejoined_ ? null : framed;
    this.rejoined_ = false;
    if (isOther) this.begin_(bounds);
    else if (isEarly) this.widenFirst_(bounds);
    const { hasCamera, cameraPosition: eye, cameraTarget: target } = this.world_.settings;
    const chosen = hasCamera ? smallest * Math.hypot(...eye.map((value, axis) => value - target[axis])) : 0;
    const size = Math.max(bounds.radius, chosen, 1e-12);
    this.viewer_.stage.setScene(bounds.center, size);
    this.world_.entities.body.size = this.viewer_.size;
    // A camera that looks from near, in a building of many rooms, shows pins of the size of what is near.
    this.world_.entities.nail.pinRadius = pinSize * (hasCamera ? Math.min(this.viewer_.size, nearShare * chosen / smallest) : this.viewer_.size);
    this.navigation_.setScene(bounds.center, this.viewer_.size, Math.min(this.calcReach_(bounds.center), farthestWalk * size));
    if (before === null) {
      this.frame_(true);
      this.navigation_.jumpHome();
    } else if (isEarly) {
      this.frame_(false);
      this.navigation_.jumpHome();
    } else if (this.world_.marks.held < 0) {
      // A camera that moved would move what its user holds, which would move the camera.
      const isFree = !this.navigation_.touched && !this.viewer_.presenting;
      if (isFree && !hasCamera && this.follow_(elapsed)) return;
      if (isOther) this.frame_(false);
      else if (isFree && hasCamera) this.widen_();
      else if (isFree) this.widenFree_(bounds);
    }
    this.stayed_ = Infinity;
  }

  // --- inside

  /** Takes the things that were just looked at as the scene to show. */
  private begin_(bounds: Bounds | null): Bounds | null {
    this.kept_.clear();
    this.small_ = 0;
    this.ways_?.clear();
    this.base_.clear();
    this.whole_ = bounds?.radius ?? 0;
    this.addScene_(this.base_);
    this.framed_ = bounds;
    return bounds;
  }

  /** Adds what was just looked at to the first view, unless most of it has gone elsewhere. */
  private widenFirst_(bounds: Bounds): void {
    const { base_: base } = this;
    const before = base.count;
    this.addScene_(base);
    if ((base.bounds()?.radius ?? 0) <= widest * bounds.radius) return;
    base.count = before;
    this.begin_(bounds);
  }

  /** Whether half of all things or more are still in the scene. */
  private get stays_(): boolean {
    const fixed = this.chosen_.size;
    return 2 * (this.members_.length + fixed) >= this.moving_.length + fixed;
  }

  private get isFollowing_(): boolean {
    return this.stayed_ < followSeconds;
  }

  /** Goes along with a scene that leaves the picture, at any speed, until it has come to rest; whether it does. */
  private follow_(elapsed: number): boolean {
    const { home: shown } = this.navigation_;
    const { isFollowing_: isFollowing } = this;
    const { center } = boxOf(withoutFar(this.moving_));
    this.stayed_ = this.isLeaving_(isFollowing ? this.anchor_! : shown) ? 0 : this.stayed_ + elapsed;
    if (!this.isFollowing_) return false;
    const view = this.calcView_(this.begin_(this.look_(true)) === null ? this.kept_ : this.base_);
    if (view === null) return false;
    const { last_: last } = this;
    this.last_ = center;
    this.navigation_.setHome({ ...view, distance: Math.max(followDistance * view.distance, isFollowing ? shown.distance : 0) });
    this.navigation_.follow(isFollowing ? [center[0] - last[0], center[1] - last[1], center[2] - last[2]] : [0, 0, 0]);
    if (this.stayed_ === 0) this.anchor_ = this.navigation_.home;
    return true;
  }

  /** Keeps the scene in view unless the script or the user has set the camera. */
  private widenFree_(bounds: Bounds): void {
    const shown = this.navigation_.home;
    const frame = this.calcFrame_(1.04);
    const out = this.members_.filter((item) => {
      const { setting_: corners } = this;
      corners.clear();
      this.addItem_(item, corners);
      return shareOutside(corners, shown, frame) > 0;
    });
    const { kept_: kept } = this;
    const before = kept.count;
    let most = widest;
    if (out.length > 1 && out.length > few * (this.moving_.length + this.chosen_.size)) {
      this.setting_.clear();
      for (const item of out) this.addItem_(item, this.setting_);
      addOutermost(kept, this.setting_, shown, frame);
    } else {
      if (out.length > 0 && !this.asked_) this.fetchWays_();
      const circles = this.ways_?.follow(this.members_, out, this.framed_ ?? bounds, kept, this.world_.ground === null, (item) => this.addItem_(item, kept));
      most = circles === true ? widestCircle : widest;
    }
    if (kept.count === before) this.addNewDrawings_(shown, frame);
    if (kept.count === before) return;
    this.setting_.clear();
    this.setting_.addAll(this.base_);
    this.setting_.addAll(kept);
    const reach = this.setting_.bounds();
    const view = this.calcView_(this.setting_);
    if (reach === null || view === null || reach.radius > most * Math.max(bounds.radius, this.framed_?.radius ?? 0)) {
      kept.count = before;
      return;
    }
    this.navigation_.setHome(view);
    this.navigation_.reset();
  }

  /** Whether the middle of all things leaves the view, and most of them do. A thing that hangs from a nail swings back. */
  private isLeaving_(shown: FittedView): boolean {
    const { setting_: places, moving_: moving, chosen_: { size: fixed }, world_: { entities: { nail, membership } } } = this;
    const hanging = new Set<number>();
    nail.forEachPlace((body) => hanging.add(membership.articulateOf(body)));
    hanging.delete(-1);
    const free = moving.filter(({ slot }) => slot < 0 || !hanging.has(membership.articulateOf(slot)));
    if (2 * free.length <= moving.length + fixed) return false;
    places.clear();
    for (const { center } of free) places.add(...center);
    // It is brought well into the picture.
    const inner = this.calcFrame_(this.isFollowing_ ? 0.25 : moving.length === 1 ? 0.7 : 0.9);
    const away = shareOutside(places, shown, inner) * free.length;
    if (2 * away <= moving.length + fixed) return false;
    const middle = withoutFar(moving);
    places.clear();
    places.add(...boxOf(middle).center);
    return shareOutside(places, shown, inner) > 0;
  }

  private fetchWays_(): void {
    this.asked_ = true;
    void import("./ways.ts").then(({ Ways }) => {
      this.ways_ = new Ways();
    });
  }

  /** Adds what the script has drawn or labeled since. */
  private addNewDrawings_(shown: FittedView, frame: Frame): void {
    const { setting_: drawn } = this;
    drawn.clear();
    this.addSetting_(drawn);
    if (shareOutside(drawn, shown, frame) > 0) addOutermost(this.kept_, drawn, shown, frame);
  }

  /** Brings what moves out of a narrow window into view, as far as the standard one would show it. */
  private widen_(): void {
    if (this.narrowness_ <= 1 || this.kept_.count >= mostKept) return;
    const { home } = this.navigation_;
    const { setting_: scene } = this;
    scene.clear();
    this.addScene_(scene);
    this.dropUnseen_(scene);
    if (shareOutside(scene, home, this.calcFrame_(1.04)) === 0) return;
    addOutermost(this.kept_, scene, home, this.calcFrame_(1));
    this.frame_(false);
  }

  /** Drops the points that the script's camera does not show on the standard screen either: other rooms of a building. */
  private dropUnseen_(points: Points): void {
    const { hasCamera, cameraPosition: eye, cameraTarget: target } = this.world_.settings;
    if (!hasCamera) return;
    const up = Math.tan(MathUtils.degToRad(this.viewer_.camera.fov / 2));
    dropOutside(points, eye, target, { side: usualSide, up, down: up });
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
    this.setting_.clear();
    this.setting_.addAll(this.base_);
    this.setting_.addAll(this.kept_);
    if (!hasCamera) return this.calcView_(this.setting_);
    // A narrow window shows the same width as the standard one, up to that of the scene.
    this.addDrawn_(this.setting_);
    this.dropUnseen_(this.setting_);
    return standBack(this.setting_, eye, target, this.calcFrame_(1), this.narrowness_);
  }

  /** Shows the points, and labels at their sizes. */
  private calcView_(points: Points): FittedView | null {
    const frame = this.calcFrame_(1);
    const { count } = points;
    let view = fitView(points, usualYaw, usualPitch, frame);
    // Labels are as large as the view is far away.
    for (let round = 0; round < 3 && view !== null; round++) {
      points.count = count;
      this.addLabels_(points, view);
      if (points.count === count) break;
      view = fitView(points, usualYaw, usualPitch, frame);
    }
    points.count = count;
    if (view === null) return null;
    // A single point has no size.
    return { ...view, distance: Math.max(view.distance, 1.6 * this.viewer_.size) };
  }

  /** Corners of the labels of a constant size, as they are seen in a view. */
  private addLabels_(points: Points, { distance, yaw, pitch }: FittedView): void {
    const [right, up] = viewAxes(yaw, pitch);
    for (const moving of [false, true]) {
      this.world_.entities.label.forEachPlate(moving, ({ x, y, z }, width, height) => {
        if (apart([x, y, z], this.core_.center) > (moving ? nearSize * this.core_.radius : this.labelReach_())) return;
        const [a, b] = [(width * distance) / 2, (height * distance) / 2];
        for (const [across, over] of [[a, b], [a, -b], [-a, b], [-a, -b]]) {
          points.add(x + across * right[0] + over * up[0], y + over * up[1], z + across * right[2] + over * up[2]);
        }
      });
    }
  }

  /** The part of the picture without bar, panel and edges, enlarged by the factor `larger`. A script's camera is as the script says. */
  private calcFrame_(larger: number): Frame {
    const { camera, filming } = this.viewer_;
    const up = Math.tan(MathUtils.degToRad(camera.fov / 2));
    const bar = filming ? 0.06 : this.viewer_.margins.bottom / innerHeight;
    return {
      side: Math.min(0.9 * larger, 1) * up * camera.aspect,
      right: Math.min((filming || this.world_.settings.hasCamera ? 1 : 1 - (2 * this.viewer_.margins.right) / innerWidth) * larger, 0.9 * larger, 1) * up * camera.aspect,
      up: Math.min(0.88 * larger, 1) * up,
      down: Math.max(Math.min((1 - 2 * bar) * larger, 1), 0.3) * up,
    };
  }

  /** Collects what is in the world and returns the bounds of the scene; null if there is none. `fresh`: chooses what is part of it. */
  private look_(fresh: boolean): Bounds | null {
    const { points_: points, framed_: framed, world_: { entities: { body, particleSet }, settings: { hasCamera }, time, ground } } = this;
    const every = Math.ceil(body.count / mostBodies);
    points.clear();
    let moving: Item[] = [];
    const fixed: Item[] = [];
    const take = (first: number, slot: number, moves: boolean) => {
      const item = makeItem(points, first, slot, moves);
      if (item !== null) (moves ? moving : fixed).push(item);
    };
    body.forEachDrawn((slot, kind) => {
      const first = points.count;
      body.addCorners(points, slot);
      take(first, slot, kind === BodyKind.dynamic);
    }, every);
    if (moving.length === 0) {
      const { setting_: sparks } = this;
      sparks.clear();
      particleSet.addPoints(sparks);
      for (let at = 0; at < 3 * sparks.count; at += 3) {
        points.add(sparks.xyz[at], sparks.xyz[at + 1], sparks.xyz[at + 2]);
        take(points.count - 1, -1, true);
      }
    }
    if (moving.length === 0) moving = fixed.splice(0);
    if (moving.length === 0) {
      const first = points.count;
      this.addDrawn_(points);
      take(first, -1, true);
    }
    this.moving_ = moving;
    if (moving.length === 0) return null;
    if (fresh || framed === null) {
      // All that stands is where the scene was made.
      const usual = time > goneAfter ? new Set(withoutFar([...moving, ...fixed])) : null;
      const there = usual === null ? [] : moving.filter((item) => usual.has(item));
      this.members_ = there.length > 0 ? there : withoutFar(moving);
      this.core_ = boxOf(this.members_);
      this.chosen_ = new Set(settingOf(this.members_, fixed, !hasCamera).map(({ slot }) => slot));
    } else {
      const most = nearSize * Math.max(framed.radius, 1e-12);
      this.members_ = moving.filter(({ center }) => apart(center, framed.center) < most);
    }
    this.fixed_ = fixed.filter((item) => (
      this.chosen_.has(item.slot) || (!fresh && framed !== null && apart(item.center, framed.center) + item.radius < framed.radius)
    ));
    const { setting_: scene } = this;
    scene.clear();
    this.addScene_(scene);
    let bounds = scene.bounds();
    // The place of the shadow below.
    if (bounds !== null && ground !== null && ground < bounds.lowest && bounds.lowest - ground < 1.5 * bounds.radius) {
      points.add(bounds.center[0], ground, bounds.center[2]);
      take(points.count - 1, -1, false);
      this.fixed_ = [...this.fixed_, fixed.at(-1)!];
      scene.add(bounds.center[0], ground, bounds.center[2]);
      bounds = scene.bounds();
    }
    return bounds;
  }

  private addItem_({ first, end }: Item, points: Points): void {
    const { xyz } = this.points_;
    for (let at = 3 * first; at < 3 * end; at += 3) points.add(xyz[at], xyz[at + 1], xyz[at + 2]);
  }

  /** Adds what is part of the scene. */
  private addScene_(points: Points): void {
    for (const item of this.members_) this.addItem_(item, points);
    const drawn = new Points();
    for (const view of Object.values<EntityView<never>>(this.world_.entities)) view.addMoving?.(drawn);
    this.addNear_(drawn, nearSize * (this.framed_?.radius ?? Infinity), points);
    this.addSetting_(points);
  }

  /** How far labels are that belong to the scene: a button may be small on its pedestal. */
  private labelReach_(): number {
    return Math.max(labelSize * this.core_.radius, nearSize * this.whole_, 1e-12);
  }

  /** Adds what is part of the scene and does not move. */
  private addSetting_(points: Points): void {
    for (const item of this.fixed_) this.addItem_(item, points);
    const drawn = new Points();
    this.addDrawn_(drawn);
    this.addNear_(drawn, settingSize * Math.max(this.core_.radius, 1e-12), points);
    this.addHanging_(points);
    this.world_.entities.label.forEachPlate(false, ({ x, y, z }) => {
      if (apart([x, y, z], this.core_.center) < this.labelReach_()) points.add(x, y, z);
    });
  }

  /** Adds nails, and below each the place down to which what hangs from it alone reaches at rest. */
  private addHanging_(points: Points): void {
    const { moving_: moving, world_: { ground, entities: { nail, membership } } } = this;
    const hanging = new Map<number, readonly [number, number, number] | null>();
    nail.forEachPlace((body, { x, y, z }) => {
      points.add(x, y, z);
      const part = membership.articulateOf(body);
      hanging.set(part, part < 0 || hanging.has(part) ? null : [x, y, z]);
    });
    if (ground === null) return;
    for (const [part, place] of hanging) {
      const links = moving.filter(({ slot }) => slot >= 0 && membership.articulateOf(slot) === part);
      if (place === null || links.length > mostLinks) continue;
      points.add(place[0], Math.max(place[1] - links.reduce((length, { radius }) => length + 2 * radius, 0), ground), place[2]);
    }
  }

  /** Adds those of the points that are near the middle of the scene, one by one: a single thing far away leaves the others counted. */
  private addNear_({ xyz, count }: Points, most: number, points: Points): void {
    const { center } = this.core_;
    for (let at = 0; at < 3 * count; at += 3) {
      if (apart([xyz[at], xyz[at + 1], xyz[at + 2]], center) < most) points.add(xyz[at], xyz[at + 1], xyz[at + 2]);
    }
  }

  /** From a place to the farthest corner of what is fixed or has gone away, m. */
  private calcReach_([x, y, z]: readonly [number, number, number]): number {
    const { world_: { entities: { body } }, setting_: corners } = this;
    corners.clear();
    body.forEachDrawn((slot, kind) => {
      if (kind !== BodyKind.dynamic) body.addCorners(corners, slot);
    });
    let reach = 0;
    for (let at = 0; at < 3 * corners.count; at += 3) reach = Math.max(reach, Math.hypot(corners.xyz[at] - x, corners.xyz[at + 1] - y, corners.xyz[at + 2] - z));
    for (const { center } of this.moving_) reach = Math.max(reach, apart(center, [x, y, z]));
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

