// SPDX-License-Identifier: Apache-2.0
// Curves over time on a small canvas.

import type { PlotEntity } from "../protocol/generated.ts";
import { make } from "./dom.ts";

/** css px. */
const size = { width: 252, height: 96 };
const edge = 4;

/** Least and greatest value, slightly widened if they are equal; null without samples. */
export function rangeOf(values: ArrayLike<number>): readonly [number, number] | null {
  let low = Infinity;
  let high = -Infinity;
  for (let index = 0; index < values.length; index++) {
    low = Math.min(low, values[index]);
    high = Math.max(high, values[index]);
  }
  if (low > high) return null;
  const least = 1e-9 + 1e-6 * Math.max(Math.abs(low), Math.abs(high));
  const missing = Math.max(0, least - (high - low)) / 2;
  return [low - missing, high + missing];
}

/** Three digits. */
export function briefly(value: number): string {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e5 || size < 1e-3)) return value.toExponential(1);
  return String(Number(value.toPrecision(3)));
}

/** The start of the line of zero, css px: it begins beside a number (its lower edge and width) that it would strike through. */
export function startOfZero(y: number, numbers: readonly { readonly at: number; readonly width: number }[]): number {
  const struck = numbers.filter(({ at }) => y > at - 10 && y < at + 2).map(({ width }) => width + 4);
  return edge + Math.max(0, ...struck);
}

export function drawPlot(canvas: HTMLCanvasElement, legend: HTMLElement, plot: PlotEntity): void {
  const density = Math.min(devicePixelRatio, 2);
  canvas.width = size.width * density;
  canvas.height = size.height * density;
  const context = canvas.getContext("2d");
  if (context === null) return;
  context.scale(density, density);
  drawCurves(context, plot, getComputedStyle(canvas).color);
  legend.replaceChildren(...plot.curves.map((name, curve) => entry(name, plot.colors[curve], newest(plot, curve))));
}

/** The last value of a curve; null without samples. */
function newest({ times, values }: PlotEntity, curve: number): number | null {
  return times.length === 0 ? null : values[(curve + 1) * times.length - 1];
}

/** Draws the curves from the origin on, as large as on the panel. */
function drawCurves(context: CanvasRenderingContext2D, { times, values, curves, colors, seconds }: PlotEntity, ink: string): void {
  const range = rangeOf(values);
  if (range === null) return;
  const [low, high] = range;
  const end = times[times.length - 1];
  const x = (time: number) => edge + (1 - (end - time) / seconds) * (size.width - 2 * edge);
  const y = (value: number) => size.height - edge - ((value - low) / (high - low)) * (size.height - 2 * edge);
  context.strokeStyle = context.fillStyle = ink;
  context.globalAlpha = 0.25;
  context.lineWidth = 1;
  context.font = "10px system-ui, sans-serif";
  const scale = [{ text: briefly(high), at: edge + 8 }, { text: briefly(low), at: size.height - edge }];
  if (low < 0 && high > 0) {
    const numbers = scale.map(({ text, at }) => ({ at, width: context.measureText(text).width }));
    context.beginPath();
    context.moveTo(startOfZero(y(0), numbers), y(0));
    context.lineTo(size.width - edge, y(0));
    context.stroke();
  }
  context.globalAlpha = 1;
  context.lineWidth = 1.6;
  context.lineJoin = "round";
  curves.forEach((_, curve) => {
    context.strokeStyle = css(colors[curve]);
    context.beginPath();
    for (let index = 0; index < times.length; index++) {
      const value = values[curve * times.length + index];
      if (index === 0) context.moveTo(x(times[index]), y(value));
      else context.lineTo(x(times[index]), y(value));
    }
    context.stroke();
  });
  context.globalAlpha = 0.75;
  for (const { text, at } of scale) context.fillText(text, edge, at);
  context.globalAlpha = 1;
}

/** Space between plots and around them, and height of a line of text, css px. */
const margin = 12;
const line = 18;
const paper = "rgb(250 249 247 / 88%)";
const ink = "#22262a";

/** Draws plots over a picture of a size in px, one below the other at its right edge, a third of its width at most. */
export function drawPlots(context: CanvasRenderingContext2D, plots: readonly PlotEntity[], width: number, height: number): void {
  if (plots.length === 0) return;
  const tall = plots.length * (wholeSize.height + margin) + margin;
  const wide = size.width + 2 * margin;
  const scale = Math.min(width / 3 / wide, (height - 2 * margin) / tall, height / 480);
  context.save();
  context.translate(width - scale * (wide + margin), scale * margin);
  context.scale(scale, scale);
  context.fillStyle = paper;
  context.beginPath();
  context.roundRect(0, 0, wide, tall, 12);
  context.fill();
  context.translate(margin, margin);
  for (const plot of plots) {
    drawWhole(context, plot, ink);
    context.translate(0, wholeSize.height + margin);
  }
  context.restore();
}

/** Size of a plot with its name and its legend, css px. */
export const wholeSize = { width: size.width, height: size.height + 2 * line };

/** Draws a plot with its name and its legend from the origin on. */
export function drawWhole(context: CanvasRenderingContext2D, plot: PlotEntity, color: string): void {
  context.save();
  context.textAlign = "left";
  context.textBaseline = "alphabetic";
  context.fillStyle = color;
  context.font = "600 13px system-ui, sans-serif";
  context.fillText(plot.unit === "" ? plot.label : `${plot.label}, ${plot.unit}`, 0, 12, size.width);
  context.translate(0, line);
  drawCurves(context, plot, color);
  context.translate(0, size.height);
  writeLegend(context, plot, color);
  context.restore();
}

function writeLegend(context: CanvasRenderingContext2D, plot: PlotEntity, color: string): void {
  let x = 0;
  context.font = "12px system-ui, sans-serif";
  plot.curves.forEach((name, curve) => {
    const value = newest(plot, curve);
    const text = value === null ? name : `${name} ${briefly(value)}`;
    context.fillStyle = css(plot.colors[curve]);
    context.fillRect(x, 5, 9, 9);
    context.fillStyle = color;
    context.fillText(text, x + 14, 14);
    x += 26 + context.measureText(text).width;
  });
}

function css(color: number): string {
  return `#${color.toString(16).padStart(6, "0")}`;
}

function entry(name: string, color: number, value: number | null): HTMLElement {
  const element = make("span");
  const mark = make("i");
  mark.style.background = css(color);
  element.append(mark, name);
  if (value !== null) element.append(" ", make("b", "", briefly(value)));
  return element;
}
