// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import type { Command, ScriptCommand } from "../src/commands/command.ts";
import { Commands } from "../src/commands/commands.ts";

function command(name: string, keys: readonly string[], log: string[] = []): Command {
  return { name, keys, title: () => name, run: () => log.push(name) };
}

function action(name: string, key: string): ScriptCommand {
  return { ...command(name, [key]), onBody: true, button: null, runOn: () => {} };
}

describe("the list of commands", () => {
  it("runs a command by its name or its key", () => {
    const log: string[] = [];
    const commands = new Commands();
    commands.add(command("step", ["."], log));
    commands.run("step");
    commands.ofKey(".")?.run();
    expect(log).toEqual(["step", "step"]);
    expect(commands.ofKey("x")).toBeUndefined();
    expect(() => commands.run("fly")).toThrow(/no command "fly"/);
  });

  it("lets the script's keys win, in either case", () => {
    const commands = new Commands();
    commands.add(command("reset", ["r"]), command("style", ["l"]));
    commands.script = [action("roll", "r"), action("burn", "B")];
    expect(commands.ofKey("r")?.name).toBe("roll");
    expect(commands.ofKey("R")?.name).toBe("roll");
    expect(commands.ofKey("b")?.name).toBe("burn");
    expect(commands.ofKey("l")?.name).toBe("style");
  });

  it("refuses a second command of the same name or on the same key", () => {
    const commands = new Commands();
    commands.add(command("step", ["."]));
    expect(() => commands.add(command("step", []))).toThrow(/"step" already/);
    expect(() => commands.add(command("dot", ["."]))).toThrow(/key "\." has a command already/);
  });

  it("knows which commands have a button at a place, and tells of each change", () => {
    let changes = 0;
    const commands = new Commands();
    commands.onChange(() => changes++);
    commands.add({ ...command("play", []), places: ["bar", "panel"] }, command("home", []));
    commands.script = [];
    expect(commands.at("bar").map((entry) => entry.name)).toEqual(["play"]);
    expect(commands.at("panel foot")).toEqual([]);
    expect(changes).toBe(2);
  });
});
