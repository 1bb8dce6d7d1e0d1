// SPDX-License-Identifier: Apache-2.0
// A session in a headset: enters and leaves, places the user, and each frame passes the state of hands and controllers
// to pointers, panels and locomotion.

import { Matrix4, Vector3, type Camera } from "three";
import type { LinkState } from "../net/connection.ts";
import type { PageListener, PageNotice } from "../page/events.ts";
import type { Page } from "../page/page.ts";
import type { FramePart } from "../page/viewer.ts";
import type { Change } from "../world/world.ts";
import type { Pointer } from "../interact/gestures.ts";
import type { Board } from "./board.ts";
import { ControllerView } from "./controllers.ts";
import { HandView } from "./hands.ts";
import { ForceLabel } from "./force_label.ts";
import { headsetCommands, ratioOf } from "./headset_commands.ts";
import { Input, type FaceButton } from "./input.ts";
import { Locomotion, turns } from "./locomotion.ts";
import { Notices } from "./notices.ts";
import { buttonAt, pointOnPlate, rayOnPlate, Spot } from "./plate.ts";
import { RayView } from "./rays.ts";
import { fitScale, standBefore, tableScale } from "./standing.ts";
import { Vignette } from "./vignette.ts";
import { WayHome } from "./way_home.ts";
import { WristPanel } from "./wrist_panel.ts";

interface View {
  readonly ray: RayView;
  readonly force: ForceLabel;
  readonly body: ControllerView | HandView | null;
}

const linkCard = "link";
const helpCard = "help";
const faceButtons: readonly FaceButton[] = ["a", "b"];
const fingerSlack = 7;
/** How near and far a headset sees, m of the user's; farther where the scene is. */
const nearest = 0.03;
const farthest = 60;
/** Height of a standing person's eyes, m. */
const standingEyes = 1.6;
/** Pictures a second. */
const fastestRate = 90;
/** From 0 to 1. */
const foveation = 0.6;

export class Headset implements PageListener, FramePart {
  readonly inputs: Input[] = [];
  readonly panel: WristPanel;
  readonly notices: Notices;
  readonly locomotion: Locomotion;
  readonly vignette = new Vignette();
  /** All panels that can be pressed. */
  readonly boards: readonly Board[];
  /** Head in the world, m. */
  readonly head = new Vector3();

  private readonly page_: Page;
  private session_: XRSession | null = null;
  private space_: XRReferenceSpace | null = null;
  private readonly wayHome_ = new WayHome();
  private toPlace_ = false;
  /** Raises the eyes of who sits to those of who stands, m of the user's. */
  private raised_ = 0;
  /** The pace that the panel shows. */
  private ratio_ = "";
  private pressedBy_: Input | null = null;
  private everConnected_ = false;
  private helped_ = false;
  /** By pointer name; kept, since hands and controllers may disappear and return. */
  private readonly views_ = new Map<string, View>();
  private readonly headLocal_ = new Matrix4();
  private readonly eye_ = new Vector3();
  private readonly scene_ = new Vector3();
  private readonly spot_ = new Spot();

