// SPDX-License-Identifier: Apache-2.0
// Traces: the past paths of points, recorded by this page. A trace is sent only once.

import { Vector3 } from "three";
import type { TraceEntity } from "../../protocol/generated.ts";
import { placeOf } from "../anchors.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import { Strokes } from "../strokes.ts";
import type { EntityView } from "./entity.ts";

/** A point that has moved less is not added, m. */
const still = 1e-6;

interface Trace {
  entity: TraceEntity;
  /** Four numbers each: place (m) and simulated time (s); a ring. */
  points: Float64Array;
  first: number;
  count: number;
}

/** Number of pieces for a bulge as high as long, and the maximum: a bulge of 0.2 % is drawn straight. */
const straightEnough = 500;
const mostPieces = 8;

/** Index of the numbers of a point, counted from the oldest. */
function at({ first, entity: { capacity } }: Trace, index: number): number {
  return 4 * ((first + index) % capacity);
}

export class TraceView implements EntityView<TraceEntity> {
  private readonly strokes_ = new Strokes();
  private readonly poses_: PoseBuffer;
  private readonly time_: () => number;
  private readonly traces_ = new Map<number, Trace>();
  private readonly place_ = new Vector3();
  private readonly next_ = new Vector3();
  /** For the drawn piece: its duration times the velocity of its first and of its second end, m. */
  private readonly slopes_ = new Float64Array(6);
  private lastTime_ = 0;
  private changed_ = false;

  /** `time`: simulated, s. */
  constructor(poses: PoseBuffer, time: () => number) {
    this.poses_ = poses;
    this.time_ = time;
  }

  get root() {
    return this.strokes_.mesh;
  }

  /** Number of points of a trace. */
  countOf(slot: number): number {
    return this.traces_.get(slot)?.count ?? 0;
  }

  create(entity: TraceEntity): void {
    this.traces_.set(entity.id.slot, { entity, points: new Float64Array(4 * entity.capacity), first: 0, count: 0 });
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

  draw(): void {
    const time = this.time_();
    for (const trace of this.traces_.values()) {
      // Back in time: reset or undo.
      if (time < this.lastTime_ && trace.count > 0) {
        trace.count = 0;
        this.changed_ = true;
      }
      this.extend_(trace, time);
    }
    this.lastTime_ = time;
    if (!this.changed_) return;
    this.changed_ = false;
    this.strokes_.clear();
    for (const trace of this.traces_.values()) this.write_(trace);
    this.strokes_.upload();
  }

  private extend_(trace: Trace, time: number): void {
    const { points, entity: { at, capacity, seconds } } = trace;
    const { place_: place } = this;
    while (seconds > 0 && trace.count > 0 && points[4 * trace.first + 3] < time - seconds) {
      trace.first = (trace.first + 1) % capacity;
      trace.count--;
      this.changed_ = true;
    }
    if (!placeOf(this.poses_, at, place)) return;
    const last = 4 * ((trace.first + trace.count - 1 + capacity) % capacity);
    const moved = Math.hypot(place.x - points[last], place.y - points[last + 1], place.z - points[last + 2]);
    if (trace.count > 0 && moved < still) return;
    const next = 4 * ((trace.first + trace.count) % capacity);
    place.toArray(points, next);
    points[next + 3] = time;
    if (trace.count < capacity) trace.count++;
    else trace.first = (trace.first + 1) % capacity;
    this.changed_ = true;
  }

  private write_(trace: Trace): void {
    const { points, count, entity: { radius, color } } = trace;
    const { place_: from, next_: to } = this;
    for (let index = 1; index < count; index++) {
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
  }

  /**
   * Calculates the velocities at both ends of a piece from the points around them, and returns the number of straight
   * lines for the curve between: a page that draws slowly has few points of a path.
   */
  private fitCurve_(trace: Trace, index: number, start: Vector3): number {
    const { points, count } = trace;
    const a = at(trace, index - 1);
    const b = at(trace, index);
    const before = at(trace, Math.max(index - 2, 0));
    const after = at(trace, Math.min(index + 1, count - 1));
    const seconds = points[b + 3] - points[a + 3];
    for (let axis = 0; axis < 3; axis++) {
      this.slopes_[axis] = (seconds * (points[b + axis] - points[before + axis])) / Math.max(points[b + 3] - points[before + 3], 1e-12);
      this.slopes_[3 + axis] = (seconds * (points[after + axis] - points[a + axis])) / Math.max(points[after + 3] - points[a + 3], 1e-12);
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
