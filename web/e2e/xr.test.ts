// SPDX-License-Identifier: Apache-2.0
// An emulated Quest 3 on a real world: enters, drags by ray and by pinch, breaks and rejoins by face
// buttons and by the panel, turns, teleports, leaves.

import { afterAll, beforeAll, beforeEach, describe, expect, it } from "vitest";
import { Browser, distance, runsAll, small } from "./browser.ts";
import { HeadsetTab } from "./headset.ts";
import { freePort, probe, WorldServer } from "./server.ts";

let server: WorldServer;
let browser: Browser;
let me: HeadsetTab;

/** The cost of software rendering is per pixel of both eyes; only the pictures need a high resolution. */
const size = { width: 400, height: 224 };
const pictureSize = { width: 1200, height: 600 };
const rightRest = [0.2, 1.32, -0.38] as const;
const leftRest = [-0.2, 1.32, -0.38] as const;
const link = 14;

beforeAll(async () => {
  server = await WorldServer.start([probe], await freePort());
  browser = await Browser.start(size);
  me = await HeadsetTab.open(browser, server.url);
  await me.enter();
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
});

/** Restores the whole chain at rest: earlier tests leave it broken, folded or swinging. */
async function calm(): Promise<void> {
  await me.tab.pause(false);
  await me.tab.reset();
  await me.tab.until("the chain hangs still", () => iota.step > 60 && iota.bodies().every((id) => {
    const [x, , z] = iota.bodyPosition(id);
    return Math.hypot(x, z) < 0.12;
  }));
}

beforeEach(async () => {
  await me.point("right", rightRest, [0.2, 1.32, -2]);
  await me.point("left", leftRest, [-0.2, 1.32, -2]);
});

async function untilParts(count: number): Promise<void> {
  await me.tab.until(`there are ${count} parts`, (wanted) => new Set(iota.articulates().values()).size === wanted, count);
  await expect.poll(() => server.report?.articulates).toBe(count);
}

/** Points the right ray at a link of a world that stands still. */
async function pointAtLink(body: number): Promise<void> {
  await me.tab.freeze();
  await me.pointAtBody("right", rightRest, body);
  await me.tab.until(`the ray is on link ${body}`, (id) => iotaXR!.inputs().some((input) => input.hovered === id), body);
}

async function holdIsStrong(): Promise<void> {
  await me.tab.until("the hold pulls", () => iota.holds().length === 1 && iota.holds()[0].force > 1);
}

async function swingsBack(body: number, from: readonly number[]): Promise<void> {
  await me.tab.until("the hold is gone", () => iota.holds().length === 0 && iota.held === -1);
  await me.tab.until("the link has swung back", ([id, at]) => {
    const now = iota.bodyPosition(id as number);
    return Math.hypot(...now.map((value, axis) => value - (at as number[])[axis])) > 0.1;
  }, [body, from] as const);
}

