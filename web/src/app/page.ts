// SPDX-License-Identifier: Apache-2.0
// The page's parts, wired together. Everything here works without the DOM's overlay, so that a headset
// can use the same parts: see README.md, "For XR".

import {
  ACESFilmicToneMapping, Color, Group, InstancedBufferAttribute, InstancedMesh, Matrix4, PCFShadowMap, PerspectiveCamera, Scene, Vector3,
  WebGLRenderer,
} from "three";
import { Gestures, type GestureListener, type Grab, type Pointer } from "../interact/gestures.ts";
import { Navigation } from "../navigate/navigation.ts";
import { Connection, type ConnectionListener, type LinkState } from "../net/connection.ts";
import { NO_BODY, type Notice, type PosesBuffer, type ServerMessage, type Vec3 } from "../protocol/generated.ts";
import { BodyView, Outline } from "../scene/body_view.ts";
import { Flashes } from "../scene/flashes.ts";
import { makeGeometry } from "../scene/geometry.ts";
import { HoldLines } from "../scene/hold_lines.ts";
import { materialOf, palette } from "../scene/materials.ts";
import { SparkView } from "../scene/spark_view.ts";
import { Stage } from "../scene/stage.ts";
import { allowAnisotropy } from "../scene/textures.ts";
import { TieView } from "../scene/tie_view.ts";
import { usualLateness } from "../scene/pose_buffer.ts";
import { WorldModel, type Change } from "../scene/world_model.ts";
import { Sound } from "../ui/sound.ts";
import { Commands } from "./commands.ts";

/** Told of what happens; the DOM overlay is one, a headset's panel another. All optional. */
export interface PageListener {
  /** The first pictures are drawn: the page can be shown. */
  ready?(): void;
  /** Part of the world, the selection or the look changed. */
  changed?(what: Change | "selection" | "look"): void;
  link?(state: LinkState, reason: string): void;
  notice?(notice: Omit<Notice, "type">): void;
  /** break, join or grab at a place (world, m). */
  effect?(kind: string, position: Readonly<Vec3>): void;
  hover?(pointer: Pointer, body: number): void;
  grab?(grab: Grab, phase: "start" | "end"): void;
  pressNothing?(pointer: Pointer): void;
  /** Each frame, after poses were sampled and before gestures are worked out: aim pointers here. */
  beforeGestures?(seconds: number, frame: XRFrame | null): void;
  /** Each frame, just before drawing. */
  beforeRender?(seconds: number, frame: XRFrame | null): void;
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

/** Colors of other people, by client number. */
const others = ["#8d6fd1", "#3f7fd0", "#c2863a", "#4c9a52", "#c0508e"].map((code) => new Color(code));
const mostOthers = 6;
/** After the last change the page goes on drawing for so long, until all easing has ended. */
const drawOnMs = 700;
/** Before the page is shown, all that may appear later is drawn once, so that no grab waits for a shader. */
const warmFrames = 3;
/** A hold that the server has not confirmed by then was refused. */
const confirmWithinMs = 1500;

export function colorOfClient(client: number): Color {
  return others[client % others.length];
}

export class Page implements ConnectionListener, GestureListener {
  readonly renderer: WebGLRenderer;
  readonly scene = new Scene();
  /** Where the viewer stands; identity on a flat screen, moved by locomotion in a headset. */
  readonly rig = new Group();
  readonly camera = new PerspectiveCamera(42, 1, 0.02, 200);
  readonly model = new WorldModel((change) => this.modelChanged_(change));
  readonly view = new BodyView(this.model);
  readonly ties = new TieView(this.model, this.view.poses);
  readonly sparks = new SparkView();
  readonly stage: Stage;
  readonly gestures = new Gestures(this.view, this);
  readonly navigation = new Navigation(this.camera);
  readonly connection: Connection;
  readonly commands = new Commands(this);
  readonly sound = new Sound();
  readonly listeners: PageListener[] = [];
  readonly timing: Timing = { frameMs: 16.7, scriptMs: 0, renderMs: 0, decodeMs: 0 };
  /** This client's selected body, -1: none. */
  selected = -1;
  /** Name of the look that is drawn. */
  look = "";

  private readonly holdLines_ = new HoldLines();
  private readonly flashes_ = new Flashes();
  private readonly statics_ = new Group();
  private readonly hoverOutline_ = new Outline(palette.hoverOnLight);
  private readonly selectedOutline_ = new Outline(palette.selected);
  private readonly otherOutlines_: Outline[] = [];
  private lookChosen_ = false;
  private placed_ = false;
  private fresh_ = true;
  private rebuild_: "no" | "yes" | "regrow" = "no";
  private retie_ = false;
  private last_ = 0;
  private drawUntil_ = 0;
  private warmed_ = 0;
  private readonly eye_ = new Vector3();
  private readonly point_ = new Float32Array(3);

