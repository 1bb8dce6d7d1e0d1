// SPDX-License-Identifier: Apache-2.0
// Draws, flat or in a headset: renderer, camera, stage, and the frame that goes through all parts of the page.

import { ACESFilmicToneMapping, Group, PCFShadowMap, PerspectiveCamera, Scene, WebGLRenderer, type Object3D } from "three";
import { Stage } from "../scene/stage.ts";
import { allowAnisotropy } from "../scene/textures.ts";

/**
 * A part of the page that does something each frame. A frame goes through all parts once for each stage, in the
 * order of the list: what is drawn is known before pointers are aimed, and gestures before anything is marked.
 */
export interface FramePart {
  /** Works out what is drawn in this frame; `now` in ms of performance.now(). */
  update?(seconds: number, now: number): void;
  /** Aims pointers. */
  aim?(seconds: number, frame: XRFrame | null): void;
  /** Works out gestures, and what follows from them. */
  decide?(seconds: number): void;
  /** Shows all that may appear later, once: no grab shall wait for a shader to be compiled. */
  warm?(): void;
  /** Writes what the renderer reads. */
  draw?(seconds: number, frame: XRFrame | null): void;
}

/** Running means, ms. */
export interface Timing {
  /** From frame to frame. */
  frameMs: number;
  /** Our own script in a frame, without drawing. */
  scriptMs: number;
  /** Handing the scene to the GPU. */
  renderMs: number;
  /** Taking in one pose frame. */
  decodeMs: number;
}

/** After the last change the page goes on drawing for so long, until all easing has ended. */
const drawOnMs = 700;
/** So many frames are drawn before the page is shown, with all that may appear later. */
const warmFrames = 3;
const longestFrameMs = 100;

/** A running mean that forgets half in about 14 values. */
export function smooth(mean: number, value: number): number {
  return mean + (value - mean) * 0.05;
}

export class Viewer {
  readonly renderer: WebGLRenderer;
  readonly scene = new Scene();
  /** Where the viewer stands; identity on a flat screen, moved by locomotion in a headset. */
  readonly rig = new Group();
  readonly camera = new PerspectiveCamera(42, 1, 0.02, 200);
  readonly stage: Stage;
  readonly timing: Timing = { frameMs: 16.7, scriptMs: 0, renderMs: 0, decodeMs: 0 };

  private readonly parts_: FramePart[] = [];
  private worthShowing_: () => boolean = () => false;
  private ready_: () => void = () => {};
  private last_ = 0;
  private drawUntil_ = 0;
  private warmed_ = 0;

  constructor(canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    this.renderer.toneMapping = ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 0.95;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    allowAnisotropy(this.renderer);
    this.stage = new Stage(this.scene, this.renderer);
    this.rig.add(this.camera);
    this.scene.add(this.rig);
  }

  /** In a headset now. */
  get presenting(): boolean {
    return this.renderer.xr.isPresenting;
  }

  /** A part takes its turn after those that were added before it; what it draws, its `root`, goes into the scene. */
  add(...parts: readonly (FramePart & { readonly root?: Object3D })[]): void {
    for (const part of parts) {
      this.parts_.push(part);
      if (part.root !== undefined) this.scene.add(part.root);
    }
  }

  /** Draws from now on; `ready` is called once, after the first pictures of a world that is worth showing. */
  start(worthShowing: () => boolean, ready: () => void): void {
    this.worthShowing_ = worthShowing;
    this.ready_ = ready;
    this.renderer.setAnimationLoop((now: number, frame?: XRFrame) => this.frame_(now, frame ?? null));
  }

  /** Something is to be drawn anew: a page on which nothing changes does not draw, which spares batteries. */
  stir(): void {
    this.drawUntil_ = performance.now() + drawOnMs;
  }

  /** Fits the drawing to a size in css px. */
  resize(width: number, height: number, pixelRatio: number): void {
    if (this.presenting) return;
    this.stir();
    this.renderer.setPixelRatio(pixelRatio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // A tall screen sees the same height of the world at a wider angle, so that a hanging thing still fits.
    this.camera.fov = width < height ? 52 : 42;
    this.camera.updateProjectionMatrix();
  }

  private frame_(now: number, frame: XRFrame | null): void {
    const started = performance.now();
    const elapsed = this.last_ === 0 ? 16.7 : now - this.last_;
    this.last_ = now;
    const seconds = Math.min(Math.max(elapsed, 0), longestFrameMs) / 1000;
    const { timing, parts_: parts } = this;
    timing.frameMs = smooth(timing.frameMs, Math.min(elapsed, 1000));
    if (this.presenting) this.stir();
    for (const part of parts) part.update?.(seconds, started);
    for (const part of parts) part.aim?.(seconds, frame);
    for (const part of parts) part.decide?.(seconds);
    const warming = this.warmed_ < warmFrames && this.worthShowing_();
    if (warming) for (const part of parts) part.warm?.();
    for (const part of parts) part.draw?.(seconds, frame);
    const scripted = performance.now();
    if (scripted < this.drawUntil_) {
      this.renderer.render(this.scene, this.camera);
      if (warming && ++this.warmed_ === warmFrames) this.ready_();
    }
    timing.scriptMs = smooth(timing.scriptMs, scripted - started);
    timing.renderMs = smooth(timing.renderMs, performance.now() - scripted);
  }
}
