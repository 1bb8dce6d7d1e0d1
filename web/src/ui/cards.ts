// SPDX-License-Identifier: Apache-2.0
// Small cards: event, place, and suggestion. The world stays visible behind them, and they lie on no label and no control, unless the
// script has chosen their place.

import type { Choice } from "../page/events.ts";
import { NoticePlace } from "../protocol/generated.ts";
import { make } from "./dom.ts";

export type CardLevel = "info" | "warning" | "error";

export interface CardText {
  readonly level: CardLevel;
  readonly title: string;
  readonly text: string;
  readonly hint: string;
}

export interface CardOptions {
  /** How long it is shown; 0: as usual for its level, -1: until it is closed. */
  readonly seconds?: number | undefined;
  readonly place?: NoticePlace | undefined;
  /** The address of an image. */
  readonly picture?: string | undefined;
  /** Buttons; after a press the card goes. */
  readonly choices?: readonly Choice[] | undefined;
  /** Goes only by remove(). */
  readonly lasting?: boolean;
}

/** The places where cards are stacked, the first of which is free is taken. */
const spots = ["top", "left", "right", "bottom"] as const;
const spotOf: Partial<Record<NoticePlace, (typeof spots)[number]>> = {
  [NoticePlace.top]: "top", [NoticePlace.left]: "left", [NoticePlace.right]: "right", [NoticePlace.bottom]: "bottom",
};

const most = 4;
/** In css px. */
const gap = 8;
const wideWindow = 900;
/** Errors remain until they are closed. */
const shownMs: Record<CardLevel, number> = { info: 5000, warning: 9000, error: Infinity };

export class Cards {
  private readonly stacks_ = new Map<string, HTMLElement>();
  private readonly shown_ = new Map<string, HTMLElement>();
  private readonly covered_: () => readonly DOMRect[];

  /** `covered`: what a card must not lie on, css px. */
  constructor(root: HTMLElement, covered: () => readonly DOMRect[]) {
    this.covered_ = covered;
    for (const spot of spots) this.stacks_.set(spot, make("div", `spot ${spot}`));
    root.append(...this.stacks_.values());
  }

  /** Shows a card; one with the same key is replaced. */
  show(card: CardText, key = card.title, { seconds = 0, place = NoticePlace.free, lasting = false, picture, choices = [] }: CardOptions = {}): void {
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
    if (picture !== undefined) element.append(makePicture(picture));
    if (choices.length > 0) {
      const row = make("div", "choices");
      for (const { text, choose } of choices) {
        const button = make("button", "text", text);
        button.type = "button";
        button.addEventListener("click", () => {
          this.remove(key);
          choose();
        });
        row.append(button);
      }
      element.append(row);
    }
    this.shown_.set(key, element);
    this.place_(element, place);
    const wait = seconds === 0 ? shownMs[card.level] : seconds < 0 ? Infinity : 1000 * seconds;
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

  /** Puts a card where it was told, or where it covers nothing. */
  private place_(element: HTMLElement, place: NoticePlace): void {
    this.makeRoom_();
    const chosen = spotOf[place];
    if (chosen !== undefined) return this.stacks_.get(chosen)!.append(element);
    const covered = this.covered_();
    // Cards lie on a label sooner than on each other; without a place for all of them, the oldest goes.
    while (!this.fits_(element, covered) && !this.fits_(element, []) && this.shown_.size > 1) this.remove(this.shown_.keys().next().value!);
  }

  /** Puts a card in the first stack where it lies on no other card and on none of the boxes; whether there is one. Without one it is at the top. */
  private fits_(element: HTMLElement, covered: readonly DOMRect[]): boolean {
    const isFree = (spot: (typeof spots)[number]) => {
      this.stacks_.get(spot)!.append(element);
      const { left, right, top, bottom } = element.getBoundingClientRect();
      const isClear = (box: DOMRect) => left >= box.right || right <= box.left || top >= box.bottom || bottom <= box.top;
      const cards = [...this.shown_.values()].filter((other) => other !== element).map((other) => other.getBoundingClientRect());
      return top >= 0 && bottom <= innerHeight && [...covered, ...cards].every(isClear);
    };
    if (spots.some(isFree)) return true;
    this.stacks_.get("top")!.append(element);
    return false;
  }

  /** Stacks leave the panel of controls and the bar free, as they are now. */
  private makeRoom_(): void {
    const panel = document.getElementById("panel")?.getBoundingClientRect();
    const foot = document.getElementById("foot")?.getBoundingClientRect();
    const isBeside = panel !== undefined && panel.width > 0 && innerWidth >= wideWindow;
    this.stacks_.get("top")!.style.setProperty("--beside", isBeside ? `${innerWidth - panel.left + gap}px` : "0px");
    this.stacks_.get("right")!.style.setProperty("--below", panel !== undefined && panel.width > 0 ? `${panel.bottom + gap}px` : "0px");
    this.stacks_.get("bottom")!.style.setProperty("--above", `${innerHeight - (foot?.top ?? innerHeight) + gap}px`);
  }

  remove(key: string): void {
    this.shown_.get(key)?.remove();
    this.shown_.delete(key);
  }
}

/** There may be none at the address. */
function makePicture(address: string): HTMLImageElement {
  const picture = make("img");
  picture.alt = "";
  picture.addEventListener("error", () => picture.remove());
  picture.src = address;
  return picture;
}
