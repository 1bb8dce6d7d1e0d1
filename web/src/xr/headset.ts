// SPDX-License-Identifier: Apache-2.0
// A session in a headset: enters and leaves, places the user, and each frame hands the state of hands
// and controllers to pointers, panels and locomotion.

import { Matrix4, Vector3 } from "three";
import type { LinkState } from "../net/connection.ts";
import type { PageListener, PageNotice } from "../page/events.ts";
import type { Page } from "../page/page.ts";
import type { FramePart } from "../page/viewer.ts";
import type { Change } from "../world/world.ts";
import type { Pointer } from "../interact/gestures.ts";
import type { Board } from "./board.ts";
import { ControllerView } from "./controllers.ts";
import { HandView } from "./hands.ts";
import { headsetCommands } from "./headset_commands.ts";
import { Input, type FaceButton } from "./input.ts";
import { Locomotion, snapDegrees } from "./locomotion.ts";
import { Notices } from "./notices.ts";
import { buttonAt, pointOnPlate, rayOnPlate, Spot } from "./plate.ts";
import { RayView } from "./rays.ts";
import { standBefore } from "./standing.ts";
import { WristPanel } from "./wrist_panel.ts";

interface View {
  readonly ray: RayView;
  readonly body: ControllerView | HandView | null;
}

const linkCard = "link";
const helpCard = "help";
const faceButtons: readonly FaceButton[] = ["a", "b"];
const fingerSlack = 7;

export class Headset implements PageListener, FramePart {
  readonly inputs: Input[] = [];
  readonly panel: WristPanel;
  readonly notices: Notices;
  readonly locomotion: Locomotion;
  /** All panels that can be pressed. */
  readonly boards: readonly Board[];
  /** Head in the world, m. */
  readonly head = new Vector3();

  private readonly page_: Page;
  private session_: XRSession | null = null;
  private space_: XRReferenceSpace | null = null;
  private toPlace_ = false;
  private pressedBy_: Input | null = null;
  private everConnected_ = false;
  private helped_ = false;
  /** By pointer name; kept, since hands and controllers come and go. */
  private readonly views_ = new Map<string, View>();
  private readonly headLocal_ = new Matrix4();
  private readonly eye_ = new Vector3();
  private readonly spot_ = new Spot();

