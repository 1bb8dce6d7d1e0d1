// SPDX-License-Identifier: Apache-2.0
import { afterEach, describe, expect, it, vi } from "vitest";
import { addressAfterMove, followerOf, whereIs } from "../src/net/gateway.ts";

const here = new URL("http://10.0.0.2:8081/?rooms=http%3A%2F%2F10.0.0.1%3A8080&room=one&style=rope");
const moved = "http://10.0.0.3:8081/?token=t&rooms=http%3A%2F%2F10.0.0.1%3A8080&room=one";

function answering(body: unknown, ok = true) {
  const asked = vi.fn(async () => ({ ok, text: async () => String(body), json: async () => body }));
  vi.stubGlobal("fetch", asked);
  return asked;
}

afterEach(() => vi.unstubAllGlobals());

describe("a page of a room", () => {
  it("stays while the room starts, and where the room still is", () => {
    expect(addressAfterMove(here, "", "Ada")).toBeNull();
    expect(addressAfterMove(here, "http://10.0.0.2:8081/?token=t", "Ada")).toBeNull();
  });

  it("takes what its address asked for and its user's name to where the room is now", () => {
    const there = new URL(addressAfterMove(here, moved, "Ada")!);
    expect(there.host).toBe("10.0.0.3:8081");
    expect(Object.fromEntries(there.searchParams)).toEqual({
      token: "t", rooms: "http://10.0.0.1:8080", room: "one", style: "rope", name: "Ada",
    });
  });

  it("asks the server of its link once at a time, and goes on when that does not answer", async () => {
    const asked = answering({ url: moved, state: "running", trouble: "" });
    const went: string[] = [];
    const lost = followerOf(here, "t", (url) => went.push(url))!;
    lost("Ada");
    lost("Ada");
    await vi.waitFor(() => expect(went).toHaveLength(1));
    expect(asked.mock.calls).toEqual([["http://10.0.0.1:8080/rooms/where?room=one&token=t", { cache: "no-store" }]]);
    vi.stubGlobal("fetch", async () => Promise.reject(new Error("down")));
    lost("Ada");
    await expect(whereIs("http://10.0.0.1:8080", "one", "t")).rejects.toThrow("does not answer");
    expect(went).toHaveLength(1);
  });

  it("of a world that does not move asks nobody", () => {
    expect(followerOf(new URL("http://127.0.0.1:8080/"), "t", () => undefined)).toBeNull();
  });

  it("tells why a link leads nowhere", async () => {
    answering("there is no such room\n", false);
    await expect(whereIs("http://10.0.0.1:8080", "one", "t")).rejects.toThrow("there is no such room");
  });
});
