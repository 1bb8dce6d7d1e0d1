// SPDX-License-Identifier: Apache-2.0
// The page's own controls: one thin bar, time readings, a hint at the pointer, actions, cards, help.

import { speeds } from "../app/commands.ts";
import type { Page, PageListener } from "../app/page.ts";
import type { Grab, Pointer } from "../interact/gestures.ts";
import type { LinkState } from "../net/connection.ts";
import type { Notice } from "../protocol/generated.ts";
import type { ActionEntry, Change } from "../scene/world_model.ts";
import { Cards, type CardLevel } from "./cards.ts";
import { byId, keyName, make, makeActionButton, placeNear } from "./dom.ts";
import { openHelp } from "./help.ts";
import { Keys } from "./keys.ts";

const idleAfterMs = 7000;
const welcomeMs = 15000;
const meterEveryMs = 250;
const linkCard = "link";
const levels: readonly CardLevel[] = ["info", "warning", "error"];

export class Overlay implements PageListener {
  readonly cards = new Cards(byId("cards", HTMLElement));
  readonly keys: Keys;

  private readonly page_: Page;
  private readonly canvas_: HTMLCanvasElement;
  private readonly hint_ = byId("hint", HTMLElement);
  private readonly menu_ = byId("menu", HTMLElement);
  private readonly strip_ = byId("strip", HTMLElement);
  private readonly play_ = byId("play", HTMLButtonElement);
  private readonly look_ = byId("look", HTMLButtonElement);
  private readonly speed_ = byId("speed", HTMLSelectElement);
  private readonly meter_ = byId("meter", HTMLElement);
  private readonly welcome_ = byId("welcome", HTMLElement);
  private readonly help_ = byId("help", HTMLDialogElement);
  private pointerAt_ = { x: 0, y: 0, touch: false };
  private idle_: number | undefined;
  private paused_: boolean | null = null;
  private hintText_ = "";
  private bodyHint_ = "drag";
  private everConnected_ = false;

  constructor(page: Page, canvas: HTMLCanvasElement) {
    this.page_ = page;
    this.canvas_ = canvas;
    const stir = () => this.stir();
    const { commands } = page;
    this.keys = new Keys(page, [
      { keys: [" "], help: "pause, play", run: () => commands.togglePause() },
      { keys: ["."], help: "one step", run: () => commands.step() },
      { keys: ["r"], help: "reset", run: () => commands.reset() },
      { keys: ["[", "]"], help: "slower, faster", run: () => {} },
      { keys: ["l"], help: "next look", run: () => commands.nextLook() },
      { keys: ["f"], help: "a drag on nothing looks around instead of orbiting", run: () => this.toggleFlying_() },
      { keys: ["Home", "0"], help: "back to the first view", run: () => page.navigation.reset() },
      { keys: ["g"], help: "grid: lines each 0.1 m and 1 m", run: () => this.toggleGrid_() },
      { keys: ["m"], help: "sound on, off", run: () => this.toggleSound_() },
      { keys: ["ArrowRight", "ArrowDown"], help: "selects the next body", run: () => commands.selectNext(1) },
      { keys: ["ArrowLeft", "ArrowUp"], help: "selects the one before", run: () => commands.selectNext(-1) },
      { keys: ["Escape"], help: "selects nothing", run: () => this.escape_() },
      { keys: ["?"], help: "this help", run: () => this.openHelp() },
    ], stir);
    window.addEventListener("keydown", (event) => this.speedKey_(event));
    this.play_.addEventListener("click", () => commands.togglePause());
    byId("step", HTMLButtonElement).addEventListener("click", () => commands.step());
    byId("reset", HTMLButtonElement).addEventListener("click", () => commands.reset());
    byId("help-open", HTMLButtonElement).addEventListener("click", () => this.openHelp());
    this.look_.addEventListener("click", () => commands.nextLook());
    for (const speed of speeds) this.speed_.append(new Option(`${speed}×`, String(speed)));
    this.speed_.addEventListener("change", () => {
      commands.setSpeed(Number(this.speed_.value));
      canvas.focus({ preventScroll: true });
    });
    // After a click the keys go to the world again: space must not press the same button once more.
    byId("foot", HTMLElement).addEventListener("click", (event) => {
      if (event.detail > 0 && event.target instanceof Element && event.target.closest("button") !== null) {
        canvas.focus({ preventScroll: true });
      }
    });
    this.help_.addEventListener("click", (event) => {
      if (event.target === this.help_) this.help_.close();
    });
    window.addEventListener("pointerdown", (event) => this.anyPress_(event), true);
    window.addEventListener("pointermove", (event) => {
      this.pointerAt_ = { x: event.clientX, y: event.clientY, touch: event.pointerType === "touch" };
      stir();
    }, true);
    const theme = matchMedia("(prefers-color-scheme: dark)");
    const applyTheme = () => page.setTheme(theme.matches ? "dark" : "light");
    theme.addEventListener("change", applyTheme);
    applyTheme();
    window.setInterval(() => this.refreshMeter_(), meterEveryMs);
    window.setTimeout(() => this.welcome_.classList.add("gone"), welcomeMs);
    this.refreshLook_();
    stir();
  }