describe("an emulated headset", () => {
  beforeAll(calm);

  it("draws two different views and stands before the chain, facing it", async () => {
    const seen = await me.tab.page.evaluate(() => {
      const { page } = iota;
      const eyes = page.viewer.renderer.xr.getCamera().cameras;
      const target = page.navigation.home.pivot;
      const head = iotaXR!.head();
      const ahead = page.viewer.camera.getWorldDirection(page.viewer.camera.position.clone());
      const [dx, dz] = [target[0] - head[0], target[2] - head[2]];
      return {
        views: eyes.map((eye) => [eye.viewport!.x, eye.viewport!.width]),
        apart: Math.hypot(...[12, 13, 14].map((at) => eyes[0].matrixWorld.elements[at] - eyes[1].matrixWorld.elements[at])),
        away: Math.hypot(dx, dz),
        facing: (ahead.x * dx + ahead.z * dz) / Math.hypot(dx, dz),
        ground: page.world.ground, feet: iotaXR!.rig().position[1],
      };
    });
    expect(seen.views).toEqual([[0, size.width / 2], [size.width / 2, size.width / 2]]);
    expect(seen.apart).toBeCloseTo(0.063, 3);
    expect(seen.away).toBeGreaterThan(2);
    expect(seen.away).toBeLessThan(3.5);
    expect(seen.facing).toBeGreaterThan(0.99);
    expect(seen.feet).toBe(seen.ground);
    expect(me.tab.complaints).toEqual([]);
  });

  it("takes hold by ray and trigger, drags, pushes with the stick, and lets go", async () => {
    await pointAtLink(link);
    await me.button("right", "trigger", 1);
    await me.tab.until("the link is held", (id) => iota.held === id, link);
    await me.tab.pause(false);
    const [x, y, z] = await me.bodyInSpace(link);
    await me.point("right", rightRest, [x + 0.3, y + 0.35, z]);
    await holdIsStrong();
    await me.tab.until("the link has come to the hand", (id) => {
      const [hold] = iota.holds();
      return Math.hypot(...iota.bodyPosition(id).map((value, axis) => value - hold.target[axis])) < 0.15;
    }, link);
    const before = await me.tab.page.evaluate(() => iota.holds()[0].target);
    await me.stick("right", 0, -1);
    await me.tab.until("the stick pushes it away", (was) => {
      const hold = iota.holds().at(0);
      return hold !== undefined && Math.hypot(...hold.target.map((value, axis) => value - was[axis])) > 0.1;
    }, before);
    await me.stick("right", 0, 0);
    const held = await me.tab.position(link);
    await me.button("right", "trigger", 0);
    await swingsBack(link, held);
    expect(await me.tab.page.evaluate(() => iota.selected)).toBe(link);
  });

  it("breaks with B and rejoins with A the body on the ray", async () => {
    await pointAtLink(link);
    await me.tab.pause(false);
    await me.click("right", "b-button");
    await untilParts(2);
    await me.click("right", "a-button");
    await untilParts(1);
    await me.click("right", "a-button");
    await me.tab.until("the headset says so too", () => iotaXR!.cards().includes("Nothing to join"));
  });

  it("breaks and rejoins by the panel at the left wrist", async () => {
    await me.tab.page.evaluate((id) => iota.select(id), link);
    await me.tab.pause(false);
    await me.pointAtPanel("right", [0.12, 1.38, -0.2], "action break");
    await me.click("right", "trigger");
    await untilParts(2);
    await me.pointAtPanel("right", [0.12, 1.38, -0.2], "action join");
    await me.click("right", "trigger");
    await untilParts(1);
    await me.pointAtPanel("right", [0.12, 1.38, -0.2], "play");
    await me.click("right", "trigger");
    await me.tab.until("the panel has paused the world", () => iota.paused);
    await me.look(0, 0);
  });

  it("has its panel only while the user looks at the back of the left hand", async () => {
    const isThere = () => me.tab.page.evaluate(() => iotaXR!.headset.panel.board.mesh.visible);
    await me.point("left", [-0.2, 1.36, -0.38], [-0.2, 1.36, -2]);
    await me.look(0, 0);
    await me.tab.until("a hand that points ahead has none", () => !iotaXR!.headset.panel.board.mesh.visible);
    await me.look(0.4, -0.3);
    await me.frames(20);
    expect(await isThere(), "a hand that points ahead has none for who looks at it").toBe(false);
    await me.lookAtWrist();
    expect(await isThere()).toBe(true);
    await me.look(-0.6, 0.1);
    await me.tab.until("it is gone for who looks away", () => !iotaXR!.headset.panel.board.mesh.visible);
    await me.look(0, 0);
  });

  it("selects several by the panel and the trigger", async () => {
    await me.tab.page.evaluate(() => iota.select(-1));
    const press = async () => {
      await me.pointAtPanel("right", [0.12, 1.38, -0.2], "select several");
      await me.click("right", "trigger");
      await me.look(0, 0);
    };
    await press();
    for (const body of [8, link]) {
      await pointAtLink(body);
      await me.click("right", "trigger");
    }
    await me.tab.until("both are selected", (both) => JSON.stringify(iota.page.selection.actionBodies) === JSON.stringify(both), [8, link]);
    await press();
    await pointAtLink(link);
    await me.click("right", "trigger");
    await pointAtLink(10);
    await me.click("right", "trigger");
    await me.tab.until("one is", () => JSON.stringify(iota.page.selection.actionBodies) === "[10]");
  });

  it("turns by 30 degrees about the head with the stick", async () => {
    const before = await me.tab.page.evaluate(() => ({ rig: iotaXR!.rig(), head: iotaXR!.head() }));
    await me.stick("right", 1, 0);
    await me.stick("right", 1, 0);
    await me.stick("right", 0, 0);
    const after = await me.tab.page.evaluate(() => ({ rig: iotaXR!.rig(), head: iotaXR!.head() }));
    expect(((before.rig.yaw - after.rig.yaw) * 180) / Math.PI).toBeCloseTo(30, 3);
    expect(distance(before.head, after.head)).toBeLessThan(1e-4);
  });

  it("turns smoothly on request, with a narrowed view meanwhile", async () => {
    await me.look(0.3, -0.25);
    for (const shown of ["45°", "Smooth"]) {
      await me.pointAtPanel("right", [0.12, 1.38, -0.2], "turn by");
      await me.click("right", "trigger");
      await me.tab.until(`turns are ${shown}`, (wanted) => iotaXR!.headset.panel.layout.buttons.some(({ command }) => command.title() === wanted), shown);
    }
    await me.point("right", rightRest, [0.2, 1.32, -2]);
    const yaw = () => me.tab.page.evaluate(() => (iotaXR!.rig().yaw * 180) / Math.PI);
    const before = await yaw();
    await me.stick("right", 1, 0);
    await me.tab.until("it turns, with a narrowed view", (was) => was - (iotaXR!.rig().yaw * 180) / Math.PI > 0.5 && iotaXR!.headset.vignette.mesh.visible, before);
    await me.stick("right", 0, 0);
    await me.tab.until("the view is wide again", () => !iotaXR!.headset.vignette.mesh.visible);
    const rest = await yaw();
    await me.frames(3);
    expect(await yaw()).toBe(rest);
    await me.pointAtPanel("right", [0.12, 1.38, -0.2], "turn by");
    await me.click("right", "trigger");
    await me.look(0, 0);
  });

  it("faces where the stick says at the end of a teleport", async () => {
    await me.point("left", leftRest, [-0.2, 1.0, -1.5]);
    const before = await me.tab.page.evaluate(() => iotaXR!.rig().yaw);
    await me.stick("left", 0, -1);
    await me.stick("left", -1, 0);
    await me.frames(2);
    await me.stick("left", 0, 0);
    const after = await me.tab.page.evaluate(() => iotaXR!.rig().yaw);
    expect(((after - before) * 180) / Math.PI).toBeCloseTo(90, 1);
  });

  it("shows an arrow to the scene while that is out of view, and only then", async () => {
    const untilShown = (shown: boolean) => me.tab.until(`the arrow is ${shown ? "" : "not "}shown`, (wanted) => iota.page.viewer.room.getObjectByName("way home")!.visible === wanted, shown);
    // A teleport may have led so near that nothing of the scene is out of view.
    await me.tab.page.evaluate(() => iota.page.commands.run("home in vr"));
    for (const [yaw, pitch] of [[2.2, 0], [-1.8, 0.3]]) {
      await me.look(0, 0);
      await untilShown(false);
      await me.look(yaw, pitch);
      await untilShown(true);
      const arrow = await me.tab.page.evaluate(() => {
        const { room, stage, renderer } = iota.page.viewer;
        const { position, quaternion } = room.getObjectByName("way home")!;
        const points = position.clone().set(0, 0, 1).applyQuaternion(quaternion);
        const way = room.worldToLocal(stage.middle.clone()).sub(position).normalize();
        const seen = room.localToWorld(position.clone()).project(renderer.xr.getCamera().cameras[0]);
        return { cosine: points.dot(way), seen: Math.max(Math.abs(seen.x), Math.abs(seen.y)) };
      });
      expect(arrow.cosine).toBeGreaterThan(0.97);
      expect(arrow.seen, "1 is the edge of the view").toBeLessThan(1);
    }
    await me.picture("xr_way_home");
    await me.look(0, 0);
    await untilShown(false);
  });

  it("sits and stands, and goes home", async () => {
    await me.look(0.3, -0.25);
    const press = async (name: string) => {
      await me.pointAtPanel("right", [0.12, 1.38, -0.2], name);
      await me.click("right", "trigger");
      await me.frames(2);
      return me.tab.page.evaluate(() => ({ head: iotaXR!.head(), ground: iota.page.world.ground!, rig: iotaXR!.rig() }));
    };
    await me.tab.page.evaluate(() => { iotaXR!.device!.position.y = 1.2; });
    await me.frames(2);
    const seated = await press("seated");
    expect(seated.head[1] - seated.ground).toBeCloseTo(1.6, 2);
    const table = await press("size");
    expect(table.rig.scale).toBeGreaterThan(1.5);
    expect(table.head[1] - table.ground).toBeLessThan(1.6 * table.rig.scale);
    const again = await press("size");
    expect(again.rig.scale).toBe(1);
    await me.tab.page.evaluate(() => { iotaXR!.device!.position.y = 1.6; });
    await press("seated");
    const home = await press("home in vr");
    expect(home.head[1] - home.ground).toBeCloseTo(1.6, 2);
    const away = await me.tab.page.evaluate(() => {
      const { pivot } = iota.page.navigation.home;
      const [x, , z] = iotaXR!.head();
      return Math.hypot(x - pivot[0], z - pivot[2]);
    });
    expect(away).toBeGreaterThan(2);
    expect(away).toBeLessThan(3.5);
    await me.look(0, 0);
  });

  it("moves, turns and scales the world between both hands", async () => {
    await me.point("left", [-0.2, 1.3, -0.3], [-0.6, 3, -0.4]);
    await me.point("right", [0.2, 1.3, -0.3], [0.6, 3, -0.4]);
    for (const side of ["left", "right"] as const) await me.button(side, "squeeze", 1);
    await me.tab.until("both hold the world", () => iotaXR!.headset.locomotion.grabbing);
    const held = await me.tab.page.evaluate(() => iotaXR!.headset.inputs.map((input) => [...input.pointer.origin]));
    await me.point("left", [-0.3, 1.2, -0.1], [-0.7, 3, -0.2]);
    await me.point("right", [0.4, 1.2, -0.5], [0.8, 3, -0.6]);
    const now = await me.tab.page.evaluate(() => ({ rig: iotaXR!.rig(), hands: iotaXR!.headset.inputs.map((input) => [...input.pointer.origin]) }));
    expect(now.rig.scale).toBeCloseTo(0.4 / Math.hypot(0.7, 0.4), 2);
    now.hands.forEach((hand, index) => expect(distance(hand, held[index])).toBeLessThan(2e-3));
    await me.picture("xr-world-grab");
    for (const side of ["left", "right"] as const) await me.button(side, "squeeze", 0);
    expect(await me.tab.page.evaluate(() => iota.holds().length)).toBe(0);
    await me.tab.page.evaluate(() => iota.page.commands.run("home in vr"));
    expect((await me.tab.page.evaluate(() => iotaXR!.rig())).scale).toBe(1);
  });

  it("teleports along the arc when the stick is let go", async () => {
    await me.point("left", leftRest, [-0.2, 1.0, -1.5]);
    await me.stick("left", 0, -1);
    await me.tab.until("the arc lands", () => iotaXR!.landing() !== null);
    const landing = await me.tab.page.evaluate(() => iotaXR!.landing());
    const before = await me.tab.page.evaluate(() => iotaXR!.head());
    await me.stick("left", 0, 0);
    const after = await me.tab.page.evaluate(() => iotaXR!.head());
    expect(distance(before, after)).toBeGreaterThan(0.5);
    expect(distance([after[0], after[2]], [landing![0], landing![2]])).toBeLessThan(1e-3);
    expect(after[1]).toBeCloseTo(before[1], 4);
  });
});