  constructor(page: Page) {
    this.page_ = page;
    this.locomotion = new Locomotion(page.viewer.rig);
    this.notices = new Notices(page.viewer.rig);
    page.commands.add(...headsetCommands({
      turn: (direction) => {
        this.locomotion.turn(direction * snapDegrees, this.head);
        this.moved_();
      },
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

  /** Asks for a session; to be called from a gesture of the user. Rejects when the headset refuses. */
  async enter(): Promise<void> {
    if (this.session_ !== null) return;
    const system = navigator.xr;
    if (system === undefined) throw new Error("this browser has no WebXR");
    const session = await system.requestSession("immersive-vr", {
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
    this.space_ = xr.getReferenceSpace();
    this.space_?.addEventListener("reset", () => {
      this.toPlace_ = true;
    });
    this.toPlace_ = true;
    this.page_.gestures.releaseAll();
    this.page_.sound.wake();
    for (const source of session.inputSources) this.add_(source);
    this.panel.arrange();
    this.link(this.page_.session.connection.state, "");
  }

  async leave(): Promise<void> {
    await this.session_?.end();
  }

  // --- FramePart

  aim(seconds: number, frame: XRFrame | null): void {
    if (frame === null || this.space_ === null || !this.presenting) return;
    this.readHead_();
    if (this.toPlace_) this.place_();
    for (const input of this.inputs) {
      input.read(frame, this.space_);
      input.lift(this.page_.viewer.rig.matrixWorld);
    }
    if (this.locomotion.steer(this.inputs, this.head, seconds)) this.moved_();
    this.panel.update(this.wearer_(), this.headLocal_, seconds);
    this.notices.update(this.headLocal_, seconds);
    for (const board of this.boards) board.begin();
    for (const input of this.inputs) this.aim_(input);
    for (const board of this.boards) board.end(seconds);
    this.actByButtons_();
  }

  draw(seconds: number, frame: XRFrame | null): void {
    if (frame === null || !this.presenting) return;
    this.locomotion.draw(this.floor_());
    for (const input of this.inputs) {
      const view = this.views_.get(input.pointer.name);
      if (view === undefined) continue;
      view.ray.root.visible = true;
      view.ray.update(input, this.eye_, this.locomotion.aiming !== input, seconds);
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
    if (!this.presenting || kind === "grab") return;
    const strength = kind === "break" ? 0.9 : 0.5;
    for (const input of this.inputs) input.pulse(input.pointer.grab === null ? strength / 2 : strength, kind === "break" ? 60 : 35);
  }

  notice({ level, title, text, hint, key }: PageNotice): void {
    if (this.presenting) this.notices.show(level, title, text, hint, key);
  }

  link(state: LinkState, reason: string): void {
    if (state === "connected") {
      this.everConnected_ = true;
      this.notices.remove(linkCard);
    } else if (state === "lost") {
      this.notices.show(1, this.everConnected_ ? "The world is not answering" : "No world here yet",
        "Trying again; it comes back by itself.", "If the script was stopped, start it again.", linkCard, true);
    } else if (state === "refused") {
      this.notices.show(2, "The world does not let this page in", reason, "", linkCard, true);
    }
  }

  pressNothing(pointer: Pointer): void {
    // A bare hand pinches by chance now and then: only a trigger clears the selection.
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
    this.page_.viewer.scene.add(ray.root);
    const body = !input.hasBody ? null : input.isHand ? new HandView() : new ControllerView(input.source.handedness);
    if (body !== null) this.page_.viewer.rig.add(body.root);
    return { ray, body };
  }

  private hide_(input: Input): void {
    const view = this.views_.get(input.pointer.name);
    if (view === undefined) return;
    view.ray.root.visible = false;
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
    const { rig } = this.page_.viewer;
    rig.position.set(0, 0, 0);
    rig.rotation.set(0, 0, 0);
    rig.updateMatrixWorld();
    this.page_.viewer.invalidate();
  }

  /** Explains once a session how to take hold, with hands or with controllers. */
  private greet_(hands: boolean): void {
    if (this.helped_) return;
    this.helped_ = true;
    this.notices.show(0, hands ? "Pinch to take hold" : "Pull the trigger to take hold",
      hands ? "Close to a part, or from afar along the ray. All else is on the panel at your left hand." : "Close to a part, or from afar along the ray. A stick to the side turns you, forward takes you elsewhere. All else is on the panel at your left hand.",
      "", helpCard);
  }

  // --- each frame

  /** The middle between the eyes, with the left eye's direction, in the reference space; and in the world. */
  private readHead_(): void {
    const { rig, renderer } = this.page_.viewer;
    const camera = renderer.xr.getCamera();
    this.headLocal_.copy(camera.matrix);
    const eyes = camera.cameras;
    if (eyes.length > 1) {
      const e = this.headLocal_.elements;
      for (let axis = 12; axis < 15; axis++) e[axis] = (eyes[0].matrix.elements[axis] + eyes[1].matrix.elements[axis]) / 2;
    }
    this.head.setFromMatrixPosition(this.headLocal_).applyMatrix4(rig.matrixWorld);
    this.eye_.copy(this.head);
  }

  private place_(): void {
    this.toPlace_ = false;
    const { world, navigation, viewer: { rig } } = this.page_;
    const { pivot, distance, yaw, pitch } = navigation.home;
    const flat = distance * Math.cos(pitch);
    const eye = [pivot[0] + flat * Math.sin(yaw), pivot[1] + distance * Math.sin(pitch), pivot[2] + flat * Math.cos(yaw)] as const;
    standBefore({ eye: [...eye], target: [...pivot], ground: world.ground }, this.headLocal_.elements, rig);
    rig.updateMatrixWorld();
    this.panel.snap();
    this.readHead_();
  }

  /** After the rig jumped: everything that hangs on it is worked out again within the frame. */
  private moved_(): void {
    const { rig } = this.page_.viewer;
    this.head.setFromMatrixPosition(this.headLocal_).applyMatrix4(rig.matrixWorld);
    this.eye_.copy(this.head);
    for (const input of this.inputs) input.lift(rig.matrixWorld);
  }

  /** The hand that wears the panel. A user with one hand needs it to press the panel, so the panel floats. */
  private wearer_(): Input | null {
    if (this.inputs.length < 2) return null;
    for (const input of this.inputs) if (input.hasBody && input.source.handedness === "left") return input;
    return null;
  }

  private floor_(): number {
    return this.page_.world.ground ?? this.page_.viewer.rig.position.y;
  }

  /** Finds the panel that a hand points at or touches; presses it when a fingertip goes through. */
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

  /** Face buttons run the script's actions on what that hand holds or points at, else on what is selected. */
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

  // --- presses; only starts and ends count: an emulated headset tells `select` too early

  /** `select`: trigger or pinch; else the grip button, which takes hold of things but presses no panel. */
  private press_(event: XRInputSourceEvent, select: boolean): void {
    // An input may appear at the very moment of its press.
    this.add_(event.inputSource);
    const input = this.inputs.find((each) => each.source === event.inputSource);
    if (input === undefined || this.space_ === null) return;
    this.aimNow_(input, event.frame);
    if (select) input.selecting = true;
    else input.squeezing = true;
    if (input.board !== null) {
      // A bare hand whose fingertip is at the panel presses with that.
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
    input.lift(this.page_.viewer.rig.matrixWorld);
    this.aim_(input);
  }
}
