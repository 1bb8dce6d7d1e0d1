// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { linkTo, peopleIn, tellTime, type Room } from "../src/rooms/rooms.ts";

const room: Room = {
  name: "one", source: "chain", title: "", time: 0, state: "running", trouble: "", people: [], port: 8081,
  tokens: { host: "h", guest: "g", viewer: "v" }, picture: "",
};
const local = { base: "", is_proxied: false, is_on_machines: false };
const lan = { base: "https://192.168.0.2", is_proxied: false, is_on_machines: false };
const proxied = { base: "https://worlds.example.org", is_proxied: true, is_on_machines: false };

describe("rooms", () => {
  it("are at a port of the machine that served the page", () => {
    expect(linkTo(room, "guest", local, new URL("http://localhost:8080/"), true)).toBe("http://localhost:8081/?token=g");
    expect(linkTo(room, "host", lan, new URL("http://127.0.0.1:8080/"), false)).toBe("http://127.0.0.1:8081/?token=h");
  });

  it("are told to others by an address that they can reach", () => {
    expect(linkTo(room, "viewer", lan, new URL("http://127.0.0.1:8080/"), true)).toBe("https://192.168.0.2:8081/?token=v");
    expect(linkTo(room, "guest", proxied, new URL("http://127.0.0.1:8080/"), true)).toBe("https://worlds.example.org/8081/?token=g");
  });

  it("behind a proxy are entered by it only if the page came that way", () => {
    expect(linkTo(room, "host", proxied, new URL("https://worlds.example.org/"), false)).toBe("https://worlds.example.org/8081/?token=h");
    expect(linkTo(room, "host", proxied, new URL("http://127.0.0.1:8080/"), false)).toBe("http://127.0.0.1:8081/?token=h");
  });

  it("on several machines have links that do not change when they move", () => {
    const moving = { ...local, is_on_machines: true };
    expect(linkTo(room, "guest", moving, new URL("http://10.0.0.1:8080/"), true)).toBe("http://10.0.0.1:8080/enter.html?token=g&room=one");
    const behind = { ...proxied, is_on_machines: true };
    expect(linkTo(room, "guest", behind, new URL("http://10.0.0.1:8080/"), true)).toBe("https://worlds.example.org/enter.html?token=g&room=one");
  });

  it("name who is there", () => {
    const people = (...names: string[]) => peopleIn({ ...room, people: names.map((name) => ({ name, role: name === "Ben" ? "guest" : "host" })) });
    expect(people()).toBe("");
    expect(people("Ada")).toBe("Ada");
    expect(people("Ada", "Ben", "")).toBe("Ada, Ben (guest) and somebody");
    expect(people("a", "b", "c", "d", "e", "f")).toBe("a, b, c, d and 2 more");
  });

  it("tell the time of their world in the unit that fits", () => {
    expect([0, 59.9, 60, 3599, 7300].map(tellTime)).toEqual(["0\u00A0s", "59\u00A0s", "1\u00A0min", "59\u00A0min", "2\u00A0h"]);
  });
});
