// SPDX-License-Identifier: Apache-2.0
// Notifies listeners of events on the page. Listeners are the overlay, the headset, sounds and flashes.

import type { Grab, Pointer } from "../interact/gestures.ts";
import type { LinkState } from "../net/connection.ts";
import type { NoticeLevel, NoticePlace, Vec3 } from "../protocol/generated.ts";
import type { Change } from "../world/world.ts";

/** More breaks and joins than this in this time are not shown as events. */
const mostEffects = 6;
const calmMs = 2000;

/** A card for the user. */
export interface PageNotice {
  readonly level: NoticeLevel;
  readonly title: string;
  readonly text: string;
  /** A suggestion; may be empty. */
  readonly hint: string;
  /** Replaces the card with the same key; default: its title. */
  readonly key?: string;
  /** How long it is shown; 0 (default): as usual for its level, -1: until it is closed. */
  readonly seconds?: number;
  readonly place?: NoticePlace;
  /** The address of an image. */
  readonly picture?: string;
  /** Buttons, each with its text; after a press the card goes. */
  readonly choices?: readonly Choice[];
}

export interface Choice {
  readonly text: string;
  readonly choose: () => void;
}

/** All methods are optional. */
export interface PageListener {
  /** The first pictures are drawn: the page can be shown. */
  ready?(): void;
  /** Part of the world, the selection or the look changed. */
  changed?(what: Change | "selection"): void;
  /** A body was destroyed. Its slot may hold another body from now on. */
  bodyGone?(body: number): void;
  /** The connection to the server; `reason` is a sentence for the user, may be empty. */
  link?(state: LinkState, reason: string): void;
  notice?(notice: PageNotice): void;
  /** break, join, grab, impact, or a sound of the script behind a #, at a place (world, m); volume: 1 is usual. */
  effect?(kind: string, position: Readonly<Vec3>, volume: number): void;
  /** The script's: in the left or right hand, or with an empty name in both; strength from 0 to 1. */
  pulse?(hand: string, strength: number, seconds: number): void;
  hover?(pointer: Pointer, body: number): void;
  grab?(grab: Grab, phase: "start" | "end"): void;
  pressNothing?(pointer: Pointer): void;
  releaseNothing?(pointer: Pointer): void;
}

/** Notifies all listeners, in the order in which they were added. */
export class Events implements Required<PageListener> {
  private readonly listeners_: PageListener[] = [];
  /** Times of the last ones, ms. */
  private readonly effects_: number[] = [];

  add(...listeners: readonly PageListener[]): void {
    this.listeners_.push(...listeners);
  }

  ready(): void {
    for (const listener of this.listeners_) listener.ready?.();
  }

  changed(what: Change | "selection"): void {
    for (const listener of this.listeners_) listener.changed?.(what);
  }

  bodyGone(body: number): void {
    for (const listener of this.listeners_) listener.bodyGone?.(body);
  }

  link(state: LinkState, reason: string): void {
    for (const listener of this.listeners_) listener.link?.(state, reason);
  }

  notice(notice: PageNotice): void {
    for (const listener of this.listeners_) listener.notice?.(notice);
  }

  /** Frequent breaks and joins are normal in some worlds: then they have no flash or sound. */
  effect(kind: string, position: Readonly<Vec3>, volume = 1): void {
    if (kind === "break" || kind === "join") {
      const now = performance.now();
      while (this.effects_.length > 0 && now - this.effects_[0] > calmMs) this.effects_.shift();
      if (this.effects_.push(now) > mostEffects) return;
    }
    for (const listener of this.listeners_) listener.effect?.(kind, position, volume);
  }

  pulse(hand: string, strength: number, seconds: number): void {
    for (const listener of this.listeners_) listener.pulse?.(hand, strength, seconds);
  }

  hover(pointer: Pointer, body: number): void {
    for (const listener of this.listeners_) listener.hover?.(pointer, body);
  }

  grab(grab: Grab, phase: "start" | "end"): void {
    for (const listener of this.listeners_) listener.grab?.(grab, phase);
  }

  pressNothing(pointer: Pointer): void {
    for (const listener of this.listeners_) listener.pressNothing?.(pointer);
  }

  releaseNothing(pointer: Pointer): void {
    for (const listener of this.listeners_) listener.releaseNothing?.(pointer);
  }
}
