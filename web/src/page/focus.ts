// SPDX-License-Identifier: Apache-2.0
// Keys that a focused control needs itself; all others are the script's and the page's.

/** Keys that move a slider. */
const sliderKeys = /^(Arrow|Home|End|Page)/;
/** Keys that take another one of several options. */
const radioKeys = /^(Arrow| )/;

const owners: ((key: string) => boolean)[] = [];

/** Keys for which `owns` is true are neither the script's nor the page's: those of an emulated headset, while it presents. */
export function ownKeys(owns: (key: string) => boolean): void {
  owners.push(owns);
}

/** Whether the focused control, an open dialog or an owner keeps the key. */
export function keepsKey({ target, key }: KeyboardEvent): boolean {
  if (owners.some((owns) => owns(key))) return true;
  if (!(target instanceof HTMLElement)) return false;
  if (target.closest("dialog[open]") !== null) return true;
  if (target instanceof HTMLInputElement && target.type === "range") return sliderKeys.test(key);
  if (target.matches("[type=radio]")) return radioKeys.test(key);
  if (target.matches("button, summary, [type=checkbox]")) return key === " " || key === "Enter";
  return target.matches("input, select, textarea") && key !== "Escape";
}
