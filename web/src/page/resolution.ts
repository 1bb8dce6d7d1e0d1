// SPDX-License-Identifier: Apache-2.0
// Fits the drawing to the window, and lowers the resolution if drawing is too slow. It does not alternate.

import type { FramePart, Viewer } from "./viewer.ts";

const slowFrameMs = 30;
const patienceSeconds = 1.5;
const lowestScale = 0.6;

export class Resolution implements FramePart {
  private readonly viewer_: Viewer;
  private scale_ = 1;
  private slow_ = 0;

  constructor(viewer: Viewer) {
    this.viewer_ = viewer;
    window.addEventListener("resize", () => this.apply());
    viewer.renderer.xr.addEventListener("sessionend", () => this.apply());
    this.apply();
  }

  apply(): void {
    this.viewer_.resize(innerWidth, innerHeight, Math.min(devicePixelRatio, 2) * this.scale_);
  }

  draw(seconds: number): void {
    if (document.visibilityState !== "visible" || this.viewer_.presenting || this.viewer_.filming) return;
    this.slow_ = this.viewer_.timing.frameMs > slowFrameMs ? this.slow_ + seconds : 0;
    if (this.slow_ < patienceSeconds || this.scale_ < lowestScale) return;
    this.slow_ = 0;
    this.scale_ *= 0.8;
    this.apply();
  }
}
