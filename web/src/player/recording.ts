// SPDX-License-Identifier: Apache-2.0
// What a server once told a page, told again: frames by time, to a socket that has no server.

import { MessageType, messageTypeOf } from "../protocol/generated.ts";

export interface Frame {
  /** From the start of the recording, s. */
  readonly time: number;
  readonly data: ArrayBuffer;
}

const magic = "iota stream 1\n";

/** Throws where the bytes are no recording, or one that was cut off. See python/iota/film/stream.py. */
export function readFrames(bytes: Uint8Array): Frame[] {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (new TextDecoder().decode(bytes.subarray(0, magic.length)) !== magic) throw new Error("this is no recording of Iota");
  const frames: Frame[] = [];
  for (let at = magic.length; at < bytes.length;) {
    if (at + 12 > bytes.length) throw new Error("the recording is cut off");
    const time = view.getFloat64(at, true);
    const end = at + 12 + view.getUint32(at + 8, true);
    if (end > bytes.length) throw new Error("the recording is cut off");
    frames.push({ time, data: bytes.slice(at + 12, end).buffer });
    at = end;
  }
  return frames;
}

/** Tells the frames as time goes by, from the start again after the last. */
export class Playback {
  playing = true;
  /** s */
  position = 0;
  readonly duration: number;

  private readonly frames_: readonly Frame[];
  private readonly tell_: (data: ArrayBuffer) => void;
  private next_ = 0;

  constructor(frames: readonly Frame[], tell: (data: ArrayBuffer) => void) {
    this.frames_ = frames;
    this.tell_ = tell;
    this.duration = frames.at(-1)?.time ?? 0;
  }

  /** Some time has passed, s. */
  pass(seconds: number): void {
    if (!this.playing) return;
    if (this.position >= this.duration) return this.seek(0);
    this.position = Math.min(this.position + seconds, this.duration);
    while (this.next_ < this.frames_.length && this.frames_[this.next_].time <= this.position) {
      this.tell_(this.frames_[this.next_++].data);
    }
  }

  /** Goes to a time: tells all that holds then, but not what happened on the way. */
  seek(position: number): void {
    this.position = Math.min(Math.max(position, 0), this.duration);
    const past = this.frames_.findIndex((frame) => frame.time > this.position);
    this.next_ = past < 0 ? this.frames_.length : past;
    const told = this.frames_.slice(0, this.next_);
    const isPoses = ({ data }: Frame) => messageTypeOf(data) === MessageType.poses;
    const [first, last] = [told.findIndex(isPoses), told.findLastIndex(isPoses)];
    told.forEach((frame, index) => {
      const type = messageTypeOf(frame.data);
      if (type === MessageType.effect || type === MessageType.notice) return;
      // The first poses complete the picture of what is there.
      if (type !== MessageType.poses || index === first || index === last) this.tell_(frame.data);
    });
  }

  /** The newest poses once more: the page hears that the line is alive. */
  repeat(): void {
    const last = this.frames_.slice(0, this.next_).findLast(({ data }) => messageTypeOf(data) === MessageType.poses);
    if (last !== undefined) this.tell_(last.data);
  }
}
