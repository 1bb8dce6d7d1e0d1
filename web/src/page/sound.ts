// SPDX-License-Identifier: Apache-2.0
// Sound of the page: silent until the first gesture of the user, as browsers require; what makes it is fetched then.

import type { Grab } from "../interact/gestures.ts";
import type { SoundEntity, Vec3 } from "../protocol/generated.ts";
import type { WatchedRecords } from "../scene/entities/widget.ts";
import type { Events, PageListener } from "./events.ts";
import type { Sounds } from "./sounds.ts";
import type { FramePart, Viewer } from "./viewer.ts";

/** A sound that was waited for longer comes too late to be played. */
const latestMs = 1000;

export class Sound implements PageListener, FramePart {
  muted = false;
  private readonly viewer_: Pick<Viewer, "camera" | "size">;
  private readonly records_: WatchedRecords<SoundEntity>;
  private readonly events_: Events;
  private context_: AudioContext | null = null;
  /** When the browser lets them be heard. */
  private ready_: Promise<Sounds> | null = null;
  private sounds_: Sounds | null = null;

  constructor(viewer: Pick<Viewer, "camera" | "size">, records: WatchedRecords<SoundEntity>, events: Events) {
    this.viewer_ = viewer;
    this.records_ = records;
    this.events_ = events;
    // Before the keys of the script, which go no further.
    for (const gesture of ["pointerdown", "keydown"]) window.addEventListener(gesture, () => this.wake(), true);
  }

  /** Call it in a gesture that is neither a press nor a key. */
  wake(): void {
    if (this.context_ === null && typeof AudioContext !== "undefined") {
      const context = (this.context_ = new AudioContext());
      this.ready_ = Promise.all([import("./sounds.ts"), context.resume()]).then(([{ Sounds }]) =>
        (this.sounds_ = new Sounds(context, this.viewer_, this.records_, this.events_)));
    } else if (this.context_?.state === "suspended") void this.context_.resume();
  }

  /** position: world, m; without one it is heard everywhere alike. */
  effect(kind: string, position?: Readonly<Vec3>, volume = 1): void {
    if (this.muted) return;
    if (this.sounds_ !== null) return this.sounds_.play(kind, position, volume);
    // The answer to the first gesture can come sooner than what plays it.
    const asked = performance.now();
    void this.ready_?.then((sounds) => {
      if (performance.now() - asked < latestMs) sounds.play(kind, position, volume);
    });
  }

  // --- PageListener

  grab({ target }: Grab, phase: "start" | "end"): void {
    if (phase === "start") this.effect("grab", [target[0], target[1], target[2]]);
  }

  // --- FramePart

  draw(): void {
    this.sounds_?.draw();
  }
}
