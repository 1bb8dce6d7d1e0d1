// SPDX-License-Identifier: Apache-2.0
// Signs of what scripts usually offer, by its name: actions ("break"), and options of a choice ("box"). Lines of a 24 x 24 square, as
// the path of an SVG.

const signs: Readonly<Record<string, string>> = {
  axle: "M12 4a8 8 0 1 0 .01 0M12 10a2 2 0 1 0 .01 0",
  ball: "M12 4a8 8 0 1 0 .01 0M8 11a4 4 0 0 1 3-3",
  box: "M12 3l8 4.5v9L12 21l-8-4.5v-9zM4 7.5l8 4.5 8-4.5M12 12v9",
  break: "M10 7H7a5 5 0 0 0 0 10h3M14 7h3a5 5 0 0 1 0 10h-3M12 3v3M12 18v3",
  chain: "M12 2a3 4 0 1 0 .01 0M12 14a3 4 0 1 0 .01 0M12 8v8",
  combine: "M12 8.4a5 5 0 1 0 0 7.2 5 5 0 1 0 0-7.2",
  copy: "M9 9h11v11H9zM5 15H4V4h11v1",
  delete: "M5 7h14M10 7V4h4v3M7 7l1 13h8l1-13",
  join: "M10 7H7a5 5 0 0 0 0 10h3M14 7h3a5 5 0 0 1 0 10h-3M8 12h8",
  measure: "M4 7v10M20 7v10M4 12h16",
  nail: "M8 4h8M12 4v12M10 16h4l-2 5z",
  nothing: "M6 4l13 8-6 1-2 6z",
  particle: "M12 9a3 3 0 1 0 .01 0",
  redo: "M15 5l5 5-5 5M20 10H9a5 5 0 0 0 0 10h3",
  rewind: "M12 6l-8 6 8 6zM20 6l-8 6 8 6z",
  rod: "M4 17L17 4l3 3L7 20z",
  rope: "M6 4c9 3-3 7 6 8s-3 5 6 8",
  spring: "M12 2v2L8 6l8 3-8 3 8 3-8 3 4 2v2",
  tie: "M6 15a3 3 0 1 0 .01 0M18 3a3 3 0 1 0 .01 0M8.5 15.5l7-7",
  undo: "M9 5l-5 5 5 5M4 10h11a5 5 0 0 1 0 10h-3",
};

/** Undefined: it has none. */
export function signOf(name: string): string | undefined {
  return Object.hasOwn(signs, name) ? signs[name] : undefined;
}
