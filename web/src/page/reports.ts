// SPDX-License-Identifier: Apache-2.0
// Sends the events that the script listens to: clicks, hovers, keys. Holds and selections are always sent.

import type { Grab, Pointer } from "../interact/gestures.ts";
import { PointerKind, type Vec3 } from "../protocol/generated.ts";
import type { PageListener } from "./events.ts";
import { keepsKey } from "./focus.ts";
import type { PageParts } from "./page_parts.ts";
import type { PointerMoves } from "./pointer_moves.ts";
import type { FramePart } from "./viewer.ts";

/** A press that is shorter than this, and whose ray turns less, is a click. */
const clickMs = 350;
const clickTurn = 0.02;

const noNumbers = new Float32Array(0);

interface Press {
  readonly at: number;
  readonly direction: readonly number[];
  /** Null: on empty space. */
  readonly grab: Grab | null;
}

export class Reports implements PageListener, FramePart {
  private readonly parts_: Pick<PageParts, "world" | "session" | "gestures" | "viewer">;
  private readonly presses_ = new Map<Pointer, Press>();
  private readonly hovered_ = new Map<Pointer, number>();
  private readonly down_ = new Set<string>();
  private moves_: PointerMoves | null = null;
  private fetched_: Promise<void> | null = null;

  constructor(parts: Pick<PageParts, "world" | "session" | "gestures" | "viewer" | "events">) {
    this.parts_ = parts;
    parts.events.add(this);
    // Before the page's own keys, since the script's have priority.
    window.addEventListener("keydown", (event) => this.key_(event, true), true);
    window.addEventListener("keyup", (event) => this.key_(event, false), true);
    window.addEventListener("blur", () => {
      for (const key of this.down_) parts.session.send({ type: "key", key, down: false });
      this.down_.clear();
    });
  }

  // --- PageListener

  grab(grab: Grab, phase: "start" | "end"): void {
    if (phase === "start") this.press_(grab.pointer, grab);
    else this.release_(grab.pointer);
  }

  pressNothing(pointer: Pointer): void {
    this.press_(pointer, null);
  }

  /** At once: the next frame may come too late for a click. */
  releaseNothing(pointer: Pointer): void {
    this.release_(pointer);
  }

  hover(pointer: Pointer, body: number): void {
    if (!this.parts_.world.listens.hovers) return;
    const before = this.hovered_.get(pointer) ?? -1;
    if (before >= 0) this.send_(PointerKind.hoverEnd, pointer, before);
    if (body >= 0) this.send_(PointerKind.hover, pointer, body);
    this.hovered_.set(pointer, body);
  }

  // --- FramePart

  interact(): void {
    if (this.parts_.world.listens.moves) this.tellMoves_();
  }

  // --- inside

  private press_(pointer: Pointer, grab: Grab | null): void {
    this.tellNow_(pointer);
    this.presses_.set(pointer, { at: timeOf(pointer), direction: [...pointer.direction], grab });
  }

  private release_(pointer: Pointer): void {
    this.tellNow_(pointer);
    const press = this.presses_.get(pointer);
    this.presses_.delete(pointer);
    // A press can also end while the button is down, with its body or with the connection.
    const now = pointer.pressed ? performance.now() : timeOf(pointer);
    if (press === undefined || !this.parts_.world.listens.clicks || now - press.at > clickMs) return;
    const { direction } = pointer;
    const turned = Math.hypot(direction[0] - press.direction[0], direction[1] - press.direction[1], direction[2] - press.direction[2]);
    if (turned < clickTurn) this.send_(PointerKind.click, pointer, press.grab?.body ?? -1, press.grab?.start);
  }

  private send_(kind: PointerKind, pointer: Pointer, body: number, point?: ArrayLike<number>): void {
    const origin = vec3(pointer.origin);
    this.parts_.session.send({
      type: "pointer", kind, body: this.parts_.session.idOf(body), name: pointer.name.slice(0, 16),
      point: body >= 0 ? vec3(point ?? pointer.hit.point) : origin, origin, direction: vec3(pointer.direction),
      rotation: [0, 0, 0, 1], buttons: noNumbers, axes: noNumbers, joints: noNumbers,
    });
  }

  private tellNow_(pointer: Pointer): void {
    if (this.parts_.world.listens.moves) this.moves_?.tellNow(pointer);
  }

  /** By code that is fetched for the first script that listens to it. */
  private tellMoves_(): void {
    if (this.moves_ !== null) return this.moves_.tell();
    this.fetched_ ??= import("./pointer_moves.ts").then(({ PointerMoves }) => {
      this.moves_ = new PointerMoves(this.parts_);
    });
  }

  private key_(event: KeyboardEvent, down: boolean): void {
    const { key } = event;
    if (!down && this.down_.delete(key)) {
      this.parts_.session.send({ type: "key", key, down: false });
      return;
    }
    if (!down || !this.parts_.world.listens.keys.includes(key)) return;
    if (event.ctrlKey || event.metaKey || event.altKey || keepsKey(event)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    if (event.repeat) return;
    this.down_.add(key);
    this.parts_.session.send({ type: "key", key, down: true });
  }
}

/** The time of its last press or release, ms. */
function timeOf({ at }: Pointer): number {
  return at > 0 ? at : performance.now();
}

function vec3(from: ArrayLike<number>): Vec3 {
  return [from[0], from[1], from[2]];
}
