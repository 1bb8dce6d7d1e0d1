// SPDX-License-Identifier: Apache-2.0
// Traces: the past paths of points, recorded by this page from all poses that arrive, however rarely it draws. A trace is
// sent only once.

import { Vector3 } from "three";
import { NO_BODY, type TraceEntity } from "../../protocol/generated.ts";
import { bodyOf, placeOf } from "../anchors.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import { Strokes } from "../strokes.ts";
import type { EntityView } from "./entity.ts";

/** A point that has moved less is not added, m. */
const still = 1e-6;
/** Numbers of a point: place (m), simulated time (s), stamp of its poses (ms). */
const stride = 5;

interface Trace {
  entity: TraceEntity;
  /** A ring of points. */
  points: Float64Array;
  first: number;
  count: number;
  /** The first points are drawn; the others are later than their body is drawn, whose place is the trace's end. */
  shown: number;
  end: Vector3;
}

/** Number of pieces for a bulge as high as long, and the maximum: a bulge of 0.2 % is drawn straight. */
const straightEnough = 500;
const mostPieces = 8;

/** Index of the numbers of a point, counted from the oldest. */
function at({ first, entity: { capacity } }: Trace, index: number): number {
  return stride * ((first + index) % capacity);
}

/**
 * Along an axis, m/s: at the second of three points of a path, of the parabola through them. They may be far apart in time on one side,
 * where poses were lost. At an end of the path, where it is twice the same point, the mean between the others.
 */
function velocityAt(points: Float64Array, before: number, now: number, after: number, axis: number): number {
  const past = points[now + 3] - points[before + 3];
  const coming = points[after + 3] - points[now + 3];
  const came = points[now + axis] - points[before + axis];
  const goes = points[after + axis] - points[now + axis];
  if (past === 0 || coming === 0) return (came + goes) / Math.max(past + coming, 1e-12);
  return ((came / past) * coming + (goes / coming) * past) / (past + coming);
}

export class TraceView implements EntityView<TraceEntity> {
  private readonly strokes_ = new Strokes();
  private readonly poses_: PoseBuffer;
  private readonly traces_ = new Map<number, Trace>();
  private readonly place_ = new Vector3();
  private readonly next_ = new Vector3();
  /** For the drawn piece: its duration times the velocity of its first and of its second end, m. */
  private readonly slopes_ = new Float64Array(6);
  private lastTime_ = 0;
  private changed_ = false;

  constructor(poses: PoseBuffer) {
    this.poses_ = poses;
  }

  get root() {
    return this.strokes_.mesh;
  }

  create(entity: TraceEntity): void {
    const points = new Float64Array(stride * entity.capacity);
    this.traces_.set(entity.id.slot, { entity, points, first: 0, count: 0, shown: 0, end: new Vector3() });
    this.changed_ = true;
  }

  /** Keeps its points: an edit may only have moved its point to another body. */
  change(entity: TraceEntity): void {
    const trace = this.traces_.get(entity.id.slot);
    if (trace === undefined || trace.entity.capacity !== entity.capacity) return this.create(entity);
    trace.entity = entity;
    this.changed_ = true;
  }

  destroy(slot: number): void {
    this.traces_.delete(slot);
    this.changed_ = true;
  }

  /** Adds the newest poses. `time`: simulated, s. */
  takePoses(time: number): void {
    for (const trace of this.traces_.values()) {
      // Back in time: reset or undo.
      if (time < this.lastTime_) trace.count = 0;
      this.extend_(trace, time);
    }
    this.lastTime_ = time;
  }

  draw(): void {
    for (const trace of this.traces_.values()) this.update_(trace);
    if (!this.changed_) return;
    this.changed_ = false;
    this.strokes_.clear();
    for (const trace of this.traces_.values()) this.write_(trace);
    this.strokes_.upload();
  }

