// SPDX-License-Identifier: Apache-2.0
export { EmbeddedWorld, type EmbedOptions, type Picked } from "../src/embed/embedded_world.ts";
export { Hit, pickPoint, pickRay } from "../src/interact/picking.ts";
export { makePage, type Page } from "../src/page/page.ts";
export type { FramePart, Viewer } from "../src/page/viewer.ts";
export { Stage } from "../src/scene/stage.ts";
export { World, type WorldListener } from "../src/world/world.ts";
