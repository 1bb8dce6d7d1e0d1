// SPDX-License-Identifier: Apache-2.0
// The help: commands of the script, then those of the page, both from the list of commands.

import { isAllowed, type Entry } from "../commands/command.ts";
import type { Commands } from "../commands/commands.ts";
import { keyName, make } from "./dom.ts";
import { walkKeyNames } from "./keys.ts";

const mouse: readonly (readonly [string, string])[] = [
  ["drag a body", "pulls it by a spring; the wheel, or shift and drag, moves it nearer or away"],
  ["click a body", "selects it for actions, until esc or a click on empty space"],
  ["double click", "or right click on a body: its actions"],
  ["drag empty space", "orbits; with shift, or with the middle button, moves sideways"],
  ["right drag", "looks around"],
  ["wheel", "nearer, farther"],
];

const touch: readonly (readonly [string, string])[] = [
  ["one finger", "on a body pulls it, on empty space orbits; several fingers can hold several bodies"],
  ["two fingers", "on empty space: move sideways, pinch to come nearer"],
  ["long press", "or double tap on a body: its actions"],
];

/** For who only watches. */
const watching: readonly (readonly [string, string])[] = [["click a body", "selects it, and shows its name"], ["drag", "orbits; with shift, or with the middle button, moves sideways"]];
const watchingTouch: readonly (readonly [string, string])[] = [["one finger", "orbits"], touch[1]];

function addRows(list: HTMLElement, rows: Iterable<readonly [Node | string, string]>): void {
  for (const [what, help] of rows) {
    const term = make("dt");
    term.append(what);
    list.append(term, make("dd", "", help));
  }
}

function keyCaps(keys: readonly string[]): HTMLElement {
  const caps = make("span");
  keys.forEach((key, index) => {
    if (index > 0) caps.append(" ");
    caps.append(make("kbd", "", keyName(key)));
  });
  return caps;
}

function addSection(root: HTMLElement, title: string, rows: readonly (readonly [Node | string, string])[]): void {
  if (rows.length === 0) return;
  const list = make("dl");
  addRows(list, rows);
  const section = make("section");
  section.append(make("h2", "", title), list);
  root.append(section);
}

/** Lines of the help for commands; those with the same text share one. Keys for which `hidden` is true are left out. */
function rowsOf(entries: readonly Entry[], hidden: (key: string) => boolean): (readonly [Node | string, string])[] {
  const keysOf = new Map<string, string[]>();
  for (const { help, keys } of entries) {
    if (help === undefined || keys === undefined) continue;
    const line = keysOf.get(help) ?? [];
    line.push(...keys.filter((key) => !hidden(key)));
    keysOf.set(help, line);
  }
  return [...keysOf].filter(([, keys]) => keys.length > 0).map(([help, keys]) => [keyCaps(keys), help] as const);
}

/** Page commands whose key belongs to the script here: names their buttons. */
function displaced(commands: Commands, taken: (key: string) => boolean): (readonly [Node | string, string])[] {
  return commands.own
    .filter((entry) => entry.keys?.some(taken) === true && entry.keys.every((key) => taken(key)) && entry.offered?.() !== false && isAllowed(entry))
    .map((entry) => [
      entry.title(),
      `${(entry.keys ?? []).map(keyName).join(" ")} is this world's key here${entry.places?.includes("bar") === true ? ": press the button in the bar" : ""}`,
    ] as const);
}

/** Fills and opens the dialog. heard: keys to which the script listens without an action; watches: its reader only watches. Commands that
 * the reader may not run are left out. */
export function openHelp(dialog: HTMLDialogElement, title: string, commands: Commands, heard: readonly string[], watches = false): void {
  dialog.replaceChildren();
  const header = make("header");
  header.append(make("h1", "", title));
  const close = make("button", "", "×");
  close.type = "button";
  close.setAttribute("aria-label", "Close");
  close.addEventListener("click", () => dialog.close());
  header.append(close);
  const columns = make("div", "columns");
  dialog.append(header, columns);
  addSection(columns, "In this world", commands.script.filter(isAllowed).map((command) => [
    command.keys === undefined || command.keys.length === 0 ? command.title() : keyCaps(command.keys), command.help || command.title(),
  ]));
  if (matchMedia("(pointer: coarse)").matches) addSection(columns, "Touch", watches ? watchingTouch : touch);
  if (matchMedia("(any-hover: hover)").matches) addSection(columns, "Mouse", watches ? [...watching, ...mouse.slice(4)] : mouse);
  const taken = (key: string) => heard.includes(key) || commands.scriptOfKey(key) !== undefined;
  const keyboard = matchMedia("(any-hover: hover)").matches;
  if (keyboard) addSection(columns, "Keys", [
    ...rowsOf(commands.own.filter((entry) => entry.offered?.() !== false && isAllowed(entry)), taken),
    ...displaced(commands, taken),
    [keyCaps(walkKeyNames.filter((key) => !taken(key))), "walk, down and up; with shift faster"],
  ]);
  dialog.showModal();
}
