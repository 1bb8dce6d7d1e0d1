// SPDX-License-Identifier: Apache-2.0
// A command of a user. Each is described once; the bar, the keys, the help and the wrist panel read the same list.

/** Places of a command's button, besides its keys and its line in the help. */
export type Place = "bar" | "panel" | "panel foot";

interface Described {
  /** Unique, in lower case. With dashes for spaces, it is the id of its element in the bar. */
  readonly name: string;
  /** Description for the help; commands with the same text share one line. */
  readonly help?: string;
  /** As `KeyboardEvent.key` names them. */
  readonly keys?: readonly string[];
  readonly places?: readonly Place[];
  /** Its present name for users: "Pause", then "Play". */
  title(): string;
  /** Drawn on its button: lines of a 24 x 24 square, as the path of an SVG. Without it the button shows `label`. */
  sign?(): string;
  /** Text of its button without a sign; by default its title. */
  label?(): string;
  /** Whether its button is shown now; by default always. */
  offered?(): boolean;
  /** Whether it can be run now; by default always. */
  enabled?(): boolean;
  /** Why the user of this page may never run it, a sentence; empty: they may, which is the default. Running it then only tells so. */
  refusal?(): string;
  /** Whether it is switched on or in progress; its button is highlighted. */
  active?(): boolean;
  /** A narrower button on the wrist panel. */
  readonly narrow?: boolean;
}

export interface Command extends Described {
  /** Repeated while its key is held down. */
  readonly repeats?: boolean;
  /** `key`: the pressed key; none for a button. */
  run(key?: string): void;
}

/** One of several values: a list in the bar, a reading on the wrist panel. */
export interface Choice extends Described {
  readonly options: readonly string[];
  /** Suffix of each value. */
  readonly unit: string;
  /** Takes the room that its row on the wrist panel has left. */
  readonly wide?: boolean;
  /** The current value; it need not be one of the options. */
  value(): string;
  choose(option: string): void;
}

/** An action of the script, about the world or about a body (see Selection.actionBody). */
export interface ScriptCommand extends Command {
  readonly onBody: boolean;
  /** Controller face button that runs it. */
  readonly button: "a" | "b" | null;
  /** Runs it on a given body. */
  runOn(body: number): void;
}

export type Entry = Command | Choice;

/** Whether the user of this page may run it. */
export function isAllowed(entry: Entry): boolean {
  return (entry.refusal?.() ?? "") === "";
}

export function isChoice(entry: Entry): entry is Choice {
  return "options" in entry;
}