  private extend_(trace: Trace, time: number): void {
    const { points, entity: { at: anchor, capacity, seconds } } = trace;
    const { place_: place } = this;
    while (seconds > 0 && trace.count > 0 && points[at(trace, 0) + 3] < time - seconds) {
      trace.first = (trace.first + 1) % capacity;
      trace.count--;
      this.changed_ = true;
    }
    if (!placeOf(this.poses_.newest, anchor, place)) return;
    if (trace.count > 0) {
      const last = at(trace, trace.count - 1);
      if (Math.hypot(place.x - points[last], place.y - points[last + 1], place.z - points[last + 2]) < still) return;
    }
    if (trace.count === capacity) trace.first = (trace.first + 1) % capacity;
    else trace.count++;
    const added = at(trace, trace.count - 1);
    place.toArray(points, added);
    points[added + 3] = time;
    points[added + 4] = this.poses_.newestStamp;
  }

  /** Finds how much of a trace is drawn, and where it ends. */
  private update_(trace: Trace): void {
    const { points, entity: { at: anchor } } = trace;
    const { place_: end } = this;
    const body = bodyOf(this.poses_, anchor);
    const when = body === NO_BODY ? Infinity : this.poses_.drawnStamp(body);
    let shown = trace.count;
    while (shown > 0 && points[at(trace, shown - 1) + 4] > when) shown--;
    if (!placeOf(this.poses_, anchor, end)) shown = 0;
    if (shown === trace.shown && end.distanceTo(trace.end) < still) return;
    trace.shown = shown;
    trace.end.copy(end);
    this.changed_ = true;
  }

  private write_(trace: Trace): void {
    const { points, shown, end, entity: { radius, color } } = trace;
    const { place_: from, next_: to } = this;
    for (let index = 1; index < shown; index++) {
      const a = at(trace, index - 1);
      const b = at(trace, index);
      from.fromArray(points, a);
      const pieces = this.fitCurve_(trace, index, from);
      for (let piece = 1; piece <= pieces; piece++) {
        this.onCurve_(points, a, b, piece / pieces, to);
        this.strokes_.add(from.x, from.y, from.z, to.x, to.y, to.z, radius, radius, color);
        from.copy(to);
      }
    }
    if (shown === 0) return;
    from.fromArray(points, at(trace, shown - 1));
    this.strokes_.add(from.x, from.y, from.z, end.x, end.y, end.z, radius, radius, color);
  }

  /**
   * Calculates the velocities at both ends of a piece from the points around them, and returns the number of straight
   * lines for the curve between: a page with a slow connection, or a fast world, has few points of a path.
   */
  private fitCurve_(trace: Trace, index: number, start: Vector3): number {
    const { points, count } = trace;
    const a = at(trace, index - 1);
    const b = at(trace, index);
    const before = at(trace, Math.max(index - 2, 0));
    const after = at(trace, Math.min(index + 1, count - 1));
    const seconds = points[b + 3] - points[a + 3];
    for (let axis = 0; axis < 3; axis++) {
      this.slopes_[axis] = seconds * velocityAt(points, before, a, b, axis);
      this.slopes_[3 + axis] = seconds * velocityAt(points, a, b, after, axis);
    }
    const length = Math.hypot(points[b] - start.x, points[b + 1] - start.y, points[b + 2] - start.z);
    this.onCurve_(points, a, b, 0.5, this.next_);
    const bulge = Math.hypot(
      this.next_.x - (start.x + points[b]) / 2, this.next_.y - (start.y + points[b + 1]) / 2, this.next_.z - (start.z + points[b + 2]) / 2,
    );
    return Math.min(Math.ceil(Math.sqrt((straightEnough * bulge) / Math.max(length, 1e-12))) || 1, mostPieces);
  }

  /** A place between two points, 0 .. 1: a cubic with the velocities at its ends. */
  private onCurve_(points: Float64Array, a: number, b: number, t: number, out: Vector3): void {
    const [start, end] = [t * (1 - t) ** 2, t * t * (t - 1)];
    const share = t * t * (3 - 2 * t);
    for (let axis = 0; axis < 3; axis++) {
      const value = points[a + axis] + share * (points[b + axis] - points[a + axis]) + start * this.slopes_[axis] + end * this.slopes_[3 + axis];
      out.setComponent(axis, value);
    }
  }
}