  constructor(page: Page) {
    this.page_ = page;
    this.locomotion = new Locomotion(page.viewer.rig, page.viewer.room);
    const { locomotion } = this;
    void import("../page/walking.ts").then(({ wallsOf }) => {
      locomotion.walls = wallsOf(page.world);
    });
    this.notices = new Notices(page.viewer.room);
    page.viewer.room.add(this.vignette.mesh, this.wayHome_.mesh);
    page.commands.add(...headsetCommands({
      turn: (direction) => {
        locomotion.turn(direction * (locomotion.turnBy || turns[0]), this.head);
        this.moved_();
      },
      turnBy: () => locomotion.turnBy,
      nextTurn: () => {
        locomotion.turnBy = turns[(turns.indexOf(locomotion.turnBy) + 1) % turns.length];
      },
      seated: () => this.raised_ !== 0,
      sit: () => this.sit_(),
      scale: () => page.viewer.room.scale.x,
      changeSize: () => {
        this.place_(page.viewer.room.scale.x === 1 ? tableScale(page.navigation.home.distance) : 1);
      },
      home: () => this.goHome_(),
      aimTeleport: () => {
        if (this.pressedBy_ !== null) this.locomotion.arm(this.pressedBy_);
      },
      teleportArmed: () => this.locomotion.armed,
      leave: () => void this.leave(),
    }));
    this.panel = new WristPanel(page);
    this.everConnected_ = page.session.connection.connected;
    this.boards = [this.panel.board, this.notices.board];
    page.viewer.scene.add(this.locomotion.root);
    page.events.add(this);
    page.viewer.add(this);
    page.commands.onChange(() => this.markButtons_());
    page.viewer.renderer.xr.addEventListener("sessionend", () => this.ended_());
  }

  get presenting(): boolean {
    return this.page_.viewer.presenting;
  }

  /**
   * Asks for a session, in which the user's surroundings are seen behind the world with "immersive-ar"; to be called from a gesture of the
   * user. Rejects when the headset refuses.
   */
  async enter(mode: "immersive-vr" | "immersive-ar" = "immersive-vr"): Promise<void> {
    if (this.session_ !== null) return;
    const system = navigator.xr;
    if (system === undefined) throw new Error("this browser has no WebXR");
    const session = await system.requestSession(mode, {
      requiredFeatures: ["local-floor"], optionalFeatures: ["hand-tracking"],
    });
    this.session_ = session;
    session.addEventListener("inputsourceschange", (event) => this.sourcesChanged_(event));
    session.addEventListener("selectstart", (event) => this.press_(event, true));
    session.addEventListener("selectend", (event) => this.release_(event, true));
    session.addEventListener("squeezestart", (event) => this.press_(event, false));
    session.addEventListener("squeezeend", (event) => this.release_(event, false));
    const { xr } = this.page_.viewer.renderer;
    xr.enabled = true;
    xr.setReferenceSpaceType("local-floor");
    try {
      await xr.setSession(session);
    } catch (error) {
      this.session_ = null;
      await session.end().catch(() => {});
      throw error;
    }
    this.easeDrawing_(session);
    this.space_ = xr.getReferenceSpace();
    this.space_?.addEventListener("reset", () => {
      this.toPlace_ = true;
    });
    this.toPlace_ = true;
    this.page_.viewer.stage.passthrough = mode === "immersive-ar";
    this.page_.gestures.releaseAll();
    this.page_.sound.wake();
    for (const source of session.inputSources) this.add_(source);
    this.panel.arrange();
    this.link(this.page_.session.connection.state, "");
  }

  /** The quickest rate that usual scenes keep, and coarser pixels at the edge of the view, where headsets offer them. */
  private easeDrawing_(session: XRSession): void {
    const { xr } = this.page_.viewer.renderer;
    xr.setFoveation(foveation);
    const rates = [...(session.supportedFrameRates ?? [])].filter((rate) => rate <= fastestRate);
    // Refused by some while a session begins; the headset then keeps its own.
    if (rates.length > 0) void session.updateTargetFrameRate?.(Math.max(...rates)).catch(() => {});
  }

  async leave(): Promise<void> {
    await this.session_?.end();
  }

  /** The text above a hand that holds something; empty: none. */
  forceText(input: Input): string {
    return this.views_.get(input.pointer.name)?.force.text ?? "";
  }

  // --- FramePart

