// SPDX-License-Identifier: Apache-2.0
// The help: what the script offers, made from its own key bindings, then what the page offers.

import type { Page } from "../app/page.ts";
import { keyName, make } from "./dom.ts";
import type { Keys } from "./keys.ts";

const mouse: readonly (readonly [string, string])[] = [
  ["drag a body", "pulls it by a spring; the wheel, or shift and drag, moves it nearer or away"],
  ["click a body", "selects it: actions are about it until esc or a click on nothing"],
  ["double click", "or right click on a body: its actions"],
  ["drag nothing", "orbits; with shift, or with the middle button, moves sideways"],
  ["right drag", "looks around"],
  ["wheel", "nearer, farther"],
];

const touch: readonly (readonly [string, string])[] = [
  ["one finger", "on a body pulls it, on nothing orbits; several fingers can hold several bodies"],
  ["two fingers", "on nothing: move sideways, pinch to come nearer"],
  ["long press", "or double tap on a body: its actions"],
];

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
  root.append(make("h2", "", title), list);
}

/** Fills and opens the dialog. */
export function openHelp(dialog: HTMLDialogElement, page: Page, keys: Keys): void {
  dialog.replaceChildren();
  const header = make("header");
  header.append(make("h1", "", page.model.settings.title || "Iota"));
  const close = make("button", "", "×");
  close.type = "button";
  close.setAttribute("aria-label", "Close");
  close.addEventListener("click", () => dialog.close());
  header.append(close);
  dialog.append(header);
  addSection(dialog, "In this world", page.model.actions.map((action) => [
    action.key === "" ? action.label : keyCaps([action.key]), action.help || action.label,
  ]));
  if (matchMedia("(pointer: coarse)").matches) addSection(dialog, "Touch", touch);
  if (matchMedia("(any-hover: hover)").matches) addSection(dialog, "Mouse", mouse);
  const walking = ["w", "a", "s", "d", "q", "e"].filter((key) => keys.actionOf(key) === undefined);
  addSection(dialog, "Keys", [
    ...keys.bindings
      .map((binding) => ({ keys: binding.keys.filter((key) => keys.actionOf(key) === undefined), help: binding.help }))
      .filter((binding) => binding.keys.length > 0)
      .map((binding) => [keyCaps(binding.keys), binding.help] as const),
    [keyCaps(walking), "walk, down and up; with shift faster"],
  ]);
  dialog.showModal();
}
