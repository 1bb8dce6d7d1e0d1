// SPDX-License-Identifier: Apache-2.0
// The layout of the wrist panel: the page's commands in a row, the script's actions, controls and plots below, and locomotion at the foot.

import { isChoice, type Entry, type ScriptCommand } from "../commands/command.ts";
import type { Commands } from "../commands/commands.ts";
import type { PlotEntity } from "../protocol/generated.ts";
import { wholeSize } from "../ui/plot.ts";
import { makeReading } from "./controls.ts";
import type { Rect } from "./plate.ts";

export interface PanelButton extends Rect {
  readonly command: Entry;
  /** Small, beside the label: the controller's face button for the same action; may be empty. */
  readonly badge: string;
}

export interface PanelPlot extends Rect {
  readonly plot: PlotEntity;
}

/** A row of entries, or of plots, which is as high as two rows of entries. */
type Row = readonly Entry[] | { readonly plots: readonly PlotEntity[] };

export interface Layout {
  /** Buttons that can be pressed. */
  readonly buttons: readonly PanelButton[];
  /** Fields that only show a value. */
  readonly readings: readonly PanelButton[];
  readonly plots: readonly PanelPlot[];
  /** px */
  readonly height: number;
}

export const panelWidth = 1000;
export const headHeight = 92;
const edge = 26;
const gap = 14;
const row = 124;
const pictogram = 106;
const narrow = 84;
const reading = 104;
const actionsInRow = 3;
const plotsInRow = 2;
const footInRow = 5;

/** Width of a command's button, px; 0: an equal share of the remaining width of its row. */
function widthOf(command: Entry): number {
  if (isChoice(command)) return command.wide === true ? 0 : reading;
  if (command.sign === undefined) return 0;
  return command.narrow === true ? narrow : pictogram;
}

/** Spreads commands over a row. A command that is not offered now keeps its place, so that the others do not jump. */
function spread(commands: readonly Entry[], top: number): PanelButton[] {
  const widths = commands.map(widthOf);
  const fixed = widths.reduce((sum, width) => sum + width, 0);
  const free = panelWidth - 2 * edge - gap * (commands.length - 1) - fixed;
  const loose = widths.filter((width) => width === 0).length;
  let x = edge;
  return commands.map((command, index) => {
    const width = widths[index] > 0 ? widths[index] : free / loose;
    const button = { command, badge: badgeOf(command), x, y: top, width, height: row };
    x += width + gap;
    return button;
  });
}

function badgeOf(command: Entry): string {
  return (command as Partial<ScriptCommand>).button?.toUpperCase() ?? "";
}

/** More would be taller than an arm can hold. */
export const mostRows = 7;
const signs = { back: "M14 6l-6 6 6 6", on: "M10 6l6 6-6 6" };

function isPlots(entries: Row): entries is Exclude<Row, readonly Entry[]> {
  return "plots" in entries;
}

/** In rows of entries. */
function heightOf(rows: readonly Row[]): number {
  return rows.reduce((sum, each) => sum + (isPlots(each) ? 2 : 1), 0);
}

/** The rows of one leaf where there are more than fit; the last row turns over. `turn` is called with the leaf to show. */
export function leafOf(rows: readonly Row[], leaf: number, turn: (leaf: number) => void): readonly Row[] {
  if (heightOf(rows) <= mostRows) return rows;
  const leaves: Row[][] = [[]];
  for (const each of rows) {
    if (heightOf([...leaves.at(-1)!, each]) > mostRows - 1) leaves.push([]);
    leaves.at(-1)!.push(each);
  }
  const shown = Math.min(leaf, leaves.length - 1);
  const turner = (name: string, sign: string, by: number): Entry => ({
    name, title: () => name, sign: () => sign, narrow: true, run: () => turn((shown + by + leaves.length) % leaves.length),
  });
  const place = makeReading("name leaf", () => `${shown + 1} of ${leaves.length}`);
  return [...leaves[shown], [turner("previous leaf", signs.back, -1), place, turner("next leaf", signs.on, 1)]];
}

/** Cuts a list into pieces of some length; the last may be shorter. */
function inPieces<T>(list: readonly T[], length: number): T[][] {
  return Array.from({ length: Math.ceil(list.length / length) }, (_, piece) => list.slice(length * piece, length * (piece + 1)));
}

/** The controls and plots that a script has put on the panel besides its actions. */
export interface Shown {
  readonly controls?: readonly (readonly Entry[])[];
  readonly plots?: readonly PlotEntity[];
}

/** `controls`: rows of those of the script; `leaf`: the one that is shown of its actions, controls and plots. */
export function layoutPanel(commands: Commands, { controls = [], plots = [] }: Shown = {}, leaf = 0, turn: (leaf: number) => void = () => {}): Layout {
  let top = headHeight;
  const buttons: PanelButton[] = [];
  const placed: PanelPlot[] = [];
  const add = (entries: readonly Entry[]) => {
    buttons.push(...spread(entries, top));
    top += row + gap;
  };
  const addPlots = (shown: readonly PlotEntity[]) => {
    const width = (panelWidth - 2 * edge - (plotsInRow - 1) * gap) / plotsInRow;
    const height = (width / wholeSize.width) * wholeSize.height;
    shown.forEach((plot, index) => placed.push({ plot, x: edge + index * (width + gap), y: top, width, height }));
    top += 2 * (row + gap);
  };
  add(commands.at("panel"));
  const { script } = commands;
  const rows: Row[] = [...inPieces(script, actionsInRow), ...controls, ...inPieces(plots, plotsInRow).map((pair) => ({ plots: pair }))];
  for (const each of leafOf(rows, leaf, turn)) {
    if (isPlots(each)) addPlots(each.plots);
    else add(each);
  }
  for (const entries of inPieces(commands.at("panel foot"), footInRow)) add(entries);
  return {
    buttons: buttons.filter(({ command }) => !isChoice(command) && (commands.script.includes(command as ScriptCommand) || command.offered?.() !== false)),
    readings: buttons.filter(({ command }) => isChoice(command)),
    plots: placed,
    height: top - gap + edge,
  };
}
