// SPDX-License-Identifier: Apache-2.0
// The hovered, selected and held bodies of the user. Sends selections and holds to the server.

import { Gestures, type GestureListener, type Grab, type Pointer } from "../interact/gestures.ts";
import { toBody, toWorld } from "../interact/picking.ts";
import type { LinkState } from "../net/connection.ts";
import { Role, type Vec3 } from "../protocol/generated.ts";
import { usualLateness } from "../scene/pose_buffer.ts";
import type { Hold, World } from "../world/world.ts";
import type { Events, PageListener } from "./events.ts";
import type { Session } from "./session.ts";
import type { FramePart, Viewer } from "./viewer.ts";

type SelectionSession = Pick<Session, "clientId" | "role" | "idOf" | "select" | "send">;

export class Selection implements GestureListener, FramePart, PageListener {
  readonly gestures: Gestures;

  private readonly world_: World;
  private readonly session_: SelectionSession;
  private readonly viewer_: Pick<Viewer, "invalidate">;
  private readonly events_: Events;
  /** A press on a body adds it to the selection, or takes it out. */
  adding = false;
  private selected_ = -1;
  /** Selected besides that one. */
  private readonly more_ = new Set<number>();
  /** Stamp of the last poses before a body was gone, ms. */
  private goneAt_ = 0;
  /** Version of the structure in which the holds were followed last. */
  private followedVersion_ = 0;
  private readonly place_ = new Float32Array(3);

  constructor(world: World, session: SelectionSession, viewer: Pick<Viewer, "invalidate">, events: Events) {
    this.world_ = world;
    this.session_ = session;
    this.viewer_ = viewer;
    this.events_ = events;
    this.gestures = new Gestures(world.entities.body, this);
  }

  /** This page's selected body, -1: none. */
  get selected(): number {
    return this.selected_;
  }

  /** The body held by a hand of this page, the newest of several; -1: none. */
  get held(): number {
    return this.gestures.grabs.findLast((grab) => !grab.isGone)?.body ?? -1;
  }

  /** The hovered body, -1: none. */
  get hovered(): number {
    for (const pointer of this.gestures.pointers) {
      if (pointer.active && pointer.grab === null && pointer.hovered >= 0) return pointer.hovered;
    }
    return -1;
  }

  /** The body for an action: the held one, otherwise the selected, then the hovered one; -1: none. */
  get actionBody(): number {
    if (this.held >= 0) return this.held;
    return this.selected_ >= 0 ? this.selected_ : this.hovered;
  }

  /** The bodies for an action: as `actionBody`, with all that are selected together with it. */
  get actionBodies(): readonly number[] {
    const body = this.actionBody;
    if (body < 0) return [];
    return body === this.selected_ || this.more_.has(body) ? [this.selected_, ...this.more_] : [body];
  }

  /** The selected bodies if there are several. */
  get several(): ReadonlySet<number> {
    return this.more_;
  }

  /** Selects these bodies and no others; the server is told of the first one. */
  selectMany(bodies: Iterable<number>): void {
    const [first = -1, ...more] = new Set(bodies);
    this.select(first);
    for (const body of more) this.more_.add(body);
    if (more.length > 0) this.events_.changed("selection");
  }

  /** Adds a body to the selection, or takes it out. */
  toggle(body: number): void {
    const all = this.selected_ < 0 ? [] : [this.selected_, ...this.more_];
    this.selectMany(all.includes(body) ? all.filter((other) => other !== body) : [...all, body]);
  }

  /** Selects a body alone, -1: none. */
  select(body: number): void {
    if (body === this.selected_ && this.more_.size === 0) return;
    this.viewer_.invalidate();
    this.more_.clear();
    if (body === this.selected_) return this.events_.changed("selection");
    this.selected_ = body;
    this.session_.select(body);
    this.events_.changed("selection");
  }

  /** Selects the next or previous body that can be held: for use without a mouse. */
  selectNext(direction: 1 | -1): void {
    const { pickable, pickableCount } = this.world_.entities.body;
    if (pickableCount === 0) return;
    const at = pickable.subarray(0, pickableCount).indexOf(this.selected_);
    const next = at < 0 ? (direction > 0 ? 0 : pickableCount - 1) : (at + direction + pickableCount) % pickableCount;
    this.select(pickable[next]);
  }

  /** Force of a grab in the server's last message, N; -1 until the server has confirmed it. */
  confirmedForce(grab: Grab): number {
    return this.holdOf_(grab)?.force ?? -1;
  }

  /** Force of a grab in the server's last message, N. */
  forceOf(grab: Grab): number {
    return Math.max(this.confirmedForce(grab), 0);
  }

  // --- FramePart

