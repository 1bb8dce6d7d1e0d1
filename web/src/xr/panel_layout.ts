// SPDX-License-Identifier: Apache-2.0
// What is on the wrist panel and where: the page's bar, the script's actions, and getting about.

import type { ActionEntry } from "../scene/world_model.ts";
import type { Rect } from "./plate.ts";

export interface PanelButton extends Rect {
  /** What it does: "play", "step", ..., "action break". */
  readonly name: string;
  readonly label: string;
  /** Small, beside the label: the controller's face button that does the same. */
  readonly badge: string;
  /** Drawn as a sign instead of its label. */
  readonly sign: boolean;
  /** Needs a body that is held or selected. */
  readonly onBody: boolean;
}

export interface Layout {
  readonly buttons: readonly PanelButton[];
  /** Where the speed is written. */
  readonly speed: Rect;
  /** px */
  readonly height: number;
}

export const panelWidth = 1000;
export const headHeight = 92;
const edge = 26;
const gap = 14;
const row = 124;
const actionsInRow = 3;

interface Cell {
  readonly name: string;
  readonly label: string;
  readonly width: number;
  readonly sign?: boolean;
  readonly badge?: string;
  readonly onBody?: boolean;
}

/** Spreads cells over a row; a width of 0 takes an equal part of what is left. */
function spread(cells: readonly Cell[], top: number): PanelButton[] {
  const fixed = cells.reduce((sum, cell) => sum + cell.width, 0);
  const free = panelWidth - 2 * edge - gap * (cells.length - 1) - fixed;
  const loose = cells.filter((cell) => cell.width === 0).length;
  let x = edge;
  return cells.map((cell) => {
    const width = cell.width > 0 ? cell.width : free / loose;
    const button = {
      name: cell.name, label: cell.label, badge: cell.badge ?? "", sign: cell.sign ?? false, onBody: cell.onBody ?? false,
      x, y: top, width, height: row,
    };
    x += width + gap;
    return button;
  });
}

/** Lays out the panel for a script's actions; `looks`: whether there is more than one, `look`: its name. */
export function layoutPanel(actions: readonly ActionEntry[], looks: boolean, look: string): Layout {
  let top = headHeight;
  const bar = spread([
    { name: "play", label: "", width: row, sign: true },
    { name: "step", label: "", width: row, sign: true },
    { name: "reset", label: "", width: row, sign: true },
    { name: "slower", label: "", width: 96, sign: true },
    { name: "speed", label: "", width: 112 },
    { name: "faster", label: "", width: 96, sign: true },
    { name: "look", label: looks ? look : "one look", width: 0 },
  ], top);
  const speed = bar[4];
  const buttons = bar.filter((button) => button !== speed && (looks || button.name !== "look"));
  top += row + gap;
  for (let from = 0; from < actions.length; from += actionsInRow) {
    buttons.push(...spread(actions.slice(from, from + actionsInRow).map((action) => ({
      name: `action ${action.name}`, label: action.label, width: 0,
      badge: action.button === null ? "" : action.button.toUpperCase(), onBody: action.on === "body",
    })), top));
    top += row + gap;
  }
  buttons.push(...spread([
    { name: "turn left", label: "", width: row, sign: true },
    { name: "turn right", label: "", width: row, sign: true },
    { name: "go", label: "Go to ...", width: 0 },
    { name: "leave", label: "Leave VR", width: 0 },
  ], top));
  return { buttons, speed, height: top + row + edge };
}
