// SPDX-License-Identifier: Apache-2.0
// Draws, flat or in a headset: renderer, camera, stage, and the frame that calls all parts of the page.

import { ACESFilmicToneMapping, Group, PCFShadowMap, PerspectiveCamera, Scene, WebGLRenderer, type Object3D, type Vector3 } from "three";
import { Stage } from "../scene/stage.ts";
import { allowAnisotropy } from "../scene/textures.ts";
import { Redraw } from "./redraw.ts";

/**
 * A part of the page with work in each frame. A frame runs the stages below in this order, each of them for all parts:
 * poses are updated before pointers are aimed, and pointers before gestures are processed.
 */
export interface FramePart {
  /** Updates the state to draw; `now` in ms of performance.now(). */
  update?(seconds: number, now: number): void;
  /** Aims pointers. */
  aim?(seconds: number, frame: XRFrame | null): void;
  /** Processes gestures and marks bodies. */
  interact?(seconds: number): void;
  /** Draws one of each thing that may appear later, so that its shader is compiled before the page is shown. */
  warmUp?(): void;
  /** Writes the data for the renderer. */
  draw?(seconds: number, frame: XRFrame | null): void;
}

/** Running means, ms. */
export interface Timing {
  /** From frame to frame. */
  frameMs: number;
  /** Time of our script in a frame, without drawing. */
  scriptMs: number;
  /** Time to submit the scene to the GPU. */
  renderMs: number;
  /** Time to decode one pose frame. */
  decodeMs: number;
}

const longestFrameMs = 100;

/** A running mean that forgets half in about 14 values. */
export function smooth(mean: number, value: number): number {
  return mean + (value - mean) * 0.05;
}

export class Viewer {
  readonly renderer: WebGLRenderer;
  readonly scene = new Scene();
  /** The place of the viewer: identity on a flat screen, moved by locomotion in a headset. */
  readonly rig = new Group();
  /** The user's own room in a headset: what is in it has the size that the user sees. Its scale is meters of the world in one of the user's. */
  readonly room = new Group();
  readonly camera = new PerspectiveCamera(42, 1, 0.02, 200);
  readonly stage: Stage;
  readonly timing: Timing = { frameMs: 16.7, scriptMs: 0, renderMs: 0, decodeMs: 0 };

  /** While a film is made, frames are drawn on request, none is skipped, and nothing covers the picture. */
  filming = false;

  /** The place of a headset's user in the world, m: the head, and three numbers for each hand. Null and none before a flat screen. */
  readonly user = { head: null as Vector3 | null, hands: [] as number[] };

  /** Height of the page's own controls at the lower edge, and width of the script's at the right one, css px: a view is framed beside them. */
  readonly margins = { bottom: 84, right: 0 };

  /** Distance from the camera to what it looks at, m. */
  lookDistance: () => number = () => this.stage.size;

  private readonly parts_: FramePart[] = [];
  private worthShowing_: () => boolean = () => false;
  private ready_: () => void = () => {};
  private last_ = 0;
  private readonly redraw_ = new Redraw();
  private shown_: "nothing" | "warm" | "ready" = "nothing";

  constructor(canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    this.renderer.toneMapping = ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 0.95;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    allowAnisotropy(this.renderer);
    this.stage = new Stage(this.scene, this.renderer, () => this.invalidate());
    this.rig.add(this.camera, this.room);
    this.scene.add(this.rig);
  }

  /** Half the diagonal of the scene's box, m. */
  get size(): number {
    return this.stage.size;
  }

  /** Whether a headset session is active. */
  get presenting(): boolean {
    return this.renderer.xr.isPresenting;
  }

  /** Parts are called in the order in which they were added. A part's `root` is added to the scene. */
  add(...parts: readonly (FramePart & { readonly root?: Object3D })[]): void {
    for (const part of parts) {
      this.parts_.push(part);
      if (part.root !== undefined) this.scene.add(part.root);
    }
  }

  /** Whether the page has shown no picture of the world yet. */
  get hidden(): boolean {
    return this.shown_ !== "ready";
  }

  /** Whether nothing has changed for a while, so that no picture is drawn. */
  get resting(): boolean {
    return this.redraw_.isResting;
  }

  /** Starts drawing; `ready` is called once, after the first pictures of a complete world. */
  start(worthShowing: () => boolean, ready: () => void): void {
    this.worthShowing_ = worthShowing;
    this.ready_ = ready;
    this.renderer.setAnimationLoop((now: number, frame?: XRFrame) => this.frame_(now, frame ?? null));
  }

  /** Draws one frame of a film immediately. */
  drawFilmFrame(): void {
    this.filming = true;
    this.renderer.setAnimationLoop(null);
    this.invalidate();
    this.frame_(performance.now(), null);
  }

  /** Requests a new picture. A page without changes does not draw, which saves battery power. */
  invalidate(): void {
    this.redraw_.ask();
  }

  /** Fits the drawing to a size in css px. */
  resize(width: number, height: number, pixelRatio: number): void {
    if (this.presenting) return;
    this.invalidate();
    this.renderer.setPixelRatio(pixelRatio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // A tall screen has a wider vertical angle, so that hanging bodies still fit.
    this.camera.fov = width < height ? 52 : 42;
    this.camera.updateProjectionMatrix();
  }

  private frame_(now: number, frame: XRFrame | null): void {
    const started = performance.now();
    const elapsed = this.last_ === 0 ? 16.7 : now - this.last_;
    this.last_ = now;
    const seconds = Math.min(Math.max(elapsed, 0), this.filming ? Infinity : longestFrameMs) / 1000;
    const { timing, parts_: parts } = this;
    timing.frameMs = smooth(timing.frameMs, Math.min(elapsed, 1000));
    if (this.presenting) this.invalidate();
    for (const part of parts) part.update?.(seconds, started);
    for (const part of parts) part.aim?.(seconds, frame);
    for (const part of parts) part.interact?.(seconds);
    const warming = this.shown_ === "nothing" && this.worthShowing_();
    if (warming) for (const part of parts) part.warmUp?.();
    for (const part of parts) part.draw?.(seconds, frame);
    if (!this.presenting) this.stage.followCamera(this.camera, this.lookDistance());
    const scripted = performance.now();
    if (this.redraw_.isDue(seconds)) {
      // Not before there is a world: until it has come, its colors are not known.
      if (warming || this.shown_ !== "nothing" || this.presenting) this.stage.drawReflections();
      if (this.presenting || !this.renderer.shadowMap.enabled) this.stage.hideContacts();
      else this.stage.drawContacts();
      this.renderer.render(this.scene, this.camera);
      // The page shows the next picture: this one has one of each thing that may appear later.
      if (this.shown_ === "warm") {
        this.shown_ = "ready";
        this.ready_();
      } else if (warming) {
        this.shown_ = "warm";
        this.invalidate();
      }
    }
    timing.scriptMs = smooth(timing.scriptMs, scripted - started);
    timing.renderMs = smooth(timing.renderMs, performance.now() - scripted);
  }
}
