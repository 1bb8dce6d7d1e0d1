// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, it, vi } from "vitest";
import type { World } from "../src/world/world.ts";

afterEach(() => void vi.unstubAllGlobals());

it("keys of an emulated headset are not told to the script while it presents", async () => {
  const listeners = new Map<string, (event: unknown) => void>();
  vi.stubGlobal("window", { addEventListener: (type: string, act: (event: unknown) => void) => listeners.set(type, act) });
  vi.stubGlobal("HTMLElement", class {});
  const { ownKeys } = await import("../src/page/focus.ts");
  const { Reports } = await import("../src/page/reports.ts");
  const sent: unknown[] = [];
  const parts = {
    world: { listens: { keys: ["x", "k"], clicks: false, hovers: false, moves: false } } as unknown as World, session: { send: (message: unknown) => sent.push(message) },
    gestures: {}, viewer: {}, events: { add: () => undefined },
  };
  new Reports(parts as never);
  let presents = true;
  ownKeys((key) => presents && key === "x");
  const press = (key: string) => {
    const event = { key, target: null, preventDefault: () => undefined, stopImmediatePropagation: () => undefined };
    listeners.get("keydown")!(event);
    listeners.get("keyup")!(event);
  };
  press("x");
  press("k");
  expect(sent).toEqual([{ type: "key", key: "k", down: true }, { type: "key", key: "k", down: false }]);
  presents = false;
  press("x");
  expect(sent).toHaveLength(4);
});

it.each([["text", "k", true], ["radio", "k", false], ["radio", "ArrowLeft", true], ["radio", " ", true], ["radio", "Enter", false]])("an input of type %s in focus keeps the key '%s': %s", async (type, key, keeps) => {
  class Input {
    readonly type = type;
    closest = () => null;
    matches = (selector: string) => selector.split(", ").some((one) => one === "input" || one === `[type=${type}]`);
  }
  vi.stubGlobal("HTMLElement", Input);
  vi.stubGlobal("HTMLInputElement", Input);
  const { keepsKey } = await import("../src/page/focus.ts");
  expect(keepsKey({ target: new Input(), key } as never)).toBe(keeps);
});
