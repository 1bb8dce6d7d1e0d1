// SPDX-License-Identifier: Apache-2.0
// Puts the page together: world, input, overlay, and the headset when there is one.

import { ScreenInput } from "../interact/screen_input.ts";
import { Overlay } from "../ui/overlay.ts";
import { byId } from "../ui/dom.ts";
import { offerHeadset } from "../xr/entry.ts";
import { makeDebug } from "./debug.ts";
import { Page } from "./page.ts";

/** Where the world's socket is: beside this page, with the token of this page's address. */
function socketUrl(): string {
  const url = new URL("ws", document.baseURI);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  const token = new URLSearchParams(location.search).get("token");
  if (token !== null) url.searchParams.set("token", token);
  return url.href;
}

/** Lowers the resolution when drawing cannot keep up, and never flickers back and forth. */
class Resolution {
  private scale_ = 1;
  private slow_ = 0;
  private readonly page_: Page;

  constructor(page: Page) {
    this.page_ = page;
    window.addEventListener("resize", () => this.apply());
    this.apply();
  }

  apply(): void {
    this.page_.resize(innerWidth, innerHeight, Math.min(devicePixelRatio, 2) * this.scale_);
  }

  beforeRender(seconds: number): void {
    if (document.visibilityState !== "visible" || this.page_.renderer.xr.isPresenting) return;
    this.slow_ = this.page_.timing.frameMs > 30 ? this.slow_ + seconds : 0;
    if (this.slow_ < 1.5 || this.scale_ < 0.6) return;
    this.slow_ = 0;
    this.scale_ *= 0.8;
    this.apply();
  }
}

function main(): void {
  const canvas = byId("view", HTMLCanvasElement);
  canvas.classList.add("waiting");
  const page = new Page(canvas, socketUrl(), "");
  const overlay = new Overlay(page, canvas);
  const input = new ScreenInput(canvas, page.camera, page.gestures, page.navigation, {
    clickNothing: () => page.select(-1),
    menu: (body, x, y) => overlay.openMenu(body, x, y),
    stir: () => overlay.stir(),
  });
  const resolution = new Resolution(page);
  page.renderer.xr.addEventListener("sessionend", () => resolution.apply());
  page.listeners.push(overlay, resolution, {
    beforeGestures: () => {
      if (page.renderer.xr.isPresenting) input.mouse.active = false;
      else input.aim();
    },
  });
  window.iota = makeDebug(page, canvas);
  page.start();
  void offerHeadset(page, canvas, byId("xr", HTMLElement));
}

try {
  main();
} catch (error) {
  // No WebGL, most likely: say so where it can be read.
  const text = error instanceof Error ? error.message : String(error);
  const card = document.createElement("section");
  card.className = "card error";
  const title = document.createElement("h2");
  title.textContent = "This browser cannot draw the world";
  const body = document.createElement("p");
  body.textContent = text;
  card.append(title, body);
  document.getElementById("cards")?.append(card);
  throw error;
}
