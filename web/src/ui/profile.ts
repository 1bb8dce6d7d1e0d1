// SPDX-License-Identifier: Apache-2.0
// The parts of the time of a shown frame: the world's steps and their parts, the network, the page's script and drawing, as a
// bar and as numbers.

import type { Page } from "../page/page.ts";
import { make } from "./dom.ts";
import "./profile.css";

interface Part {
  readonly name: string;
  /** For its color. */
  readonly kind: "steps" | "step-part" | "network" | "script" | "drawing";
  /** Time in a frame. */
  readonly ms: number;
}

export class Profile {
  readonly element = make("div", "profile");
  private readonly page_: Pick<Page, "world" | "viewer">;
  private readonly bar_ = make("div", "split");
  private readonly lines_ = make("dl");
  private frames_ = 0;
  private lastFrames_ = 0;
  private lastStep_ = 0;

  constructor(page: Pick<Page, "world" | "viewer">) {
    this.page_ = page;
    this.element.append(this.lines_, this.bar_);
    page.viewer.add({ draw: () => void this.frames_++ });
  }

  /** From time to time: what has happened since the last call. */
  refresh(): void {
    const { world: { step, stepMs, costs }, viewer: { timing } } = this.page_;
    const frames = Math.max(this.frames_ - this.lastFrames_, 1);
    // Back in time after a reset.
    const steps = Math.max(step - this.lastStep_, 0) / frames;
    this.lastFrames_ = this.frames_;
    this.lastStep_ = step;
    const ofSteps = costs.map(({ part, ms }): Part => ({ name: part, kind: "step-part", ms: steps * ms }));
    const others: readonly Part[] = [
      { name: "network", kind: "network", ms: timing.decodeMs },
      { name: "page script", kind: "script", ms: timing.scriptMs },
      { name: "drawing", kind: "drawing", ms: timing.renderMs },
    ];
    const all: Part = { name: "steps", kind: "steps", ms: costs.length > 0 ? sum(ofSteps) : steps * stepMs };
    const whole = Math.max(timing.frameMs, sum([all, ...others]));
    const share = (part: Part) => (100 * part.ms) / whole;
    const segments = [...(costs.length > 0 ? ofSteps : [all]), ...others];
    this.bar_.replaceChildren(...segments.map((part) => {
      const segment = make("i", part.kind);
      segment.style.width = `${share(part)}%`;
      return segment;
    }));
    this.lines_.replaceChildren(...[all, ...ofSteps, ...others].flatMap((part) =>
      [make("dt", part.kind, part.name), make("dd", part.kind, `${part.ms.toFixed(2)} ms  ${share(part).toFixed(0)} %`)]));
  }
}

function sum(parts: readonly Part[]): number {
  return parts.reduce((ms, part) => ms + part.ms, 0);
}
