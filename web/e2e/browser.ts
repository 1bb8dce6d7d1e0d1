// SPDX-License-Identifier: Apache-2.0
// Debian's headless Chromium, drawing with Mesa's llvmpipe; and hands for the tests. A run has one process of it (shared_browser.ts), in
// which each `Browser` is a context of its own: with its own window, storage and cache.

import { mkdirSync } from "node:fs";
import path from "node:path";
import { chromium, type Browser as Chromium, type BrowserContext, type CDPSession, type Page } from "playwright-core";
import type { IotaDebug } from "../src/app/debug.ts";
import { ControlCommand } from "../src/protocol/generated.ts";
import { artifacts } from "./server.ts";

declare global {
  // The same object as window.iota, as scripts of the page see it.
  var iota: IotaDebug;
  // Whether a page that draws less than always draws what it shows.
  var drawsFrames: boolean | undefined;
}

/** Everything of the suite, also what takes long and changes seldom. */
export const runsAll = process.env["IOTA_TEST_ALL"] === "1";

/** The address of the run's browser; a script outside of a run starts its own. */
export const sharedBrowser = "IOTA_TEST_BROWSER";

const flags = [
  "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist",
  // Software composes the page faster itself than by the commands of a graphics card.
  "--disable-gpu-compositing",
];

export interface BrowserOptions {
  readonly width: number;
  readonly height: number;
  readonly touch?: boolean;
  readonly dark?: boolean;
  /** Drawn pixels for a css pixel; a half unless told. */
  readonly density?: number;
  /** Accepts self-signed certificates. */
  readonly trustsAll?: boolean;
  /** Draws shadows, for tests that look at pictures: software takes most of a frame for them. */
  readonly shadows?: boolean;
  /** Which pictures of the world are drawn: those that the page shows ("always"), those that a test draws and reads ("asked"), these and
   * what frames keep for them ("kept": surroundings that surfaces mirror, and shadows five times a second), or none, which is usual. All else of a page goes on
   * without them. Software takes most of two cores for them, and some seconds for a frame where the machine is busy. */
  readonly draws?: Draws;
}

type Draws = "always" | "kept" | "asked" | "never";

/** Small windows at low resolution: the cost of software rendering is per pixel, and the tests do not depend on it. */
export const small: BrowserOptions = { width: 640, height: 360 };

/** For a page that draws less than always: leaves out the commands that fill pixels, the blur of what is behind a panel, and most
 * frames. What the processor does for a picture stays. */
const drawLess = (draws: Draws) => {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync("* { backdrop-filter: none !important; -webkit-backdrop-filter: none !important; }");
  document.adoptedStyleSheets = [sheet];
  let inFrame = false;
  let isOnScreen = true;
  const nextFrame = globalThis.requestAnimationFrame;
  // Nobody sees the frames: a fifth as many do.
  const betweenFramesMs = 60;
  // What a test draws has shadows of its own, but for those on the ground below things; a page draws for longer than this after a change.
  const betweenShadowsMs = 200;
  let hasShadows = false;
  let shadowsAt = -Infinity;
  let mirrors: IotaDebug["page"]["viewer"]["stage"] | null = null;
  let isMirroring = false;
  /** Surroundings are drawn once after a change: never left out. */
  const keepMirrors = () => {
    const stage = globalThis.iota?.page.viewer.stage;
    if (stage === undefined || stage === mirrors) return;
    mirrors = stage;
    const own = stage.drawReflections.bind(stage);
    stage.drawReflections = () => {
      isMirroring = true;
      own();
      isMirroring = false;
    };
  };
  const calledOff = new Set<number>();
  let asked = 0;
  globalThis.requestAnimationFrame = (callback) => {
    const handle = ++asked;
    setTimeout(() => nextFrame((time) => {
      if (calledOff.delete(handle)) return;
      inFrame = true;
      keepMirrors();
      hasShadows = time >= shadowsAt + betweenShadowsMs;
      if (hasShadows) shadowsAt = time;
      try {
        callback(time);
      } finally {
        inFrame = false;
      }
    }), betweenFramesMs);
    return handle;
  };
  globalThis.cancelAnimationFrame = (handle) => void calledOff.add(handle);
  const context = WebGL2RenderingContext.prototype;
  const bind = context.bindFramebuffer;
  context.bindFramebuffer = function (target, framebuffer) {
    isOnScreen = framebuffer === null;
    bind.call(this, target, framebuffer);
  };
  const isLeftOut = () => globalThis.drawsFrames !== true && (draws === "never" || (inFrame && (isOnScreen || draws === "asked" || !(hasShadows || isMirroring))));
  for (const name of ["clear", "drawArrays", "drawElements", "drawArraysInstanced", "drawElementsInstanced"] as const) {
    const own = context[name] as (...given: number[]) => void;
    context[name] = function (this: WebGL2RenderingContext, ...given: number[]) {
      if (!isLeftOut()) own.apply(this, given);
    };
  }
};

