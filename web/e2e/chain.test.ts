// SPDX-License-Identifier: Apache-2.0
// The page against a real world: move, drag, break, rejoin, two tabs, garbage.

import { afterAll, beforeAll, beforeEach, describe, expect, it } from "vitest";
import { Browser, distance, small, type Tab } from "./browser.ts";
import { freePort, probe, WorldServer } from "./server.ts";

let server: WorldServer;
let browser: Browser;
let tab: Tab;

beforeAll(async () => {
  server = await WorldServer.start([probe], await freePort());
  browser = await Browser.start(small);
  tab = await browser.open(server.url);
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

beforeEach(async () => {
  await tab.page.mouse.up();
  await tab.page.keyboard.press("Escape");
  await tab.pause(false);
  await tab.reset();
});

/** The state in Python, once it has caught up with the page. */
async function inPython(articulates: number): Promise<void> {
  await expect.poll(() => server.report?.articulates).toBe(articulates);
}

type Quat = readonly number[];

function dot(a: Quat, b: Quat): number {
  return a.reduce((sum, value, axis) => sum + value * b[axis], 0);
}

/** Angle between two rotations, rad. */
function angle(a: Quat, b: Quat): number {
  return 2 * Math.acos(Math.min(1, Math.abs(dot(a, b))));
}

/** Rotation of b about its own x axis relative to a, rad. */
function twist(a: Quat, b: Quat): number {
  const x = a[3] * b[0] - a[0] * b[3] - a[1] * b[2] + a[2] * b[1];
  return 2 * Math.atan2(Math.sign(dot(a, b)) * x, Math.abs(dot(a, b)));
}

describe("the page of a chain", () => {
  it("shows all links, moving, and no error", async () => {
    const bodies = await tab.page.evaluate(() => iota.bodies());
    expect(bodies).toHaveLength(24);
    const lowest = bodies.at(-1) ?? 0;
    const before = await tab.position(lowest);
    await tab.until("the lowest link has moved", ([id, was]) => {
      const now = iota.bodyPosition(id);
      return Math.hypot(...now.map((value, axis) => value - was[axis])) > 0.02;
    }, [lowest, before] as const);
    expect(await tab.articulates()).toBe(1);
    expect(await tab.page.title()).toBe("chain · Iota");
    expect(tab.complaints).toEqual([]);
  });

  it("switches styles live and keeps links interlocked, each turned against its neighbors", async () => {
    const first = await tab.page.evaluate(() => iota.style);
    const other = await tab.page.evaluate((style) => iota.styles.find((name) => name !== style), first);
    await tab.press("#style");
    await tab.until("it is in the other style", (wanted) => iota.style === wanted, other);
    await tab.page.keyboard.press("l");
    await tab.until("it is in the first style again", (wanted) => iota.style === wanted, first);
  });

  it("turns no link suddenly and keeps neighbors untwisted, or links would not stay interlocked", async () => {
    await tab.freeze();
    const rotations = () => tab.page.evaluate(() => iota.bodies().map((body) => iota.bodyRotation(body)));
    let before = await rotations();
    for (let step = 0; step < 6; step++) {
      const made = await tab.page.evaluate(() => iota.step);
      await tab.page.keyboard.press(".");
      await tab.until("one step was made", (was) => iota.step === was + 1, made);
      await tab.freeze();
      const now = await rotations();
      for (const [body, q] of now.entries()) expect(angle(before[body], q)).toBeLessThan(0.8);
      before = now;
    }
    for (let body = 1; body < before.length; body++) expect(Math.abs(twist(before[body - 1], before[body]))).toBeLessThan(0.8);
  });

  it("lets a link be dragged by mouse: it follows, is outlined and selected, and swings back", async () => {
    const body = 15;
    await tab.page.mouse.move(...(await tab.slack(await tab.take(body), 0.3)), { steps: 6 });
    await tab.until("the server knows the hold", () => iota.holds().length === 1);
    await tab.until("the link has come to the hand", (id) => {
      const [hold] = iota.holds();
      const at = iota.bodyPosition(id);
      return Math.hypot(...at.map((value, axis) => value - hold.target[axis])) < 0.15;
    }, body);
    expect(await tab.page.evaluate(() => iota.selected)).toBe(body);
    await expect.poll(() => tab.page.textContent("#hint")).toMatch(/\d N$/);
    await expect.poll(() => server.report?.held).toBe(1);
    await tab.picture("drag");
    const held = await tab.position(body);
    await tab.page.mouse.up();
    await tab.until("the hold is gone", () => iota.holds().length === 0 && iota.held === -1);
    await tab.until("the link has swung back", ([id, at]) => {
      const now = iota.bodyPosition(id as number);
      return Math.hypot(...now.map((value, axis) => value - (at as number[])[axis])) > 0.25;
    }, [body, held] as const);
  });

  it("breaks with b and rejoins with c, on the page and in Python", async () => {
    await tab.click(12);
    await tab.page.keyboard.press("b");
    await tab.until("there are two parts", () => new Set(iota.articulates().values()).size === 2);
    await inPython(2);
    const parts = await tab.page.evaluate(() => {
      const articulate = iota.articulates();
      return iota.bodies().map((body) => articulate.get(body) === articulate.get(12));
    });
    expect(parts.filter(Boolean)).toHaveLength(12);
    await tab.goOn(0.3);
    await tab.pause(true);  // what has fallen to the ground is joined by other ends
    await tab.picture("broken");
    await tab.pause(false);
    await tab.page.keyboard.press("c");
    await tab.until("there is one part", () => new Set(iota.articulates().values()).size === 1);
    await inPython(1);
    // They are one part while their ends are still closing, when there is no hinge to break yet.
    await tab.until("the ends have met", () => {
      const [above, below] = [iota.bodyPosition(11), iota.bodyPosition(12)];
      return Math.hypot(...above.map((value, axis) => value - below[axis])) < 0.101;
    });
  });

  it("tells where the time of a frame goes", async () => {
    await tab.pause(false);
    await tab.page.keyboard.press("i");
    const parts = "forces.+analyze.+factor.+solve.+integrate.+";
    await expect.poll(() => tab.page.textContent("#meter")).toMatch(new RegExp(`steps\\d+\\.\\d\\d ms {2}\\d+ %${parts}network.+page script.+drawing\\d`));
    // In one reading: the figures change twice a second.
    const steps = () => tab.page.evaluate(() => ["steps", "step-part"].map((kind) => (
      [...document.querySelectorAll(`#meter dd.${kind}`)].map((line) => parseFloat(line.textContent!))
    )));
    await expect.poll(async () => (await steps())[0][0]).toBeGreaterThan(0);
    const [[whole], ofSteps] = await steps();
    expect(Math.abs(whole - ofSteps.reduce((sum, ms) => sum + ms, 0))).toBeLessThan(0.02 * ofSteps.length);
    const shares = () => tab.page.evaluate(() => [...document.querySelectorAll<HTMLElement>("#meter .split i")].map((part) => parseFloat(part.style.width)));
    await expect.poll(async () => {
      const [drawing, script, , ...steps] = (await shares()).reverse();
      return Math.min(steps.reduce((sum, share) => sum + share, 0), script, drawing);
    }).toBeGreaterThan(0);
    expect((await shares()).reduce((sum, share) => sum + share, 0)).toBeLessThan(100.1);
    await tab.picture("profile");
    await tab.pause(true);
    await expect.poll(async () => (await shares())[0]).toBe(0);
    await tab.pause(false);
    await tab.page.keyboard.press("i");
    await expect.poll(() => tab.page.textContent("#meter")).not.toContain("drawing");
    await tab.until("nobody is told of the parts any more", () => iota.page.world.costs.length === 0);
  });

  it("selects several links by a rectangle, breaks all of them at once, and takes that back at once", async () => {
    await tab.freeze();
    const places = await Promise.all([6, 9].map((link) => tab.place(link)));
    const [left, right] = [Math.min(...places.map(([x]) => x)) - 30, Math.max(...places.map(([x]) => x)) + 30];
    const [top, bottom] = [Math.min(...places.map(([, y]) => y)) - 1, Math.max(...places.map(([, y]) => y)) + 1];
    await tab.page.keyboard.down("Control");
    await tab.page.mouse.move(left, top);
    await tab.page.mouse.down();
    await tab.page.mouse.move(right, bottom, { steps: 4 });
    await tab.picture("band");
    await tab.page.mouse.up();
    await tab.page.keyboard.up("Control");
    await expect.poll(() => tab.page.evaluate(() => [...iota.page.selection.actionBodies].sort((a, b) => a - b))).toEqual([6, 7, 8, 9]);
    await tab.pause(false);
    await tab.page.keyboard.press("b");
    await tab.until("each of them is off", () => new Set(iota.articulates().values()).size === 5);
    await tab.page.keyboard.press("u");
    await tab.until("all are on again", () => new Set(iota.articulates().values()).size === 1);
    await tab.page.keyboard.press("Escape");
    await tab.until("nothing is selected", () => iota.page.selection.several.size === 0);
  });

  it("tells the user of a part of the page that cannot be fetched", async () => {
    const other = await browser.open(server.url);
    try {
      await other.page.route("**/help-*.js", (route) => route.abort());
      const failed = other.page.waitForEvent("requestfailed");
      await other.page.keyboard.press("?");
      expect((await failed).url()).toContain("help-");
      await expect.poll(() => other.page.textContent("#cards")).toMatch(/A part of the page did not come.+help-.+Reload the page/);
      await other.page.unroute("**/help-*.js");
    } finally {
      await other.page.close();
    }
  });

  it("pauses and goes on with the space key", async () => {
    for (const paused of [true, false]) {
      await tab.page.keyboard.press(" ");
      await tab.until(`paused: ${paused}`, (wanted) => iota.paused === wanted, paused);
    }
  });

  it("has a button, a key and a line in the help for a command that is added to its list", async () => {
    await tab.page.evaluate(() => {
      const added = { name: "toll the bell", help: "rings once", keys: ["F8"], places: ["bar", "panel"] as const, title: () => "Bell" };
      iota.page.commands.add({ ...added, run: () => void (document.body.dataset["rung"] = `${Number(document.body.dataset["rung"] ?? 0) + 1}`) });
    });
    const rung = () => tab.page.evaluate(() => document.body.dataset["rung"]);
    await tab.press("#toll-the-bell");
    expect(await rung()).toBe("1");
    expect(await tab.page.getAttribute("#toll-the-bell", "title")).toBe("Bell (F8)");
    await tab.page.keyboard.press("F8");
    expect(await rung()).toBe("2");
    await tab.page.keyboard.press("?");
    await expect.poll(() => tab.page.textContent("#help[open]")).toMatch(/F8 *rings once/);
    await tab.page.keyboard.press("Escape");
  });

  it("offers the same by buttons once something is selected, and in the help", async () => {
    await tab.click(12);
    await tab.press("#strip .action:has-text('break')");
    await tab.until("there are two parts", () => new Set(iota.articulates().values()).size === 2);
    await tab.press("#strip .action:has-text('join')");
    await tab.until("there is one part", () => new Set(iota.articulates().values()).size === 1);
    await tab.page.keyboard.press("?");
    const help = (await tab.page.locator("#help[open]").textContent()) ?? "";
    expect(help).toContain("separates the held or selected body");
    expect(help).toContain("orbits");
    await tab.page.keyboard.press("Escape");
    await tab.page.keyboard.press("Escape");
    await tab.until("nothing is selected", () => iota.selected === -1);
    await expect.poll(() => tab.page.locator("#strip .action").count()).toBe(0);
  });

  it("orbits, walks, pauses, steps and slows down", async () => {
    await tab.until("nothing lies over the canvas there", () => document.elementFromPoint(600, 60)?.id === "view");
    const before = await tab.eyeAtRest();
    await tab.page.mouse.move(600, 60);
    await tab.page.mouse.down();
    await tab.page.mouse.move(500, 80, { steps: 4 });
    await tab.page.mouse.up();
    const orbited = await tab.eyeAtRest();
    expect(distance(before, orbited)).toBeGreaterThan(0.3);
    await tab.page.keyboard.down("w");
    await tab.until("the camera has walked", (from) => (
      Math.hypot(...iota.page.viewer.camera.position.toArray().map((value, axis) => value - from[axis])) > 0.1), orbited);
    await tab.page.keyboard.up("w");
    await tab.page.keyboard.press("Home");
    await tab.pause(true);
    const step = await tab.page.evaluate(() => iota.step);
    await tab.page.keyboard.press(".");
    await tab.until("one step was made", (was) => iota.step === was + 1, step);
    await tab.pause(false);
    await tab.page.selectOption("#speed", "0.25");
    await tab.until("the world is slow", () => Math.abs(iota.page.world.speed - 0.25) < 1e-6);
    await tab.page.selectOption("#speed", "1");
    await tab.until("the world is at full speed", () => iota.page.world.speed === 1);
  });

  it("goes on undisturbed by garbage in either direction", async () => {
    const outcome = await tab.page.evaluate(async () => {
      const url = new URL(`ws${location.search}`, location.href);
      url.protocol = "ws:";
      const answers: string[] = [];
      for (const bytes of [[], [255, 1, 2], [3, 0], [1, 73, 79, 84, 65], Array.from({ length: 70_000 }, (_, i) => i % 256)]) {
        answers.push(await new Promise<string>((resolve) => {
          const socket = new WebSocket(url);
          socket.onopen = () => socket.send(new Uint8Array(bytes));
          socket.onclose = () => resolve("closed");
          socket.onmessage = () => resolve("answered");
          setTimeout(() => resolve("silent"), 15_000);
        }));
      }
      const refused = await new Promise<string>((resolve) => {
        const socket = new WebSocket(`ws://${location.host}/ws?token=wrong`);
        socket.onopen = () => resolve("opened");
        socket.onclose = () => resolve("refused");
      });
      return { answers, refused };
    });
    expect(outcome.refused).toBe("refused");
    expect(outcome.answers).not.toContain("silent");
    const before = await tab.page.evaluate(() => {
      const socket = (iota.page.session.connection as unknown as { socket_: WebSocket }).socket_;
      for (const bytes of [[], [68], [68, 1, 2, 3], [66, 255, 255, 255, 255], [200, 0]]) {
        socket.dispatchEvent(new MessageEvent("message", { data: new Uint8Array(bytes).buffer }));
      }
      socket.dispatchEvent(new MessageEvent("message", { data: "text" }));
      return iota.step;
    });
    await tab.until("the world goes on", (was) => iota.step > was + 10 && iota.connected, before);
    expect(await tab.page.evaluate(() => iota.badFrames)).toBe(6);
  });
});

describe("two tabs on one world", () => {
  let other: Tab;

  beforeAll(async () => {
    other = await browser.open(server.url);
  });

  afterAll(async () => {
    await other?.page.close();
  });

  it("agree on the world and have their own selections", async () => {
    await tab.click(8);
    await other.click(16);
    expect(await tab.page.evaluate(() => iota.selected)).toBe(8);
    const ids = [await tab.page.evaluate(() => iota.clientId), await other.page.evaluate(() => iota.clientId)];
    expect(ids[0]).not.toBe(ids[1]);
    await tab.until("each sees the other's selection", (id) => iota.clients().some((client) => client.client === id && client.selected === 16), ids[1]);
    await tab.freeze();
    await other.freeze();
    const bodies = await tab.page.evaluate(() => iota.bodies());
    for (const body of [bodies[0], bodies[11], bodies[23]]) {
      await expect.poll(async () => distance(await tab.position(body), await other.position(body))).toBeLessThan(1e-3);
    }
    await tab.picture("two_tabs");
  });

  it("see each other break and rejoin", async () => {
    await other.click(10);
    await other.page.keyboard.press("b");
    for (const each of [tab, other]) await each.until("there are two parts", () => new Set(iota.articulates().values()).size === 2);
    await inPython(2);
    await other.page.keyboard.press("c");
    for (const each of [tab, other]) await each.until("there is one part", () => new Set(iota.articulates().values()).size === 1);
  });

  it("hold the same link with forces that add", async () => {
    const body = 18;
    const at = await tab.freezeInView(body);
    for (const each of [tab, other]) {
      await each.freeze();
      await each.page.mouse.move(...(await each.place(body)));
      await each.page.mouse.down();
      await each.until("the link is held", (id) => iota.held === id, body);
    }
    await tab.page.mouse.move(at[0] + 100, at[1], { steps: 4 });
    await other.page.mouse.move(at[0] - 100, at[1], { steps: 4 });
    await tab.pause(false);
    await tab.until("two hands hold it", (id) => iota.holds().filter((hold) => hold.body === id).length === 2, body);
    await tab.goOn(1.5);
    await tab.picture("two_hands");
    const between = await tab.page.evaluate((id) => {
      const holds = iota.holds();
      const along = holds[1].target.map((value, axis) => value - holds[0].target[axis]);
      const from = iota.bodyPosition(id).map((value, axis) => value - holds[0].target[axis]);
      const dot = (a: number[], b: number[]) => a.reduce((sum, value, axis) => sum + value * b[axis], 0);
      return { share: dot(from, along) / dot(along, along), forces: holds.map((hold) => hold.force) };
    }, body);
    // Pulled apart by equal springs (and its own weight) it stays between; a single spring would pull it to its end.
    expect(between.share).toBeGreaterThan(0.2);
    expect(between.share).toBeLessThan(0.8);
    for (const force of between.forces) expect(force).toBeGreaterThan(1);
    await tab.page.mouse.up();
    await other.until("the other hand has it alone", (id) => {
      const holds = iota.holds();
      const position = iota.bodyPosition(id);
      return holds.length === 1 && Math.hypot(...position.map((value, axis) => value - holds[0].target[axis])) < 0.6;  // as near as the chain lets it come
    }, body);
    await other.page.mouse.up();
  });
});
