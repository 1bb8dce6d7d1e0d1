// SPDX-License-Identifier: Apache-2.0
// Buttons of commands: those of the bar, and the script's in the strip and the menu.

import { isAllowed, isChoice, type Choice, type Command, type Entry, type ScriptCommand } from "../commands/command.ts";
import { keyName, make, makeSign } from "./dom.ts";

/** An element of the bar that shows the present state of an entry. */
export interface BarItem {
  readonly element: HTMLElement;
  /** Changes the element only where necessary. */
  refresh(): void;
}

export function makeBarItem(entry: Entry, refocus: () => void): BarItem {
  const item = isChoice(entry) ? makeSelect(entry, refocus) : makeButton(entry);
  item.element.id = entry.name.replaceAll(" ", "-");
  item.refresh();
  return item;
}

/** "Pause (space)"; or, for a user who may not, why. */
function tooltip(entry: Entry): string {
  if (!isAllowed(entry)) return `${entry.title()}: ${entry.refusal!()}`;
  const key = entry.keys?.at(0);
  return key === undefined ? entry.title() : `${entry.title()} (${keyName(key)})`;
}

/** Calls `write` with a value whenever it has changed. */
function onChange(read: () => string, write: (value: string) => void): () => void {
  let shown: string | null = null;
  return () => {
    const value = read();
    if (value === shown) return;
    shown = value;
    write(value);
  };
}

function makeButton(command: Command): BarItem {
  const button = make("button", command.sign === undefined ? "text" : "");
  button.type = "button";
  button.addEventListener("click", () => command.run());
  const face = command.sign === undefined ? writeLabel(button, command) : drawSign(button, command.sign);
  const title = onChange(() => tooltip(command), (text) => {
    button.title = text;
    button.setAttribute("aria-label", command.title());
  });
  return {
    element: button,
    refresh: () => {
      button.hidden = command.offered?.() === false;
      button.disabled = command.enabled?.() === false || !isAllowed(command);
      face();
      title();
    },
  };
}

function drawSign(button: HTMLButtonElement, sign: () => string): () => void {
  const picture = makeSign("");
  button.append(picture);
  return onChange(sign, (lines) => picture.firstElementChild!.setAttribute("d", lines));
}

function writeLabel(button: HTMLButtonElement, command: Command): () => void {
  return onChange(() => command.label?.() ?? command.title(), (label) => {
    button.textContent = label;
  });
}

function makeSelect(choice: Choice, refocus: () => void): BarItem {
  const select = make("select");
  for (const option of choice.options) select.append(new Option(option + choice.unit, option));
  select.setAttribute("aria-label", choice.title());
  select.addEventListener("change", () => {
    choice.choose(select.value);
    refocus();
  });
  const title = onChange(() => tooltip(choice), (text) => {
    select.title = text;
  });
  const value = onChange(() => choice.value(), (now) => {
    // A value that is not offered is not shown: the previous one stays.
    if (choice.options.includes(now)) select.value = now;
  });
  return {
    element: select,
    refresh: () => {
      select.disabled = !isAllowed(choice);
      title();
      if (document.activeElement !== select) value();
    },
  };
}

/** A button with the script's label and key, and a sign if its name has one, for `body`; default: the action's body. */
export function makeActionButton(command: ScriptCommand, after?: () => void, body?: number): HTMLButtonElement {
  const button = make("button", "action");
  button.type = "button";
  const title = make("span", "", command.title());
  button.append(title);
  void import("./signs.ts").then(({ signOf }) => {
    const sign = signOf(command.name.replace(/^action /, ""));
    if (sign !== undefined) title.before(makeSign(sign));
  });
  button.disabled = !isAllowed(command);
  button.title = command.refusal?.() || command.help || "";
  for (const key of command.keys ?? []) button.append(make("kbd", "", keyName(key)));
  button.addEventListener("click", () => {
    if (body === undefined) command.run();
    else command.runOn(body);
    after?.();
  });
  return button;
}
