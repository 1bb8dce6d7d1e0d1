// SPDX-License-Identifier: Apache-2.0
import type { Gestures } from "../interact/gestures.ts";
import type { Navigation } from "../navigate/navigation.ts";
import type { World } from "../world/world.ts";
import type { Events } from "./events.ts";
import type { Framing } from "./framing.ts";
import type { Selection } from "./selection.ts";
import type { Session } from "./session.ts";
import type { Sound } from "./sound.ts";
import type { Viewpoints } from "./viewpoints.ts";
import type { Viewer } from "./viewer.ts";

/** The parts of the page, except its commands. */
export interface PageParts {
  readonly world: World;
  readonly session: Session;
  readonly selection: Selection;
  readonly gestures: Gestures;
  readonly viewer: Viewer;
  readonly navigation: Navigation;
  readonly framing: Framing;
  readonly viewpoints: Viewpoints;
  readonly sound: Sound;
  readonly events: Events;
}
