// SPDX-License-Identifier: Apache-2.0
// The force of a grab, above the hand that holds.

import { Vector3, type Matrix4 } from "three";
import { Board, font, roundedBox } from "./board.ts";
import { forceText } from "../page/force_text.ts";
import type { Input } from "./input.ts";
import { faceReader } from "./wrist_panel.ts";

/** px; and of the label in the room, m. */
const width = 260;
const height = 96;
const wide = 0.065;
const above = 0.06;
/** N; less is shown as none. */
const leastForce = 0.05;
const readEverySeconds = 0.1;

export class ForceLabel {
  readonly board = new Board(width / wide);
  /** "8.1 N"; empty: it is hidden. */
  text = "";

  private sinceRead_ = Infinity;
  private readonly at_ = new Vector3();
  private readonly head_ = new Vector3();

  constructor() {
    this.board.resize(width, height);
    this.board.paint = (context, colors) => {
      roundedBox(context, { x: 2, y: 2, width: width - 4, height: height - 4 }, height / 2, colors.paper);
      context.font = `600 54px ${font}`;
      context.textAlign = "center";
      context.textBaseline = "middle";
      context.fillStyle = colors.ink;
      context.fillText(this.text, width / 2, height / 2 + 2);
    };
  }

  /** `newtons`: of the hand's grab, below 0: it has none. `head`: in the reference space. */
  update(input: Input, newtons: number, head: Matrix4, seconds: number): void {
    const { board } = this;
    board.shown = newtons >= 0;
    this.sinceRead_ += seconds;
    if (!board.shown) {
      this.text = "";
      this.sinceRead_ = Infinity;
    } else if (this.sinceRead_ > readEverySeconds) {
      this.sinceRead_ = 0;
      const text = newtons < leastForce ? "0 N" : forceText(newtons);
      if (text !== this.text) board.repaint();
      this.text = text;
    }
    if (board.shown) {
      this.at_.setFromMatrixPosition(input.rayLocal).y += above;
      faceReader(this.at_, this.head_.setFromMatrixPosition(head), board.mesh.matrix);
      board.mesh.updateMatrixWorld(true);
    }
    board.end(seconds);
  }
}