describe("bare hands in an emulated headset", () => {
  beforeAll(async () => {
    await me.tab.page.evaluate(() => iotaXR!.device!.recenter());
    await me.useHands(true);
    await calm();
  });

  it("take hold by a pinch near a link, drag it and let go", async () => {
    await me.tab.freeze();
    const [x, y, z] = await me.bodyInSpace(link);
    // The pinch of this hand happens about here from its ray's origin.
    const tip = await me.tab.page.evaluate(() => {
      const input = iotaXR!.headset.inputs.find((each) => each.pointer.name === "right hand")!;
      return iotaXR!.toSpace([...input.pointer.tip]);
    });
    const reach = [x - (tip[0] - rightRest[0]), y - (tip[1] - rightRest[1]), z - (tip[2] - rightRest[2])] as const;
    await me.point("right", reach, [reach[0], reach[1], reach[2] - 1]);
    await me.tab.until("the hand is near the link", () => iotaXR!.inputs().some((input) => input.near));
    const body = await me.tab.page.evaluate(() => iotaXR!.inputs().find((input) => input.near)!.hovered);
    await me.pinch("right", 1);
    await me.tab.until("the link is held", (id) => iota.held === id, body);
    await me.tab.pause(false);
    // Inwards and up: a link that swings wide cannot follow any further outwards.
    const inwards = Math.sign((await me.bodyInSpace(0))[0] - x) * 0.25;
    const moved = [reach[0] + inwards, reach[1] + 0.3, reach[2]] as const;
    await me.point("right", moved, [moved[0], moved[1], moved[2] - 1]);
    await holdIsStrong();
    await me.tab.until("the link has come to the hand", (id) => {
      const [hold] = iota.holds();
      return Math.hypot(...iota.bodyPosition(id).map((value, axis) => value - hold.target[axis])) < 0.15;
    }, body);
    const held = await me.tab.position(body);
    await me.pinch("right", 0);
    await swingsBack(body, held);
  });

  it("press the panel with a fingertip, once for each touch", async () => {
    await me.tab.page.evaluate((id) => iota.select(id), link);
    await me.lookAtWrist();
    const press = async (name: string) => {
      await me.tab.until(`the panel has a button ${name}`, (wanted) => iotaXR!.panelButton(wanted), name);
      const path = await me.tab.page.evaluate((wanted) => {
        const { at, facing } = iotaXR!.panelButton(wanted)!;
        const input = iotaXR!.headset.inputs.find((each) => each.pointer.name === "right hand")!;
        const finger = iotaXR!.toSpace([...input.finger]);
        const { position } = iotaXR!.device!.hands.right!;
        const offset = [finger[0] - position.x, finger[1] - position.y, finger[2] - position.z];
        return [0.06, 0.025, -0.01].map((out) => at.map((value, axis) => value + out * facing[axis] - offset[axis]) as [number, number, number]);
      }, name);
      for (const at of path) await me.point("right", at, [at[0], at[1], at[2] - 1]);
      await me.frames(1);
      await me.point("right", rightRest, [0.2, 1.32, -2]);
    };
    await press("action break");
    await untilParts(2);
    await press("action join");
    await untilParts(1);
  });

  it("teleport by the panel's button, the arc and a pinch", async () => {
    await me.pointAtPanel("right", [0.1, 1.38, -0.15], "go");
    await me.pinch("right", 1);
    await me.pinch("right", 0);
    await me.point("right", rightRest, [0.3, 0.9, -1.6]);
    await me.tab.until("the arc lands", () => iotaXR!.landing());
    const before = await me.tab.page.evaluate(() => iotaXR!.head());
    const landing = await me.tab.page.evaluate(() => iotaXR!.landing()!);
    await me.pinch("right", 1);
    await me.pinch("right", 0);
    const after = await me.tab.page.evaluate(() => iotaXR!.head());
    expect(distance(before, after)).toBeGreaterThan(0.5);
    expect(distance([after[0], after[2]], [landing[0], landing[2]])).toBeLessThan(1e-3);
  });
});

