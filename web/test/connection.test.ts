// SPDX-License-Identifier: Apache-2.0
// The page's socket, against a made-up one and a made-up clock.

import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { Connection, type LinkState } from "../src/net/connection.ts";
import { encodeServerMessage, Role, SENT_AWAY_CLOSE_CODE } from "../src/protocol/generated.ts";

class Socket {
  static readonly OPEN = 1;
  static readonly made: Socket[] = [];
  binaryType = "";
  readyState = 0;
  closed = false;
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: unknown }) => void) | null = null;
  onclose: ((event: { code: number }) => void) | null = null;

  constructor() {
    Socket.made.push(this);
  }

  send(): void {}

  close(): void {
    this.closed = true;
  }

  open(): void {
    this.readyState = Socket.OPEN;
    this.onopen!();
  }
}

/** How a socket ends without a word. */
const torn = { code: 1006 };

let states: LinkState[];
let connection: Connection;
const asked = vi.fn(async () => ({ ok: true }));

beforeEach(() => {
  vi.useFakeTimers();
  Socket.made.length = 0;
  asked.mockClear();
  states = [];
  vi.stubGlobal("WebSocket", Socket);
  vi.stubGlobal("fetch", asked);
  vi.stubGlobal("window", { addEventListener() {}, setInterval, clearInterval, setTimeout, clearTimeout });
  vi.stubGlobal("document", { addEventListener() {}, visibilityState: "visible" });
  connection = new Connection("ws://here", { world: "", role: Role.actor, name: "" }, {
    message() {}, poses() {}, state: (state) => states.push(state),
  });
  connection.open();
});

afterEach(() => {
  connection.close();
  vi.restoreAllMocks();
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

it("gives up a connection that does not come about, and tries again", () => {
  vi.advanceTimersByTime(5000);
  expect(Socket.made).toHaveLength(1);
  vi.advanceTimersByTime(10_000);
  expect(Socket.made.length).toBeGreaterThan(1);
  expect(Socket.made[0].closed).toBe(true);
  expect(states[0]).toBe("lost");
  expect(asked).not.toHaveBeenCalled();
});

it("gives up a connection that falls silent, and tries again", () => {
  Socket.made[0].open();
  vi.advanceTimersByTime(15_000);
  expect(Socket.made.length).toBeGreaterThan(1);
  expect(states[0]).toBe("lost");
});

it("keeps a connection while the page was busy for long", () => {
  Socket.made[0].open();
  vi.spyOn(performance, "now").mockReturnValue(performance.now() + 60_000);
  vi.advanceTimersByTime(2000);
  Socket.made[0].onmessage!({ data: "" });
  vi.advanceTimersByTime(5000);
  expect(Socket.made).toHaveLength(1);
  expect(states).toEqual([]);
});

it("keeps a connection as long as anything comes, also nothing but answers to its pings", () => {
  Socket.made[0].open();
  for (let seconds = 0; seconds < 60; seconds += 4) {
    Socket.made[0].onmessage!({ data: encodeServerMessage({ type: "pong", clientTime: seconds, step: 0 }) });
    vi.advanceTimersByTime(4000);
  }
  expect(Socket.made).toHaveLength(1);
  expect(states).toEqual([]);
});

it("asks why where the server closes before it has begun", () => {
  Socket.made[0].onclose!(torn);
  expect(asked).toHaveBeenCalledOnce();
  expect(states[0]).toBe("lost");
});

it("tries again ever more rarely, but at least each five seconds", () => {
  for (let tries = 0; tries < 20; tries++) {
    Socket.made.at(-1)!.onclose!(torn);
    vi.advanceTimersByTime(5000);
    expect(Socket.made).toHaveLength(tries + 2);
  }
  Socket.made.at(-1)!.onclose!(torn);
  vi.advanceTimersByTime(2000);
  expect(Socket.made, "not as often as at the begin").toHaveLength(21);
});

it("tries again at once after a connection that was good, however rarely it tried before", () => {
  for (let tries = 0; tries < 20; tries++) {
    Socket.made.at(-1)!.onclose!(torn);
    vi.advanceTimersByTime(5000);
  }
  const socket = Socket.made.at(-1)!;
  socket.open();
  socket.onmessage!({ data: encodeServerMessage({ type: "welcome", version: 1, world: "", client: 3 }) });
  expect([connection.clientId, connection.connected]).toEqual([3, true]);
  socket.onclose!(torn);
  vi.advanceTimersByTime(500);
  expect(Socket.made).toHaveLength(22);
});

it("stays away when the host has sent it away, also after the network comes back", () => {
  Socket.made[0].open();
  Socket.made[0].onclose!({ code: SENT_AWAY_CLOSE_CODE });
  connection.retryNow();
  vi.advanceTimersByTime(600_000);
  expect(Socket.made).toHaveLength(1);
});

it("comes back after any other end", () => {
  for (const code of [1000, 1001, 1006, 1008, 1011]) {
    Socket.made.at(-1)!.onclose!({ code });
    vi.advanceTimersByTime(5000);
  }
  expect(Socket.made).toHaveLength(6);
});
