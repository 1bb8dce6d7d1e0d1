// SPDX-License-Identifier: Apache-2.0
// Traces: the paths of points, as this page has drawn them. Nothing is sent for them but once.

import { Vector3 } from "three";
import type { TraceEntity } from "../../protocol/generated.ts";
import { placeOf } from "../anchors.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import { Strokes } from "../strokes.ts";
import type { EntityView } from "./entity.ts";

/** A point that has moved less is not drawn anew, m. */
const still = 1e-6;

interface Trace {
  entity: TraceEntity;
  /** Four numbers each: place (m) and simulated time (s); a ring. */
  points: Float64Array;
  first: number;
  count: number;
}

export class TraceView implements EntityView<TraceEntity> {
  private readonly strokes_ = new Strokes();
  private readonly poses_: PoseBuffer;
  private readonly time_: () => number;
  private readonly traces_ = new Map<number, Trace>();
  private readonly place_ = new Vector3();
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

  /** What it has drawn stays: an edit may only have given its point to another body. */
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

  private write_({ points, first, count, entity: { capacity, radius, color } }: Trace): void {
    for (let index = 1; index < count; index++) {
      const a = 4 * ((first + index - 1) % capacity);
      const b = 4 * ((first + index) % capacity);
      this.strokes_.add(points[a], points[a + 1], points[a + 2], points[b], points[b + 1], points[b + 2], radius, radius, color);
    }
  }
}
