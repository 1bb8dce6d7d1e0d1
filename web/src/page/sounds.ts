// SPDX-License-Identifier: Apache-2.0
// Sounds at their places: short synthesized ones (a crack for a break, a soft click for a join, a thud for an impact), and the
// script's own, decoded by the browser.

import { Quaternion, Vector3 } from "three";
import type { SoundEntity, Vec3 } from "../protocol/generated.ts";
import type { WatchedRecords } from "../scene/entities/widget.ts";
import type { Events } from "./events.ts";
import type { Viewer } from "./viewer.ts";

/** An effect of a kind that begins with this plays the script's sound of the name behind it. */
const mark = "#";
/** At once; further ones are silent. */
const mostVoices = 24;
/** A small file can last for hours: then it is not decoded. */
const longestSeconds = 60;

export class Sounds {
  private readonly context_: AudioContext;
  private readonly viewer_: Pick<Viewer, "camera" | "size">;
  private readonly records_: WatchedRecords<SoundEntity>;
  private readonly events_: Events;
  private readonly noise_: AudioBuffer;
  /** The sounds of the script, by name; null: the sound cannot be played. */
  private readonly buffers_ = new Map<string, Promise<AudioBuffer | null>>();
  private seen_ = 0;
  private voices_ = 0;
  private readonly place_ = new Vector3();
  private readonly turn_ = new Quaternion();

  constructor(context: AudioContext, viewer: Pick<Viewer, "camera" | "size">, records: WatchedRecords<SoundEntity>, events: Events) {
    this.context_ = context;
    this.viewer_ = viewer;
    this.records_ = records;
    this.events_ = events;
    this.noise_ = makeNoise(context);
  }

  play(kind: string, position: Readonly<Vec3> | undefined, volume: number): void {
    const context = this.context_;
    if (context.state !== "running" || volume === 0 || this.voices_ >= mostVoices) return;
    this.hear_();
    if (kind.startsWith(mark)) return void this.playFile_(kind.slice(mark.length), position, volume);
    const out = this.voice_(volume, position);
    switch (kind) {
      case "break":
        this.burst_(out, 0.09, 2600, 0.22);
        this.ring_(out, 1320, 0.35, 0.05);
        this.ring_(out, 2093, 0.22, 0.03);
        break;
      case "join":
        this.ring_(out, 520, 0.07, 0.09);
        this.ring_(out, 784, 0.1, 0.05);
        break;
      case "grab":
        this.ring_(out, 330, 0.05, 0.03);
        break;
      case "impact":
        this.burst_(out, 0.12, 260, 0.5);
        this.ring_(out, 110, 0.16, 0.12);
        break;
    }
  }

  /** Once a frame: decodes the script's sounds before they are played; a user who moves hears long ones from where they are. */
  draw(): void {
    if (this.voices_ > 0) this.hear_();
    this.decodeNew_();
  }

  // --- inside

  /** A page that has nothing new to draw does not draw: then the first sound is decoded when it is played. */
  private decodeNew_(): void {
    if (this.records_.version === this.seen_) return;
    this.seen_ = this.records_.version;
    const records = this.records_.all();
    const names = new Set(records.map(({ name }) => name));
    for (const name of this.buffers_.keys()) if (!names.has(name)) this.buffers_.delete(name);
    for (const { name, file } of records) {
      if (this.buffers_.has(name)) continue;
      this.buffers_.set(name, decode(this.context_, file).catch((error: unknown) => {
        const text = error instanceof RangeError ? error.message : "The browser cannot decode its file.";
        this.events_.notice({ level: 1, title: "A sound cannot be played", text, hint: "", key: `sound ${name}` });
        return null;
      }));
    }
  }

  private async playFile_(name: string, position: Readonly<Vec3> | undefined, volume: number): Promise<void> {
    this.decodeNew_();
    const buffer = await this.buffers_.get(name);
    if (buffer === undefined || buffer === null) return;
    const reach = this.records_.all().find((record) => record.name === name)?.reach ?? 0;
    const source = this.context_.createBufferSource();
    source.buffer = buffer;
    source.connect(this.voice_(volume, position, reach));
    this.begin_(source);
  }