describe("leaving and coming back", () => {
  beforeAll(calm);

  it("brings the flat page back as it was", async () => {
    await me.useHands(false);
    await me.tab.page.evaluate(() => iotaXR!.leave());
    await me.tab.until("the session is over", () => !iotaXR!.presenting);
    await me.tab.until("the canvas lies under the bar again", () => document.getElementById("view")?.parentElement === document.body
      && !!(document.getElementById("view")!.compareDocumentPosition(document.getElementById("cards")!) & Node.DOCUMENT_POSITION_FOLLOWING) && iota.page.viewer.camera.aspect > 1.5);
    const flat = await me.tab.page.evaluate(() => ({
      rig: iotaXR!.rig(), pointers: iota.page.gestures.pointers.map((pointer) => pointer.name),
      size: [iota.page.viewer.renderer.domElement.clientWidth, iota.page.viewer.renderer.domElement.clientHeight],
    }));
    expect(flat).toEqual({ rig: { position: [0, 0, 0], yaw: 0, scale: 1 }, pointers: ["mouse"], size: [size.width, size.height] });
    await me.tab.page.setViewportSize(small);
    await me.tab.click(link);
    expect(me.tab.complaints).toEqual([]);
  });

  it("lets the mouse be a hand of the emulated headset", async () => {
    await me.tab.page.setViewportSize(size);
    await me.enter();
    await me.look(0.1, -0.1);
    await me.tab.freeze();
    // Again and again, as the eye may still be turning at the first time.
    await expect.poll(async () => {
      const [x, y] = await me.tab.page.evaluate((id) => {
        const eye = iota.page.viewer.renderer.xr.getCamera().cameras[0];
        const point = iota.page.viewer.camera.position.clone().set(...iota.bodyPosition(id)).project(eye);
        return [((point.x + 1) / 4) * innerWidth, ((1 - point.y) / 2) * innerHeight];
      }, link);
      await me.tab.page.mouse.move(x + 20, y);
      await me.tab.page.mouse.move(x, y);
      return me.tab.page.evaluate(async () => {
        for (let frame = 0; frame < 3; ++frame) await new Promise((done) => requestAnimationFrame(done));
        return iotaXR!.inputs().some((input) => input.name === "right" && input.hovered >= 0);
      });
    }, { message: "the mouse's hand points at something" }).toBe(true);
    await me.tab.page.mouse.down();
    await me.tab.until("the mouse's hand holds something", () => iotaXR!.inputs().some((input) => input.name === "right" && input.held >= 0));
    await me.tab.page.mouse.up();
    await me.tab.until("and lets go", () => iota.held === -1);
    await me.tab.page.keyboard.press("Escape");
    await me.tab.until("the session is over", () => !iotaXR!.presenting);
  });
});