export const launchOptions = {
  executablePath: path.join(import.meta.dirname, "quiet_chromium.ts"),
  args: flags,
  env: { ...process.env, LIBGL_ALWAYS_SOFTWARE: "1" },
};

let connected: Promise<Chromium> | null = null;

function chromiumOfRun(): Promise<Chromium> {
  const address = process.env[sharedBrowser];
  connected ??= address === undefined ? chromium.launch(launchOptions) : chromium.connect(address);
  return connected;
}

export class Browser {
  readonly context: BrowserContext;
  private readonly draws_: Draws;
  private readonly shadows_: boolean;

  private constructor(context: BrowserContext, draws: Draws, shadows: boolean) {
    this.context = context;
    this.draws_ = draws;
    this.shadows_ = shadows;
  }

  static async start(options: BrowserOptions = small): Promise<Browser> {
    const browser = await chromiumOfRun();
    const context = await browser.newContext({
      ignoreHTTPSErrors: options.trustsAll === true,
      deviceScaleFactor: options.density ?? 0.5,
      viewport: { width: options.width, height: options.height },
      colorScheme: options.dark === true ? "dark" : "light",
      ...(options.touch === true ? { hasTouch: true, isMobile: true } : {}),
    });
    context.setDefaultTimeout(60_000);
    const draws = runsAll || process.env[sharedBrowser] === undefined ? "always" : options.draws ?? "never";
    if (draws !== "always") await context.addInitScript(drawLess, draws);
    return new Browser(context, draws, options.shadows === true);
  }

  async stop(): Promise<void> {
    await this.context.close();
    // The last one ends what this process has started.
    if (process.env[sharedBrowser] !== undefined) return;
    const browser = await chromiumOfRun();
    if (browser.contexts().length > 0) return;
    connected = null;
    await browser.close();
  }

  /** A tab with the world drawn in it; `begun`: and running. */
  async open(url: string, { begun = true, shadows = this.shadows_ } = {}): Promise<Tab> {
    const blank = this.context.pages().find((page) => page.url() === "about:blank");
    const tab = new Tab(blank ?? (await this.context.newPage()), this.draws_);
    await tab.page.goto(shadows ? url : `${url}&shadows=none`);
    await tab.until("the world is drawn", (step) => globalThis.iota?.connected && iota.bodies().length > 0 && iota.step >= step, begun ? 1 : 0);
    return tab;
  }
}

export type Place = readonly [number, number];

export class Tab {
  readonly page: Page;
  /** Errors that the page's scripts threw, and what its console complained about. */
  readonly complaints: string[] = [];
  private devtools_: CDPSession | null = null;
  private fingers_ = 0;
  private readonly draws_: Draws;
  /** When the world was back at its start, ms. */
  private begunAnew_ = -Infinity;

  constructor(page: Page, draws: Draws) {
    this.page = page;
    this.draws_ = draws;
    page.on("pageerror", (error) => this.complaints.push(String(error)));
    page.on("console", (message) => {
      if (message.type() === "error") this.complaints.push(message.text());
    });
  }

  /** Waits until a function of the page is true; the error says what it waited for. */
  async until<T>(what: string, condition: (argument: T) => unknown, argument?: T, timeout = 60_000): Promise<void> {
    try {
      await this.page.waitForFunction(condition as (argument: unknown) => unknown, argument, { timeout, polling: 50 });
    } catch (error) {
      const state = await this.page.evaluate(async () => {
        if (globalThis.iota === undefined) return "no page";
        const from = iota.step;
        let pictures = 0;
        const draws = () => void (requestAnimationFrame(draws), pictures++);
        draws();
        await new Promise((resolve) => setTimeout(resolve, 1000));
        return JSON.stringify({
          connected: iota.connected, step: iota.step, stepsPerSecond: iota.step - from, pictures, held: iota.held, selected: iota.selected,
          articulates: new Set(iota.articulates().values()).size, paused: iota.paused, focus: document.activeElement?.outerHTML.slice(0, 80),
          eye: iota.page.viewer.camera.position.toArray(), settings: iota.page.world.settings,
          holds: iota.holds().map((hold) => ({ ...hold, at: iota.bodyPosition(hold.body) })),
        });
      });
      throw new Error(`waited in vain until ${what}; ${state}`, { cause: error });
    }
  }

