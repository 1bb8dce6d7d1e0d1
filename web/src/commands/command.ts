// SPDX-License-Identifier: Apache-2.0
// What a user can ask for. Each command is described once; the bar, the keys, the help and the wrist panel read the same list.

/** Where a command has a button, besides its keys and its line in the help. */
export type Place = "bar" | "panel" | "panel foot";

interface Described {
  /** Unique, in lower case. The element in the bar has it as its id, with dashes for spaces. */
  readonly name: string;
  /** What it does, for the help; commands with the same text share one line. */
  readonly help?: string;
  /** As `KeyboardEvent.key` names them. */
  readonly keys?: readonly string[];
  readonly places?: readonly Place[];
  /** Its name for a person, as it stands now: "Pause", then "Play". */
  title(): string;
  /** Drawn on its button: lines of a 24 x 24 square, as the path of an SVG. Without it the button shows `label`. */
  sign?(): string;
  /** Written on its button where there is no sign; by default its title. */
  label?(): string;
  /** Whether its button is shown now; by default always. */
  offered?(): boolean;
  /** Whether it can be run now; by default always. */
  enabled?(): boolean;
  /** Whether it is switched on or in progress; its button is highlighted. */
  active?(): boolean;
  /** A narrower button on the wrist panel. */
  readonly narrow?: boolean;
}

export interface Command extends Described {
  /** A key that is held down runs it again and again. */
  readonly repeats?: boolean;
  /** `key`: that was pressed; none where a button was. */
  run(key?: string): void;
}

/** One of several values: a list in the bar, a reading on the wrist panel. */
export interface Choice extends Described {
  readonly options: readonly string[];
  /** Written after each value. */
  readonly unit: string;
  /** The current value; it need not be one of the options. */
  value(): string;
  choose(option: string): void;
}

/** An action of the script, about the world or about a body (see Selection.actionBody). */
export interface ScriptCommand extends Command {
  readonly onBody: boolean;
  /** Controller face button that runs it. */
  readonly button: "a" | "b" | null;
  /** About another body than the usual one. */
  runOn(body: number): void;
}

export type Entry = Command | Choice;

export function isChoice(entry: Entry): entry is Choice {
  return "options" in entry;
}
