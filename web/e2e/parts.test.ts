// SPDX-License-Identifier: Apache-2.0
// Each ready part of interaction by each way to reach it; docs/interaction.md has the table.

import { afterAll, beforeAll, beforeEach, describe, expect, it } from "vitest";
import { Browser, distance, type Place, type Tab } from "./browser.ts";
import { HeadsetTab } from "./headset.ts";
import { freePort, WorldServer } from "./server.ts";

/** A test that some ways of users do not have. */
const itIf = (isThere: boolean) => (isThere ? it : () => undefined);

type Point = readonly [number, number, number];

/** Of parts_probe.py. */
const [ball, stone, piece, , lower, , plug] = [0, 1, 2, 3, 4, 5, 6];
const rightRest = [0.2, 1.32, -0.38] as const;

interface Report {
  bodies: number;
  arm: number;
  plugged: boolean;
  ghost: boolean;
  measured: string;
  piece: string;
}

/** What a user does, whatever with. */
interface User {
  readonly tab: Tab;
  press(body: number): Promise<void>;
  /** Moves the hand that holds a body to where it would have it at a place of the world. */
  moveTo(place: Point): Promise<void>;
  release(): Promise<void>;
  /** Runs an action, of a body or of the world. */
  act(name: string, body?: number): Promise<void>;
  selectSeveral(bodies: readonly [number, number]): Promise<void>;
  selectOne(): Promise<void>;
  /** The force that is written at the hand. */
  force(): Promise<string>;
  /** Presses with both hands at places of the world; without it there is one pointer. */
  pressBoth?(places: readonly [Point, Point]): Promise<void>;
  moveBoth?(places: readonly [Point, Point]): Promise<void>;
  releaseBoth?(): Promise<void>;
}

/** Where a place of the world is in the window, css px. */
function onScreen(tab: Tab, place: Point): Promise<Place> {
  return tab.page.evaluate((at) => {
    const point = iota.page.viewer.camera.position.clone().set(...at).project(iota.page.viewer.camera);
    return [((point.x + 1) / 2) * innerWidth, ((1 - point.y) / 2) * innerHeight] as Place;
  }, place as [number, number, number]);
}

/** In steps, as a hand moves. */
async function inSteps(from: Place, to: Place, step: (at: Place) => Promise<void>): Promise<void> {
  for (let share = 0.25; share <= 1; share += 0.25) await step([from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share]);
}

/** Of the window: what it points at is a place in css px. */
abstract class FlatUser {
  readonly tab: Tab;
  private at_: Place = [0, 0];

  constructor(tab: Tab) {
    this.tab = tab;
  }

  protected abstract down(at: Place): Promise<void>;
  protected abstract move(at: Place): Promise<void>;

  async press(body: number): Promise<void> {
    this.at_ = await this.tab.place(body);
    await this.down(this.at_);
  }

  async moveTo(place: Point): Promise<void> {
    const to = await onScreen(this.tab, place);
    await inSteps(this.at_, to, (at) => this.move(at));
    this.at_ = to;
  }

  force = () => this.tab.page.locator("#hint").innerText();
}

class MouseUser extends FlatUser implements User {
  protected async down(at: Place): Promise<void> {
    await this.move(at);
    await this.tab.page.mouse.down();
  }

  protected move = (at: Place) => this.tab.page.mouse.move(...at);
  release = () => this.tab.page.mouse.up();
  selectOne = async () => {};

  async act(name: string, body?: number): Promise<void> {
    if (body !== undefined) await this.tab.page.mouse.click(...(await this.tab.place(body)));
    await this.tab.page.locator("#strip button:visible", { hasText: name }).first().click();
  }

  async selectSeveral(bodies: readonly [number, number]): Promise<void> {
    const [a, b] = await Promise.all(bodies.map((body) => this.tab.place(body)));
    await this.tab.page.keyboard.down("Control");
    await this.tab.page.mouse.move(a[0] - 40, a[1] - 40);
    await this.tab.page.mouse.down();
    await this.tab.page.mouse.move(a[0], b[1]);
    await this.tab.page.mouse.move(b[0] + 20, b[1] + 40);
    await this.tab.page.mouse.up();
    await this.tab.page.keyboard.up("Control");
  }
}

