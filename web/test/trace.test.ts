// SPDX-License-Identifier: Apache-2.0
import type { InstancedBufferGeometry } from "three";
import { describe, expect, it } from "vitest";
import { NO_COLOR, type TraceEntity } from "../src/protocol/generated.ts";
import { TraceView } from "../src/scene/entities/trace.ts";
import { PoseBuffer } from "../src/scene/pose_buffer.ts";
import { body, frame, id, span } from "./test_world.ts";

const [middle, radius] = [5, 2];
const framesMs = 1000 / 60;

/** A body that goes round in a second, whose page draws only each `every`-th of the poses that it gets. */
class Round {
  readonly poses = new PoseBuffer();
  readonly view = new TraceView(this.poses);
  step = 0;

  constructor(extra: Partial<TraceEntity> = {}) {
    this.view.create({ id: id(0), at: { body: 0, point: [0, 0, 0] }, seconds: 0, capacity: 500, radius: 0.01, color: NO_COLOR, ...extra });
  }

  /** Goes on without poses: the connection is slow. */
  lose(frames: number): void {
    this.step += frames;
  }

  go(frames: number, every: number): void {
    for (let count = 0; count < frames; count++, this.step++) {
      const turn = (2 * Math.PI * this.step) / 60;
      const place = { ...body(0, middle + radius * Math.cos(turn)), y: Math.round(((middle + radius * Math.sin(turn)) / span) * 65535) };
      this.poses.push(frame(this.step, [place]), 1000 + this.step * framesMs);
      this.view.takePoses(this.step / 60);
      if (this.step % every !== 0) continue;
      this.poses.sample(1000 + this.step * framesMs, (every * framesMs) / 1000);
      this.view.draw();
    }
  }

  /** Ends of the drawn lines, x and y. */
  lines(): { from: number[]; to: number[] }[] {
    const geometry = this.view.root.geometry as InstancedBufferGeometry;
    const [from, to] = ["from", "to"].map((name) => geometry.getAttribute(name));
    return Array.from({ length: geometry.instanceCount }, (_, line) => ({ from: [from.getX(line), from.getY(line)], to: [to.getX(line), to.getY(line)] }));
  }
}

describe("a trace", () => {
  it("follows a round path on a page that draws four pictures a second", () => {
    const round = new Round();
    round.go(61, 15);
    const lines = round.lines();
    expect(lines.length).toBeGreaterThan(50);
    for (const { from, to } of lines) {
      const half = [0, 1].map((axis) => (from[axis] + to[axis]) / 2 - middle);
      expect(Math.abs(Math.hypot(...half) / radius - 1)).toBeLessThan(2e-3);
    }
  });

  it("stays round where the poses of a sixth of a turn were lost", () => {
    const round = new Round();
    round.go(20, 1);
    round.lose(9);
    round.go(20, 1);
    const off = round.lines().map(({ from, to }) => Math.hypot(...[0, 1].map((axis) => (from[axis] + to[axis]) / 2 - middle)) / radius - 1);
    expect(Math.max(...off.map(Math.abs))).toBeLessThan(1e-2);
  });

  it("ends at its body as drawn, which is later than the newest poses", () => {
    const round = new Round();
    round.go(40, 4);
    const { to } = round.lines().at(-1)!;
    const { position } = round.poses;
    expect(Math.hypot(to[0] - position[0], to[1] - position[1])).toBeLessThan(1e-5);
    const { position: newest } = round.poses.newest;
    expect(Math.hypot(to[0] - newest[0], to[1] - newest[1])).toBeGreaterThan(0.1);
  });

  it("is as long as it may be, and begins anew when the world goes back in time", () => {
    const round = new Round({ seconds: 0.25 });
    round.go(61, 5);
    const turned = round.lines().reduce((sum, { from, to }) => sum + Math.hypot(to[0] - from[0], to[1] - from[1]), 0) / radius;
    expect(turned).toBeGreaterThan(0.9 * (Math.PI / 2) - 0.2);
    expect(turned).toBeLessThan(Math.PI / 2 + 0.01);
    round.step = 0;
    round.go(1, 1);
    expect(round.lines().length).toBeLessThan(2);
  });
});