  constructor(canvas: HTMLCanvasElement, socketUrl: string, name: string) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    this.renderer.toneMapping = ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 0.95;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    allowAnisotropy(this.renderer);
    this.stage = new Stage(this.scene, this.renderer);
    this.rig.add(this.camera);
    this.scene.add(this.rig, this.statics_, this.view.root, this.ties.root, this.sparks.root, this.holdLines_.root, this.flashes_.root);
    this.selectedOutline_.material.thickness.value = 0.0026;
    this.hoverOutline_.material.thickness.value = 0.0022;
    this.view.addOutline(this.selectedOutline_);
    this.view.addOutline(this.hoverOutline_);
    for (let index = 0; index < mostOthers; index++) {
      const outline = new Outline(new Color());
      outline.material.thickness.value = 0.0018;
      this.otherOutlines_.push(outline);
      this.view.addOutline(outline);
    }
    this.connection = new Connection(socketUrl, name, this);
  }

  start(): void {
    this.connection.open();
    this.renderer.setAnimationLoop((now: number, frame?: XRFrame) => this.frame_(now, frame ?? null));
  }

  /** Something is to be drawn anew: a page on which nothing changes does not draw, which spares batteries. */
  stir(): void {
    this.drawUntil_ = performance.now() + drawOnMs;
  }

  /** Selects a body, -1: none; tells the server. */
  select(body: number): void {
    if (body === this.selected) return;
    this.stir();
    this.selected = body;
    this.connection.send({ type: "select", body: body < 0 ? NO_BODY : body });
    this.tell_((listener) => listener.changed?.("selection"));
  }

  /** By the system's setting; outlines of what is pointed at stand out against either. */
  setTheme(theme: "light" | "dark"): void {
    this.stir();
    this.stage.setTheme(theme);
    this.hoverOutline_.material.color.copy(theme === "light" ? palette.hoverOnLight : palette.hoverOnDark);
  }

  /** Draws the world in another of its looks, on this page only. */
  setLook(look: string): void {
    this.lookChosen_ = true;
    this.applyLook_(look);
  }

  /** The body that a hand of this page holds, the newest if there are several; -1: none. */
  get held(): number {
    return this.gestures.grabs.at(-1)?.body ?? -1;
  }

  /** Force of a grab as the server last told, N. */
  forceOf(grab: Grab): number {
    return Math.max(this.confirmedForce_(grab), 0);
  }