class KeyboardUser extends MouseUser {
  /** By the keys alone. */
  override async act(name: string, body?: number): Promise<void> {
    for (let at = 0; body !== undefined && at < 30; at++) {
      if ((await this.tab.page.evaluate(() => iota.selected)) === body) break;
      await this.tab.page.keyboard.press("ArrowRight");
    }
    await this.tab.page.keyboard.press({ break: "b", join: "c", copy: "n", undo: "z", redo: "y", measure: "v", rewind: "Backspace" }[name]!);
  }
}

class TouchUser extends FlatUser implements User {
  protected down = (at: Place) => this.tab.touch("touchStart", [at]);
  protected move = (at: Place) => this.tab.touch("touchMove", [at]);
  release = () => this.tab.lift();

  async act(name: string, body?: number): Promise<void> {
    if (body === undefined) return this.tab.page.locator("#strip button:visible", { hasText: name }).first().tap();
    await this.tab.touch("touchStart", [await this.tab.place(body)]);
    const item = this.tab.page.locator("#menu .action", { hasText: name });
    await item.waitFor();
    await this.tab.lift();
    await item.tap();
  }

  private both_: readonly Place[] = [];

  async pressBoth(places: readonly [Point, Point]): Promise<void> {
    this.both_ = await Promise.all(places.map((place) => onScreen(this.tab, place)));
    await this.tab.touch("touchStart", this.both_);
  }

  async moveBoth(places: readonly [Point, Point]): Promise<void> {
    const to = await Promise.all(places.map((place) => onScreen(this.tab, place)));
    const at = (share: number) => this.both_.map(([x, y], index): Place => [x + (to[index][0] - x) * share, y + (to[index][1] - y) * share]);
    for (const share of [0.25, 0.5, 0.75, 1]) await this.tab.touch("touchMove", at(share));
  }

  releaseBoth = () => this.tab.lift();

  private switch_ = () => this.tab.page.evaluate(() => { document.getElementById("select-several")!.click(); });

  async selectSeveral(bodies: readonly [number, number]): Promise<void> {
    await this.switch_();
    const [a, b] = await Promise.all(bodies.map((body) => this.tab.place(body)));
    await this.tab.touch("touchStart", [[a[0] - 30, a[1] - 40]]);
    await this.tab.touch("touchMove", [[a[0], b[1]]]);
    await this.tab.touch("touchMove", [[b[0] + 15, b[1] + 40]]);
    await this.tab.lift();
  }

  selectOne = () => this.switch_();
}

/** A controller's trigger, or the pinch of a bare hand; actions by the wrist panel. */
class HeadsetUser implements User {
  readonly tab: Tab;
  private readonly me_: HeadsetTab;
  private readonly hands_: boolean;

  constructor(me: HeadsetTab, hands: boolean) {
    this.tab = me.tab;
    this.me_ = me;
    this.hands_ = hands;
  }

  private async close_(value: number): Promise<void> {
    if (this.hands_) await this.me_.pinch("right", value);
    else await this.me_.button("right", "trigger", value);
  }

  async press(body: number): Promise<void> {
    const isOn = (id: number) => iotaXR!.inputs().some((input) => input.name.startsWith("right") && input.hovered === id);
    // A busy machine may draw the world as it was before its reset when it is pointed at.
    for (let trial = 0; trial < 20; trial++) {
      await this.me_.pointAtBody("right", rightRest, body);
      if (await this.tab.page.evaluate(isOn, body)) break;
    }
    await this.tab.until(`the ray is on ${body}`, isOn, body);
    await this.close_(1);
  }

  async moveTo(place: Point): Promise<void> {
    const target = await this.tab.page.evaluate((at) => iotaXR!.toSpace(at), place);
    await this.me_.point("right", rightRest, target);
  }

  release = () => this.close_(0);
  force = () => this.tab.page.evaluate(() => iotaXR!.inputs().map(({ force }) => force).join(""));

  private async closeBoth_(value: number): Promise<void> {
    for (const side of ["left", "right"] as const) {
      if (this.hands_) await this.me_.pinch(side, value);
      else await this.me_.button(side, "trigger", value);
    }
  }

  async moveBoth(places: readonly [Point, Point]): Promise<void> {
    const targets = await this.tab.page.evaluate((all) => all.map((place) => iotaXR!.toSpace(place)), places as unknown as [number, number, number][]);
    await this.me_.point("left", [-0.2, 1.32, -0.38], targets[0]);
    await this.me_.point("right", rightRest, targets[1]);
  }

