// SPDX-License-Identifier: Apache-2.0
// Curves over time on a small canvas.

import type { PlotEntity } from "../protocol/generated.ts";
import { make } from "./dom.ts";

/** css px. */
const size = { width: 252, height: 96 };
const edge = 4;

/** Least and greatest value, a little apart where they are the same; null without samples. */
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

export function drawPlot(canvas: HTMLCanvasElement, legend: HTMLElement, plot: PlotEntity): void {
  const density = Math.min(devicePixelRatio, 2);
  canvas.width = size.width * density;
  canvas.height = size.height * density;
  const context = canvas.getContext("2d");
  if (context === null) return;
  context.scale(density, density);
  const { times, values, curves, colors, seconds } = plot;
  const range = rangeOf(values);
  if (range === null) {
    legend.replaceChildren(...curves.map((name, curve) => entry(name, colors[curve], null)));
    return;
  }
  const [low, high] = range;
  const end = times[times.length - 1];
  const x = (time: number) => edge + (1 - (end - time) / seconds) * (size.width - 2 * edge);
  const y = (value: number) => size.height - edge - ((value - low) / (high - low)) * (size.height - 2 * edge);
  const ink = getComputedStyle(canvas).color;
  context.strokeStyle = context.fillStyle = ink;
  context.globalAlpha = 0.25;
  context.lineWidth = 1;
  if (low < 0 && high > 0) {
    context.beginPath();
    context.moveTo(edge, y(0));
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
  context.font = "10px system-ui, sans-serif";
  context.fillText(briefly(high), edge, edge + 8);
  context.fillText(briefly(low), edge, size.height - edge);
  legend.replaceChildren(
    ...curves.map((name, curve) => entry(name, colors[curve], values[(curve + 1) * times.length - 1])),
  );
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
