// SPDX-License-Identifier: Apache-2.0
// Short synthesized sounds: a crack for a break, a soft click for a join. Silent until the first gesture of the user,
// as browsers require.

type Kind = "break" | "join" | "grab";

export class Sound {
  muted = false;
  private context_: AudioContext | null = null;
  private noise_: AudioBuffer | null = null;

  /** Call it in a gesture of the user. */
  wake(): void {
    if (this.context_ === null && typeof AudioContext !== "undefined") this.context_ = new AudioContext();
    if (this.context_?.state === "suspended") void this.context_.resume();
  }

  effect(kind: string): void {
    const context = this.context_;
    if (this.muted || context === null || context.state !== "running") return;
    switch (kind as Kind) {
      case "break":
        this.burst_(context, 0.09, 2600, 0.22);
        this.ring_(context, 1320, 0.35, 0.05);
        this.ring_(context, 2093, 0.22, 0.03);
        break;
      case "join":
        this.ring_(context, 520, 0.07, 0.09);
        this.ring_(context, 784, 0.1, 0.05);
        break;
      case "grab":
        this.ring_(context, 330, 0.05, 0.03);
        break;
    }
  }

  private ring_(context: AudioContext, hertz: number, seconds: number, level: number): void {
    const tone = context.createOscillator();
    tone.frequency.value = hertz;
    tone.connect(this.fade_(context, seconds, level));
    tone.start();
    tone.stop(context.currentTime + seconds);
  }

  private burst_(context: AudioContext, seconds: number, hertz: number, level: number): void {
    this.noise_ ??= makeNoise(context);
    const source = context.createBufferSource();
    source.buffer = this.noise_;
    const filter = context.createBiquadFilter();
    filter.type = "bandpass";
    filter.frequency.value = hertz;
    source.connect(filter).connect(this.fade_(context, seconds, level));
    source.start();
    source.stop(context.currentTime + seconds);
  }

  private fade_(context: AudioContext, seconds: number, level: number): GainNode {
    const gain = context.createGain();
    gain.gain.setValueAtTime(level, context.currentTime);
    gain.gain.exponentialRampToValueAtTime(1e-4, context.currentTime + seconds);
    gain.connect(context.destination);
    return gain;
  }
}

function makeNoise(context: AudioContext): AudioBuffer {
  const buffer = context.createBuffer(1, Math.round(context.sampleRate * 0.2), context.sampleRate);
  const samples = buffer.getChannelData(0);
  for (let index = 0; index < samples.length; index++) samples[index] = Math.random() * 2 - 1;
  return buffer;
}
