// SPDX-License-Identifier: Apache-2.0
// Where things are in the drawn picture, by counting pixels.

import type { Tab } from "./browser.ts";

export interface Drawn {
  /** Share of the picture's pixels. */
  readonly share: number;
  /** Bounds of the drawn pixels as shares of the picture: 0 .. 1. */
  readonly wide: number;
  readonly high: number;
  /** Whether drawn pixels touch the picture's edge. */
  readonly cut: boolean;
}

const everything = ["body", "staticShape", "tie", "particleSet"] as const;

/** The pixels of these kinds of things: those that change when they are hidden. */
export async function drawn(tab: Tab, kinds: readonly (typeof everything)[number][] = everything): Promise<Drawn> {
  return tab.page.evaluate((hiding) => {
    const { viewer, world: { entities } } = iota.page;
    const { renderer } = viewer;
    const gl = renderer.getContext();
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const take = (): Uint8Array => {
      const pixels = new Uint8Array(4 * width * height);
      renderer.render(viewer.scene, viewer.camera);
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      return pixels;
    };
    const roots = hiding.map((kind) => entities[kind].root);
    renderer.shadowMap.autoUpdate = false;
    const shown = take();
    for (const root of roots) root.visible = false;
    const hidden = take();
    for (const root of roots) root.visible = true;
    renderer.shadowMap.autoUpdate = true;
    let count = 0;
    let [left, right, low, top] = [width, -1, height, -1];
    for (let index = 0; index < width * height; index++) {
      const change = Math.max(...[0, 1, 2].map((channel) => Math.abs(shown[4 * index + channel] - hidden[4 * index + channel])));
      if (change < 12) continue;
      count++;
      const [x, y] = [index % width, Math.floor(index / width)];
      [left, right, low, top] = [Math.min(left, x), Math.max(right, x), Math.min(low, y), Math.max(top, y)];
    }
    const cut = left === 0 || low === 0 || right === width - 1 || top === height - 1;
    return { share: count / (width * height), wide: (right - left) / width, high: (top - low) / height, cut };
  }, kinds);
}
