// SPDX-License-Identifier: Apache-2.0
// The last few frames of all bodies, and the interpolation between them. Frames only list moved bodies, so each one is
// applied to a copy of the previous one. Nothing is allocated once it is large enough.

import { forEachPose, type FrameEntity, type PosesBuffer } from "../protocol/generated.ts";
import type { Poses } from "./anchors.ts";

const frameCount = 8;
/** Other bodies are drawn this many frame intervals late, so that there is nearly always a later frame to interpolate
 * to. */
export const usualLateness = 1.5;
/** Times in which bodies change to another delay: a held one quickly, since its user waits for its motion. */
const easeSeconds = { held: 0.02, released: 0.08 } as const;
/** A larger slot is an error, and must not allocate gigabytes. */
export const mostSlots = 1 << 20;

interface Frame {
  /** Smoothed arrival on this page's clock, ms. */
  stamp: number;
  position: Float32Array;
  rotation: Float32Array;
}

/** A longer copy. */
export function grown(array: Float32Array, length: number): Float32Array<ArrayBuffer> {
  const larger = new Float32Array(length);
  larger.set(array);
  return larger;
}

/** a + (b - a) t for quaternions on the shorter arc, normalized; accurate enough between two frames. */
export function mixRotation(
  a: Float32Array, b: Float32Array, at: number, t: number, out: Float32Array, outAt = at,
): void {
  const dot = a[at] * b[at] + a[at + 1] * b[at + 1] + a[at + 2] * b[at + 2] + a[at + 3] * b[at + 3];
  const u = dot < 0 ? -t : t;
  const s = 1 - t;
  const x = s * a[at] + u * b[at];
  const y = s * a[at + 1] + u * b[at + 1];
  const z = s * a[at + 2] + u * b[at + 2];
  const w = s * a[at + 3] + u * b[at + 3];
  const norm = Math.sqrt(x * x + y * y + z * z + w * w) || 1;
  out[outAt] = x / norm;
  out[outAt + 1] = y / norm;
  out[outAt + 2] = z / norm;
  out[outAt + 3] = w / norm;
}

export class PoseBuffer {
  /** Frames of the script, by slot: anchors can be on them, as on bodies. */
  readonly frames = new Map<number, FrameEntity>();
  /** Capacity in slots. */
  capacity = 0;
  /** 1 if a pose has arrived, by slot. */
  known = new Uint8Array(0);
  /** Drawn position, three a slot, m. */
  position = new Float32Array(0);
  /** Drawn rotation, four a slot, x y z w. */
  rotation = new Float32Array(0);
  /** Present delay of a body, in intervals, and its target; by slot. */
  readonly lateness = { now: new Float32Array(0), goal: new Float32Array(0) };
  /** Smoothed gap between frames, ms. */
  intervalMs = 1000 / 60;
  /** Frames in the buffer. */
  count = 0;
  /** Whether bodies are drawn in their latest poses, as for a film. */
  exact = false;
  /** The poses that arrived last, most of which are not drawn yet. */
  readonly newest: Poses;

  private readonly frames_: Frame[] = [];
  private newest_ = 0;
  private arrived_ = 0;
  private sampled_ = 0;
  /** One closure for all frames. */
  private readonly set_ = (body: number, position: Float32Array, rotation: Float32Array): void => {
    if (body >= mostSlots) return;
    this.reserve(body + 1);
    const frame = this.frames_[this.newest_];
    frame.position.set(position, 3 * body);
    frame.rotation.set(rotation, 4 * body);
    if (this.known[body] === 0) this.begin_(body, frame);
  };

  constructor() {
    for (let index = 0; index < frameCount; index++) {
      this.frames_.push({ stamp: 0, position: new Float32Array(0), rotation: new Float32Array(0) });
    }
    const latest = () => this.frames_[this.newest_];
    const known = () => this.known;
    this.newest = {
      frames: this.frames,
      get known() { return known(); },
      get position() { return latest().position; },
      get rotation() { return latest().rotation; },
    };
  }

  /** When the newest poses arrived, smoothed, ms. */
  get newestStamp(): number {
    return this.frames_[this.newest_].stamp;
  }

  /** The stamp of the poses in which a body is drawn, ms. */
  drawnStamp(body: number): number {
    return this.exact ? Infinity : this.sampled_ - this.lateness.now[body] * this.intervalMs;
  }

  /** Drops all frames (a new connection), but keeps the drawn poses until the next frame arrives. */
  clear(): void {
    this.count = 0;
    this.known.fill(0);
  }

