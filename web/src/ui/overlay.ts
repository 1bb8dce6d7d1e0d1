// SPDX-License-Identifier: Apache-2.0
// The page's own controls: one thin bar, times on request, a hint at the pointer, actions, cards, help.

import { Vector3 } from "three";
import { isAllowed, type Command } from "../commands/command.ts";
import type { Grab, Pointer } from "../interact/gestures.ts";
import type { LinkState } from "../net/connection.ts";
import { forceText } from "../page/force_text.ts";
import type { PageListener, PageNotice } from "../page/events.ts";
import type { Page } from "../page/page.ts";
import type { FramePart } from "../page/viewer.ts";
import { Role } from "../protocol/generated.ts";
import type { Change } from "../world/world.ts";
import { makeActionButton, makeBarItem, type BarItem } from "./buttons.ts";
import type { Budget } from "./budget.ts";
import { Cards, type CardLevel } from "./cards.ts";
import { byId, keyName, make, placeNear } from "./dom.ts";
import { Keys } from "./keys.ts";
import type { PeopleList } from "./people_list.ts";
import type { Profile } from "./profile.ts";

const idleAfterMs = 7000;
const welcomeMs = 15000;
/** N. */
const leastForce = 0.05;
const meterEveryMs = 250;
/** Between the page's controls and what is framed, css px; and the largest share of the window below it. */
const reservedGap = 24;
const mostReserved = 0.4;
const linkCard = "link";
const watcherWelcome = "You watch: drag to look around";
const peopleSign = "M9 11a3.5 3.5 0 1 0 0-7 3.5 3.5 0 0 0 0 7M2.5 20v-1a6.5 5 0 0 1 13 0v1M15.5 4.5a3.5 3.5 0 0 1 0 6.3M18 14.6a6 5 0 0 1 3.5 4.4v1";
const levels: readonly CardLevel[] = ["info", "warning", "error"];

type OverlayPage = Pick<Page, "world" | "session" | "selection" | "gestures" | "viewer" | "navigation" | "commands" | "sound" | "framing" | "setTheme">;

export class Overlay implements PageListener, FramePart {
  readonly cards = new Cards(byId("cards", HTMLElement), () => this.coveredByOthers_());

  private readonly page_: OverlayPage;
  private readonly canvas_: HTMLCanvasElement;
  private readonly loading_ = byId("loading", HTMLElement);
  private readonly hint_ = byId("hint", HTMLElement);
  private readonly menu_ = byId("menu", HTMLElement);
  private readonly strip_ = byId("strip", HTMLElement);
  private readonly chosen_ = byId("chosen", HTMLElement);
  private readonly bar_ = byId("bar", HTMLElement);
  private readonly meter_ = byId("meter", HTMLElement);
  private readonly welcome_ = byId("welcome", HTMLElement);
  private readonly help_ = byId("help", HTMLDialogElement);
  private profile_: Profile | null = null;
  private profiles_ = false;
  private budget_: Budget | null = null;
  private barItems_: readonly BarItem[] = [];
  private pointerAt_ = { x: 0, y: 0, touch: false };
  private idle_: number | undefined;
  private paused_: boolean | null = null;
  private renamed_ = 0;
  private hintText_ = "";
  private bodyHint_ = "drag";
  private role_: Role = Role.host;
  private people_: PeopleList | null = null;
  private everConnected_ = false;
  private marks_ = false;
  private readonly place_ = new Vector3();