  /** Waits until all that fades in or slides on the page has done so. */
  async untilShown(): Promise<void> {
    await this.until("nothing fades or slides", () => document.getAnimations().every(({ playState }) => playState !== "running"));
  }

  /** Until the first picture is shown. */
  async drawn(): Promise<void> {
    await this.until("it has been drawn", () => globalThis.iota?.connected && !document.getElementById("view")!.classList.contains("waiting"));
  }

  /** Returns the world to its start, and waits until the page shows that. A page can do so once a second. */
  async reset(): Promise<void> {
    for (let trial = 0; trial < 8; trial++) {
      await new Promise((resolve) => setTimeout(resolve, Math.max(0, this.begunAnew_ + 1000 - performance.now())));
      const hasBegun = await this.page.evaluate(async () => {
        const before = iota.time;
        iota.page.commands.run("reset");
        // A time that is merely small may be that after an earlier reset.
        const isAnew = () => iota.time === 0 || iota.time < before;
        for (let wait = 0; wait < 800 && !isAnew(); wait++) await new Promise((resolve) => setTimeout(resolve, 5));
        return isAnew();
      });
      this.begunAnew_ = performance.now();
      if (hasBegun) return;
    }
    throw new Error("the world did not begin anew");
  }

  /** Waits until the camera of the flat page stands still, and returns its place. */
  async eyeAtRest(): Promise<number[]> {
    const eye = () => this.page.evaluate(async () => {
      const place = () => iota.page.viewer.camera.position.toArray();
      const before = place();
      for (let frame = 0; frame < 3; frame++) await new Promise(requestAnimationFrame);
      const { goal, distance: now } = iota.page.navigation;
      const still = Math.hypot(...place().map((value, axis) => value - before[axis])) < 1e-4 * now && Math.abs(goal.distance - now) < 1e-3 * now;
      return still ? place() : null;
    });
    for (let trial = 0; trial < 200; trial++) {
      const at = await eye();
      if (at !== null) return at;
    }
    throw new Error("the camera goes on moving");
  }

  /** Clicks a button of the bar, which hides itself after a while, comes back with the mouse and stays while it is there. */
  async press(selector: string): Promise<void> {
    await this.page.mouse.move(300, 40);
    await this.page.hover(selector, { force: true });
    await this.page.click(selector);
  }

  /** Waits until the world has gone on by s of its own time. */
  async goOn(seconds: number): Promise<void> {
    const from = await this.page.evaluate(() => iota.time);
    // A script may reset it, whose time begins at 0 again.
    await this.until(`${seconds} s have passed in the world`, ([began, span]) => iota.time > began + span || iota.time < began, [from, seconds] as const);
  }

  async articulates(): Promise<number> {
    return this.page.evaluate(() => new Set(iota.articulates().values()).size);
  }

  async position(body: number): Promise<[number, number, number]> {
    return this.page.evaluate((id) => iota.bodyPosition(id), body);
  }

  async place(body: number): Promise<Place> {
    const place = await this.page.evaluate((id) => iota.screenPosition(id), body);
    if (place === null) throw new Error(`body ${body} is behind the camera`);
    return place;
  }

  /** Asks for the state, as the key would toggle it: another tab may do so too, or one that is shown here may be older than a request. */
  async pause(paused: boolean): Promise<void> {
    await this.page.bringToFront();
    await this.page.evaluate((command) => iota.page.session.control(command), paused ? ControlCommand.pause : ControlCommand.play);
    await this.until(paused ? "the world is paused" : "the world runs", (wanted) => iota.paused === wanted, paused);
  }

  /** Pauses the world and waits until the drawn poses have come to rest too, so that bodies are at their drawn places.
   * */
  async freeze(): Promise<void> {
    await this.pause(true);
    const rested = await this.page.evaluate(async () => {
      const began = performance.now();
      const longest = 30_000;
      const drawn = () => iota.bodies().flatMap((body) => iota.bodyPosition(body).map((value) => value.toFixed(4))).join();
      let before = "";
      for (let still = 0; still < 3 && performance.now() - began < longest;) {
        // A frame, or half a second if drawing stalls, so that the wait ends.
        await Promise.race([new Promise(requestAnimationFrame), new Promise((resolve) => setTimeout(resolve, 500))]);
        const now = drawn();
        still = now === before ? still + 1 : 0;
        before = now;
      }
      return performance.now() - began < longest;
    });
    if (!rested) throw new Error("the paused world goes on moving");
  }

