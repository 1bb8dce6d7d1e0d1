// SPDX-License-Identifier: Apache-2.0
// Assembles the page's parts. They work without the overlay, so that a headset can use them too: see
// README.md, "For XR". Overlay and headset name the parts that they need: `Pick<Page, "viewer" | "commands">`.

import { Color, SRGBColorSpace } from "three";
import { Commands } from "../commands/commands.ts";
import type { JoinRequest } from "../net/connection.ts";
import { Hit, pickPoint, toBody, toWorld } from "../interact/picking.ts";
import { Navigation } from "../navigate/navigation.ts";
import { NoticeLevel } from "../protocol/generated.ts";
import type { EntityView } from "../scene/entities/entity.ts";
import { Flashes } from "../scene/flashes.ts";
import { textOf } from "../scene/parts.ts";
import { World } from "../world/world.ts";
import { Events, type PageListener } from "./events.ts";
import { Framing } from "./framing.ts";
import { Highlights } from "./highlights.ts";
import { othersOf } from "./others.ts";
import { pageCommands, scriptCommands } from "./page_commands.ts";
import type { PageParts } from "./page_parts.ts";
import { Reports } from "./reports.ts";
import { Selection } from "./selection.ts";
import { Session } from "./session.ts";
import { Sound } from "./sound.ts";
import { Viewpoints } from "./viewpoints.ts";
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
  const sound = new Sound(viewer, world.entities.sound, events);
  const navigation = new Navigation(viewer.camera);
  const session = new Session(socketUrl, request, world, viewer, events);
  const selection = new Selection(world, session, viewer, events);
  const framing = new Framing(world, viewer, navigation);
  const highlights = new Highlights(world, session, selection, viewer);
  const viewpoints = new Viewpoints(world, navigation, viewer);
  const parts: PageParts = {
    world, session, selection, gestures: selection.gestures, viewer, navigation, sound, events, framing, viewpoints,
  };
  const commands = new Commands();
  commands.add(...pageCommands(parts));
  const actions: PageListener = {
    changed: (what) => {
      if (what === "actions") commands.script = scriptCommands(world.actions, parts);
    },
  };
  events.add(actions, selection, flashesOf(flashes, parts), sound, applySettings(parts), framing, othersOf(parts));
  viewer.lookDistance = () => navigation.distance;
  const themes = new Themes(parts, highlights);
  viewer.add(themes, { draw: () => void viewer.camera.getWorldPosition(world.eye) });
  // Bodies are updated before the camera is placed.
  viewer.add(new Reports(parts), selection, ...Object.values<EntityView<never>>(world.entities), framing, viewpoints, flatCamera(parts), highlights, flashes, sound);
  return {
    ...parts,
    commands,
    setTheme: (theme) => themes.set(theme),
    start: () => {
      session.connection.open();
      viewer.start(() => world.described && !world.entities.body.unposed, () => events.ready());
    },
  };
}

/** Light or dark by the system's setting, except for surroundings set by the script. */
class Themes implements FramePart {
  private readonly parts_: PageParts;
  private readonly highlights_: Highlights;
  private system_: "light" | "dark" = "light";
  private seen_ = 0;

  constructor(parts: PageParts, highlights: Highlights) {
    this.parts_ = parts;
    this.highlights_ = highlights;
  }

  set(theme: "light" | "dark"): void {
    this.system_ = theme;
    this.apply_();
  }

  update(): void {
    const { version } = this.parts_.world.entities.stage;
    if (version === this.seen_) return;
    this.seen_ = version;
    this.apply_();
  }

  private apply_(): void {
    const { viewer, world: { entities: { stage, particleSet } } } = this.parts_;
    const told = stage.all().at(-1);
    const [sky, horizon, ground] = [told?.sky, told?.horizon, told?.ground].map((color) => (color === undefined ? null : textOf(color)));
    viewer.invalidate();
    viewer.stage.setTheme(this.system_);
    viewer.stage.setSurroundings({ sky, horizon, ground, light: told?.light ?? 1 });
    const behind = horizon ?? sky;
    const theme = behind === null ? this.system_ : new Color(behind).getHSL({ h: 0, s: 0, l: 0 }, SRGBColorSpace).l < 0.4 ? "dark" : "light";
    this.highlights_.setTheme(theme);
    particleSet.setTheme(theme);
  }
}

/** The ground at the script's height. */
function applySettings({ world, viewer, navigation }: PageParts): PageListener {
  return {
    changed: (what) => {
      if (what !== "settings") return;
      viewer.stage.setGround(world.ground);
      navigation.ground = world.ground;
    },
  };
}

/** Rings of light at breaks and joins, which follow their body. */
function flashesOf(flashes: Flashes, { world, viewer }: PageParts): PageListener {
  const bodies = world.entities.body;
  const hit = new Hit();
  const place = new Float32Array(3);
  return {
    effect: (kind, position) => {
      if (kind !== "break" && kind !== "join" && kind !== "grab") return;
      const { size } = viewer;
      if (!pickPoint(bodies, position, 0.1 * size, hit)) return flashes.show(kind, position, size);
      const { body } = hit;
      const local = new Float32Array(3);
      toBody(bodies, body, position[0], position[1], position[2], local);
      flashes.show(kind, position, size, (out) => {
        if (!bodies.has(body)) return;
        toWorld(bodies, body, local, place);
        out.set(place[0], place[1], place[2]);
      });
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
