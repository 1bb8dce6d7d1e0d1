// SPDX-License-Identifier: Apache-2.0
// Where the commands are on the wrist panel: the page's in a row, the script's actions and controls below, and getting about at the foot.

import { isChoice, type Entry, type ScriptCommand } from "../commands/command.ts";
import type { Commands } from "../commands/commands.ts";
import { makeReading } from "./controls.ts";
import type { Rect } from "./plate.ts";

export interface PanelButton extends Rect {
  readonly command: Entry;
  /** Small, beside the label: the controller's face button for the same action; may be empty. */
  readonly badge: string;
}

export interface Layout {
  /** Buttons that can be pressed. */
  readonly buttons: readonly PanelButton[];
  /** Fields that only show a value. */
  readonly readings: readonly PanelButton[];
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

/** The rows of one leaf where there are more than fit; the last row turns over. `turn` is called with the leaf to show. */
export function leafOf(rows: readonly (readonly Entry[])[], leaf: number, turn: (leaf: number) => void): readonly (readonly Entry[])[] {
  if (rows.length <= mostRows) return rows;
  const onLeaf = mostRows - 1;
  const leaves = Math.ceil(rows.length / onLeaf);
  const shown = Math.min(leaf, leaves - 1);
  const turner = (name: string, sign: string, by: number): Entry => ({
    name, title: () => name, sign: () => sign, narrow: true, run: () => turn((shown + by + leaves) % leaves),
  });
  const place = makeReading("name leaf", () => `${shown + 1} of ${leaves}`);
  return [...rows.slice(shown * onLeaf, (shown + 1) * onLeaf), [turner("previous leaf", signs.back, -1), place, turner("next leaf", signs.on, 1)]];
}

/** `controls`: rows of those of the script; `leaf`: the one that is shown of its actions and controls. */
export function layoutPanel(commands: Commands, controls: readonly (readonly Entry[])[] = [], leaf = 0, turn: (leaf: number) => void = () => {}): Layout {
  let top = headHeight;
  const buttons: PanelButton[] = [];
  const add = (entries: readonly Entry[]) => {
    buttons.push(...spread(entries, top));
    top += row + gap;
  };
  add(commands.at("panel"));
  const { script } = commands;
  const actions = Array.from({ length: Math.ceil(script.length / actionsInRow) }, (_, row) => script.slice(actionsInRow * row, actionsInRow * (row + 1)));
  for (const entries of leafOf([...actions, ...controls], leaf, turn)) add(entries);
  const foot = commands.at("panel foot");
  for (let from = 0; from < foot.length; from += footInRow) add(foot.slice(from, from + footInRow));
  return {
    buttons: buttons.filter(({ command }) => !isChoice(command) && (commands.script.includes(command as ScriptCommand) || command.offered?.() !== false)),
    readings: buttons.filter(({ command }) => isChoice(command)),
    height: top - gap + edge,
  };
}
