// SPDX-License-Identifier: Apache-2.0
// Keys that a focused control needs itself; all others are the script's and the page's.

/** Keys that move a slider. */
const sliderKeys = /^(Arrow|Home|End|Page)/;

/** Whether the focused control, or an open dialog, keeps the key. */
export function keepsKey({ target, key }: KeyboardEvent): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target.closest("dialog[open]") !== null) return true;
  if (target instanceof HTMLInputElement && target.type === "range") return sliderKeys.test(key);
  if (target.matches("button, summary, [type=checkbox]")) return key === " " || key === "Enter";
  return target.matches("input, select, textarea") && key !== "Escape";
}
