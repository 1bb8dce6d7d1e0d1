// SPDX-License-Identifier: Apache-2.0
// Puts the page together: world, input, overlay, and the headset when there is one.

import { ScreenInput } from "../interact/screen_input.ts";
import type { JoinRequest } from "../net/connection.ts";
import { takeToken } from "../net/token.ts";
import { makePage, type Page } from "../page/page.ts";
import { Resolution } from "../page/resolution.ts";
import type { FramePart } from "../page/viewer.ts";
import { Role } from "../protocol/generated.ts";
import { Overlay } from "../ui/overlay.ts";
import { byId } from "../ui/dom.ts";
import { offerHeadset } from "../xr/entry.ts";
import { makeDebug } from "./debug.ts";

/** Where the world's socket is: beside this page, with its token. */
function socketUrl(): string {
  const url = new URL("ws", document.baseURI);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  const token = takeToken();
  if (token !== null) url.searchParams.set("token", token);
  return url.href;
}

/** The world and the role that the page's address asks for. */
function requestOf(search: string): JoinRequest {
  const asked = new URLSearchParams(search);
  return { world: asked.get("world") ?? "", role: asked.get("role") === "viewer" ? Role.viewer : Role.actor, name: "" };
}

/** Controls of the script are fetched with the first of them: most worlds have none. */
function panelWhenNeeded({ world, session, viewer }: Page): FramePart {
  const { widget, plot } = world.entities;
  let asked = false;
  return {
    draw: () => {
      if (asked || widget.size + plot.size === 0) return;
      asked = true;
      void import("../ui/panel.ts").then(({ Panel }) => {
        viewer.add(new Panel({ world, session, viewer }));
        viewer.invalidate();
      });
    },
  };
}

/** Fetched when there is one. */
function gamepadWhenThere({ navigation, commands, viewer }: Page): void {
  window.addEventListener("gamepadconnected", () => {
    void import("../interact/gamepad.ts").then(({ GamepadInput }) => {
      const gamepad = new GamepadInput(navigation, commands);
      viewer.add({
        aim: (seconds) => {
          if (!viewer.presenting && gamepad.aim(seconds)) viewer.invalidate();
        },
      });
    });
  }, { once: true });
}

function main(): void {
  const canvas = byId("view", HTMLCanvasElement);
  canvas.classList.add("waiting");
  const page = makePage(canvas, socketUrl(), requestOf(location.search));
  const { viewer, selection, events, navigation } = page;
  const overlay = new Overlay(page, canvas);
  const input = new ScreenInput(canvas, viewer.camera, page.gestures, navigation, {
    clickNothing: () => selection.select(-1),
    menu: (body, x, y) => overlay.openMenu(body, x, y),
    active: () => overlay.showBar(),
  });
  events.add(overlay);
  gamepadWhenThere(page);
  viewer.add(panelWhenNeeded(page));
  viewer.add(overlay, new Resolution(viewer), {
    aim: () => {
      if (viewer.presenting) input.mouse.active = false;
      else input.aim();
    },
  });
  window.iota = makeDebug(page, canvas);
  page.start();
  void offerHeadset(page, canvas);
}

try {
  main();
} catch (error) {
  // No WebGL, most likely: say so where it can be read.
  document.getElementById("loading")?.remove();
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
