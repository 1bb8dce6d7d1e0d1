// SPDX-License-Identifier: Apache-2.0
// A painted panel in the world that rays and fingertips can press.

import { CanvasTexture, LinearFilter, LinearMipmapLinearFilter, Mesh, MeshBasicMaterial, PlaneGeometry, SRGBColorSpace } from "three";
import type { Plate, Rect } from "./plate.ts";

const flashSeconds = 0.16;
const fadeSeconds = 0.15;

export interface Colors {
  readonly paper: string;
  readonly raised: string;
  readonly hover: string;
  readonly ink: string;
  readonly faint: string;
  readonly line: string;
  readonly calm: string;
  readonly onCalm: string;
  readonly warn: string;
  readonly error: string;
}

const light: Colors = {
  paper: "#f7f5f1", raised: "#e9e6df", hover: "#cfe6e1", ink: "#22262a", faint: "#5d6368", line: "#d5d1c8",
  calm: "#16756b", onCalm: "#ffffff", warn: "#8a5200", error: "#b3261a",
};
const dark: Colors = {
  paper: "#1e2125", raised: "#2d3136", hover: "#28524d", ink: "#eceae6", faint: "#b0b3b5", line: "#3a3f45",
  calm: "#6fd0c2", onCalm: "#10201e", warn: "#f5b95a", error: "#ff9080",
};

export const font = 'system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';

export type Painter = (context: CanvasRenderingContext2D, colors: Colors) => void;

export class Board implements Plate {
  readonly mesh: Mesh<PlaneGeometry, MeshBasicMaterial>;
  width = 0;
  height = 0;
  readonly density: number;
  buttons: readonly Rect[] = [];
  /** Index of the hovered button, -1: none. */
  hovered = -1;
  /** Index of the button pressed last, -1: none. */
  flashed = -1;
  /** Whether it should be visible; it fades in and out. */
  shown = false;
  /** Called at a press of a button. */
  press: (button: number) => void = () => {};
  paint: Painter = () => {};

  private readonly canvas_ = document.createElement("canvas");
  private readonly context_: CanvasRenderingContext2D;
  private dirty_ = true;
  private next_ = -1;
  private flash_ = 0;
  private fade_ = 0;

  /** `density`: pixels a meter. */
  constructor(density: number) {
    this.density = density;
    const context = this.canvas_.getContext("2d");
    if (context === null) throw new Error("no 2-D canvas");
    this.context_ = context;
    const material = new MeshBasicMaterial({ transparent: true, alphaTest: 0.02, toneMapped: false, fog: false });
    this.mesh = new Mesh(new PlaneGeometry(1, 1), material);
    this.mesh.matrixAutoUpdate = false;
    this.mesh.visible = false;
    this.mesh.renderOrder = 5;
  }

  get matrix(): ArrayLike<number> {
    return this.mesh.matrixWorld.elements;
  }

  /** Whether it can be pressed: visible, and not fading. */
  get ready(): boolean {
    return this.shown && this.fade_ > 0.6;
  }

  /** Size of the picture, px. */
  resize(width: number, height: number): void {
    this.dirty_ = true;
    if (this.canvas_.width === width && this.canvas_.height === height && this.mesh.material.map !== null) return;
    this.canvas_.width = width;
    this.canvas_.height = height;
    this.width = width / this.density;
    this.height = height / this.density;
    this.mesh.geometry.dispose();
    this.mesh.geometry = new PlaneGeometry(this.width, this.height);
    this.mesh.material.map?.dispose();
    const texture = new CanvasTexture(this.canvas_);
    texture.colorSpace = SRGBColorSpace;
    texture.generateMipmaps = true;
    texture.minFilter = LinearMipmapLinearFilter;
    texture.magFilter = LinearFilter;
    texture.anisotropy = 8;
    this.mesh.material.map = texture;
    this.mesh.material.needsUpdate = true;
  }

  repaint(): void {
    this.dirty_ = true;
  }

  /** Hides it without fading, at the end of a session. */
  hide(): void {
    this.shown = false;
    this.fade_ = 0;
    this.mesh.visible = false;
  }

  /** Once a frame before the inputs are aimed. */
  begin(): void {
    this.next_ = -1;
  }

  hover(button: number): void {
    if (button >= 0) this.next_ = button;
  }

  /** Presses a button by its index. */
  push(button: number): void {
    this.flashed = button;
    this.flash_ = flashSeconds;
    this.dirty_ = true;
    this.press(button);
  }

  /** Once a frame after the inputs; paints only changes. */
  end(seconds: number): void {
    if (this.next_ !== this.hovered) {
      this.hovered = this.next_;
      this.dirty_ = true;
    }
    if (this.flash_ > 0) {
      this.flash_ -= seconds;
      if (this.flash_ <= 0) {
        this.flashed = -1;
        this.dirty_ = true;
      }
    }
    this.fade_ = Math.min(Math.max(this.fade_ + (this.shown ? seconds : -seconds) / fadeSeconds, 0), 1);
    this.mesh.visible = this.fade_ > 0;
    this.mesh.material.opacity = this.fade_;
    if (!this.dirty_ || !this.mesh.visible || this.mesh.material.map === null) return;
    this.dirty_ = false;
    const colors = matchMedia("(prefers-color-scheme: dark)").matches ? dark : light;
    this.wipe_(colors);
    this.paint(this.context_, colors);
    this.mesh.material.map.needsUpdate = true;
  }

  /** Clears the picture to nearly transparent paper: corners filtered against transparent black would get dark rims. */
  private wipe_(colors: Colors): void {
    const { context_: context } = this;
    context.clearRect(0, 0, this.canvas_.width, this.canvas_.height);
    context.globalAlpha = 2 / 255;
    context.fillStyle = colors.paper;
    context.fillRect(0, 0, this.canvas_.width, this.canvas_.height);
    context.globalAlpha = 1;
  }
}

export function roundedBox(context: CanvasRenderingContext2D, rect: Rect, radius: number, fill: string): void {
  context.beginPath();
  context.roundRect(rect.x, rect.y, rect.width, rect.height, radius);
  context.fillStyle = fill;
  context.fill();
}

/** Text shortened with three dots to at most a width, px. */
export function fitText(context: CanvasRenderingContext2D, text: string, width: number): string {
  if (context.measureText(text).width <= width) return text;
  let end = text.length;
  while (end > 1 && context.measureText(`${text.slice(0, end)}…`).width > width) end--;
  return `${text.slice(0, end)}…`;
}

/** Text broken into lines of at most a width, px. */
export function wrapText(context: CanvasRenderingContext2D, text: string, width: number): string[] {
  const lines: string[] = [];
  for (const paragraph of text.split("\n")) {
    let line = "";
    for (const word of paragraph.split(" ")) {
      const longer = line === "" ? word : `${line} ${word}`;
      if (line !== "" && context.measureText(longer).width > width) {
        lines.push(line);
        line = word;
      } else {
        line = longer;
      }
    }
    if (line !== "") lines.push(fitText(context, line, width));
  }
  return lines;
}
