// SPDX-License-Identifier: Apache-2.0
// Replays a server's messages: frames by time, to a socket without a server.

import { decodePosesInto, MessageType, messageTypeOf, PosesBuffer } from "../protocol/generated.ts";

export interface Frame {
  /** From the start of the recording, s. */
  readonly time: number;
  readonly data: ArrayBuffer;
}

const isPoses = ({ data }: Frame): boolean => messageTypeOf(data) === MessageType.poses;

const magic = "iota stream 1\n";

/** Throws unless the bytes are a complete recording. See python/iota/world/recording.py. */
export function readFrames(bytes: Uint8Array): Frame[] {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (new TextDecoder().decode(bytes.subarray(0, magic.length)) !== magic) throw new Error("this is not a recording of Iota");
  const frames: Frame[] = [];
  for (let at = magic.length; at < bytes.length;) {
    if (at + 12 > bytes.length) throw new Error("the recording is truncated");
    const time = view.getFloat64(at, true);
    const end = at + 12 + view.getUint32(at + 8, true);
    if (end > bytes.length) throw new Error("the recording is truncated");
    frames.push({ time, data: bytes.slice(at + 12, end).buffer });
    at = end;
  }
  return frames;
}

/** Sends the frames in time, and starts again after the last one. */
export class Playback {
  playing = true;
  /** s */
  position = 0;
  readonly duration: number;

  private readonly frames_: readonly Frame[];
  private readonly tell_: (data: ArrayBuffer) => void;
  private readonly poses_ = new PosesBuffer();
  private next_ = 0;

  constructor(frames: readonly Frame[], tell: (data: ArrayBuffer) => void) {
    this.frames_ = frames;
    this.tell_ = tell;
    this.duration = frames.at(-1)?.time ?? 0;
  }

  /** Advances the time, s. */
  pass(seconds: number): void {
    if (!this.playing) return;
    if (this.position >= this.duration) return this.seek(0);
    this.position = Math.min(this.position + seconds, this.duration);
    while (this.next_ < this.frames_.length && this.frames_[this.next_].time <= this.position) {
      this.tell_(this.frames_[this.next_++].data);
    }
  }

  /** Goes to a time: sends the state at that time, but not the events before it. */
  seek(position: number): void {
    this.position = Math.min(Math.max(position, 0), this.duration);
    const past = this.frames_.findIndex((frame) => frame.time > this.position);
    this.next_ = past < 0 ? this.frames_.length : past;
    const told = this.frames_.slice(0, this.next_);
    const [first, last] = [told.findIndex(isPoses), told.findLastIndex((frame) => isPoses(frame) && this.isKeyframe_(frame))];
    told.forEach((frame, index) => {
      const type = messageTypeOf(frame.data);
      if (type === MessageType.effect || type === MessageType.notice) return;
      // The first poses complete the state. A keyframe lists all bodies, the poses after it those that moved since.
      if (!isPoses(frame) || index === first || index >= last) this.tell_(frame.data);
    });
  }

  /** Sends the newest poses again, so that the page does not time out. */
  repeat(): void {
    const last = this.frames_.slice(0, this.next_).findLast(isPoses);
    if (last !== undefined) this.tell_(last.data);
  }

  private isKeyframe_({ data }: Frame): boolean {
    decodePosesInto(data, this.poses_);
    return this.poses_.keyframe;
  }
}
