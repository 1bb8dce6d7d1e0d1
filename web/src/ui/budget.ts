// SPDX-License-Identifier: Apache-2.0
// The budget of a step: how full it is, what is simulated at which level, and what was changed and why. Bodies below full have the color of
// their level meanwhile.

import { Color } from "three";
import type { Page } from "../page/page.ts";
import type { FramePart } from "../page/viewer.ts";
import { make } from "./dom.ts";
import "./budget.css";

/** From the level below full on. */
const colors = ["#9aa64a", "#d9a441", "#cf7a3a", "#b5462f"].map((code) => new Color(code));
const frozen = new Color("#5a6f8c");
const tint = 0.8;

export class Budget implements FramePart {
  readonly element = make("div", "budget");
  /** Whether it is shown, and bodies are tinted. */
  shown = true;
  private readonly page_: Pick<Page, "world">;

  constructor(page: Pick<Page, "world">) {
    this.page_ = page;
  }

  refresh(): void {
    const { budgetMs, stepMs, levels, levelChanges } = this.page_.world;
    const bar = make("div", "split");
    const filled = make("i", stepMs > budgetMs ? "over" : "");
    filled.style.width = `${Math.min(100, (100 * stepMs) / budgetMs)}%`;
    bar.append(filled);
    const counts = make("div", "levels");
    for (const [index, { name, count }] of levels.entries()) {
      const entry = make("span", "", `${count} ${name}`);
      const color = colorOf(name, index);
      if (color !== null) entry.style.setProperty("--level", `#${color.getHexString()}`);
      counts.append(entry);
    }
    this.element.replaceChildren(
      make("div", "", `budget ${stepMs.toPrecision(2)} of ${Number(budgetMs.toPrecision(3))} ms`), bar, counts, ...levelChanges.map((line) => make("div", "change", line)),
    );
  }

  // --- FramePart: after the marks of users have been set

  interact(): void {
    if (!this.shown) return;
    const { levels, entities: { body } } = this.page_.world;
    for (const [index, { name, bodies }] of levels.entries()) {
      const color = colorOf(name, index);
      if (color !== null) for (const slot of bodies) body.setTint(slot, color, tint);
    }
  }
}

/** Null for full. */
function colorOf(name: string, index: number): Color | null {
  if (name === "full") return null;
  return name === "frozen" ? frozen : colors[Math.min(Math.max(index - 1, 0), colors.length - 1)];
}