describe("the user's own surroundings", () => {
  it("are behind the world on request", async () => {
    await me.tab.press("#enter-ar");
    await me.tab.until("the session runs", () => iotaXR!.presenting && iota.page.viewer.stage.passthrough && !iota.page.viewer.stage.ground.visible);
    const seen = await me.tab.page.evaluate(() => {
      const { viewer } = iota.page;
      return { mode: viewer.renderer.xr.getEnvironmentBlendMode(), ground: viewer.stage.ground.visible };
    });
    expect(seen).toEqual({ mode: "alpha-blend", ground: false });
    await me.tab.page.evaluate(() => iotaXR!.leave());
    await me.tab.until("the session is over", () => !iotaXR!.presenting && iota.page.viewer.stage.ground.visible);
    expect(me.tab.complaints).toEqual([]);
  });
});

describe("pictures of the headset", () => {
  it("are drawn for each eye, from a place of its own", async () => {
    const drawing = await Browser.start({ ...size, draws: "always" });
    try {
      const seeing = await HeadsetTab.open(drawing, server.url);
      await seeing.enter();
      // In its frame, since the browser clears what it has shown. Brightness of the left and the right half, and how they differ.
      const look = () => seeing.tab.page.evaluate(() => new Promise<readonly [number, number, number]>((resolve) => {
        requestAnimationFrame(() => {
          const canvas = iota.page.viewer.renderer.domElement;
          const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
          const context = copy.getContext("2d")!;
          context.drawImage(canvas, 0, 0);
          const half = Math.floor(canvas.width / 2);
          const [left, right] = [0, half].map((x) => context.getImageData(x, 0, half, canvas.height).data);
          // Colors of 16 steps, without what is transparent.
          const colors = (data: Uint8ClampedArray) => new Set(Array.from({ length: data.length / 4 }, (_, at) => (data[4 * at] >> 4) * 256 + (data[4 * at + 1] >> 4) * 16 + (data[4 * at + 2] >> 4))).size;
          resolve([colors(left), colors(right), left.reduce((count, value, at) => count + Number(Math.abs(value - right[at]) > 12), 0) / left.length]);
        });
      }));
      await expect.poll(async () => {
        const [left, right, apart] = await look();
        return left > 8 && right > 8 && apart > 0.005 ? "drawn" : JSON.stringify([left, right, apart]);
      }).toBe("drawn");
      expect(seeing.tab.complaints).toEqual([]);
    } finally {
      await drawing.stop();
    }
  });
});