  aim(seconds: number, frame: XRFrame | null): void {
    if (frame === null || this.space_ === null || !this.presenting) return;
    const { viewer } = this.page_;
    const isNew = frame.getViewerPose(this.space_) !== null;
    if (isNew) this.readHead_();
    if (this.toPlace_) this.goHome_();
    for (const input of this.inputs) {
      input.read(frame, this.space_);
      input.lift(viewer.room.matrixWorld, viewer.room.scale.x);
    }
    if (this.locomotion.steer(this.inputs, this.head, viewer.size, seconds)) this.moved_();
    viewer.user.head = this.head;
    viewer.user.hands = this.inputs.filter(({ tracked }) => tracked).slice(0, 2).flatMap(({ pointer }) => [...pointer.tip]);
    // Eyes that were not tracked anew have their scale.
    if (isNew) this.scaleEyes_();
    this.vignette.update(this.headLocal_, this.locomotion.gliding, seconds);
    const { room, stage, size } = viewer;
    const scene = room.worldToLocal(this.scene_.copy(stage.middle));
    this.wayHome_.update(this.headLocal_, scene, size / room.scale.x, seconds);
    this.panel.update(this.wearer_(), this.headLocal_, seconds);
    if (this.page_.gestures.grabs.length > 0) this.notices.remove(helpCard);
    this.notices.update(this.headLocal_, scene, seconds);
    for (const board of this.boards) board.begin();
    for (const input of this.inputs) this.aim_(input);
    for (const board of this.boards) board.end(seconds);
    this.actByButtons_();
  }

  draw(seconds: number, frame: XRFrame | null): void {
    if (frame === null || !this.presenting) return;
    this.locomotion.draw(this.floor_(), this.headYaw_());
    for (const input of this.inputs) {
      const view = this.views_.get(input.pointer.name);
      if (view === undefined) continue;
      view.ray.root.visible = true;
      const { grab } = input.pointer;
      view.force.update(input, grab === null ? -1 : this.page_.selection.forceOf(grab), this.headLocal_, seconds);
      view.ray.update(input, this.eye_, this.locomotion.aiming !== input, this.page_.viewer.room.scale.x, seconds);
      if (view.body !== null) {
        view.body.root.visible = input.tracked;
        if (input.tracked) view.body.update(input);
      }
    }
  }

  // --- PageListener

  changed(what: Change | "selection"): void {
    if (what === "settings" || what === "look") this.panel.arrange();
    else this.panel.board.repaint();
  }

  effect(kind: string): void {
    if (!this.presenting || kind === "grab" || kind.startsWith("#")) return;
    const strength = kind === "break" ? 0.9 : 0.5;
    for (const input of this.inputs) input.pulse(input.pointer.grab === null ? strength / 2 : strength, kind === "break" ? 60 : 35);
  }

  notice({ level, title, text, hint, key, seconds }: PageNotice): void {
    if (!this.presenting) return;
    if (title === "" && text === "") this.notices.remove(key ?? "");
    else this.notices.show(level, title, text, hint, key, false, seconds);
  }

  link(state: LinkState, reason: string): void {
    if (state === "connected") {
      this.everConnected_ = true;
      this.notices.remove(linkCard);
    } else if (state === "lost") {
      this.notices.show(1, this.everConnected_ ? "The world is not answering" : "No world here yet",
        "Trying again; it reconnects automatically.", "If the script was stopped, start it again.", linkCard, true);
    } else if (state === "refused") {
      this.notices.show(2, "The world refuses this page", reason, "", linkCard, true);
    }
  }

  pressNothing(pointer: Pointer): void {
    // A bare hand pinches by accident: only a trigger clears the selection.
    const input = this.inputs.find((each) => each.pointer === pointer);
    if (input !== undefined && !input.isHand) this.page_.selection.select(-1);
  }

  // --- session

  private sourcesChanged_(event: XRInputSourcesChangeEvent): void {
    for (const source of event.removed) this.remove_(source);
    for (const source of event.added) this.add_(source);
  }

  private add_(source: XRInputSource): void {
    if (source.targetRayMode === "screen" || this.inputs.some((input) => input.source === source)) return;
    const input = new Input(source);
    this.inputs.push(input);
    this.page_.gestures.add(input.pointer);
    if (!this.views_.has(input.pointer.name)) this.views_.set(input.pointer.name, this.makeView_(input));
    this.markButtons_();
    if (input.hasBody) this.greet_(input.isHand);
  }

