// SPDX-License-Identifier: Apache-2.0
// The page's bar on the left wrist. It stands above the hand and faces the reader; without a left hand
// it floats at the left of where the user stands.

import { Vector3, type Matrix4, type Object3D } from "three";
import type { Page } from "../app/page.ts";
import { Board, fitText, font, roundedBox, type Colors } from "./board.ts";
import { middleKnuckle } from "./hand_joints.ts";
import type { Input } from "./input.ts";
import { headHeight, layoutPanel, panelWidth, type Layout, type PanelButton } from "./panel_layout.ts";

/** px a meter: the panel is 25 cm wide. */
const density = panelWidth / 0.25;
const easeSeconds = 0.05;
const readEverySeconds = 0.25;

/** 24 x 24 line drawings, the page's own where it has them. */
const signs: Record<string, string> = {
  play: "M8 5l11 7-11 7z",
  pause: "M8.5 5v14M15.5 5v14",
  step: "M6 5l9 7-9 7zM18 5v14",
  reset: "M5 5v5h5M5.6 10A7.5 7.5 0 1 1 4.6 14",
  slower: "M6 12h12",
  faster: "M6 12h12M12 6v12",
  "turn left": "M9 5L4 10l5 5M4 10h10a5.5 5.5 0 0 1 5.5 5.5V19",
  "turn right": "M15 5l5 5-5 5M20 10H10a5.5 5.5 0 0 0-5.5 5.5V19",
};

/** What the panel asks of the session. */
export interface PanelHost {
  turn(direction: 1 | -1): void;
  /** Aims a teleport with the hand that pressed. */
  aimTeleport(): void;
  teleportArmed(): boolean;
  leave(): void;
}

export class WristPanel {
  readonly board = new Board(density);

  private readonly page_: Page;
  private readonly host_: PanelHost;
  private layout_: Layout;
  private mounted_: Input | null = null;
  private paused_ = false;
  private speed_ = 1;
  private body_ = -1;
  private armed_ = false;
  private newton_ = -1;
  private sinceRead_ = 0;
  private placed_ = false;
  private readonly at_ = new Vector3();
  private readonly goal_ = new Vector3();
  private readonly right_ = new Vector3();
  private readonly up_ = new Vector3(0, 1, 0);
  private readonly back_ = new Vector3();
  private readonly head_ = new Vector3();

  constructor(page: Page, rig: Object3D, host: PanelHost) {
    this.page_ = page;
    this.host_ = host;
    this.layout_ = this.arrange();
    this.board.paint = (context, colors) => this.paint_(context, colors);
    this.board.press = (button) => this.press_(this.layout_.buttons[button]);
    rig.add(this.board.mesh);
  }

  get layout(): Layout {
    return this.layout_;
  }

  /** The input that wears the panel and therefore cannot press it, if any. */
  get wearer(): Input | null {
    return this.mounted_;
  }

  /** Lays it out anew: other actions or looks. */
  arrange(): Layout {
    const { actions, settings } = this.page_.model;
    this.layout_ = layoutPanel(actions, settings.looks.length > 1, this.page_.look);
    this.board.buttons = this.layout_.buttons;
    this.board.resize(panelWidth, Math.ceil(this.layout_.height));
    return this.layout_;
  }

  /** Jumps to its place at the next frame instead of gliding there. */
  snap(): void {
    this.placed_ = false;
  }

  /** `head`: viewer in the reference space. `left`: the hand that wears it, or null. */
  update(left: Input | null, head: Matrix4, seconds: number): void {
    this.mounted_ = left;
    this.board.shown = left === null || (left.tracked && left.pointer.grab === null);
    this.place_(left, head, seconds);
    this.read_(seconds);
  }

  private place_(left: Input | null, head: Matrix4, seconds: number): void {
    this.head_.setFromMatrixPosition(head);
    this.right_.setFromMatrixColumn(head, 0).setY(0).normalize();
    this.back_.crossVectors(this.right_, this.up_);
    if (left === null) {
      if (!this.placed_) {
        this.goal_.copy(this.head_).addScaledVector(this.right_, -0.34).addScaledVector(this.back_, -0.42);
        this.goal_.y -= 0.3;
      }
    } else if (left.joints !== null && left.joints.tracked) {
      this.goal_.fromArray(left.joints.matrices, 16 * middleKnuckle + 12).addScaledVector(this.right_, 0.02)
        .addScaledVector(this.back_, -0.06);
      this.goal_.y += 0.13;
    } else {
      this.goal_.setFromMatrixPosition(left.rayLocal).addScaledVector(this.right_, -0.01);
      this.goal_.y += 0.1;
    }
    if (this.placed_) this.at_.lerp(this.goal_, 1 - Math.exp(-seconds / easeSeconds));
    else this.at_.copy(this.goal_);
    this.placed_ = true;
    faceReader(this.at_, this.head_, this.board.mesh.matrix);
    this.board.mesh.updateMatrixWorld(true);
  }

  /** What it shows changes with what the server says; looked at without allocating, force a few times a second. */
  private read_(seconds: number): void {
    const { model } = this.page_;
    const armed = this.host_.teleportArmed();
    const body = this.meant_();
    const grab = this.page_.gestures.grabs.at(-1);
    this.sinceRead_ += seconds;
    let newton = this.newton_;
    if (grab === undefined) newton = -1;
    else if (this.sinceRead_ > readEverySeconds) newton = Math.round(this.page_.forceOf(grab) * 10);
    if (
      model.paused === this.paused_ && model.speed === this.speed_ && body === this.body_ && newton === this.newton_
      && armed === this.armed_
    ) return;
    this.paused_ = model.paused;
    this.speed_ = model.speed;
    this.body_ = body;
    this.newton_ = newton;
    this.armed_ = armed;
    this.sinceRead_ = 0;
    this.board.repaint();
  }

