// SPDX-License-Identifier: Apache-2.0
// The page's bar on the left wrist. It appears when the user looks at the back of the left hand, as at a watch, stands above the hand and
// faces the reader; without a left hand it floats at the left of where the user stands.

import { Matrix4, Vector3 } from "three";
import { isAllowed, isChoice } from "../commands/command.ts";
import type { Page } from "../page/page.ts";
import { Role } from "../protocol/generated.ts";
import { drawWhole, wholeSize } from "../ui/plot.ts";
import { Board, fitText, font, roundedBox, type Colors } from "./board.ts";
import { middleKnuckle, wrist } from "./hand_joints.ts";
import type { Input } from "./input.ts";
import { controlRows } from "./controls.ts";
import { headHeight, layoutPanel, panelWidth, type Layout, type PanelButton } from "./panel_layout.ts";

/** px a meter: the panel is 25 cm wide. */
const density = panelWidth / 0.25;
const easeSeconds = 0.05;
const readEverySeconds = 0.25;
/** Cosines of the angles from the back of the hand to the eyes, and from where they look to the panel: it comes where both are above
 * the first, and goes where one is below the second. */
const comesAbove = 0.8;
const goesBelow = 0.5;
/** How far the fingers point ahead, level, 0 to 1: it comes below the first, and goes above the second. A hand that points ahead or works
 * also has its back up, towards the eyes, and a bare one more than a controller; but a watch is looked at with the arm across. */
const comesAcross = 0.5;
const goesAhead = 0.75;

type PanelPage = Pick<Page, "world" | "session" | "selection" | "gestures" | "viewer" | "commands">;

/** px */
const labelSize = 44;
/** The smallest size of a label, as a part of that. */
const smallestLabel = 0.65;

export class WristPanel {
  readonly board = new Board(density);

  private readonly page_: PanelPage;
  private layout_: Layout;
  private mounted_: Input | null = null;
  private paused_ = false;
  private speed_ = 1;
  private body_ = -1;
  private active_ = 0;
  private renamed_ = 0;
  private newton_ = -1;
  private sinceRead_ = 0;
  private sincePlots_ = 0;
  private controlsSeen_ = 0;
  private plotsSeen_ = 0;
  private leaf_ = 0;
  private placed_ = false;
  private readonly at_ = new Vector3();
  private readonly goal_ = new Vector3();
  private readonly right_ = new Vector3();
  private readonly up_ = new Vector3(0, 1, 0);
  private readonly back_ = new Vector3();
  private readonly head_ = new Vector3();
  private readonly wrist_ = new Matrix4();

  constructor(page: PanelPage) {
    this.page_ = page;
    this.layout_ = this.arrange();
    page.commands.onChange(() => this.arrange());
    this.board.paint = (context, colors) => this.paint_(context, colors);
    this.board.press = (button) => this.press_(this.layout_.buttons[button]);
    page.viewer.room.add(this.board.mesh);
  }

  get layout(): Layout {
    return this.layout_;
  }

  /** The input that carries the panel and therefore cannot press it, if any. */
  get wearer(): Input | null {
    return this.mounted_;
  }

  /** Lays it out again for other commands or looks. */
  arrange(): Layout {
    const { commands, world: { entities: { widget, plot } }, session } = this.page_;
    this.controlsSeen_ = widget.version;
    this.plotsSeen_ = plot.version;
    this.sincePlots_ = 0;
    const watches = session.refusal(Role.actor) !== "";
    const widgets = widget.of(session.clientId).map((each) => (watches ? { ...each, enabled: false } : each));
    const controls = controlRows(widgets, ({ id }, value) => session.send({ type: "change", widget: id, value, text: "" }));
    this.layout_ = layoutPanel(commands, { controls, plots: plot.all() }, this.leaf_, (leaf) => {
      this.leaf_ = leaf;
      this.arrange();
    });
    this.board.buttons = this.layout_.buttons;
    this.board.resize(panelWidth, Math.ceil(this.layout_.height));
    return this.layout_;
  }

  /** Jumps to its place at the next frame instead of gliding there. */
  snap(): void {
    this.placed_ = false;
  }