  private remove_(source: XRInputSource): void {
    const index = this.inputs.findIndex((input) => input.source === source);
    if (index < 0) return;
    const [input] = this.inputs.splice(index, 1);
    this.page_.gestures.remove(input.pointer);
    this.locomotion.drop(input);
    this.hide_(input);
  }

  private makeView_(input: Input): View {
    const ray = new RayView();
    const force = new ForceLabel();
    this.page_.viewer.scene.add(ray.root);
    this.page_.viewer.room.add(force.board.mesh);
    const body = !input.hasBody ? null : input.isHand ? new HandView() : new ControllerView(input.source.handedness);
    if (body !== null) this.page_.viewer.room.add(body.root);
    return { ray, force, body };
  }

  private hide_(input: Input): void {
    const view = this.views_.get(input.pointer.name);
    if (view === undefined) return;
    view.ray.root.visible = false;
    view.force.board.hide();
    if (view.body !== null) view.body.root.visible = false;
  }

  private ended_(): void {
    this.session_ = null;
    this.space_ = null;
    while (this.inputs.length > 0) this.remove_(this.inputs[0].source);
    this.locomotion.drop(null);
    this.panel.board.hide();
    this.notices.clear();
    this.helped_ = false;
    const { rig, room, user } = this.page_.viewer;
    user.head = null;
    user.hands = [];
    rig.position.set(0, 0, 0);
    rig.rotation.set(0, 0, 0);
    room.scale.setScalar(1);
    this.page_.viewer.stage.passthrough = false;
    this.vignette.mesh.visible = this.wayHome_.mesh.visible = false;
    rig.updateMatrixWorld();
    this.page_.viewer.invalidate();
  }

  /** Explains once a session how to grab, with hands or with controllers. */
  private greet_(hands: boolean): void {
    if (this.helped_) return;
    this.helped_ = true;
    this.notices.show(0, hands ? "Pinch to grab" : "Pull the trigger to grab",
      hands ? "A near body, or a far one along the ray. Look at your left wrist, as at a watch, for everything else." : "A near body, or a far one along the ray. A stick to the side turns you, forward teleports. Look at your left wrist, as at a watch, for everything else.",
      "", helpCard);
  }

  // --- each frame

  /** The middle between the eyes, with the left eye's direction, in the reference space; and in the world. */
  private readHead_(): void {
    const { room, renderer } = this.page_.viewer;
    const camera = renderer.xr.getCamera();
    this.headLocal_.copy(camera.matrix);
    const eyes = camera.cameras;
    if (eyes.length > 1) {
      const e = this.headLocal_.elements;
      for (let axis = 12; axis < 15; axis++) e[axis] = (eyes[0].matrix.elements[axis] + eyes[1].matrix.elements[axis]) / 2;
    }
    this.head.setFromMatrixPosition(this.headLocal_).applyMatrix4(room.matrixWorld);
    this.eye_.copy(this.head);
  }

  /**
   * A headset tells its eyes in the user's meters. Their places and depths are turned into those of the world here, so that all that is
   * drawn at a size, lit and fogged need not know of the scale. Once for each pose: three.js keeps the matrices until the next one.
   */
  private scaleEyes_(): void {
    const { renderer, room: { scale: { x: scale } }, camera, size, stage } = this.page_.viewer;
    camera.near = nearest;
    camera.far = Math.max(farthest, (this.head.distanceTo(stage.middle) + 40 * size) / scale);
    stage.followHead(this.head);
    const eyes = renderer.xr.getCamera();
    for (const eye of [eyes, ...eyes.cameras] as Camera[]) {
      const { elements } = eye.matrix;
      for (let axis = 12; axis < 15; axis++) elements[axis] *= scale;
      if (eye !== eyes) eye.projectionMatrix.elements[14] *= scale;
      eye.projectionMatrixInverse.copy(eye.projectionMatrix).invert();
    }
  }