  /** Drops one body: the next body in its slot starts at its own first pose. */
  forget(slot: number): void {
    if (slot < this.capacity) this.known[slot] = 0;
  }

  /** Grows to slots up to `slots` - 1. */
  reserve(slots: number): void {
    if (slots <= this.capacity) return;
    this.capacity = Math.max(slots, 2 * this.capacity, 64);
    for (const frame of this.frames_) {
      frame.position = grown(frame.position, 3 * this.capacity);
      frame.rotation = grown(frame.rotation, 4 * this.capacity);
    }
    this.position = grown(this.position, 3 * this.capacity);
    this.rotation = grown(this.rotation, 4 * this.capacity);
    const known = new Uint8Array(this.capacity);
    known.set(this.known);
    this.known = known;
    const from = this.lateness.now.length;
    this.lateness.now = grown(this.lateness.now, this.capacity);
    this.lateness.goal = grown(this.lateness.goal, this.capacity);
    this.lateness.now.fill(usualLateness, from);
    this.lateness.goal.fill(usualLateness, from);
  }

  push(poses: PosesBuffer, now: number): void {
    const previous = this.frames_[this.newest_];
    this.newest_ = (this.newest_ + 1) % frameCount;
    const frame = this.frames_[this.newest_];
    frame.position.set(previous.position);
    frame.rotation.set(previous.rotation);
    frame.stamp = this.stampOf_(previous.stamp, now);
    this.count = Math.min(this.count + 1, frameCount);
    forEachPose(poses, this.set_);
  }

  /** Calculates the drawn poses at `now` (ms); `seconds` since the previous call. */
  sample(now: number, seconds: number): void {
    if (this.count === 0) return;
    this.sampled_ = now;
    const less = 1 - Math.exp(-seconds / easeSeconds.held);
    const more = 1 - Math.exp(-seconds / easeSeconds.released);
    const { now: late, goal } = this.lateness;
    for (let body = 0; body < this.capacity; body++) {
      if (this.known[body] === 0) continue;
      late[body] += (goal[body] - late[body]) * (goal[body] < late[body] ? less : more);
      this.sampleBody_(body, this.drawnStamp(body));
    }
  }

  /** Newest known position of a body, m. */
  newestPosition(body: number, out: Float32Array): void {
    const frame = this.frames_[this.newest_];
    for (let axis = 0; axis < 3; axis++) out[axis] = frame.position[3 * body + axis];
  }

  private sampleBody_(body: number, when: number): void {
    let after = this.newest_;
    let before = after;
    for (let step = 1; step < this.count && this.frames_[before].stamp > when; step++) {
      after = before;
      before = (before + frameCount - 1) % frameCount;
    }
    const a = this.frames_[before];
    const b = this.frames_[after];
    const span = b.stamp - a.stamp;
    const t = span > 0 ? Math.min(Math.max((when - a.stamp) / span, 0), 1) : 1;
    const p = 3 * body;
    this.position[p] = a.position[p] + (b.position[p] - a.position[p]) * t;
    this.position[p + 1] = a.position[p + 1] + (b.position[p + 1] - a.position[p + 1]) * t;
    this.position[p + 2] = a.position[p + 2] + (b.position[p + 2] - a.position[p + 2]) * t;
    mixRotation(a.rotation, b.rotation, 4 * body, t, this.rotation);
  }

  /** Arrival time with reduced jitter: the expected time, corrected towards the true one. */
  private stampOf_(previous: number, now: number): number {
    const gap = now - this.arrived_;
    this.arrived_ = now;
    if (this.count === 0 || gap > 250) return now;
    this.intervalMs += (Math.min(Math.max(gap, 4), 100) - this.intervalMs) * 0.05;
    const expected = previous + this.intervalMs;
    const stamp = expected + (now - expected) * 0.2;
    return Math.max(previous, Math.min(stamp, now + this.intervalMs));
  }

  /** The first pose of a body is used for all earlier frames too. */
  private begin_(body: number, source: Frame): void {
    this.known[body] = 1;
    const p = 3 * body;
    const r = 4 * body;
    for (const frame of this.frames_) {
      if (frame === source) continue;
      frame.position.set(source.position.subarray(p, p + 3), p);
      frame.rotation.set(source.rotation.subarray(r, r + 4), r);
    }
    this.lateness.now[body] = this.lateness.goal[body] = usualLateness;
  }
}
