// SPDX-License-Identifier: Apache-2.0
// The name of this browser's user, kept for the next page.

const key = "iota.name";
const longest = 40;

/** The name in the address, or else the kept one; empty without either. */
export function ownName(asked: string | null): string {
  try {
    return (asked ?? localStorage.getItem(key) ?? "").slice(0, longest);
  } catch {
    return (asked ?? "").slice(0, longest); // a browser that keeps nothing
  }
}

export function keepName(name: string): void {
  try {
    localStorage.setItem(key, name.slice(0, longest));
  } catch {
    // It is asked for again.
  }
}
