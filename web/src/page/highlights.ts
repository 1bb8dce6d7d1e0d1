// SPDX-License-Identifier: Apache-2.0
// Marks hovered, selected and held bodies of all users: tints, outlines, and springs from hand to body.

import { Color, Vector3, type Group } from "three";
import type { BodyView } from "../scene/entities/body.ts";
import { HoldLines } from "../scene/hold_lines.ts";
import { palette } from "../scene/materials.ts";
import { Outline } from "../scene/outline.ts";
import type { World } from "../world/world.ts";
import type { Selection } from "./selection.ts";
import type { Session } from "./session.ts";
import type { FramePart, Viewer } from "./viewer.ts";

/** Colors of other people, by client number. */
export const others = ["#8d6fd1", "#3f7fd0", "#c2863a", "#4c9a52", "#c0508e"].map((code) => new Color(code));
const mostOthers = 6;
const mostHeld = 8;
/** Several selected bodies are tinted: an outline for each would be drawn one by one. */
const severalTint = 0.6;
/** A hold that the server has not confirmed after this time was refused. */
const confirmWithinMs = 1500;

function makeOutline(bodies: BodyView, color: Color, thickness: number): Outline {
  const outline = new Outline(color, thickness);
  bodies.addOutline(outline);
  return outline;
}

export class Highlights implements FramePart {
  private readonly world_: World;
  private readonly bodies_: BodyView;
  private readonly session_: Session;
  private readonly selection_: Selection;
  private readonly viewer_: Viewer;
  private readonly lines_ = new HoldLines();
  private readonly selected_: Outline;
  private readonly hovered_: Outline;
  private readonly others_: Outline[] = [];
  private readonly held_: Outline[] = [];
  private readonly eye_ = new Vector3();
  private readonly point_ = new Float32Array(3);

  constructor(world: World, session: Session, selection: Selection, viewer: Viewer) {
    this.world_ = world;
    this.bodies_ = world.entities.body;
    this.session_ = session;
    this.selection_ = selection;
    this.viewer_ = viewer;
    this.selected_ = makeOutline(this.bodies_, palette.selected, 0.0026);
    this.hovered_ = makeOutline(this.bodies_, palette.hoverOnLight, 0.0022);
    for (let index = 0; index < mostOthers; index++) this.others_.push(makeOutline(this.bodies_, new Color(), 0.0018));
    for (let index = 0; index < mostHeld; index++) this.held_.push(makeOutline(this.bodies_, new Color(), 0.0032));
  }

  get root(): Group {
    return this.lines_.root;
  }

  /** The outline of a hovered body must stand out against either background. */
  setTheme(theme: "light" | "dark"): void {
    this.hovered_.material.color.copy(theme === "light" ? palette.hoverOnLight : palette.hoverOnDark);
  }

  interact(): void {
    const { hovered, selected, held } = this.selection_;
    this.viewer_.camera.getWorldPosition(this.eye_);
    this.bodies_.clearTints();
    for (const body of this.selection_.several) this.bodies_.setTint(body, palette.selected, severalTint);
    if (this.selection_.several.size > 0) this.bodies_.setTint(selected, palette.selected, severalTint);
    this.lines_.begin();
    for (const outline of this.held_) outline.body = -1;
    this.markOwnHolds_();
    this.markOthersHolds_();
    this.outlineOthers_();
    this.hovered_.body = hovered === held ? -1 : hovered;
    this.selected_.body = selected === hovered || selected === held ? -1 : selected;
  }

  warmUp(): void {
    const { bodies_: bodies, point_: point } = this;
    const body = bodies.pickable[0];
    point.set(bodies.position.subarray(3 * body, 3 * body + 3));
    this.lines_.add(point, point, 0, this.eye_, 1);
    this.hovered_.body = body;
  }

  draw(): void {
    this.lines_.end();
  }

  private markOthersHolds_(): void {
    const { holds, holdCount } = this.world_;
    for (let index = 0; index < holdCount; index++) {
      const hold = holds[index];
      if (hold.client === this.session_.clientId) continue;
      this.outlineHeld_(hold.body, others[hold.client % others.length]);
      this.lines_.add(hold.point, hold.target, hold.force, this.eye_, 0.8);
    }
  }

  private markOwnHolds_(): void {
    const now = performance.now();
    for (const grab of this.selection_.gestures.grabs) {
      const force = this.selection_.confirmedForce(grab);
      if (force < 0 && now - grab.startedAt > confirmWithinMs) continue;
      if (!grab.isGone) this.outlineHeld_(grab.body, palette.held);
      this.selection_.gestures.grabbedPoint(grab, this.point_);
      this.lines_.add(this.point_, grab.target, Math.max(force, 0), this.eye_, 1);
    }
  }

  /** A held body keeps its material. One that several hold has the outline of the first. */
  private outlineHeld_(body: number, color: Color): void {
    const free = this.held_.find((outline) => outline.body === -1 || outline.body === body);
    if (free === undefined || free.body === body) return;
    free.material.color.copy(color);
    free.body = body;
  }

  private outlineOthers_(): void {
    let used = 0;
    for (const client of this.world_.clients) {
      const body = this.bodies_.slotOf(client.selected);
      if (client.client === this.session_.clientId || body < 0 || used === mostOthers || this.held_.some((held) => held.body === body)) continue;
      const outline = this.others_[used++];
      outline.material.color.copy(others[client.client % others.length]);
      outline.body = body;
    }
    for (; used < mostOthers; used++) this.others_[used].body = -1;
  }
}
