// SPDX-License-Identifier: Apache-2.0
// The page's cards in the headset: a card in front of the user, above or below the work, which keeps its place and follows
// only when the user has turned away from it.

import { Vector3, type Matrix4, type Object3D } from "three";
import { Board, font, roundedBox, wrapText, type Colors } from "./board.ts";
import { faceReader } from "./wrist_panel.ts";

export type NoticeLevel = 0 | 1 | 2;

interface Card {
  readonly key: string;
  readonly level: number;
  readonly title: string;
  readonly text: string;
  readonly hint: string;
  /** Seconds left; Infinity: until it is pressed or removed. */
  left: number;
  readonly lasting: boolean;
}

const width = 820;
const edge = 34;
const density = width / 0.5;
const shownSeconds = [6, 9, Infinity];
const most = 3;
const away = 0.95;
/** Most work is below the eyes, see standing.ts: the card's lower edge is 15 degrees above them. Where the middle of the scene is above the
 * eyes, as among fish, the card's upper edge is 15 degrees below them. */
const apart = 0.265;
/** To the right: the wrist panel is at the left. */
const aside = 0.24;
/** Cosine of the angle from which on it follows: 38 degrees. */
const lostFromView = 0.79;
const easeSeconds = 0.18;

/** Middle of a card of a height, m, before a head; both in the room, as is the middle of the scene. */
export function cardPlace(head: Matrix4, scene: Vector3, height: number, out: Vector3): Vector3 {
  eyes.setFromMatrixPosition(head);
  lookAhead(head);
  out.copy(eyes).addScaledVector(ahead, away);
  out.x -= aside * ahead.z;
  out.z += aside * ahead.x;
  out.y += (scene.y > eyes.y ? -1 : 1) * (apart + height / 2);
  return out;
}

/** Sets `ahead` to where a head looks, level. */
function lookAhead(head: Matrix4): void {
  ahead.setFromMatrixColumn(head, 2).negate().setY(0);
  if (ahead.lengthSq() < 1e-4) ahead.set(0, 0, -1);
  ahead.normalize();
}

const eyes = new Vector3();
const ahead = new Vector3();

export class Notices {
  readonly board = new Board(density);

  private cards_: Card[] = [];
  private placed_ = false;
  private coming_ = false;
  private readonly at_ = new Vector3();
  private readonly goal_ = new Vector3();
  private readonly head_ = new Vector3();
  private readonly measure_: CanvasRenderingContext2D;

  constructor(rig: Object3D) {
    const context = document.createElement("canvas").getContext("2d");
    if (context === null) throw new Error("no 2-D canvas");
    this.measure_ = context;
    this.board.paint = (target, colors) => this.paint_(target, colors);
    this.board.press = () => this.dismiss_();
    rig.add(this.board.mesh);
  }

  get titles(): string[] {
    return this.cards_.map((card) => card.title);
  }

  /** `seconds`: 0: as usual for the level, below 0: until it is pressed. */
  show(level: number, title: string, text: string, hint: string, key = title, lasting = false, seconds = 0): void {
    this.cards_ = this.cards_.filter((card) => card.key !== key);
    this.cards_.push({ key, level, title, text, hint, left: lasting || seconds < 0 ? Infinity : seconds || (shownSeconds[level] ?? 6), lasting });
    if (this.cards_.length > most) this.cards_.shift();
    this.arrange_();
  }

  remove(key: string): void {
    if (!this.cards_.some((card) => card.key === key)) return;
    this.cards_ = this.cards_.filter((card) => card.key !== key);
    this.arrange_();
  }

  clear(): void {
    this.cards_ = [];
    this.board.hide();
    this.placed_ = false;
  }

  /** `head`: viewer in the reference space; `scene`: middle of what is seen, in the same. */
  update(head: Matrix4, scene: Vector3, seconds: number): void {
    let gone = false;
    for (const card of this.cards_) {
      card.left -= seconds;
      gone ||= card.left <= 0;
    }
    if (gone) {
      this.cards_ = this.cards_.filter((card) => card.left > 0);
      this.arrange_();
    }
    if (this.cards_.length === 0 && !this.board.mesh.visible) {
      this.placed_ = false;
      return;
    }
    this.place_(head, scene, seconds);
  }

  private place_(head: Matrix4, scene: Vector3, seconds: number): void {
    this.head_.setFromMatrixPosition(head);
    lookAhead(head);
    const inView = this.goal_.subVectors(this.at_, this.head_).setY(0).normalize().dot(ahead);
    if (!this.placed_ || inView < lostFromView) this.coming_ = true;
    if (this.coming_) {
      cardPlace(head, scene, this.board.height, this.goal_);
      if (this.placed_) this.at_.lerp(this.goal_, 1 - Math.exp(-seconds / easeSeconds));
      else this.at_.copy(this.goal_);
      this.placed_ = true;
      if (this.at_.distanceToSquared(this.goal_) < 1e-4) this.coming_ = false;
    }
    faceReader(this.at_, this.head_, this.board.mesh.matrix);
    this.board.mesh.updateMatrixWorld(true);
  }

  /** A press removes all cards that do not last. */
  private dismiss_(): void {
    this.cards_ = this.cards_.filter((card) => card.lasting);
    this.arrange_();
  }

  private arrange_(): void {
    this.board.shown = this.cards_.length > 0;
    if (this.cards_.length === 0) {
      this.board.buttons = [];
      return;
    }
    const height = this.lay_(this.measure_, null);
    this.board.resize(width, height);
    // Cards that disappear by themselves let rays through to the bodies behind them.
    this.board.buttons = this.cards_.some((card) => (card.level > 0 || card.left === Infinity) && !card.lasting) ? [{ x: 0, y: 0, width, height }] : [];
  }

  private paint_(context: CanvasRenderingContext2D, colors: Colors): void {
    this.lay_(context, colors);
  }

  /** Measures (without colors) or paints; returns the height, px. */
  private lay_(context: CanvasRenderingContext2D, colors: Colors | null): number {
    let y = 0;
    context.textAlign = "left";
    context.textBaseline = "alphabetic";
    for (const card of this.cards_) {
      context.font = `600 40px ${font}`;
      const title = wrapText(context, card.title, width - 2 * edge - 20);
      context.font = `34px ${font}`;
      const text = card.text === "" ? [] : wrapText(context, card.text, width - 2 * edge - 20);
      const hint = card.hint === "" ? [] : wrapText(context, card.hint, width - 2 * edge - 20);
      const height = 2 * edge - 4 + 50 * title.length + 44 * (text.length + hint.length) + (hint.length > 0 ? 8 : 0);
      if (colors !== null) {
        const accent = [colors.calm, colors.warn, colors.error][card.level] ?? colors.calm;
        roundedBox(context, { x: 0, y, width, height }, 32, colors.line);
        roundedBox(context, { x: 3, y: y + 3, width: width - 6, height: height - 6 }, 30, colors.paper);
        roundedBox(context, { x: 18, y: y + 26, width: 8, height: height - 52 }, 4, accent);
        let line = y + edge + 34;
        const write = (lines: string[], style: string, color: string, pitch: number) => {
          context.font = style;
          context.fillStyle = color;
          for (const each of lines) {
            context.fillText(each, edge + 12, line);
            line += pitch;
          }
        };
        write(title, `600 40px ${font}`, colors.ink, 50);
        write(text, `34px ${font}`, colors.ink, 44);
        line += 8;
        write(hint, `34px ${font}`, colors.faint, 44);
      }
      y += height + 16;
    }
    return Math.ceil(y - 16);
  }
}
