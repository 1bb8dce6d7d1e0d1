// SPDX-License-Identifier: Apache-2.0
// The registry of commands. Those of the page, the overlay and the headset are added once; the script's change with the
// world.

import { isChoice, type Command, type Entry, type Place, type ScriptCommand } from "./command.ts";

export class Commands {
  private readonly own_: Entry[] = [];
  private script_: readonly ScriptCommand[] = [];
  private readonly listeners_: (() => void)[] = [];

  /** The page's own, in the order of the bar and the help. */
  get own(): readonly Entry[] {
    return this.own_;
  }

  /** The script's actions, in its order. */
  get script(): readonly ScriptCommand[] {
    return this.script_;
  }

  set script(commands: readonly ScriptCommand[]) {
    this.script_ = commands;
    this.tell_();
  }

  /** Calls `listener` after each change of either list. */
  onChange(listener: () => void): void {
    this.listeners_.push(listener);
  }

  /** Throws if a name or key is in use: one of two commands on a key would be hidden. */
  add(...entries: readonly Entry[]): void {
    for (const entry of entries) {
      if (this.own_.some((other) => other.name === entry.name)) throw new Error(`there is a command "${entry.name}" already`);
      const taken = entry.keys?.find((key) => this.ownOfKey_(key) !== undefined);
      if (taken !== undefined) throw new Error(`the key "${taken}" has a command already, "${entry.name}" cannot have it`);
      this.own_.push(entry);
    }
    this.tell_();
  }

  /** The page's commands with a button at a place. */
  at(place: Place): readonly Entry[] {
    return this.own_.filter((entry) => entry.places?.includes(place) === true);
  }

  /** Runs a command of the page by its name. Throws when there is none. */
  run(name: string): void {
    const command = this.own_.find((entry) => entry.name === name);
    if (command === undefined || isChoice(command)) throw new Error(`there is no command "${name}"`);
    command.run();
  }

  /** The command of a key. The script's keys have priority over the page's; letter case is ignored for them. */
  ofKey(key: string): Command | undefined {
    return this.scriptOfKey(key) ?? this.ownOfKey_(key);
  }

  /** The script's command of a key. */
  scriptOfKey(key: string): ScriptCommand | undefined {
    const lower = key.toLowerCase();
    return this.script_.find((command) => command.keys?.includes(key))
      ?? this.script_.find((command) => command.keys?.some((each) => each.toLowerCase() === lower));
  }

  private tell_(): void {
    for (const listener of this.listeners_) listener();
  }

  private ownOfKey_(key: string): Command | undefined {
    for (const entry of this.own_) if (!isChoice(entry) && entry.keys?.includes(key) === true) return entry;
    return undefined;
  }
}
