// SPDX-License-Identifier: Apache-2.0
// The page's parts, put together. All of it works without the overlay, so that a headset can use the same parts: see
// README.md, "For XR". Overlay and headset name the parts that they need: `Pick<Page, "viewer" | "commands">`.

import { Commands } from "../commands/commands.ts";
import type { JoinRequest } from "../net/connection.ts";
import { Navigation } from "../navigate/navigation.ts";
import { NoticeLevel } from "../protocol/generated.ts";
import type { EntityView } from "../scene/entities/entity.ts";
import { Flashes } from "../scene/flashes.ts";
import { World } from "../world/world.ts";
import { Events, type PageListener } from "./events.ts";
import { Highlights } from "./highlights.ts";
import { pageCommands, scriptCommands } from "./page_commands.ts";
import type { PageParts } from "./page_parts.ts";
import { Selection } from "./selection.ts";
import { Session } from "./session.ts";
import { Sound } from "./sound.ts";
import { Viewer, type FramePart } from "./viewer.ts";

export interface Page extends PageParts {
  readonly commands: Commands;
  /** By the system's setting. */
  setTheme(theme: "light" | "dark"): void;
  start(): void;
}

export function makePage(canvas: HTMLCanvasElement, socketUrl: string, request: JoinRequest): Page {
  const events = new Events();
  const viewer = new Viewer(canvas);
  const world = new World({
    changed: (change) => {
      viewer.invalidate();
      events.changed(change);
    },
    bodyGone: (body) => events.bodyGone(body),
    warn: (title, text) => events.notice({ level: NoticeLevel.error, title, text, hint: "" }),
  });
  const flashes = new Flashes(viewer.camera);
  const sound = new Sound();
  const navigation = new Navigation(viewer.camera);
  const session = new Session(socketUrl, request, world, viewer, events);
  const selection = new Selection(world, session, viewer, events);
  const highlights = new Highlights(world, session, selection, viewer, flashes);
  const parts: PageParts = { world, session, selection, gestures: selection.gestures, viewer, navigation, sound, events };
  const commands = new Commands();
  commands.add(...pageCommands(parts));
  const actions: PageListener = {
    changed: (what) => {
      if (what === "actions") commands.script = scriptCommands(world.actions, parts);
    },
  };
  events.add(actions, selection, flashes, sound, applySettings(parts));
  viewer.add(flatCamera(parts), selection, highlights, ...Object.values<EntityView<never>>(world.entities), flashes);
  return {
    ...parts,
    commands,
    setTheme: (theme) => {
      viewer.invalidate();
      viewer.stage.setTheme(theme);
      highlights.setTheme(theme);
    },
    start: () => {
      session.connection.open();
      viewer.start(() => world.entities.body.pickableCount > 0, () => events.ready());
    },
  };
}

/** Ground and first view, as the script wants them. */
function applySettings({ world, viewer, navigation }: PageParts): PageListener {
  let placed = false;
  return {
    changed: (what) => {
      if (what !== "settings") return;
      viewer.stage.setGround(world.ground);
      navigation.ground = world.ground;
      if (!placed) navigation.setHome(world.settings.cameraPosition, world.settings.cameraTarget, true);
      placed = true;
    },
  };
}

/** The camera of a flat screen; a headset has its own. */
function flatCamera({ viewer, navigation }: PageParts): FramePart {
  return {
    update: (seconds) => {
      if (!viewer.presenting && navigation.update(seconds)) viewer.invalidate();
    },
  };
}
