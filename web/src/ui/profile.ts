// SPDX-License-Identifier: Apache-2.0
// Where the time of a shown frame goes: the world's steps, the network, the page's script and drawing, as a bar and as numbers.

import type { Page } from "../page/page.ts";
import { make } from "./dom.ts";
import "./profile.css";

const parts = ["steps", "network", "script", "drawing"] as const;

export class Profile {
  readonly element = make("div", "profile");
  private readonly page_: Pick<Page, "world" | "viewer">;
  private readonly segments_ = parts.map((name) => make("i", name));
  private readonly lines_ = make("dl");
  private frames_ = 0;
  private lastFrames_ = 0;
  private lastStep_ = 0;

  constructor(page: Pick<Page, "world" | "viewer">) {
    this.page_ = page;
    const bar = make("div", "split");
    bar.append(...this.segments_);
    this.element.append(this.lines_, bar);
    page.viewer.add({ draw: () => void this.frames_++ });
  }

  /** From time to time: what has happened since the last call. */
  refresh(): void {
    const { world: { step, stepMs }, viewer: { timing } } = this.page_;
    const frames = Math.max(this.frames_ - this.lastFrames_, 1);
    // Back in time after a reset.
    const steps = Math.max(step - this.lastStep_, 0);
    this.lastFrames_ = this.frames_;
    this.lastStep_ = step;
    const spent = [(stepMs * steps) / frames, timing.decodeMs, timing.scriptMs, timing.renderMs];
    const whole = Math.max(timing.frameMs, spent.reduce((sum, value) => sum + value, 0));
    spent.forEach((value, index) => {
      this.segments_[index].style.width = `${(100 * value) / whole}%`;
    });
    this.lines_.replaceChildren(...parts.flatMap((name, index) => [make("dt", name, name), make("dd", "", `${spent[index].toFixed(2)} ms  ${((100 * spent[index]) / whole).toFixed(0)} %`)]));
  }
}