  /** Shows the bar again and lets it hide later. */
  stir(): void {
    document.body.classList.remove("idle");
    window.clearTimeout(this.idle_);
    this.idle_ = window.setTimeout(() => {
      if (!this.page_.model.paused && this.menu_.hidden) document.body.classList.add("idle");
    }, idleAfterMs);
  }

  openHelp(): void {
    if (!this.help_.open) openHelp(this.help_, this.page_, this.keys);
  }

  /** The actions for a body, at a place in css px. */
  openMenu(body: number, x: number, y: number): void {
    const actions = this.bodyActions_();
    if (actions.length === 0) return;
    this.page_.select(body);
    this.menu_.replaceChildren(
      ...actions.map((action) => {
        const button = makeActionButton(action, this.page_.commands, () => body, () => this.closeMenu_());
        button.setAttribute("role", "menuitem");
        return button;
      }),
    );
    this.menu_.hidden = false;
    placeNear(this.menu_, x, y, 14);
    this.stir();
  }

  // --- PageListener

  ready(): void {
    this.canvas_.classList.remove("waiting");
  }

  changed(what: Change | "selection" | "look"): void {
    const { settings } = this.page_.model;
    switch (what) {
      case "world":
        document.title = settings.title === "" ? "Iota" : `${settings.title} · Iota`;
        this.refreshLook_();
        break;
      case "look":
        this.refreshLook_();
        break;
      case "actions": {
        const keys = this.bodyActions_().filter((action) => action.key !== "");
        this.bodyHint_ = ["drag", ...keys.map((action) => `${keyName(action.key)} ${action.label}`)].join("; ");
        this.closeMenu_();
        this.refreshStrip_();
        break;
      }
      case "selection":
        this.closeMenu_();
        this.refreshStrip_();
        break;
      default:
        break;
    }
  }

  link(state: LinkState, reason: string): void {
    this.canvas_.classList.toggle("away", state !== "connected" && this.everConnected_);
    switch (state) {
      case "connected":
        // A world without bodies is shown too, if late.
        if (!this.everConnected_) window.setTimeout(() => this.ready(), 3000);
        this.everConnected_ = true;
        this.cards.remove(linkCard);
        break;
      case "lost":
        this.cards.show({
          level: "warning",
          title: this.everConnected_ ? "The world is not answering" : "No world here yet",
          text: "Trying again; the page comes back by itself.",
          hint: this.everConnected_ ? "If the script was stopped, start it again." : "Is the script running?",
        }, linkCard, true);
        break;
      case "refused":
        this.cards.show({ level: "error", title: "The world does not let this page in", text: reason, hint: "" }, linkCard, true);
        break;
      case "connecting":
        break;
    }
  }

  notice(notice: Omit<Notice, "type">): void {
    this.cards.show({ level: levels[notice.level] ?? "info", title: notice.title, text: notice.text, hint: notice.hint });
  }

  grab(grab: Grab): void {
    this.welcome_.classList.add("gone");
    this.canvas_.classList.toggle("grabbing", this.page_.gestures.grabs.length > 0);
    if (grab.pointer.name === "mouse") this.refreshHint_();
  }

  hover(pointer: Pointer, body: number): void {
    if (pointer.name === "mouse") this.canvas_.classList.toggle("can-grab", body >= 0);
  }

  beforeRender(): void {
    this.refreshHint_();
    const { paused } = this.page_.model;
    if (paused === this.paused_) return;
    this.paused_ = paused;
    document.body.classList.toggle("paused", paused);
    this.play_.setAttribute("aria-label", paused ? "Play" : "Pause");
    this.play_.title = paused ? "Play (space)" : "Pause (space)";
    this.stir();
  }

