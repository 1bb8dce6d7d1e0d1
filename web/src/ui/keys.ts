// SPDX-License-Identifier: Apache-2.0
// The keyboard. Keys of the script win over our own; the help is made from the same list.

import type { Page } from "../app/page.ts";
import type { ActionEntry } from "../scene/world_model.ts";

export interface KeyBinding {
  readonly keys: readonly string[];
  readonly help: string;
  readonly run: () => void;
}

/** Right, up, forward. */
const walkKeys: Record<string, readonly [number, number, number]> = {
  d: [1, 0, 0], a: [-1, 0, 0], e: [0, 1, 0], q: [0, -1, 0], w: [0, 0, 1], s: [0, 0, -1],
};

export class Keys {
  readonly bindings: readonly KeyBinding[];
  private readonly page_: Page;
  private readonly down_ = new Set<string>();

  constructor(page: Page, bindings: readonly KeyBinding[], stir: () => void) {
    this.page_ = page;
    this.bindings = bindings;
    window.addEventListener("keydown", (event) => {
      stir();
      this.press_(event);
    });
    window.addEventListener("keyup", (event) => {
      this.down_.delete(event.key.toLowerCase());
      this.page_.navigation.hurrying = event.shiftKey;
      this.walk_();
    });
    window.addEventListener("blur", () => {
      this.down_.clear();
      this.walk_();
    });
  }

  /** The script's action on a key, if there is one. */
  actionOf(key: string): ActionEntry | undefined {
    return this.page_.model.actions.find((action) => action.key !== "" && action.key === key)
      ?? this.page_.model.actions.find((action) => action.key !== "" && action.key.toLowerCase() === key.toLowerCase());
  }

  private press_(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || this.isForElement_(event)) return;
    const action = this.actionOf(event.key);
    if (action !== undefined) {
      event.preventDefault();
      if (!event.repeat) this.page_.commands.act(action);
      return;
    }
    const walking = event.key.toLowerCase();
    if (walking in walkKeys) {
      this.down_.add(walking);
      this.page_.navigation.hurrying = event.shiftKey;
      this.walk_();
      return;
    }
    const binding = this.bindings.find((item) => item.keys.includes(event.key));
    if (binding === undefined) return;
    event.preventDefault();
    if (!event.repeat || event.key === "." || event.key.startsWith("Arrow")) binding.run();
  }

  /** A focused control keeps its own keys. */
  private isForElement_(event: KeyboardEvent): boolean {
    const target = event.target;
    if (!(target instanceof HTMLElement)) return false;
    if (target.closest("dialog[open]") !== null) return true;
    if (target instanceof HTMLSelectElement || target instanceof HTMLInputElement) return event.key !== "Escape";
    return target instanceof HTMLButtonElement && (event.key === " " || event.key === "Enter");
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