  /** Rad about the vertical, in the world. */
  private headYaw_(): number {
    const { elements } = this.headLocal_;
    return this.page_.viewer.rig.rotation.y + Math.atan2(elements[8], elements[10]);
  }

  /** Raises the eyes of a seated user to those of a standing one, or lowers them again. */
  private sit_(): void {
    const { rig, room } = this.page_.viewer;
    const before = this.raised_;
    this.raised_ = before === 0 ? standingEyes - this.headLocal_.elements[13] : 0;
    this.locomotion.lift += this.raised_ - before;
    rig.position.y += room.scale.x * (this.raised_ - before);
    this.moved_();
  }

  private goHome_(): void {
    this.place_(fitScale(this.page_.navigation.home.distance));
  }

  /** Before the scene, at a scale. */
  private place_(scale: number): void {
    this.toPlace_ = false;
    const { world, navigation, framing, viewer: { rig, room } } = this.page_;
    room.scale.setScalar(scale);
    const { pivot, distance, yaw, pitch } = navigation.home;
    const flat = distance * Math.cos(pitch);
    const eye = [pivot[0] + flat * Math.sin(yaw), pivot[1] + distance * Math.sin(pitch), pivot[2] + flat * Math.cos(yaw)] as const;
    const { ground } = world;
    const toShow = framing.stepToShow(0.9 * this.calcSide_());
    standBefore({ scale, eye: [...eye], target: [...pivot], ground, toShow }, this.headLocal_.elements, this.raised_, rig);
    this.locomotion.lift = ground === null ? this.raised_ : (rig.position.y - ground) / scale;
    this.panel.snap();
    this.moved_();
  }

  /** Tangent of the angle that at least one eye sees to the left, or to the right if that is less. */
  private calcSide_(): number {
    let [left, right] = [0, 0];
    for (const { projectionMatrix: { elements } } of this.page_.viewer.renderer.xr.getCamera().cameras) {
      left = Math.max(left, (1 - elements[8]) / elements[0]);
      right = Math.max(right, (1 + elements[8]) / elements[0]);
    }
    return Math.min(left, right) || Infinity;
  }

  /** After a jump of the rig: updates everything that depends on it within the frame. */
  private moved_(): void {
    const { rig, room } = this.page_.viewer;
    rig.updateMatrixWorld();
    const ratio = ratioOf(room.scale.x);
    if (ratio !== this.ratio_) this.panel.board.repaint();
    this.ratio_ = ratio;
    this.head.setFromMatrixPosition(this.headLocal_).applyMatrix4(room.matrixWorld);
    this.eye_.copy(this.head);
    for (const input of this.inputs) input.lift(room.matrixWorld, room.scale.x);
  }

  /** The hand that carries the panel. With one hand only, the panel floats, as that hand presses it. */
  private wearer_(): Input | null {
    if (this.inputs.length < 2) return null;
    for (const input of this.inputs) if (input.hasBody && input.source.handedness === "left") return input;
    return null;
  }

  private floor_(): number {
    const { world, viewer: { rig, room } } = this.page_;
    return world.ground ?? rig.position.y - room.scale.x * this.locomotion.lift;
  }

  /** Finds the panel that a hand points at or touches; presses it when a fingertip passes through. */
  private aim_(input: Input): void {
    input.clearPanel();
    if (input.pointer.grab === null && input.tracked) {
      for (const board of this.boards) this.touch_(input, board);
      if (!input.touching) for (const board of this.boards) this.point_(input, board);
    }
    if (input.board !== null) {
      const before = input.board.hovered;
      input.board.hover(input.button);
      if (input.button >= 0 && input.button !== before) input.pulse(0.12, 8);
    }
    input.pick(input.board === null && this.locomotion.aiming !== input);
  }