  async pressBoth(places: readonly [Point, Point]): Promise<void> {
    await this.moveBoth(places);
    await this.closeBoth_(1);
  }

  releaseBoth = () => this.closeBoth_(0);

  private async push_(name: string): Promise<void> {
    await this.me_.pointAtPanel("right", [0.12, 1.38, -0.2], name);
    await this.close_(1);
    await this.close_(0);
    // The hand comes down, and the panel with it.
    await this.me_.point("left", [-0.2, 1.2, -0.38], [-0.2, 1.2, -2]);
    await this.me_.look(0, 0);
  }

  async act(name: string, body?: number): Promise<void> {
    if (body !== undefined) {
      await this.press(body);
      await this.release();
      await this.tab.until("it is selected", (id) => iota.selected === id, body);
    }
    await this.push_(`action ${name}`);
  }

  /** The first of them is selected already. */
  async selectSeveral([, second]: readonly [number, number]): Promise<void> {
    await this.push_("select several");
    await this.press(second);
    await this.release();
  }

  selectOne = () => this.push_("select several");
}

describe.each(["mouse", "keyboard", "touch", "controller", "hand"] as const)("by %s", (name) => {
  let server: WorldServer;
  let browser: Browser;
  let user: User;
  let tab: Tab;

  beforeAll(async () => {
    server = await WorldServer.start(["web/e2e/parts_probe.py"], await freePort());
    const isHeadset = name === "controller" || name === "hand";
    browser = await Browser.start(isHeadset ? { width: 400, height: 224 } : name === "touch" ? { width: 390, height: 844, touch: true } : { width: 960, height: 540 });
    if (isHeadset) {
      const me = await HeadsetTab.open(browser, server.url);
      await me.enter();
      if (name === "hand") await me.useHands(true);
      user = new HeadsetUser(me, name === "hand");
    } else {
      const opened = await browser.open(server.url);
      user = new { mouse: MouseUser, keyboard: KeyboardUser, touch: TouchUser }[name](opened);
    }
    tab = user.tab;
  });

  afterAll(async () => {
    expect(tab.complaints).toEqual([]);
    await browser?.stop();
    await server?.stop();
  });

  beforeEach(async () => {
    // A test that failed may have left its hand closed.
    await user.release();
    await tab.page.evaluate(() => iota.select(-1));
    await tab.reset();
    expect(await tab.page.evaluate(() => iota.bodies())).toHaveLength(7);
    // The camera may have eased to what came off.
    if (name !== "controller" && name !== "hand") {
      await tab.page.keyboard.press("Home");
      await tab.eyeAtRest();
    }
  });

  const report = () => server.report as unknown as Report;
  /** Waits until Python says so; the error has its last words. */
  async function reports(what: string, condition: (now: Report) => boolean): Promise<void> {
    const isSo = expect.poll(() => condition(report()), { message: what, timeout: 20_000 }).toBe(true);
    await isSo.catch((error: unknown) => {
      throw new Error(`${what}: ${JSON.stringify(server.reports.slice(-4))}`, { cause: error });
    });
  }

  async function hold(body: number): Promise<Point> {
    await user.press(body);
    await tab.until(`body ${body} is held`, (id) => iota.held === id, body);
    return tab.position(body);
  }

  async function letGo(): Promise<void> {
    await user.release();
    await tab.until("it is let go", () => iota.held === -1 && iota.holds().length === 0);
  }

  itIf(name !== "keyboard")("a body is selected, and several", async () => {
    await user.press(ball);
    await user.release();
    await tab.until("the ball is selected", (id) => iota.selected === id, ball);
    await user.selectSeveral([ball, stone]);
    await tab.until("both are selected", (both) => JSON.stringify([...iota.page.selection.actionBodies].sort()) === JSON.stringify(both), [ball, stone]);
    await user.selectOne();
  });

  itIf(name !== "keyboard")("a body is dragged by a force, which is written at the hand, and thrown", async () => {
    // A busy machine may hold up the release until the ball rests at the hand: then it does not fly, and is thrown again.
    let flown = 0;
    for (let throws = 0; throws < 6 && flown < 0.2; throws++) {
      const [x, y, z] = await hold(ball);
      await user.moveTo([x + 0.2, y + 0.4, z]);
      await expect.poll(() => user.force(), { message: "the force is written" }).toMatch(/^\d+(\.\d)? N$/);
      await tab.until("it comes to the hand", (id) => {
        const [held] = iota.holds();
        return Math.hypot(...iota.bodyPosition(id).map((value, axis) => value - held.target[axis])) < 0.12;
      }, ball);
      await user.moveTo([x + 0.2, y - 0.4, z]);
      await tab.until("it moves on", ([id, from]) => iota.bodyPosition(id)[1] < from, [ball, y + 0.3] as const);
      await letGo();
      const at = await tab.position(ball);
      await tab.goOn(1);
      flown = distance(await tab.position(ball), at);
    }
    expect(flown, "it flies on").toBeGreaterThan(0.2);
  });

  itIf(name !== "keyboard")("a piece is carried exactly", async () => {
    const [x, y, z] = await hold(piece);
    await reports("the hand moves it", (now) => now.piece.includes("scripted"));
    await tab.until("no spring pulls", () => iota.holds().length === 0);
    await user.moveTo([x + 0.1, y + 0.35, z]);
    await tab.until("it is there", ([id, to]) => Math.hypot(...iota.bodyPosition(id).map((value, axis) => value - to[axis])) < 0.06, [piece, [x + 0.1, y + 0.35, z]] as const);
    await user.release();
    await reports("it is free again", (now) => now.piece.includes("dynamic"));
  });

  itIf(name !== "keyboard")("a plug snaps into its socket, of which it has a preview", async () => {
    const [x, y, z] = await hold(plug);
    await user.moveTo([x, y + 0.38, z]);
    await reports("its place is shown", (now) => now.ghost);
    await tab.until("it is near", ([id, from]) => iota.bodyPosition(id)[1] > from + 0.3, [plug, y] as const);
    await letGo();
    await reports("it is joined", (now) => now.plugged && !now.ghost);
  });

  itIf(name !== "keyboard" && name !== "mouse")("two hands move and turn a body", async () => {
    await user.pressBoth!([[0.7, 1.46, 0], [0.7, 1.24, 0]]);
    await tab.until("both hold it", (id) => iota.holds().length === 2 && iota.holds().every(({ body }) => body === id), plug);
    await user.moveBoth!([[0.4, 1.2, 0], [0.62, 1.2, 0]]);
    await tab.until("it lies level, at the left", (id) => {
      const [x, y] = iota.bodyPosition(id);
      const [qx, qy, qz, qw] = iota.bodyRotation(id);
      return x < 0.6 && y < 1.3 && Math.abs(2 * (qx * qy + qz * qw)) < 0.4;  // the sine of its slope
    }, plug);
    await user.releaseBoth!();
    await tab.until("it is let go", () => iota.holds().length === 0);
  });

  it("an arm is broken and joined", async () => {
    await reports("it is whole", (now) => now.arm === 2);
    await user.act("break", lower);
    await reports("it is broken", (now) => now.arm === 1);
    await user.act("join", lower);
    await reports("it is joined", (now) => now.arm === 2);
  });

  it("a body is copied; that is undone, and repeated", async () => {
    await user.act("copy", ball);
    await reports("there is one more", (now) => now.bodies === 8);
    await user.act("undo");
    await reports("it is gone", (now) => now.bodies === 7);
    await user.act("redo");
    await reports("it is back", (now) => now.bodies === 8);
  });

  it("a distance is measured", async () => {
    await user.act("measure", ball);
    await user.act("measure", stone);
    await reports("the distance is told", (now) => Math.abs(Number.parseFloat(now.measured) - 0.4) < 0.02);
  });

  itIf(name === "controller" || name === "hand")("two hands on nothing hold the world, and scale it", async () => {
    await user.pressBoth!([[-1.5, 5, 0], [1.5, 5, 0]]);
    await tab.until("they hold the world", () => iotaXR!.headset.locomotion.grabbing);
    await tab.page.evaluate(() => {
      for (const part of [iotaXR!.device!.controllers.left, iotaXR!.device!.hands.left]) part!.position.x -= 0.4;
    });
    await tab.until("it has become larger", () => iotaXR!.rig().scale < 0.7);
    await user.releaseBoth!();
    await tab.page.evaluate(() => iota.page.commands.run("home in vr"));
  });
});
