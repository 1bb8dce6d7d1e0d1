// SPDX-License-Identifier: Apache-2.0
// ?emulate=quest3: an emulated headset (IWER), for tests and for users without one.

import { metaQuest3, XRDevice } from "iwer";
import type { Page } from "../page/page.ts";
import type { Viewer } from "../page/viewer.ts";
import { DeskControls } from "./desk_controls.ts";

const eyeHeight = 1.6;
/** rad. Narrower than in a headset, as the edges of a wide view look stretched on a flat screen. */
const fovy = 1.35;

export interface Emulation {
  readonly device: XRDevice;
  readonly desk: DeskControls;
}

/** Installs the emulated headset as navigator.xr. Throws for an unknown model. */
export function emulate(page: Pick<Page, "viewer" | "world" | "commands">, canvas: HTMLCanvasElement, model: string): Emulation {
  if (model !== "quest3") throw new Error(`?emulate= supports quest3, not ${model}`);
  shadowClears(page.viewer.renderer.getContext() as WebGL2RenderingContext);
  const device = new XRDevice(metaQuest3, { stereoEnabled: true, fovy });
  // Browsers have their own navigator.xr even without a headset.
  device.installRuntime({ forceInstall: true });
  device.position.set(0, eyeHeight, 0);
  restHands(device);
  keepCanvasPlace(page.viewer, canvas);
  const desk = new DeskControls(page, canvas, device);
  page.viewer.add(desk);
  return { device, desk };
}

/** Hands at their places for a standing user. */
function restHands(device: XRDevice): void {
  for (const [side, x] of [["left", -0.26], ["right", 0.26]] as const) {
    device.controllers[side]?.position.set(x, eyeHeight - 0.36, -0.38);
    device.hands[side]?.position.set(x, eyeHeight - 0.36, -0.38);
  }
}

/**
 * The emulator reads the clear values each frame, for which a software renderer waits until all drawing is finished (46
 * ms a frame, measured). They are cached here and returned as copies, as the emulator keeps the result while it sets
 * other values.
 */
function shadowClears(gl: WebGL2RenderingContext): void {
  const color = Float32Array.from(gl.getParameter(gl.COLOR_CLEAR_VALUE) as Float32Array);
  let depth = gl.getParameter(gl.DEPTH_CLEAR_VALUE) as number;
  let stencil = gl.getParameter(gl.STENCIL_CLEAR_VALUE) as number;
  const { clearColor, clearDepth, clearStencil, getParameter } = gl;
  gl.clearColor = (red, green, blue, alpha) => {
    color[0] = red;
    color[1] = green;
    color[2] = blue;
    color[3] = alpha;
    clearColor.call(gl, red, green, blue, alpha);
  };
  gl.clearDepth = (value) => {
    depth = value;
    clearDepth.call(gl, value);
  };
  gl.clearStencil = (value) => {
    stencil = value;
    clearStencil.call(gl, value);
  };
  gl.getParameter = (name: GLenum): unknown => {
    switch (name) {
      case gl.COLOR_CLEAR_VALUE: return color.slice();
      case gl.DEPTH_CLEAR_VALUE: return depth;
      case gl.STENCIL_CLEAR_VALUE: return stencil;
      default: return getParameter.call(gl, name);
    }
  };
}

/** The emulator moves the canvas while it presents and puts it back last among its siblings, over the page's bar. */
function keepCanvasPlace(viewer: Viewer, canvas: HTMLCanvasElement): void {
  const { parentElement: parent, nextSibling: next } = canvas;
  viewer.renderer.xr.addEventListener("sessionend", () => {
    // After the emulator's own handler, in any order of registration.
    setTimeout(() => {
      parent?.insertBefore(canvas, next);
      window.dispatchEvent(new Event("resize"));
    });
  });
}
