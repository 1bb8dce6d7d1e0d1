// SPDX-License-Identifier: Apache-2.0
// Draws, flat or in a headset: renderer, camera, stage, and the frame that goes through all parts of the page.

import { ACESFilmicToneMapping, Group, PCFShadowMap, PerspectiveCamera, Scene, WebGLRenderer, type Object3D } from "three";
import { Stage } from "../scene/stage.ts";
import { allowAnisotropy } from "../scene/textures.ts";

/**
 * A part of the page that does something each frame. A frame runs the stages below in this order, each of them for all
 * parts: poses are known before pointers are aimed, and pointers before gestures are worked out.
 */
export interface FramePart {
  /** Works out the state to draw; `now` in ms of performance.now(). */
  update?(seconds: number, now: number): void;
  /** Aims pointers. */
  aim?(seconds: number, frame: XRFrame | null): void;
  /** Works out gestures and marks bodies accordingly. */
  interact?(seconds: number): void;
  /** Shows one of everything that may appear later, so that its shader is compiled before the page is shown. */
  warmUp?(): void;
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

/** The page goes on drawing for this time after the last change, until all easing has ended. */
const drawOnMs = 700;
/** Number of warm-up frames before the page is shown. */
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

  /** A film is being made: frames are drawn when they are asked for, none is left out, and nothing covers the picture. */
  filming = false;

  /** Distance from the camera to what it looks at, m. */
  lookDistance: () => number = () => this.stage.size;

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

  /** Half the diagonal of the box around all that is there, m. */
  get size(): number {
    return this.stage.size;
  }

  /** In a headset now. */
  get presenting(): boolean {
    return this.renderer.xr.isPresenting;
  }

  /** Parts take their turns in the order in which they were added. A part's `root` is put into the scene. */
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

  /** One frame of a film, at once. */
  drawFilmFrame(): void {
    this.filming = true;
    this.renderer.setAnimationLoop(null);
    this.invalidate();
    this.frame_(performance.now(), null);
  }

  /** The picture is out of date. A page on which nothing changes does not draw, which spares batteries. */
  invalidate(): void {
    this.drawUntil_ = performance.now() + drawOnMs;
  }

  /** Fits the drawing to a size in css px. */
  resize(width: number, height: number, pixelRatio: number): void {
    if (this.presenting) return;
    this.invalidate();
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
    if (this.presenting) this.invalidate();
    for (const part of parts) part.update?.(seconds, started);
    for (const part of parts) part.aim?.(seconds, frame);
    for (const part of parts) part.interact?.(seconds);
    const warming = this.warmed_ < warmFrames && this.worthShowing_();
    if (warming) for (const part of parts) part.warmUp?.();
    for (const part of parts) part.draw?.(seconds, frame);
    if (!this.presenting) this.stage.followCamera(this.camera, this.lookDistance());
    const scripted = performance.now();
    if (scripted < this.drawUntil_) {
      if (this.presenting) this.stage.hideContacts();
      else this.stage.drawContacts();
      this.renderer.render(this.scene, this.camera);
      if (warming && ++this.warmed_ === warmFrames) this.ready_();
    }
    timing.scriptMs = smooth(timing.scriptMs, scripted - started);
    timing.renderMs = smooth(timing.renderMs, performance.now() - scripted);
  }
}
