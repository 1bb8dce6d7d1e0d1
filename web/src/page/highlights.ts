// SPDX-License-Identifier: Apache-2.0
// Shows what is pointed at, selected and held, by this user and by others: tints, outlines, and springs from hand to body.

import { Color, Vector3, type Group } from "three";
import { NO_BODY } from "../protocol/generated.ts";
import { Outline, type BodyView } from "../scene/body_view.ts";
import type { Flashes } from "../scene/flashes.ts";
import { HoldLines } from "../scene/hold_lines.ts";
import { palette } from "../scene/materials.ts";
import type { Change, WorldModel } from "../scene/world_model.ts";
import type { PageListener } from "./events.ts";
import type { Selection } from "./selection.ts";
import type { Session } from "./session.ts";
import type { FramePart, Viewer } from "./viewer.ts";

/** Colors of other people, by client number. */
const others = ["#8d6fd1", "#3f7fd0", "#c2863a", "#4c9a52", "#c0508e"].map((code) => new Color(code));
const mostOthers = 6;
/** A hold that the server has not confirmed by then was refused. */
const confirmWithinMs = 1500;

function makeOutline(bodies: BodyView, color: Color, thickness: number): Outline {
  const outline = new Outline(color);
  outline.material.thickness.value = thickness;
  bodies.addOutline(outline);
  return outline;
}

export class Highlights implements FramePart, PageListener {
  private readonly world_: WorldModel;
  private readonly bodies_: BodyView;
  private readonly session_: Session;
  private readonly selection_: Selection;
  private readonly viewer_: Viewer;
  private readonly flashes_: Flashes;
  private readonly lines_ = new HoldLines();
  private readonly selected_: Outline;
  private readonly hovered_: Outline;
  private readonly others_: Outline[] = [];
  private readonly eye_ = new Vector3();
  private readonly point_ = new Float32Array(3);

  constructor(world: WorldModel, bodies: BodyView, session: Session, selection: Selection, viewer: Viewer, flashes: Flashes) {
    this.world_ = world;
    this.bodies_ = bodies;
    this.session_ = session;
    this.selection_ = selection;
    this.viewer_ = viewer;
    this.flashes_ = flashes;
    this.selected_ = makeOutline(bodies, palette.selected, 0.0026);
    this.hovered_ = makeOutline(bodies, palette.hoverOnLight, 0.0022);
    for (let index = 0; index < mostOthers; index++) this.others_.push(makeOutline(bodies, new Color(), 0.0018));
  }

  get root(): Group {
    return this.lines_.root;
  }

  /** Outlines of what is pointed at stand out against either. */
  setTheme(theme: "light" | "dark"): void {
    this.hovered_.material.color.copy(theme === "light" ? palette.hoverOnLight : palette.hoverOnDark);
  }

  changed(what: Change | "selection"): void {
    if (what === "clients") this.outlineOthers_();
  }

  decide(): void {
    const { bodies_: bodies, selection_: selection } = this;
    this.viewer_.camera.getWorldPosition(this.eye_);
    bodies.clearTints();
    this.lines_.begin();
    this.markOthersHolds_();
    this.markOwnHolds_();
    const { hovered, selected, held } = selection;
    bodies.outline(this.hovered_, hovered);
    // What is held is red all over: a line around it would only dim that.
    bodies.outline(this.selected_, selected === hovered || selected === held ? -1 : selected);
  }

  warm(): void {
    const { bodies_: bodies, point_: point } = this;
    const body = bodies.pickable[0];
    point.set(bodies.position.subarray(3 * body, 3 * body + 3));
    this.lines_.add(point, point, 0, this.eye_, 1);
    this.flashes_.effect("grab", point);
    bodies.outline(this.hovered_, body);
  }

  draw(): void {
    this.lines_.end();
  }

  private markOthersHolds_(): void {
    const { holds, holdCount } = this.world_;
    for (let index = 0; index < holdCount; index++) {
      const hold = holds[index];
      if (hold.client === this.session_.clientId) continue;
      this.bodies_.setTint(hold.body, palette.held, 0.85);
      this.lines_.add(hold.point, hold.target, hold.force, this.eye_, 0.8);
    }
  }

  private markOwnHolds_(): void {
    const now = performance.now();
    for (const grab of this.selection_.gestures.grabs) {
      const force = this.selection_.confirmedForce(grab);
      if (force < 0 && now - grab.startedAt > confirmWithinMs) continue;
      this.bodies_.setTint(grab.body, palette.held, 1);
      this.selection_.gestures.grabbedPoint(grab, this.point_);
      this.lines_.add(this.point_, grab.target, Math.max(force, 0), this.eye_, 1);
    }
  }

  private outlineOthers_(): void {
    let used = 0;
    for (const client of this.world_.clients) {
      if (client.client === this.session_.clientId || client.selected === NO_BODY || used === mostOthers) continue;
      const outline = this.others_[used++];
      outline.material.color.copy(others[client.client % others.length]);
      this.bodies_.outline(outline, client.selected);
    }
    for (; used < mostOthers; used++) this.bodies_.outline(this.others_[used], -1);
  }
}
