// SPDX-License-Identifier: Apache-2.0
// Where things are in the drawn picture, by counting pixels.

import type { DirectionalLight, Object3D } from "three";
import type { Tab } from "./browser.ts";

export interface Drawn {
  /** Share of the picture's pixels. */
  readonly share: number;
  /** Extent of the drawn pixels, and the lowest of them, as shares of the picture: 0 .. 1. */
  readonly wide: number;
  readonly high: number;
  readonly low: number;
  /** Whether drawn pixels touch the picture's edge. */
  readonly cut: boolean;
  /** Of the drawn pixels, the share under the panel of controls. The bar hides itself. */
  readonly covered: number;
}

/** Bodies that are of an articulate, and obstacles, which are of none. */
const everything = ["body", "obstacle", "tie", "particleSet"] as const;

/** The pixels of these kinds of things, or of shadows: those that change when they are hidden. */
export async function drawn(tab: Tab, what: readonly (typeof everything)[number][] | "shadows" = everything): Promise<Drawn> {
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
    const showKind = (kind: (typeof hiding)[number], on: boolean) => {
      if (kind === "tie" || kind === "particleSet") {
        entities[kind].root.visible = on;
        return;
      }
      const { bodies_: bodies } = entities.body as unknown as { bodies_: Map<number, { instances: readonly { mesh: Object3D }[] }> };
      for (const [slot, { instances }] of bodies) {
        if ((entities.membership.articulateOf(slot) >= 0) === (kind === "body")) for (const { mesh } of instances) mesh.visible = on;
      }
    };
    const intensities = new Map<DirectionalLight, number>();
    viewer.scene.traverse((light) => { if ("isDirectionalLight" in light) intensities.set(light as DirectionalLight, (light as DirectionalLight).shadow.intensity); });
    const show = (on: boolean) => {
      if (hiding !== "shadows") for (const kind of hiding) showKind(kind, on);
      else for (const [{ shadow }, intensity] of intensities) shadow.intensity = on ? intensity : 0;
    };
    renderer.shadowMap.autoUpdate = false;
    renderer.shadowMap.needsUpdate = true;
    const shown = take();
    show(false);
    const hidden = take();
    show(true);
    renderer.shadowMap.autoUpdate = true;
    const panel = document.getElementById("panel")?.getBoundingClientRect();
    let [count, under] = [0, 0];
    let [left, right, low, top] = [width, -1, height, -1];
    const differs = (at: number) => Math.abs(shown[at] - hidden[at]) >= 12;
    for (let index = 0; index < width * height; index++) {
      if (!differs(4 * index) && !differs(4 * index + 1) && !differs(4 * index + 2)) continue;
      count++;
      const [x, y] = [index % width, Math.floor(index / width)];
      const [across, down] = [(x / width) * innerWidth, (1 - y / height) * innerHeight];
      if (panel !== undefined && across > panel.left && across < panel.right && down > panel.top && down < panel.bottom) under++;
      [left, right, low, top] = [Math.min(left, x), Math.max(right, x), Math.min(low, y), Math.max(top, y)];
    }
    const cut = left === 0 || low === 0 || right === width - 1 || top === height - 1;
    return { share: count / (width * height), wide: (right - left) / width, high: (top - low) / height, low: low / height, cut, covered: under / Math.max(count, 1) };
  }, what);
}
