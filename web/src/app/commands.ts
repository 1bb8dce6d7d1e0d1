// SPDX-License-Identifier: Apache-2.0
// What a user can ask for, the same from a key, the bar, a menu, a controller or an in-world panel.

import { ControlCommand, NO_BODY } from "../protocol/generated.ts";
import type { ActionEntry } from "../scene/world_model.ts";
import type { Page } from "./page.ts";

export const speeds: readonly number[] = [0.1, 0.25, 0.5, 1, 2];

export class Commands {
  private readonly page_: Page;

  constructor(page: Page) {
    this.page_ = page;
  }

  togglePause(): void {
    this.control_(this.page_.model.paused ? ControlCommand.play : ControlCommand.pause, 0);
  }

  /** One step; pauses first when the world runs. */
  step(): void {
    if (!this.page_.model.paused) this.control_(ControlCommand.pause, 0);
    this.control_(ControlCommand.singleStep, 0);
  }

  reset(): void {
    this.control_(ControlCommand.reset, 0);
  }

  /** Times real time. */
  setSpeed(speed: number): void {
    this.control_(ControlCommand.speed, speed);
  }

  /** Next faster (1) or slower (-1) of the speeds on offer. */
  changeSpeed(direction: 1 | -1): void {
    const now = this.page_.model.speed;
    const next = direction > 0 ? speeds.find((speed) => speed > now * 1.01) : speeds.findLast((speed) => speed < now * 0.99);
    if (next !== undefined) this.setSpeed(next);
  }

  /** The next of the world's looks, on this page only. */
  nextLook(): void {
    const { looks } = this.page_.model.settings;
    if (looks.length > 0) this.page_.setLook(looks[(looks.indexOf(this.page_.look) + 1) % looks.length]);
  }

  /** Selects the next body that can be taken, or the one before: for keyboards without a mouse. */
  selectNext(direction: 1 | -1): void {
    const { pickable, pickableCount } = this.page_.view;
    if (pickableCount === 0) return;
    const at = pickable.subarray(0, pickableCount).indexOf(this.page_.selected);
    const next = at < 0 ? (direction > 0 ? 0 : pickableCount - 1) : (at + direction + pickableCount) % pickableCount;
    this.page_.select(pickable[next]);
  }

  /** Runs an action of the script on a body, by default on the held, else selected, else hovered one. */
  act(action: ActionEntry, body = this.actionBody()): void {
    this.page_.connection.send({ type: "action", name: action.name, body: body < 0 ? NO_BODY : body });
  }

  /** What an action is about: the held, else the selected, else the hovered body, else -1. */
  actionBody(): number {
    const { gestures, selected } = this.page_;
    const held = gestures.grabs.at(-1);
    if (held !== undefined) return held.body;
    if (selected >= 0) return selected;
    return gestures.pointers.find((pointer) => pointer.active && pointer.hovered >= 0)?.hovered ?? -1;
  }

  private control_(command: ControlCommand, value: number): void {
    this.page_.connection.send({ type: "control", command, value });
  }
}