  /** `head`: viewer in the reference space. `left`: the hand that carries it, or null. */
  update(left: Input | null, head: Matrix4, seconds: number): void {
    this.mounted_ = left;
    this.place_(left, head, seconds);
    this.board.shown = left === null || (left.tracked && left.pointer.grab === null && this.isLookedAt_(left, head));
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
      this.goal_.y += 0.05 + this.board.height / 2;
    } else {
      this.goal_.setFromMatrixPosition(left.rayLocal).addScaledVector(this.right_, -0.01);
      this.goal_.y += 0.02 + this.board.height / 2;
    }
    if (this.placed_) this.at_.lerp(this.goal_, 1 - Math.exp(-seconds / easeSeconds));
    else this.at_.copy(this.goal_);
    this.placed_ = true;
    faceReader(this.at_, this.head_, this.board.mesh.matrix);
    this.board.mesh.updateMatrixWorld(true);
  }

  private isLookedAt_(left: Input, head: Matrix4): boolean {
    const { joints } = left;
    if (joints !== null && joints.tracked) this.wrist_.fromArray(joints.matrices, 16 * wrist);
    else this.wrist_.copy(left.rayLocal);
    return isWatched(this.wrist_, this.goal_, head, this.board.shown);
  }

  /** Checks the shown values without allocating, the force a few times a second. */
  private read_(seconds: number): void {
    const { world, selection } = this.page_;
    const { widget, plot } = world.entities;
    this.sincePlots_ += seconds;
    // A plot changes with each of its samples; it is drawn again a few times a second, while it is looked at.
    const drawsPlots = plot.version !== this.plotsSeen_ && this.board.shown && this.sincePlots_ > readEverySeconds;
    if (widget.version !== this.controlsSeen_ || drawsPlots) this.arrange();
    const body = selection.actionBody;
    let active = 0;
    for (const { command } of this.layout_.buttons) if (command.active?.() === true) active++;
    const grab = this.page_.gestures.grabs.at(-1);
    this.sinceRead_ += seconds;
    let newton = this.newton_;
    if (grab === undefined) newton = -1;
    else if (this.sinceRead_ > readEverySeconds) newton = Math.round(selection.forceOf(grab) * 10);
    if (
      world.paused === this.paused_ && world.speed === this.speed_ && body === this.body_ && newton === this.newton_
      && active === this.active_ && world.entities.body.renamed === this.renamed_
    ) return;
    this.renamed_ = world.entities.body.renamed;
    this.paused_ = world.paused;
    this.speed_ = world.speed;
    this.body_ = body;
    this.newton_ = newton;
    this.active_ = active;
    this.sinceRead_ = 0;
    this.board.repaint();
  }

  private press_({ command }: PanelButton): void {
    if (!isChoice(command) && command.enabled?.() !== false) command.run();
  }

  private paint_(context: CanvasRenderingContext2D, colors: Colors): void {
    const { height, buttons, readings, plots } = this.layout_;
    roundedBox(context, { x: 0, y: 0, width: panelWidth, height }, 44, colors.line);
    roundedBox(context, { x: 3, y: 3, width: panelWidth - 6, height: height - 6 }, 42, colors.paper);
    this.paintHead_(context, colors);
    buttons.forEach((button, index) => this.paintButton_(context, colors, button, index));
    context.fillStyle = colors.ink;
    context.font = `600 42px ${font}`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (const { command, x, y, width: across, height: tall } of readings) {
      if (isChoice(command)) context.fillText(fitText(context, command.value() + command.unit, across), x + across / 2, y + tall / 2);
    }
    for (const { plot, x, y, width } of plots) {
      context.save();
      context.translate(x, y);
      context.scale(width / wholeSize.width, width / wholeSize.width);
      drawWhole(context, plot, colors.ink);
      context.restore();
    }
  }

  private paintHead_(context: CanvasRenderingContext2D, colors: Colors): void {
    const { world, gestures } = this.page_;
    context.textBaseline = "middle";
    context.textAlign = "left";
    context.fillStyle = colors.ink;
    context.font = `600 42px ${font}`;
    const middle = headHeight / 2 + 2;
    context.fillText(fitText(context, world.settings.title.split(": ")[0], 360), 36, middle);
    const body = world.entities.body.nameOf(this.body_);
    const grab = gestures.grabs.at(-1);
    const text = grab === undefined
      ? (body === "" ? "point at a body and grab it" : body)
      : `${body} · ${this.newton_ < 0 ? "…" : (this.newton_ / 10).toFixed(this.newton_ < 100 ? 1 : 0)} N`;
    context.textAlign = "right";
    context.font = `36px ${font}`;
    context.fillStyle = body === "" ? colors.faint : colors.calm;
    context.fillText(fitText(context, text, 540), panelWidth - 36, middle);
  }

  private paintButton_(context: CanvasRenderingContext2D, colors: Colors, button: PanelButton, index: number): void {
    const { command } = button;
    const on = index === this.board.flashed || command.active?.() === true;
    const dim = command.enabled?.() === false || !isAllowed(command);
    const fill = on ? colors.calm : index === this.board.hovered && !dim ? colors.hover : colors.raised;
    roundedBox(context, button, 26, fill);
    const ink = on ? colors.onCalm : dim ? colors.faint : colors.ink;
    const x = button.x + button.width / 2;
    const y = button.y + button.height / 2;
    context.globalAlpha = dim ? 0.6 : 1;
    if (command.sign !== undefined) {
      paintSign(context, command.sign(), x, y, 2.5, ink);
      context.globalAlpha = 1;
      return;
    }
    context.font = `600 ${labelSize}px ${font}`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = ink;
    const badgeRoom = button.badge === "" ? 0 : 74;
    const label = command.label?.() ?? command.title();
    const room = button.width - 28 - badgeRoom;
    // A long one is written smaller before it is cut.
    const share = Math.max(room / context.measureText(label).width, smallestLabel);
    if (share < 1) context.font = `600 ${share * labelSize}px ${font}`;
    context.fillText(fitText(context, label, room), x - badgeRoom / 2, y + 2);
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
const toward = new Vector3();
const axis = new Vector3();

/** Whether the user looks at the back of a hand as at a watch. `hand`: y from its back, -z along its fingers; `panel`: where the panel is;
 * `head`: of the viewer, in the same frame; `before`: the answer of the last frame. */
export function isWatched(hand: Matrix4, panel: Vector3, head: Matrix4, before: boolean): boolean {
  toward.setFromMatrixPosition(hand).sub(out.setFromMatrixPosition(head)).normalize();
  const turned = -toward.dot(axis.setFromMatrixColumn(hand, 1));
  toward.subVectors(panel, out).normalize();
  const seen = -toward.dot(axis.setFromMatrixColumn(head, 2));
  // Level: who looks down on a hand that points ahead sees its fingers point up.
  axis.setY(0).normalize();
  const ahead = axis.dot(toward.setFromMatrixColumn(hand, 2));
  return Math.min(turned, seen) > (before ? goesBelow : comesAbove) && ahead < (before ? goesAhead : comesAcross);
}

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
