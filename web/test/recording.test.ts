// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { Playback, readFrames, type Frame } from "../src/player/recording.ts";
import { encodePoses, MessageType } from "../src/protocol/generated.ts";

/** A frame of a type, with a number that tells it from others. */
function frame(time: number, type: number, number: number): Frame {
  return { time, data: Uint8Array.of(type, number).buffer };
}

/** Poses whose step is that number. */
function poses(time: number, step: number, keyframe: boolean): Frame {
  const empty = { bodies: [], farBodies: [], sparks: [], holds: [] };
  const data = encodePoses({
    type: "poses", step, time, structureVersion: 1, keyframe, kinetic: 0, potential: 0, gap: 0, boxMin: [0, 0, 0], boxMax: [1, 1, 1], ...empty,
  });
  return { time, data };
}

const frames = [
  frame(0, MessageType.welcome, 1), poses(0, 2, true), poses(1, 3, false), frame(1, MessageType.effect, 4),
  frame(2, MessageType.entitiesSet, 5), poses(2, 6, true), poses(2.2, 7, false), poses(2.4, 8, false), poses(3, 9, false),
];

function play(): { playback: Playback; told: number[] } {
  const told: number[] = [];
  return { told, playback: new Playback(frames, (data) => void told.push(new Uint8Array(data)[1])) };
}

describe("a recording", () => {
  it("reads a written recording, and refuses truncated and other bytes", () => {
    const bytes = new Uint8Array(14 + 2 * 12 + 3);
    bytes.set(new TextEncoder().encode("iota stream 1\n"));
    const view = new DataView(bytes.buffer);
    view.setFloat64(14, 0.5, true);
    view.setUint32(22, 2, true);
    bytes.set([7, 8], 26);
    view.setFloat64(28, 1.5, true);
    view.setUint32(36, 1, true);
    bytes[40] = 9;
    const read = readFrames(bytes);
    expect(read.map(({ time, data }) => [time, ...new Uint8Array(data)])).toEqual([[0.5, 7, 8], [1.5, 9]]);
    for (const length of [20, 25, 27, 39]) expect(() => readFrames(bytes.subarray(0, length))).toThrow("truncated");
    expect(() => readFrames(new TextEncoder().encode("something else"))).toThrow("not a recording");
  });

  it("is told as time goes by, and from the start again after its end", () => {
    const { playback, told } = play();
    playback.seek(0);
    expect(told.splice(0)).toEqual([1, 2]);
    playback.pass(0.9);
    expect(told.splice(0)).toEqual([]);
    playback.pass(0.2);
    expect(told.splice(0)).toEqual([3, 4]);
    playback.playing = false;
    playback.pass(5);
    expect(told.splice(0)).toEqual([]);
    playback.playing = true;
    playback.pass(5);
    expect(told.splice(0)).toEqual([5, 6, 7, 8, 9]);
    playback.pass(0.1);
    expect(told.splice(0)).toEqual([1, 2]);
    expect(playback.position).toBe(0);
  });

  it("goes to any time by what holds then, without what happened on the way", () => {
    const { playback, told } = play();
    playback.seek(2.5);
    expect(told.splice(0), "the last keyframe, and what moved since").toEqual([1, 2, 5, 6, 7, 8]);
    playback.repeat();
    expect(told.splice(0)).toEqual([8]);
    playback.seek(0.5);
    expect(told.splice(0)).toEqual([1, 2]);
    playback.pass(0.6);
    expect(told).toEqual([3, 4]);
  });
});