  /** Fits the drawing to a size in css px. */
  resize(width: number, height: number, pixelRatio: number): void {
    if (this.renderer.xr.isPresenting) return;
    this.stir();
    this.renderer.setPixelRatio(pixelRatio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    // A tall screen sees the same height of the world at a wider angle, so that a hanging thing still fits.
    this.camera.fov = width < height ? 52 : 42;
    this.camera.updateProjectionMatrix();
  }

  // --- from the server

  message(message: ServerMessage): void {
    this.stir();
    switch (message.type) {
      case "welcome":
        this.fresh_ = true;
        if (this.selected >= 0) this.connection.send({ type: "select", body: this.selected });
        break;
      case "scene":
        this.takeScene_(message.key, message.json);
        break;
      case "structure":
        this.model.setStructure(message);
        break;
      case "clients":
        this.model.setClients(message.clients);
        break;
      case "notice":
        this.tell_((listener) => listener.notice?.(message));
        break;
      case "effect":
        this.flashes_.add(message.kind, message.position);
        this.sound.play(message.kind);
        this.tell_((listener) => listener.effect?.(message.kind, message.position));
        break;
      default:
        break;
    }
  }

  poses(poses: PosesBuffer, now: number): void {
    const started = performance.now();
    if (this.fresh_) {
      this.view.poses.clear();
      this.fresh_ = false;
    }
    if (poses.step !== this.model.step || poses.holds.count > 0) this.stir();
    this.model.setState(poses);
    this.view.poses.push(poses, now);
    this.sparks.take(poses.sparks);
    const { boxMin, boxMax } = poses;
    if (poses.keyframe) this.stage.fit(boxMin[0], boxMin[1], boxMin[2], boxMax[0], boxMax[1], boxMax[2]);
    this.timing.decodeMs += (performance.now() - started - this.timing.decodeMs) * 0.05;
  }

  state(state: LinkState, reason: string): void {
    if (state !== "connected") this.gestures.releaseAll();
    this.tell_((listener) => listener.link?.(state, reason));
  }

  // --- from the gestures

  hovered(pointer: Pointer, body: number): void {
    this.stir();
    if (body >= 0) pointer.pulse(0.15, 12);
    this.tell_((listener) => listener.hover?.(pointer, body));
  }

  grabStarted(grab: Grab): void {
    this.select(grab.body);
    this.connection.send({
      type: "grabStart", hold: grab.hold, body: grab.body, localPoint: vec3(grab.localPoint), target: vec3(grab.target),
    });
    grab.pointer.pulse(0.6, 30);
    this.tell_((listener) => listener.grab?.(grab, "start"));
  }

  grabMoved(grab: Grab): void {
    this.connection.send({ type: "grabMove", hold: grab.hold, target: vec3(grab.target) });
  }

  grabEnded(grab: Grab): void {
    this.connection.send({ type: "grabEnd", hold: grab.hold });
    this.tell_((listener) => listener.grab?.(grab, "end"));
  }

  pressedNothing(pointer: Pointer): void {
    this.tell_((listener) => listener.pressNothing?.(pointer));
  }

  // --- inside

  private tell_(say: (listener: PageListener) => void): void {
    for (const listener of this.listeners) say(listener);
  }

  private takeScene_(key: string, json: string): void {
    try {
      this.model.setScene(key, json);
    } catch (error) {
      const text = error instanceof Error ? error.message : String(error);
      this.tell_((listener) => listener.notice?.({
        level: 2, title: `The scene's "${key}" cannot be drawn`, text, hint: "Look at the script's description of its shapes.",
      }));
    }
  }

  private modelChanged_(change: Change): void {
    switch (change) {
      case "world":
        this.applyWorld_();
        break;
      case "bodies":
        if (this.rebuild_ === "no") this.rebuild_ = "yes";
        break;
      case "ties":
        this.retie_ = true;
        break;
      case "statics":
        this.buildStatics_();
        break;
      case "clients":
        this.outlineOthers_();
        break;
      default:
        break;
    }
    this.tell_((listener) => listener.changed?.(change));
  }

  private applyWorld_(): void {
    const { settings } = this.model;
    this.stage.setGround(settings.ground);
    this.navigation.ground = settings.ground;
    if (settings.camera !== null && !this.placed_) {
      this.navigation.setHome(settings.camera.position, settings.camera.target, true);
      this.placed_ = true;
    }
    if (!this.lookChosen_ || !settings.looks.includes(this.look)) this.applyLook_(settings.look);
  }

  private applyLook_(look: string): void {
    if (look === this.look) return;
    this.stir();
    this.look = look;
    this.rebuild_ = "regrow";
    this.tell_((listener) => listener.changed?.("look"));
  }

  private buildStatics_(): void {
    for (const child of this.statics_.children.slice()) {
      this.statics_.remove(child);
      const mesh = child as InstancedMesh;
      mesh.geometry.dispose();
      mesh.dispose();
    }
    for (const entry of this.model.statics) {
      const { shape } = entry;
      const geometry = makeGeometry(shape, "fine");
      geometry.setAttribute("tint", new InstancedBufferAttribute(new Float32Array(4), 4));
      // An instance of one, so that statics and bodies share a program.
      const mesh = new InstancedMesh(geometry, materialOf(shape.material, shape.color), 1);
      mesh.setMatrixAt(0, new Matrix4());
      mesh.position.set(...entry.position);
      mesh.quaternion.set(...entry.rotation);
      mesh.castShadow = mesh.receiveShadow = true;
      this.statics_.add(mesh);
    }
  }

  private outlineOthers_(): void {
    let used = 0;
    for (const client of this.model.clients) {
      if (client.client === this.connection.clientId || client.selected === NO_BODY || used === mostOthers) continue;
      const outline = this.otherOutlines_[used++];
      outline.material.color.copy(colorOfClient(client.client));
      this.view.outline(outline, client.selected);
    }
    for (; used < mostOthers; used++) this.view.outline(this.otherOutlines_[used], -1);
  }

  private frame_(now: number, xr: XRFrame | null): void {
    const started = performance.now();
    const elapsed = this.last_ === 0 ? 16.7 : now - this.last_;
    this.last_ = now;
    const seconds = Math.min(Math.max(elapsed, 0), 100) / 1000;
    this.timing.frameMs += (Math.min(elapsed, 1000) - this.timing.frameMs) * 0.05;
    if (this.rebuild_ !== "no" || this.retie_) {
      this.ties.rebuild(this.look);
      this.retie_ = false;
    }
    if (this.rebuild_ !== "no") {
      this.view.rebuild(this.look, this.rebuild_ === "regrow");
      this.rebuild_ = "no";
    }
    this.hurryHeld_();
    this.view.sample(started, seconds);
    this.dropVanished_();
    const presenting = this.renderer.xr.isPresenting;
    const moved = !presenting && this.navigation.update(seconds);
    if (presenting || moved || this.gestures.grabs.length > 0) this.stir();
    for (const listener of this.listeners) listener.beforeGestures?.(seconds, xr);
    this.gestures.updateAll();
    this.mark_();
    this.view.draw(seconds);
    this.ties.draw();
    this.flashes_.update(seconds, this.camera);
    for (const listener of this.listeners) listener.beforeRender?.(seconds, xr);
    const scripted = performance.now();
    if (scripted < this.drawUntil_) {
      this.renderer.render(this.scene, this.camera);
      if (this.warmed_ < warmFrames && this.view.pickableCount > 0 && ++this.warmed_ === warmFrames) {
        this.tell_((listener) => listener.ready?.());
      }
    }
    this.timing.scriptMs += (scripted - started - this.timing.scriptMs) * 0.05;
    this.timing.renderMs += (performance.now() - scripted - this.timing.renderMs) * 0.05;
  }

  /** What is held, and all that is jointed to it, is drawn without delay: alone it would tear off its neighbors. */
  private hurryHeld_(): void {
    const goal = this.view.poses.lateness.goal;
    goal.fill(usualLateness);
    for (const grab of this.gestures.grabs) {
      goal[grab.body] = 0;
      const articulate = this.model.articulateOf.get(grab.body);
      if (articulate === undefined) continue;
      for (const entry of this.model.articulates) if (entry.articulate === articulate) goal[entry.body] = 0;
    }
  }

  private dropVanished_(): void {
    if (this.selected >= 0 && this.model.bodies.size > 0 && !this.model.bodies.has(this.selected)) this.select(-1);
    for (let index = this.gestures.grabs.length - 1; index >= 0; index--) {
      const grab = this.gestures.grabs[index];
      if (!this.model.bodies.has(grab.body)) this.gestures.releaseAll(grab.body);
    }
  }

  /** Tints, outlines and springs of this frame. */
  private mark_(): void {
    const { model, view, gestures } = this;
    this.camera.getWorldPosition(this.eye_);
    view.clearTints();
    this.holdLines_.begin();
    for (let index = 0; index < model.holdCount; index++) {
      const hold = model.holds[index];
      if (hold.client === this.connection.clientId) continue;
      view.setTint(hold.body, palette.held, 0.85);
      this.holdLines_.add(hold.point, hold.target, hold.force, this.eye_, 0.8);
    }
    const now = performance.now();
    for (const grab of gestures.grabs) {
      const force = this.confirmedForce_(grab);
      if (force < 0 && now - grab.startedAt > confirmWithinMs) continue;
      view.setTint(grab.body, palette.held, 1);
      gestures.grabbedPoint(grab, this.point_);
      this.holdLines_.add(this.point_, grab.target, Math.max(force, 0), this.eye_, 1);
    }
    const warming = this.warmed_ < warmFrames && view.pickableCount > 0;
    if (warming) {
      this.point_.set(view.position.subarray(3 * view.pickable[0], 3 * view.pickable[0] + 3));
      this.holdLines_.add(this.point_, this.point_, 0, this.eye_, 1);
      this.flashes_.add("grab", this.point_);
    }
    this.holdLines_.end();
    let hovered = warming ? view.pickable[0] : -1;
    for (const pointer of gestures.pointers) {
      if (pointer.active && pointer.grab === null && pointer.hovered >= 0) hovered = pointer.hovered;
    }
    view.outline(this.hoverOutline_, hovered);
    // What is held is red all over: a line around it would only dim that.
    view.outline(this.selectedOutline_, this.selected === hovered || this.selected === this.held ? -1 : this.selected);
  }

  /** -1 while the server has not confirmed the hold. */
  private confirmedForce_(grab: Grab): number {
    for (let index = 0; index < this.model.holdCount; index++) {
      const hold = this.model.holds[index];
      if (hold.client === this.connection.clientId && hold.hold === grab.hold) return hold.force;
    }
    return -1;
  }
}

function vec3(from: Float32Array): Vec3 {
  return [from[0], from[1], from[2]];
}
