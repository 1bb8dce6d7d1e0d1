// SPDX-License-Identifier: Apache-2.0
// The page's parts, put together. All of it works without the overlay, so that a headset can use the same parts: see
// README.md, "For XR". Overlay and headset name the parts that they need: `Pick<Page, "viewer" | "commands">`.

import { Commands } from "../commands/commands.ts";
import type { Gestures } from "../interact/gestures.ts";
import { Navigation } from "../navigate/navigation.ts";
import { BodyView } from "../scene/body_view.ts";
import { Flashes } from "../scene/flashes.ts";
import { SparkView } from "../scene/spark_view.ts";
import { StaticView } from "../scene/static_view.ts";
import { TieView } from "../scene/tie_view.ts";
import { WorldModel } from "../scene/world_model.ts";
import { Events, type PageListener } from "./events.ts";
import { Highlights } from "./highlights.ts";
import { pageCommands, scriptCommands } from "./page_commands.ts";
import { Selection } from "./selection.ts";
import { Session, type PoseTaker } from "./session.ts";
import { Sound } from "./sound.ts";
import { smooth, Viewer, type FramePart } from "./viewer.ts";

/** What the page is made of, but for its commands. */
export interface PageParts {
  readonly world: WorldModel;
  readonly bodies: BodyView;
  readonly session: Session;
  readonly selection: Selection;
  readonly gestures: Gestures;
  readonly viewer: Viewer;
  readonly navigation: Navigation;
  readonly sound: Sound;
  readonly events: Events;
}

export interface Page extends PageParts {
  readonly commands: Commands;
  /** By the system's setting. */
  setTheme(theme: "light" | "dark"): void;
  start(): void;
}

export function makePage(canvas: HTMLCanvasElement, socketUrl: string, name: string): Page {
  const events = new Events();
  const viewer = new Viewer(canvas);
  const world = new WorldModel((change) => {
    viewer.stir();
    events.changed(change);
  });
  const bodies = new BodyView(world);
  const ties = new TieView(world, bodies.poses);
  const statics = new StaticView(world);
  const sparks = new SparkView();
  const flashes = new Flashes(viewer.camera);
  const sound = new Sound();
  const navigation = new Navigation(viewer.camera);
  const poses: PoseTaker = {
    takePoses: (frame, now, fresh) => {
      const started = performance.now();
      if (fresh) bodies.poses.clear();
      bodies.poses.push(frame, now);
      sparks.take(frame.sparks);
      const { boxMin, boxMax } = frame;
      if (frame.keyframe) viewer.stage.fit(boxMin[0], boxMin[1], boxMin[2], boxMax[0], boxMax[1], boxMax[2]);
      viewer.timing.decodeMs = smooth(viewer.timing.decodeMs, performance.now() - started);
    },
  };
  const session = new Session(socketUrl, name, world, poses, events, () => viewer.stir());
  const selection = new Selection(world, bodies, session, viewer, events);
  const highlights = new Highlights(world, bodies, session, selection, viewer, flashes);
  const parts: PageParts = { world, bodies, session, selection, gestures: selection.gestures, viewer, navigation, sound, events };
  const commands = new Commands();
  commands.add(...pageCommands(parts));
  const actions: PageListener = {
    changed: (what) => {
      if (what === "actions") commands.script = scriptCommands(world.actions, parts);
    },
  };
  events.add(actions, bodies, ties, statics, selection, highlights, flashes, sound, followSettings(parts));
  viewer.add(bodies, selection, flyFlat(parts), highlights, ties, statics, sparks, flashes);
  return {
    ...parts,
    commands,
    setTheme: (theme) => {
      viewer.stir();
      viewer.stage.setTheme(theme);
      highlights.setTheme(theme);
    },
    start: () => {
      session.open();
      viewer.start(() => bodies.pickableCount > 0, () => events.ready());
    },
  };
}

/** Ground and first view, as the script wants them. */
function followSettings({ world, viewer, navigation }: PageParts): PageListener {
  let placed = false;
  return {
    changed: (what) => {
      if (what !== "world") return;
      const { ground, camera } = world.settings;
      viewer.stage.setGround(ground);
      navigation.ground = ground;
      if (camera === null || placed) return;
      navigation.setHome(camera.position, camera.target, true);
      placed = true;
    },
  };
}

/** The camera of a flat screen; a headset has its own. */
function flyFlat({ viewer, navigation }: PageParts): FramePart {
  return {
    update: (seconds) => {
      if (!viewer.presenting && navigation.update(seconds)) viewer.stir();
    },
  };
}
