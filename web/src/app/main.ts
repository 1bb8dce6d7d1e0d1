// SPDX-License-Identifier: Apache-2.0
// Assembles the page: world, input, overlay, and the headset if there is one.

import { ScreenInput } from "../interact/screen_input.ts";
import type { JoinRequest } from "../net/connection.ts";
import { ownName } from "../net/name.ts";
import { takeToken } from "../net/token.ts";
import type { PageListener } from "../page/events.ts";
import { makePage, type Page } from "../page/page.ts";
import { Resolution } from "../page/resolution.ts";
import type { FramePart } from "../page/viewer.ts";
import { NoticeLevel, Role } from "../protocol/generated.ts";
import type { Band } from "../ui/band.ts";
import { Overlay } from "../ui/overlay.ts";
import { byId } from "../ui/dom.ts";
import { offerHeadset } from "../xr/entry.ts";
import { makeDebug } from "./debug.ts";

/** For a browser that reports no paints. */
const longestPaintMs = 3000;

/** Address of the world's socket: beside this page, with its token. */
function socketUrl(token: string | null): string {
  const url = new URL("ws", document.baseURI);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  if (token !== null) url.searchParams.set("token", token);
  // A gallery passes the socket on to the process of its world.
  const world = new URLSearchParams(location.search).get("world");
  if (world !== null) url.searchParams.set("world", world);
  return url.href;
}

/** The world, the role and the user's name in the page's address. */
function requestOf(search: string): JoinRequest {
  const asked = new URLSearchParams(search);
  return { world: asked.get("world") ?? "", role: asked.get("role") === "viewer" ? Role.viewer : Role.actor, name: ownName(asked.get("name")) };
}

/** The panel of controls is loaded with the first control, as most worlds have none. */
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

/** Follows a room that moves between machines. Its part is loaded at once, as the machine may be gone when the connection is lost. */
function followRoom({ session }: Page, token: string | null): void {
  const here = new URL(location.href);
  if (!here.searchParams.has("room")) return;
  void import("../net/gateway.ts").then(({ followerOf }) => {
    session.onLost = followerOf(here, token, (url) => location.replace(url));
  });
}

/** Loaded when there is one. */
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

/** Fetched with the first step of a walk, which waits for them: otherwise it could lead through one. */
function wallsWhenWalking({ navigation, world }: Page): void {
  let fetched: Promise<void> | null = null;
  navigation.walls = {
    slide: (_, way) => {
      way.set(0, 0, 0);
      fetched ??= import("../page/walking.ts").then(
        ({ wallsOf }) => {
          navigation.walls = wallsOf(world);
        },
        () => {
          navigation.walls = null;
        },
      );
      return false;
    },
    floorBelow: () => -Infinity,
  };
}

/** Loads the script's modules in their order, each once, also if the page is later told of another version. */
function modulesOf({ world, events }: Page): PageListener {
  const known = new Set<string>();
  let queue = Promise.resolve();
  const load = async (path: string, name: string): Promise<void> => {
    try {
      await import(/* @vite-ignore */ new URL(path, document.baseURI).href);
    } catch (error) {
      events.notice({ level: NoticeLevel.error, title: `The module ${name} failed`, text: String(error), hint: "Correct it, and reload the page." });
    }
  };
  return {
    changed: (what) => {
      if (what !== "settings") return;
      for (const path of world.settings.modules) {
        const name = path.slice(path.lastIndexOf("/") + 1);
        if (known.has(name)) continue;
        known.add(name);
        queue = queue.then(() => load(path, name));
      }
    },
  };
}

function main(): void {
  const canvas = byId("view", HTMLCanvasElement);
  canvas.classList.add("waiting");
  const token = takeToken();
  const page = makePage(canvas, socketUrl(token), requestOf(location.search));
  followRoom(page, token);
  const { viewer, selection, events, navigation } = page;
  // Before the first picture, since shadows are part of the shader programs.
  if (new URLSearchParams(location.search).get("shadows") === "none") viewer.renderer.shadowMap.enabled = false;
  const overlay = new Overlay(page, canvas);
  let band: Promise<Band> | null = null;
  const input = new ScreenInput(canvas, viewer.camera, page.gestures, navigation, {
    clickNothing: () => selection.select(-1),
    openMenu: (body, x, y) => overlay.openMenu(body, x, y),
    closeMenu: () => overlay.closeMenu(),
    active: () => overlay.showBar(),
    band: (left, top, right, bottom, done) => {
      band ??= import("../ui/band.ts").then(({ Band }) => new Band(page));
      void band.then((shown) => shown.draw(left, top, right, bottom, done));
    },
    toggle: (body) => selection.toggle(body),
  });
  events.add(overlay, modulesOf(page));
  window.addEventListener("vite:preloadError", ({ payload }) => {
    const hint = "Reload the page. If the world has ended, start its script again.";
    events.notice({ level: 1, title: "A part of the page did not come", text: payload.message, hint });
  });
  gamepadWhenThere(page);
  wallsWhenWalking(page);
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

/** Until the page has painted that it opens the world: main() takes a second or two where WebGL is in software, in which
 * nothing would be seen. A hidden page does not paint. Nobody sees that of a film, whose clock stands: it might wait for ever. */
function firstPaint(): Promise<void> {
  return new Promise((resolve) => {
    if (document.visibilityState !== "visible" || new URLSearchParams(location.search).has("film")) return resolve();
    new PerformanceObserver(() => resolve()).observe({ type: "paint", buffered: true });
    window.setTimeout(resolve, longestPaintMs);
  });
}

void firstPaint().then(() => {
  try {
    main();
  } catch (error) {
    // Most likely WebGL is missing: show the error on the page.
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
});