  constructor(page: OverlayPage, canvas: HTMLCanvasElement) {
    this.page_ = page;
    this.canvas_ = canvas;
    const showBar = () => this.showBar();
    page.commands.add(this.peopleCommand_(), this.helpCommand_(), this.profileCommand_());
    page.commands.onChange(() => this.takeCommands_());
    this.takeCommands_();
    window.addEventListener("keydown", (event) => this.closeMenuByKey_(event), true);
    new Keys(page, showBar);
    // After a click the keys go to the world again: space must not press the same button again.
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
      showBar();
    }, true);
    const theme = matchMedia("(prefers-color-scheme: dark)");
    const applyTheme = () => page.setTheme(theme.matches ? "dark" : "light");
    theme.addEventListener("change", applyTheme);
    applyTheme();
    window.setInterval(() => this.refreshMeter_(), meterEveryMs);
    window.setTimeout(() => this.welcome_.classList.add("gone"), welcomeMs);
    window.addEventListener("resize", () => this.reserve_());
    showBar();
  }

  /** Shows the bar again and lets it hide later. */
  showBar(): void {
    document.body.classList.remove("idle");
    window.clearTimeout(this.idle_);
    this.idle_ = window.setTimeout(() => {
      if (!this.page_.world.paused && this.menu_.hidden) document.body.classList.add("idle");
    }, idleAfterMs);
  }

  openHelp(): void {
    void import("./help.ts").then(({ openHelp }) => {
      const { world, commands, session } = this.page_;
      if (!this.help_.open) openHelp(this.help_, world.settings.title || "Iota", commands, world.listens.keys, session.role === Role.viewer);
    });
  }

  /** The actions for a body, at a place in css px. */
  openMenu(body: number, x: number, y: number): void {
    const actions = this.page_.commands.script.filter((action) => action.onBody);
    if (actions.length === 0) return;
    this.page_.selection.select(body);
    this.menu_.replaceChildren(
      ...actions.map((action) => {
        const button = makeActionButton(action, () => this.closeMenu(), body);
        button.setAttribute("role", "menuitem");
        return button;
      }),
    );
    const name = this.page_.world.entities.body.nameOf(body);
    this.menu_.setAttribute("aria-label", `Actions for ${name}`);
    this.menu_.prepend(make("div", "about", name));
    this.menu_.hidden = false;
    placeNear(this.menu_, x, y, 14);
    this.showBar();
  }

  closeMenu(): void {
    if (this.menu_.hidden) return;
    this.menu_.hidden = true;
    this.canvas_.focus({ preventScroll: true });
  }

  // --- PageListener

  ready(): void {
    this.canvas_.classList.remove("waiting");
    this.loading_.hidden = true;
  }

  changed(what: Change | "selection"): void {
    const { title } = this.page_.world.settings;
    if (what === "settings") {
      // "NAME: LINE" says what the world is, too.
      const [name, line = ""] = title.split(/: (.*)/);
      document.title = name === "" ? "Iota" : `${name} · Iota`;
      byId("about", HTMLElement).replaceChildren(...(line === "" ? [] : [make("b", "", name), ` ${line}`]));
      this.reserve_();
    }
    if (what === "selection") {
      this.closeMenu();
      this.refreshStrip_();
    }
    if (what === "clients") {
      this.takeRole_(this.page_.session.role);
      this.people_?.refresh();
    }
    this.refreshBar_();
  }

  link(state: LinkState, reason: string): void {
    this.canvas_.classList.toggle("away", state !== "connected" && this.everConnected_);
    if (state !== "connected") this.people_?.close();
    switch (state) {
      case "connected":
        // A world without bodies is shown too, after a delay.
        if (!this.everConnected_) window.setTimeout(() => this.ready(), 3000);
        this.everConnected_ = true;
        this.cards.remove(linkCard);
        if (this.profiles_) this.page_.session.send({ type: "profile", on: true });
        break;
      case "lost":
        this.loading_.hidden = true;
        this.cards.show({
          level: "warning",
          title: this.everConnected_ ? "The world is not answering" : "No world here yet",
          text: "Trying again; the page reconnects automatically.",
          hint: this.everConnected_ ? "If the script was stopped, start it again." : "Is the script running?",
        }, linkCard, { lasting: true });
        break;
      case "refused":
        this.loading_.hidden = true;
        this.cards.show({ level: "error", title: "The world refuses this page", text: reason, hint: "" }, linkCard, { lasting: true });
        break;
      case "connecting":
        break;
    }
  }

  notice({ level, title, text, hint, key, ...options }: PageNotice): void {
    if (title === "" && text === "") this.cards.remove(key ?? "");
    else this.cards.show({ level: levels[level] ?? "info", title, text, hint }, key, options);
  }

  grab(grab: Grab): void {
    this.welcome_.classList.add("gone");
    this.canvas_.classList.toggle("grabbing", this.page_.gestures.grabs.length > 0);
    if (grab.pointer.name === "mouse") this.refreshHint_();
  }

  hover(pointer: Pointer, body: number): void {
    if (pointer.name === "mouse") this.canvas_.classList.toggle("can-grab", body >= 0 && this.page_.gestures.mayHold);
  }

  // --- FramePart

  draw(): void {
    this.refreshHint_();
    if (this.page_.world.entities.body.renamed !== this.renamed_) this.refreshStrip_();
    const { paused } = this.page_.world;
    if (paused === this.paused_) return;
    this.paused_ = paused;
    this.refreshBar_();
    this.showBar();
  }

  // --- inside

  private profileCommand_(): Command {
    return {
      name: "profile",
      help: "times of a step and of a frame",
      keys: ["i"],
      title: () => "Profile",
      active: () => this.profiles_,
      run: () => {
        this.profiles_ = !this.profiles_;
        this.page_.session.send({ type: "profile", on: this.profiles_ });
        if (this.budget_ !== null) this.budget_.shown = this.profiles_;
        void import("./profile.ts").then(({ Profile }) => {
          this.profile_ ??= new Profile(this.page_);
          this.refreshMeter_();
        });
      },
    };
  }

  private peopleCommand_(): Command {
    const { world } = this.page_;
    return {
      name: "people",
      help: "who is here",
      keys: [","],
      places: ["bar"],
      title: () => `${world.clients.length} are here`,
      sign: () => peopleSign,
      offered: () => world.clients.length > 1,
      active: () => this.people_?.isOpen === true,
      run: () => void import("./people_list.ts").then(({ PeopleList }) => {
        this.people_ ??= new PeopleList(this.page_, byId("foot", HTMLElement));
        this.people_.toggle();
      }),
    };
  }

  private helpCommand_(): Command {
    return {
      name: "open help",
      help: "this help",
      keys: ["?"],
      places: ["bar"],
      title: () => "Help",
      label: () => "?",
      run: () => this.openHelp(),
    };
  }

  /** Once the server has told it. */
  private takeRole_(role: Role): void {
    if (role === this.role_) return;
    this.role_ = role;
    if (role === Role.viewer) this.welcome_.lastElementChild!.textContent = watcherWelcome;
    this.takeCommands_();
  }

  /** Places the buttons of all commands. */
  private takeCommands_(): void {
    const { commands } = this.page_;
    const refocus = () => this.canvas_.focus({ preventScroll: true });
    this.barItems_ = commands.at("bar").map((entry) => makeBarItem(entry, refocus));
    this.bar_.replaceChildren(...this.barItems_.map((item) => item.element));
    const hints = commands.script.filter((action) => action.onBody && isAllowed(action))
      .flatMap((action) => (action.keys ?? []).map((key) => `${keyName(key)} ${action.title()}`));
    this.bodyHint_ = (this.role_ === Role.viewer ? [] : ["drag", ...hints]).join("; ");
    this.closeMenu();
    this.refreshStrip_();
    this.reserve_();
  }

  /** Keeps the place of bar, buttons and start hint free of what is framed. Buttons that come and go with a selection do not change it. */
  private reserve_(): void {
    const tops = [this.bar_, this.strip_, this.welcome_].filter(({ childNodes }) => childNodes.length > 0).map((part) => part.getBoundingClientRect().top);
    this.page_.viewer.margins.bottom = Math.min(innerHeight - Math.min(...tops) + reservedGap, mostReserved * innerHeight);
    this.page_.viewer.invalidate();
  }

  /** The places that a card must not cover, css px: controls and labels. */
  private coveredByOthers_(): DOMRect[] {
    const { world: { entities: { label } }, viewer: { camera } } = this.page_;
    const boxes: DOMRect[] = [];
    for (const element of document.querySelectorAll("#panel, #bar, #strip:not(:empty)")) boxes.push(element.getBoundingClientRect());
    label.forEachBox(camera, (left, top, width, height) => boxes.push(new DOMRect(left, top, width, height)));
    return boxes.filter(({ width }) => width > 0);
  }

  private refreshBar_(): void {
    for (const item of this.barItems_) item.refresh();
  }

  private anyPress_(event: PointerEvent): void {
    this.pointerAt_ = { x: event.clientX, y: event.clientY, touch: event.pointerType === "touch" };
    this.showBar();
    if (!this.menu_.hidden && !(event.target instanceof Node && this.menu_.contains(event.target))) this.closeMenu();
  }

  /** Escape only closes an open menu. */
  private closeMenuByKey_(event: KeyboardEvent): void {
    if (event.key !== "Escape" || this.menu_.hidden) return;
    event.stopImmediatePropagation();
    this.closeMenu();
  }

  /** Shows the selection and the script's buttons: those for the world always, those for a body while one is selected. */
  private refreshStrip_(): void {
    const { world: { entities: { body } }, selection, commands } = this.page_;
    const { size: more } = selection.several;
    this.renamed_ = body.renamed;
    const name = body.nameOf(selection.selected) + (more > 0 ? ` and ${more} more` : "");
    // For readers of the screen: the arrow keys select.
    if (this.chosen_.textContent !== name) this.chosen_.textContent = name;
    const shown: HTMLElement[] = commands.script.filter((action) => action.offered?.() !== false).map((action) => makeActionButton(action));
    if (name !== "") shown.unshift(make("span", "about", name));
    this.strip_.replaceChildren(...shown);
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
    // A force is shown above the hand, because the held body hangs below it.
    const lift = this.page_.gestures.grabs.length === 0 ? 0 : 62;
    placeNear(this.hint_, this.pointerAt_.x, this.pointerAt_.y - lift, this.pointerAt_.touch ? 36 : 16);
  }

  private calcHint_(): string {
    if (this.page_.viewer.presenting || !this.menu_.hidden) return "";
    const grab = this.page_.gestures.grabs.at(-1);
    if (grab !== undefined) {
      const force = this.page_.selection.forceOf(grab);
      // A click that only selects has no force.
      if (force < leastForce) return "";
      return forceText(force);
    }
    const mouse = this.page_.gestures.pointers[0];
    if (!mouse.active || mouse.hovered < 0) return "";
    const name = this.page_.world.entities.body.ownNameOf(mouse.hovered);
    return [name, this.bodyHint_].filter((part) => part !== "").join(": ");
  }

  /** Markers are fetched when the first body has left the view. */
  private markWhatLeft_(): void {
    const { world: { entities: { body } }, viewer } = this.page_;
    if (this.marks_ || viewer.presenting) return;
    for (let index = 0; index < body.pickableCount && !this.marks_; index++) {
      const { x, y, z } = this.place_.fromArray(body.position, 3 * body.pickable[index]).project(viewer.camera);
      this.marks_ = !(Math.abs(x) < 1 && Math.abs(y) < 1 && z < 1);
    }
    if (this.marks_) void import("./edge_markers.ts").then(({ EdgeMarkers }) => viewer.add(new EdgeMarkers(this.page_, byId("away", HTMLElement))));
  }

  private refreshMeter_(): void {
    this.refreshBar_();
    this.markWhatLeft_();
    this.meter_.hidden = !this.profiles_;
    if (!this.profiles_) return this.meter_.replaceChildren();
    const { world, viewer: { timing } } = this.page_;
    const step = make("b", "", world.stepMs.toFixed(2));
    const frame = make("b", "", timing.frameMs.toFixed(1));
    this.meter_.replaceChildren("step ", step, " ms\nframe ", frame, " ms");
    this.meter_.title = `script ${timing.scriptMs.toFixed(2)} ms a frame · step ${world.step} · ${world.time.toFixed(1)} s · gap ${world.gap.toExponential(1)} m`;
    if (this.profile_ === null) return;
    this.profile_.refresh();
    this.meter_.append(this.profile_.element);
    if (world.budgetMs === 0) return;
    if (this.budget_ === null) {
      void import("./budget.ts").then(({ Budget }) => {
        if (this.budget_ !== null) return;
        this.budget_ = new Budget(this.page_);
        this.budget_.shown = this.profiles_;
        this.page_.viewer.add(this.budget_);
      });
      return;
    }
    this.budget_.refresh();
    this.meter_.append(this.budget_.element);
  }
}