describe("pictures for people to look at", () => {
  beforeAll(async () => {
    await me.tab.page.setViewportSize(pictureSize);
    await me.enter();
    await calm();
    await me.tab.page.evaluate(() => iotaXR!.headset.notices.clear());
    await me.look(0.15, -0.2);
    await me.point("left", [-0.22, 1.36, -0.42], [-0.3, 1.3, -2]);
  });

  it.runIf(runsAll)("show a drag by the ray, the panel, the arc and hands in stereo", async () => {
    await pointAtLink(link);
    await me.button("right", "trigger", 1);
    const [x, y, z] = await me.bodyInSpace(link);
    await me.tab.pause(false);
    await me.point("right", rightRest, [x + 0.1, y + 0.25, z + 0.2]);
    await me.frames(4);
    await me.picture("xr-ray");
    await me.button("right", "trigger", 0);
    await me.pointAtPanel("right", [0.14, 1.3, -0.3], "action break");
    await me.picture("xr-panel");
    await me.point("right", [0.16, 1.32, -0.4], [0.35, 0.9, -1.8]);
    await me.stick("right", 0, -1);
    await me.picture("xr-teleport");
    await me.useHands(true);
    await me.point("right", [0.16, 1.3, -0.4], [0.1, 1.25, -2]);
    await me.pinch("right", 0.7);
    await me.picture("xr-hands");
  });

  it("show the card that says that the world is gone", async () => {
    await server.stop();
    await me.tab.until("a card says so", () => iotaXR!.cards().includes("The world is not answering"));
    await me.frames(3);
    await me.picture("xr-lost");
    await me.tab.page.keyboard.press("Escape");
    await me.tab.until("the session is over", () => !iotaXR!.presenting);
  });
});
