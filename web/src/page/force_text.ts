// SPDX-License-Identifier: Apache-2.0
// A force in words for users.

/** From which force on a unit is used, and its size. */
const units = [[1e6, 1e6, "MN"], [1e3, 1e3, "kN"], [0.1, 1, "N"], [1e-3, 1e-3, "mN"], [1e-6, 1e-6, "\u00b5N"]] as const;

/** With two digits: "8.2 N", "320 N", "2.1 kN". */
export function forceText(newtons: number): string {
  const rounded = Number(newtons.toPrecision(2));
  const [, size, unit] = units.find(([least]) => rounded >= least) ?? [0, 1e-9, "nN"];
  const value = rounded / size;
  return `${value.toFixed(value < 0.95 ? 2 : value < 9.95 ? 1 : 0)} ${unit}`;
}