  // --- inside

  private bodyActions_(): readonly ActionEntry[] {
    return this.page_.model.actions.filter((action) => action.on === "body");
  }

  private anyPress_(event: PointerEvent): void {
    this.pointerAt_ = { x: event.clientX, y: event.clientY, touch: event.pointerType === "touch" };
    this.page_.sound.wake();
    this.stir();
    if (!this.menu_.hidden && !(event.target instanceof Node && this.menu_.contains(event.target))) this.closeMenu_();
  }

  private closeMenu_(): void {
    if (this.menu_.hidden) return;
    this.menu_.hidden = true;
    this.canvas_.focus({ preventScroll: true });
  }

  private escape_(): void {
    if (this.menu_.hidden) this.page_.select(-1);
    else this.closeMenu_();
  }

  private toggleGrid_(): void {
    const { stage } = this.page_;
    stage.gridShown = !stage.gridShown;
    this.page_.stir();
  }

  private toggleFlying_(): void {
    const { navigation } = this.page_;
    navigation.flying = !navigation.flying;
    this.cards.show({
      level: "info", title: navigation.flying ? "Fly: drag looks around, w a s d q e walk" : "Orbit: drag turns the view", text: "", hint: "",
    }, "fly");
  }

  private toggleSound_(): void {
    const { sound } = this.page_;
    sound.muted = !sound.muted;
    this.cards.show({ level: "info", title: sound.muted ? "Sound is off" : "Sound is on", text: "", hint: "" }, "sound");
  }

  /** Two keys share a line of the help, so they are told apart here. */
  private speedKey_(event: KeyboardEvent): void {
    this.page_.sound.wake();
    if (this.keys.actionOf(event.key) !== undefined) return;
    if (event.key === "[") this.page_.commands.changeSpeed(-1);
    if (event.key === "]") this.page_.commands.changeSpeed(1);
  }

  private refreshLook_(): void {
    const { looks } = this.page_.model.settings;
    this.look_.hidden = looks.length < 2;
    this.look_.textContent = this.page_.look;
    this.look_.setAttribute("aria-label", `Look: ${this.page_.look}`);
  }

  /** Buttons of the script: those about the world always, those about a body while one is selected. */
  private refreshStrip_(): void {
    const { model, selected, commands } = this.page_;
    const shown = model.actions.filter((action) => action.on === "world" || selected >= 0);
    this.strip_.replaceChildren(
      ...shown.map((action) => makeActionButton(action, commands, () => (action.on === "body" ? this.page_.selected : -1))),
    );
  }

  private refreshHint_(): void {
    const text = this.calcHint_();
    if (text === "") {
      this.hintText_ = "";
      this.hint_.hidden = true;
      return;
    }
    if (text !== this.hintText_) {
      this.hintText_ = text;
      this.hint_.textContent = text;
      this.hint_.hidden = false;
    }
    // A force is shown above the hand: below it hangs what is held.
    const lift = this.page_.gestures.grabs.length === 0 ? 0 : 62;
    placeNear(this.hint_, this.pointerAt_.x, this.pointerAt_.y - lift, this.pointerAt_.touch ? 36 : 16);
  }

  private calcHint_(): string {
    if (this.page_.renderer.xr.isPresenting || !this.menu_.hidden) return "";
    const grab = this.page_.gestures.grabs.at(-1);
    if (grab !== undefined) {
      const force = this.page_.forceOf(grab);
      return `${force < 10 ? force.toFixed(1) : force.toFixed(0)} N`;
    }
    const mouse = this.page_.gestures.pointers[0];
    if (!mouse.active || mouse.hovered < 0) return "";
    return this.bodyHint_;
  }

  private refreshMeter_(): void {
    const { model, timing } = this.page_;
    const step = make("b", "", model.stepMs.toFixed(2));
    const frame = make("b", "", timing.frameMs.toFixed(1));
    this.meter_.replaceChildren("step ", step, " ms\nframe ", frame, " ms");
    this.meter_.title = `script ${timing.scriptMs.toFixed(2)} ms a frame · step ${model.step} · ${model.time.toFixed(1)} s · gap ${model.gap.toExponential(1)} m`;
    const speed = speeds.find((value) => Math.abs(value - model.speed) < 0.01 * value);
    if (speed !== undefined && document.activeElement !== this.speed_) this.speed_.value = String(speed);
  }
}
