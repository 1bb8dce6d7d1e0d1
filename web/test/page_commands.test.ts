// SPDX-License-Identifier: Apache-2.0
// What each role finds in the list of commands.

import { readFileSync } from "node:fs";
import { PerspectiveCamera, Scene, type WebGLRenderer } from "three";
import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { isAllowed, isChoice, type Entry } from "../src/commands/command.ts";
import { Events } from "../src/page/events.ts";
import { pageCommands, scriptCommands } from "../src/page/page_commands.ts";
import type { PageParts } from "../src/page/page_parts.ts";
import { Session } from "../src/page/session.ts";
import { ActionTarget, ControllerButton, Role, type ClientMessage } from "../src/protocol/generated.ts";
import { TestWorld } from "./test_world.ts";

const forHosts = ["play", "step", "reset", "slower", "speed", "faster"];

let parts: PageParts;
let told: string[];
let sent: ClientMessage["type"][];

beforeEach(() => {
  vi.stubGlobal("window", { addEventListener() {} });
  vi.stubGlobal("document", { addEventListener() {} });
  told = [];
  sent = [];
  const { world } = new TestWorld();
  const events = new Events();
  events.add({ notice: ({ title }) => void told.push(title) });
  const viewer = {
    renderer: {} as WebGLRenderer, scene: new Scene(), camera: new PerspectiveCamera(), presenting: false,
    timing: { frameMs: 0, scriptMs: 0, renderMs: 0, decodeMs: 0 }, invalidate: () => {},
  };
  const session = new Session("", { world: "", role: Role.actor, name: "" }, world, viewer, events);
  vi.spyOn(session.connection, "send").mockImplementation(({ type }) => sent.push(type) > 0);
  parts = { world, session, viewer, events, selection: { actionBody: -1, actionBodies: [], selected: -1 } } as unknown as PageParts;
});

afterEach(() => vi.unstubAllGlobals());

/** The commands of a page whose client, 0, has this role. */
function commandsOf(role: Role): Entry[] {
  const others = [Role.viewer, Role.host].map((each, index) => ({ client: 7 + index, name: "", selected: { slot: 0, generation: 0 }, role: each }));
  parts.world.take({ type: "clients", clients: [...others, { ...others[0], client: 0, role }] });
  const actions = [{ name: "push", label: "Push", key: "b", button: ControllerButton.a, help: "", on: ActionTarget.world }];
  return [...pageCommands(parts), ...scriptCommands(actions, parts)];
}

/** Runs those of some names. */
function run(commands: readonly Entry[], names: readonly string[]): void {
  for (const name of names) {
    const entry = commands.find((each) => each.name === name)!;
    if (!isChoice(entry)) entry.run();
  }
}

const refused = (commands: readonly Entry[]) => commands.filter((entry) => !isAllowed(entry)).map(({ name }) => name);

it("no button has the id of an element of the page", () => {
  const page = readFileSync(new URL("../index.html", import.meta.url), "utf8");
  const ids = [...page.matchAll(/ id="([^"]+)"/g)].map(([, each]) => each);
  const names = commandsOf(Role.host).map(({ name }) => name.replaceAll(" ", "-"));
  expect(ids).toContain("view");
  expect(names.filter((name) => ids.includes(name))).toEqual([]);
});

it("a host may run them all", () => {
  const commands = commandsOf(Role.host);
  expect(refused(commands)).toEqual([]);
  run(commands, ["play", "reset", "action push"]);
  expect(sent).toEqual(["control", "control", "action"]);
});

it("a guest may not pause, step, reset or change the speed, and is told so instead of the server", () => {
  const commands = commandsOf(Role.actor);
  expect(refused(commands)).toEqual(forHosts);
  run(commands, [...forHosts, "action push"]);
  expect(sent).toEqual(["action"]);
  expect(told).toEqual(forHosts.slice(1).map(() => "Only the host does that"));
});

it("a viewer may neither do that nor run an action of the script", () => {
  const commands = commandsOf(Role.viewer);
  expect(refused(commands)).toEqual([...forHosts, "action push"]);
  run(commands, ["reset", "action push"]);
  const action = commands.find(({ name }) => name === "action push")!;
  if ("runOn" in action) (action.runOn as (body: number) => void)(3);
  expect(sent).toEqual([]);
  expect(told).toEqual(Array(3).fill("You only watch this world"));
});

it("a page that has not been told of its role shows all: the server decides", () => {
  expect(isAllowed(pageCommands(parts).find(({ name }) => name === "play")!)).toBe(true);
});