  /** The ears are where the camera is. */
  private hear_(): void {
    const { listener } = this.context_;
    const { camera } = this.viewer_;
    const { place_: place, turn_: turn } = this;
    camera.getWorldPosition(place);
    camera.getWorldQuaternion(turn);
    [listener.positionX.value, listener.positionY.value, listener.positionZ.value] = place.toArray();
    [listener.forwardX.value, listener.forwardY.value, listener.forwardZ.value] = place.set(0, 0, -1).applyQuaternion(turn).toArray();
    [listener.upX.value, listener.upY.value, listener.upZ.value] = place.set(0, 1, 0).applyQuaternion(turn).toArray();
  }

  /** The node that a sound is connected to. Beyond `reach` m (0: the size of the scene) it is fainter. */
  private voice_(volume: number, position?: Readonly<Vec3>, reach = 0): GainNode {
    const context = this.context_;
    const gain = context.createGain();
    gain.gain.value = volume;
    if (position === undefined) {
      gain.connect(context.destination);
      return gain;
    }
    const [positionX, positionY, positionZ] = position;
    const refDistance = reach > 0 ? reach : this.viewer_.size;
    gain.connect(new PannerNode(context, { positionX, positionY, positionZ, refDistance })).connect(context.destination);
    return gain;
  }

  private ring_(out: AudioNode, hertz: number, seconds: number, level: number): void {
    const tone = this.context_.createOscillator();
    tone.frequency.value = hertz;
    tone.connect(this.fade_(out, seconds, level));
    this.begin_(tone);
    tone.stop(this.context_.currentTime + seconds);
  }

  private burst_(out: AudioNode, seconds: number, hertz: number, level: number): void {
    const source = this.context_.createBufferSource();
    source.buffer = this.noise_;
    const filter = this.context_.createBiquadFilter();
    filter.type = "bandpass";
    filter.frequency.value = hertz;
    source.connect(filter).connect(this.fade_(out, seconds, level));
    this.begin_(source);
    source.stop(this.context_.currentTime + seconds);
  }

  private begin_(source: AudioScheduledSourceNode): void {
    this.voices_++;
    source.onended = () => this.voices_--;
    source.start();
  }

  private fade_(out: AudioNode, seconds: number, level: number): GainNode {
    const { currentTime } = this.context_;
    const gain = this.context_.createGain();
    gain.gain.setValueAtTime(level, currentTime);
    gain.gain.exponentialRampToValueAtTime(1e-4, currentTime + seconds);
    gain.connect(out);
    return gain;
  }
}

function makeNoise(context: AudioContext): AudioBuffer {
  const buffer = context.createBuffer(1, Math.round(context.sampleRate * 0.2), context.sampleRate);
  const samples = buffer.getChannelData(0);
  for (let index = 0; index < samples.length; index++) samples[index] = Math.random() * 2 - 1;
  return buffer;
}

async function decode(context: AudioContext, file: Uint8Array): Promise<AudioBuffer> {
  const bytes = Uint8Array.from(file);
  const seconds = await lengthOf(bytes);
  if (!(seconds <= longestSeconds)) throw new RangeError(`It lasts ${seconds} s, more than ${longestSeconds}.`);
  return context.decodeAudioData(bytes.buffer);
}

/** The length of a sound file, by its header, s. Rejects a file that is not a sound. */
async function lengthOf(bytes: Uint8Array<ArrayBuffer>): Promise<number> {
  const address = URL.createObjectURL(new Blob([bytes]));
  try {
    return await new Promise((resolve, reject) => {
      const audio = new Audio();
      audio.preload = "metadata";
      audio.onloadedmetadata = () => resolve(Math.round(audio.duration * 10) / 10);
      audio.onerror = reject;
      audio.src = address;
    });
  } finally {
    URL.revokeObjectURL(address);
  }
}