  private touch_(input: Input, board: Board): void {
    if (!board.ready || board.buttons.length === 0 || !input.hasBody || (board === this.panel.board && input === this.panel.wearer)) return;
    const over = pointOnPlate(board, input.finger, this.spot_);
    const pressed = input.poke(board).update(over, this.spot_.distance);
    if (!input.poke(board).near) return;
    input.board = board;
    input.touching = true;
    input.button = buttonAt(board.buttons, this.spot_.x, this.spot_.y, fingerSlack);
    input.spot.distance = this.spot_.distance;
    if (pressed) this.push_(input);
  }

  private point_(input: Input, board: Board): void {
    if (!board.ready || board.buttons.length === 0 || !input.hasRay || (board === this.panel.board && input === this.panel.wearer)) return;
    if (!rayOnPlate(board, input.pointer.origin, input.pointer.direction, this.spot_)) return;
    if (input.board !== null && this.spot_.distance > input.spot.distance) return;
    input.board = board;
    input.button = buttonAt(board.buttons, this.spot_.x, this.spot_.y);
    input.spot.distance = this.spot_.distance;
  }

  private push_(input: Input): void {
    if (input.board === null || input.button < 0) return;
    this.pressedBy_ = input;
    input.pulse(0.5, 20);
    this.page_.sound.effect("grab");
    input.board.push(input.button);
  }

  /** Face buttons run the script's actions on the body that this hand holds or points at, else on the selected one. */
  private actByButtons_(): void {
    for (const input of this.inputs) {
      for (const button of faceButtons) {
        if (!input.pressed(button)) continue;
        const action = this.page_.commands.script.find((command) => command.button === button);
        if (action === undefined) continue;
        const meant = input.pointer.grab?.body ?? (input.board === null ? input.pointer.hovered : -1);
        if (action.onBody && meant >= 0) this.page_.selection.select(meant);
        if (meant >= 0) action.runOn(meant);
        else action.run();
        input.pulse(0.4, 20);
      }
    }
  }

  private markButtons_(): void {
    const { script } = this.page_.commands;
    const onA = script.some((command) => command.button === "a");
    const onB = script.some((command) => command.button === "b");
    for (const view of this.views_.values()) if (view.body instanceof ControllerView) view.body.mark(onA, onB);
  }

  // --- presses; only starts and ends count: an emulated headset sends `select` too early

  /** `select`: trigger or pinch; else the grip button, which grabs bodies but does not press panels. */
  private press_(event: XRInputSourceEvent, select: boolean): void {
    // An input may appear at the moment of its press.
    this.add_(event.inputSource);
    const input = this.inputs.find((each) => each.source === event.inputSource);
    if (input === undefined || this.space_ === null) return;
    this.aimNow_(input, event.frame);
    if (select) input.selecting = true;
    else input.squeezing = true;
    if (input.board !== null) {
      // A bare hand with its fingertip at the panel presses with that.
      if (select && !(input.touching && input.isHand)) this.push_(input);
      return;
    }
    if (select && this.locomotion.press(input)) return;
    if (this.locomotion.aiming === input) return;
    input.pointer.pressed = true;
    this.page_.gestures.update(input.pointer);
  }

  private release_(event: XRInputSourceEvent, select: boolean): void {
    const input = this.inputs.find((each) => each.source === event.inputSource);
    if (input === undefined) return;
    if (select) input.selecting = false;
    else input.squeezing = false;
    if (select && this.locomotion.release(input, this.head)) this.moved_();
    if (input.selecting || input.squeezing) return;
    input.pointer.pressed = false;
    this.page_.gestures.update(input.pointer);
  }

  private aimNow_(input: Input, frame: XRFrame): void {
    if (this.space_ === null) return;
    input.read(frame, this.space_);
    input.lift(this.page_.viewer.room.matrixWorld, this.page_.viewer.room.scale.x);
    this.aim_(input);
  }
}
