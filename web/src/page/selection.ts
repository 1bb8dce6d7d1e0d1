// SPDX-License-Identifier: Apache-2.0
// What the user points at, has selected and holds; the server is told of selections and holds.

import { Gestures, type GestureListener, type Grab, type Pointer } from "../interact/gestures.ts";
import type { LinkState } from "../net/connection.ts";
import type { Vec3 } from "../protocol/generated.ts";
import type { BodyView } from "../scene/body_view.ts";
import { usualLateness } from "../scene/pose_buffer.ts";
import type { WorldModel } from "../scene/world_model.ts";
import type { Events, PageListener } from "./events.ts";
import type { Session } from "./session.ts";
import type { FramePart, Viewer } from "./viewer.ts";

export class Selection implements GestureListener, FramePart, PageListener {
  readonly gestures: Gestures;

  private readonly world_: WorldModel;
  private readonly bodies_: BodyView;
  private readonly session_: Session;
  private readonly viewer_: Viewer;
  private readonly events_: Events;
  private selected_ = -1;

  constructor(world: WorldModel, bodies: BodyView, session: Session, viewer: Viewer, events: Events) {
    this.world_ = world;
    this.bodies_ = bodies;
    this.session_ = session;
    this.viewer_ = viewer;
    this.events_ = events;
    this.gestures = new Gestures(bodies, this);
  }

  /** This page's selected body, -1: none. */
  get selected(): number {
    return this.selected_;
  }

  /** The body that a hand of this page holds, the newest if there are several; -1: none. */
  get held(): number {
    return this.gestures.grabs.at(-1)?.body ?? -1;
  }

  /** The body that a pointer is over without holding it, -1: none. */
  get hovered(): number {
    for (const pointer of this.gestures.pointers) {
      if (pointer.active && pointer.grab === null && pointer.hovered >= 0) return pointer.hovered;
    }
    return -1;
  }

  /** What an action is about: the held, else the selected, else the hovered body, else -1. */
  get meant(): number {
    if (this.held >= 0) return this.held;
    return this.selected_ >= 0 ? this.selected_ : this.hovered;
  }

  /** Selects a body, -1: none. */
  select(body: number): void {
    if (body === this.selected_) return;
    this.viewer_.stir();
    this.selected_ = body;
    this.session_.select(body);
    this.events_.changed("selection");
  }

  /** Selects the next body that can be held, or the one before: for keyboards without a mouse. */
  selectNext(direction: 1 | -1): void {
    const { pickable, pickableCount } = this.bodies_;
    if (pickableCount === 0) return;
    const at = pickable.subarray(0, pickableCount).indexOf(this.selected_);
    const next = at < 0 ? (direction > 0 ? 0 : pickableCount - 1) : (at + direction + pickableCount) % pickableCount;
    this.select(pickable[next]);
  }

  /** Force of a grab as the server last told, N; -1 while the server has not confirmed it. */
  confirmedForce(grab: Grab): number {
    const { holds, holdCount } = this.world_;
    for (let index = 0; index < holdCount; index++) {
      const hold = holds[index];
      if (hold.client === this.session_.clientId && hold.hold === grab.hold) return hold.force;
    }
    return -1;
  }

  /** Force of a grab as the server last told, N. */
  forceOf(grab: Grab): number {
    return Math.max(this.confirmedForce(grab), 0);
  }

  // --- FramePart

  update(): void {
    this.hurryHeld_();
    this.dropVanished_();
    if (this.gestures.grabs.length > 0) this.viewer_.stir();
  }

  decide(): void {
    this.gestures.updateAll();
  }

  // --- PageListener

  link(state: LinkState): void {
    if (state !== "connected") this.gestures.releaseAll();
    else if (this.selected_ >= 0) this.session_.select(this.selected_);
  }

  // --- GestureListener

  hoverChanged(pointer: Pointer, body: number): void {
    this.viewer_.stir();
    if (body >= 0) pointer.pulse(0.15, 12);
    this.events_.hover(pointer, body);
  }

  grabStarted(grab: Grab): void {
    this.select(grab.body);
    this.session_.send({
      type: "grabStart", hold: grab.hold, body: grab.body, localPoint: vec3(grab.localPoint), target: vec3(grab.target),
    });
    grab.pointer.pulse(0.6, 30);
    this.events_.grab(grab, "start");
  }

  grabMoved(grab: Grab): void {
    this.session_.send({ type: "grabMove", hold: grab.hold, target: vec3(grab.target) });
  }

  grabEnded(grab: Grab): void {
    this.session_.send({ type: "grabEnd", hold: grab.hold });
    this.events_.grab(grab, "end");
  }

  pressedNothing(pointer: Pointer): void {
    this.events_.pressNothing(pointer);
  }

  // --- inside

  /** What is held, and all that is jointed to it, is drawn without delay: alone it would tear off its neighbors. */
  private hurryHeld_(): void {
    const goal = this.bodies_.poses.lateness.goal;
    goal.fill(usualLateness);
    for (const grab of this.gestures.grabs) {
      goal[grab.body] = 0;
      const articulate = this.world_.articulateOf.get(grab.body);
      if (articulate === undefined) continue;
      for (const entry of this.world_.articulates) if (entry.articulate === articulate) goal[entry.body] = 0;
    }
  }

  private dropVanished_(): void {
    const { bodies } = this.world_;
    if (this.selected_ >= 0 && bodies.size > 0 && !bodies.has(this.selected_)) this.select(-1);
    for (let index = this.gestures.grabs.length - 1; index >= 0; index--) {
      const grab = this.gestures.grabs[index];
      if (!bodies.has(grab.body)) this.gestures.releaseAll(grab.body);
    }
  }
}

function vec3(from: Float32Array): Vec3 {
  return [from[0], from[1], from[2]];
}