  /** Freezes the world when a body is well in view and not covered by the page's controls. */
  async freezeInView(body: number): Promise<Place> {
    for (let trial = 0; trial < 20; trial++) {
      await this.freeze();
      const at = await this.place(body);
      const free = await this.page.evaluate(([x, y]) => (
        x > 0.12 * innerWidth && x < 0.88 * innerWidth && y > 0.08 * innerHeight && y < 0.92 * innerHeight
        && document.elementFromPoint(x, y)?.id === "view"
      ), at);
      if (free) return at;
      await this.pause(false);
      await this.goOn(0.2);
    }
    throw new Error(`body ${body} never came into view`);
  }

  /** A place some way from a body's towards the first link: there the chain is slack and a hand can go anywhere. */
  async slack(from: Place, share: number): Promise<Place> {
    const [x, y] = await this.place(0);
    return [from[0] + (x - from[0]) * share, from[1] + (y - from[1]) * share];
  }

  /** Presses the mouse on a body of a frozen world and lets it run again. Returns the place of the press. */
  async take(body: number): Promise<Place> {
    const at = await this.freezeInView(body);
    await this.page.mouse.move(...at);
    await this.page.mouse.down();
    await this.until(`body ${body} is held`, (id) => iota.held === id, body);
    await this.pause(false);
    return at;
  }

  async click(body: number): Promise<void> {
    await this.page.mouse.click(...(await this.freezeInView(body)));
    await this.until(`body ${body} is selected`, (id) => iota.selected === id, body);
    await this.pause(false);
  }

  /** Presses the mouse and lets it go at once, by the times that the events have: a busy machine takes longer for both than a click. */
  async clickAt([x, y]: Place): Promise<void> {
    await this.page.mouse.move(x, y);
    this.devtools_ ??= await this.page.context().newCDPSession(this.page);
    const timestamp = Date.now() / 1000;
    for (const type of ["mousePressed", "mouseReleased"] as const) {
      await this.devtools_.send("Input.dispatchMouseEvent", { type, x, y, button: "left", clickCount: 1, timestamp });
    }
  }

  /** Fingers on the screen. */
  async touch(type: "touchStart" | "touchMove", fingers: readonly Place[]): Promise<void> {
    this.fingers_ = fingers.length;
    await this.sendTouch_(type, fingers);
  }

  async lift(): Promise<void> {
    if (this.fingers_ > 0) await this.sendTouch_("touchEnd", []);
    this.fingers_ = 0;
  }

  private async sendTouch_(type: "touchStart" | "touchMove" | "touchEnd", fingers: readonly Place[]): Promise<void> {
    this.devtools_ ??= await this.page.context().newCDPSession(this.page);
    await this.devtools_.send("Input.dispatchTouchEvent", { type, touchPoints: fingers.map(([x, y], id) => ({ x, y, id })) });
  }

  /** A file for people to look at. */
  async picture(name: string): Promise<void> {
    await this.showing(async () => {
      mkdirSync(artifacts, { recursive: true });
      const file = path.join(artifacts, `${name}.png`);
      for (let trial = 0; trial < 3; trial++) {
        try {
          await this.page.screenshot({ path: file, timeout: 8000 });
          return;
        } catch (error) {
          // A busy machine's software renderer may take seconds for a frame; a missing picture is not a failure.
          console.warn(`no picture ${name}: ${String(error).split("\n")[0]}`);
        }
      }
    });
  }

  /** Does something with the picture that the page shows; nothing on a page that never draws. */
  async showing(look: () => Promise<void>): Promise<void> {
    if (this.draws_ === "never") return;
    await this.page.evaluate(async () => {
      globalThis.drawsFrames = true;
      iota.page.viewer.invalidate();
      for (let frame = 0; frame < 2; frame++) await new Promise(requestAnimationFrame);
    });
    await look();
    await this.page.evaluate(() => { globalThis.drawsFrames = false; });
  }
}

export function distance(a: readonly number[], b: readonly number[]): number {
  return Math.hypot(...a.map((value, axis) => value - b[axis]));
}
