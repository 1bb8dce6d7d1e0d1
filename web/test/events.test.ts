// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Events } from "../src/page/events.ts";

beforeEach(() => { vi.useFakeTimers({ toFake: ["performance"] }); });
afterEach(() => { vi.useRealTimers(); });

it("breaks and joins cause cards while they are few, and none where a mechanism makes them all the time", () => {
  const events = new Events();
  const told: string[] = [];
  events.add({ effect: (kind) => told.push(kind) });
  for (let count = 0; count < 40; count++) {
    vi.advanceTimersByTime(100);
    events.effect("join", [0, 0, 0]);
  }
  expect(told.length).toBe(6);
  vi.advanceTimersByTime(2500);
  events.effect("break", [0, 0, 0]);
  expect(told.at(-1)).toBe("break");
});