  update(): void {
    for (const grab of this.gestures.grabs.slice()) this.followHold_(grab);
    this.followedVersion_ = this.world_.structureVersion;
    this.drawHeldAtOnce_();
    if (this.gestures.grabs.length > 0) this.viewer_.invalidate();
  }

  interact(): void {
    this.gestures.updateAll();
    const { hovered, selected, held } = this;
    Object.assign(this.world_.marks, { hovered, selected, held });
  }

  // --- PageListener

  /** Drops everything about the body, so that nothing passes to the next body in its slot. */
  bodyGone(body: number): void {
    this.gestures.forget(body);
    this.goneAt_ = this.world_.poses.newestStamp;
    this.more_.delete(body);
    if (this.selected_ === body) this.selectMany([...this.more_]);
  }

  pulse(hand: string, strength: number, seconds: number): void {
    for (const pointer of this.gestures.pointers) if (hand === "" || pointer.name === hand) pointer.pulse(strength, 1000 * seconds);
  }

  link(state: LinkState): void {
    if (state !== "connected") this.gestures.releaseAll();
    else if (this.selected_ >= 0) this.session_.select(this.selected_);
  }

  // --- GestureListener

  mayHold(): boolean {
    return this.session_.role !== Role.viewer;
  }

  bodyPressed(body: number): void {
    if (this.adding) this.toggle(body);
    else this.select(body);
  }

  hoverChanged(pointer: Pointer, body: number): void {
    this.viewer_.invalidate();
    if (body >= 0) pointer.pulse(0.15, 12);
    this.events_.hover(pointer, body);
  }

  grabStarted(grab: Grab): void {
    // A hand on one of several keeps them all: an action is about them.
    if (this.adding) this.toggle(grab.body);
    else if (grab.body !== this.selected_ && !this.more_.has(grab.body)) this.select(grab.body);
    // The hand acts at the center of a particle, not where its surface was pressed: while it rests, it must not pull there.
    const { entities: { body } } = this.world_;
    body.toAnchor(grab.body, grab.localPoint);
    toWorld(body, grab.body, grab.localPoint, grab.target);
    for (let axis = 0; axis < 3; axis++) grab.offset[axis] += grab.target[axis] - grab.start[axis];
    this.session_.send({
      type: "grabStart", hold: grab.hold, body: this.session_.idOf(grab.body), localPoint: vec3(grab.localPoint), target: vec3(grab.target),
      pointer: grab.pointer.name,
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

  releasedNothing(pointer: Pointer): void {
    this.events_.releaseNothing(pointer);
  }

  // --- inside

  private holdOf_(grab: Grab): Hold | undefined {
    const { holds, holdCount } = this.world_;
    for (let index = 0; index < holdCount; index++) {
      const hold = holds[index];
      if (hold.client === this.session_.clientId && hold.hold === grab.hold) return hold;
    }
    return undefined;
  }

  /**
   * After an edit a grab is where the server's hold is: on the body that absorbed its own, or on the part that was taken from it. If the
   * body was destroyed and there is no hold, the grab ends. The same body may also have another frame, with its origin in another place.
   */
  private followHold_(grab: Grab): void {
    const { poses, structureVersion } = this.world_;
    if (poses.newestStamp === this.goneAt_) return;  // the holds that are known are from before that
    const hold = this.holdOf_(grab);
    if (hold === undefined || poses.known[hold.body] !== 1) {
      if (grab.isGone) this.gestures.release(grab.pointer);
      return;
    }
    const { body: before, isGone: wasGone } = grab;
    if (grab.isPlaced && !wasGone && hold.body === before && structureVersion === this.followedVersion_) return;
    if (!grab.isPlaced && hold.body === before) {
      toWorld(poses.newest, before, grab.localPoint, this.place_);
      for (let axis = 0; axis < 3; axis++) grab.offset[axis] += hold.point[axis] - this.place_[axis];
    }
    grab.isPlaced = true;
    grab.body = hold.body;
    grab.isGone = false;
    // In the poses that came with it: the drawn ones are older, and a new body has none before its first picture.
    toBody(poses.newest, hold.body, hold.point[0], hold.point[1], hold.point[2], grab.localPoint);
    // A selection that is the body in this hand follows to the body that the hand holds now.
    const wasSelected = !wasGone && before === this.selected_ && this.more_.size === 0;
    if (this.selected_ < 0 || wasSelected) this.select(grab.body);
  }

  /** Draws held bodies and their articulates without delay; otherwise a held body would seem to leave its neighbors. */
  private drawHeldAtOnce_(): void {
    const { poses, entities: { membership } } = this.world_;
    const { goal } = poses.lateness;
    goal.fill(usualLateness);
    for (const grab of this.gestures.grabs) membership.fillAlong(grab.body, goal, 0);
  }
}

function vec3(from: Float32Array): Vec3 {
  return [from[0], from[1], from[2]];
}
