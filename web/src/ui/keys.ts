// SPDX-License-Identifier: Apache-2.0
// The keyboard: runs commands, and walks while a key is held down. Keys of the script have priority over the page's.

import { keepsKey } from "../page/focus.ts";
import type { Page } from "../page/page.ts";

/** Right, up, forward. */
const walkKeys: Record<string, readonly [number, number, number]> = {
  d: [1, 0, 0], a: [-1, 0, 0], e: [0, 1, 0], q: [0, -1, 0], w: [0, 0, 1], s: [0, 0, -1],
};

/** In the order of the help. */
export const walkKeyNames: readonly string[] = ["w", "a", "s", "d", "q", "e"];

export class Keys {
  private readonly page_: Pick<Page, "commands" | "navigation">;
  private readonly down_ = new Set<string>();

  /** `pressed` is called at every key. */
  constructor(page: Pick<Page, "commands" | "navigation">, pressed: () => void) {
    this.page_ = page;
    window.addEventListener("keydown", (event) => {
      pressed();
      this.press_(event);
    });
    window.addEventListener("keyup", (event) => {
      this.down_.delete(event.key.toLowerCase());
      this.page_.navigation.walkingFast = event.shiftKey;
      this.walk_();
    });
    window.addEventListener("blur", () => {
      this.down_.clear();
      this.walk_();
    });
  }

  private press_(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || keepsKey(event)) return;
    const { commands, navigation } = this.page_;
    const walking = event.key.toLowerCase();
    if (walking in walkKeys && commands.scriptOfKey(event.key) === undefined) {
      this.down_.add(walking);
      navigation.walkingFast = event.shiftKey;
      this.walk_();
      return;
    }
    const command = commands.ofKey(event.key);
    if (command === undefined) return;
    event.preventDefault();
    if (!event.repeat || command.repeats === true) command.run(event.key);
  }

  private walk_(): void {
    const { walk } = this.page_.navigation;
    walk.set(0, 0, 0);
    for (const key of this.down_) {
      const [x, y, z] = walkKeys[key];
      walk.set(walk.x + x, walk.y + y, walk.z + z);
    }
  }
}