  private press_(button: PanelButton): void {
    const { commands, model } = this.page_;
    switch (button.name) {
      case "play": commands.togglePause(); break;
      case "step": commands.step(); break;
      case "reset": commands.reset(); break;
      case "slower": commands.changeSpeed(-1); break;
      case "faster": commands.changeSpeed(1); break;
      case "look": commands.nextLook(); break;
      case "turn left": this.host_.turn(1); break;
      case "turn right": this.host_.turn(-1); break;
      case "go": this.host_.aimTeleport(); break;
      case "leave": this.host_.leave(); break;
      default: {
        const action = model.actions.find((entry) => `action ${entry.name}` === button.name);
        if (action !== undefined && !this.dim_(button)) commands.act(action);
      }
    }
  }

  /** The body that an action would be about, as Commands.actionBody, which is not made for each frame. */
  private meant_(): number {
    const { held, selected, gestures } = this.page_;
    if (held >= 0) return held;
    if (selected >= 0) return selected;
    for (const pointer of gestures.pointers) if (pointer.active && pointer.hovered >= 0) return pointer.hovered;
    return -1;
  }

  private dim_(button: PanelButton): boolean {
    return button.onBody && this.meant_() < 0;
  }

  private paint_(context: CanvasRenderingContext2D, colors: Colors): void {
    const { height, buttons, speed } = this.layout_;
    roundedBox(context, { x: 0, y: 0, width: panelWidth, height }, 44, colors.line);
    roundedBox(context, { x: 3, y: 3, width: panelWidth - 6, height: height - 6 }, 42, colors.paper);
    this.paintHead_(context, colors);
    buttons.forEach((button, index) => this.paintButton_(context, colors, button, index));
    context.fillStyle = colors.ink;
    context.font = `600 42px ${font}`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(`${Number(this.page_.model.speed.toPrecision(2))}×`, speed.x + speed.width / 2, speed.y + speed.height / 2);
  }

  private paintHead_(context: CanvasRenderingContext2D, colors: Colors): void {
    const { model, gestures } = this.page_;
    context.textBaseline = "middle";
    context.textAlign = "left";
    context.fillStyle = colors.ink;
    context.font = `600 42px ${font}`;
    const middle = headHeight / 2 + 2;
    context.fillText(fitText(context, model.settings.title, 360), 36, middle);
    const entry = this.body_ < 0 ? undefined : model.bodies.get(this.body_);
    const grab = gestures.grabs.at(-1);
    const body = entry === undefined ? "" : `${entry.className} ${entry.body}`;
    const text = grab === undefined
      ? (entry === undefined ? "point at a part and take hold" : body)
      : `${body} · ${this.newton_ < 0 ? "…" : (this.newton_ / 10).toFixed(this.newton_ < 100 ? 1 : 0)} N`;
    context.textAlign = "right";
    context.font = `36px ${font}`;
    context.fillStyle = entry === undefined ? colors.faint : colors.calm;
    context.fillText(fitText(context, text, 540), panelWidth - 36, middle);
  }

  private paintButton_(context: CanvasRenderingContext2D, colors: Colors, button: PanelButton, index: number): void {
    const flashed = index === this.board.flashed;
    const on = flashed || (button.name === "go" && this.armed_);
    const dim = this.dim_(button);
    const fill = on ? colors.calm : index === this.board.hovered && !dim ? colors.hover : colors.raised;
    roundedBox(context, button, 26, fill);
    const ink = on ? colors.onCalm : dim ? colors.faint : colors.ink;
    const x = button.x + button.width / 2;
    const y = button.y + button.height / 2;
    if (button.sign) {
      const name = button.name === "play" && !this.page_.model.paused ? "pause" : button.name;
      paintSign(context, signs[name], x, y, 2.5, ink);
      return;
    }
    context.globalAlpha = dim ? 0.6 : 1;
    context.font = `600 44px ${font}`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = ink;
    const badgeRoom = button.badge === "" ? 0 : 74;
    context.fillText(fitText(context, button.label, button.width - 28 - badgeRoom), x - badgeRoom / 2, y + 2);
    if (button.badge !== "") {
      const side = 54;
      roundedBox(context, { x: button.x + button.width - side - 22, y: y - side / 2, width: side, height: side }, side / 2, on ? colors.onCalm : colors.paper);
      context.fillStyle = on ? colors.calm : colors.faint;
      context.font = `600 34px ${font}`;
      context.fillText(button.badge, button.x + button.width - side / 2 - 22, y + 2);
    }
    context.globalAlpha = 1;
  }
}

function paintSign(context: CanvasRenderingContext2D, path: string, x: number, y: number, scale: number, ink: string): void {
  context.save();
  context.translate(x - 12 * scale, y - 12 * scale);
  context.scale(scale, scale);
  context.strokeStyle = ink;
  context.lineWidth = 2;
  context.lineCap = context.lineJoin = "round";
  context.stroke(new Path2D(path));
  context.restore();
}

const right = new Vector3();
const up = new Vector3();
const out = new Vector3();

/** Writes the transform of a panel at a place that faces a reader and stays level. */
export function faceReader(at: Vector3, head: Vector3, matrix: Matrix4): void {
  out.subVectors(head, at);
  if (out.lengthSq() < 1e-8) out.set(0, 0, 1);
  out.normalize();
  right.set(out.z, 0, -out.x);
  if (right.lengthSq() < 1e-8) right.set(1, 0, 0);
  right.normalize();
  up.crossVectors(out, right);
  matrix.makeBasis(right, up, out).setPosition(at);
}
