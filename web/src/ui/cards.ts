// SPDX-License-Identifier: Apache-2.0
// Small cards at the top: event, place, and suggestion. The world stays visible behind them.

import { make } from "./dom.ts";

export type CardLevel = "info" | "warning" | "error";

export interface CardText {
  readonly level: CardLevel;
  readonly title: string;
  readonly text: string;
  readonly hint: string;
}

const most = 4;
/** Errors remain until they are closed. */
const shownMs: Record<CardLevel, number> = { info: 5000, warning: 9000, error: Infinity };

export class Cards {
  private readonly root_: HTMLElement;
  private readonly shown_ = new Map<string, HTMLElement>();

  constructor(root: HTMLElement) {
    this.root_ = root;
  }

  /** Shows a card; one with the same key is replaced. `lasting` cards go only by remove(). */
  show(card: CardText, key = card.title, lasting = false): void {
    const face = `${card.level}\n${card.title}\n${card.text}\n${card.hint}`;
    const before = this.shown_.get(key);
    // Repeated (each failed attempt to connect): it is shown already, and must not flash.
    if (lasting && before?.dataset["face"] === face) return;
    this.remove(key);
    const element = make("section", `card ${card.level}`);
    element.dataset["face"] = face;
    element.setAttribute("role", card.level === "error" ? "alert" : "status");
    element.append(make("h2", "", card.title));
    if (!lasting) {
      const close = make("button", "", "×");
      close.type = "button";
      close.setAttribute("aria-label", "Close");
      close.addEventListener("click", () => this.remove(key));
      element.append(close);
    }
    if (card.text !== "") element.append(make("p", "", card.text));
    if (card.hint !== "") element.append(make("p", "try", card.hint));
    this.shown_.set(key, element);
    this.root_.append(element);
    const wait = shownMs[card.level];
    if (!lasting && Number.isFinite(wait)) {
      window.setTimeout(() => {
        if (this.shown_.get(key) === element) this.remove(key);
      }, wait);
    }
    for (const oldest of this.shown_.keys()) {
      if (this.shown_.size <= most) break;
      this.remove(oldest);
    }
  }

  remove(key: string): void {
    this.shown_.get(key)?.remove();
    this.shown_.delete(key);
  }
}
