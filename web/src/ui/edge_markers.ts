// SPDX-License-Identifier: Apache-2.0
// Markers at the edge of the window for bodies that have left it: one for each articulate. Pressing one brings
// everything back into view.

import { Vector3 } from "three";
import type { Page } from "../page/page.ts";
import type { FramePart } from "../page/viewer.ts";
import { make } from "./dom.ts";

const most = 4;
/** Things that are farther apart than one of so many directions have markers of their own. */
const directions = 8;
const lookEverySeconds = 0.15;
/** From the edge, css px. */
const margin = 34;

interface Part {
  bodies: number;
  inView: number;
  readonly middle: Vector3;
}

/** One thing of each direction, those with most things first. Angles in rad. */
export function oneOfEach<Thing>(things: readonly Thing[], angleOf: (thing: Thing) => number): Thing[] {
  const ways = new Map<number, Thing[]>();
  for (const thing of things) {
    const way = (Math.round((angleOf(thing) / (2 * Math.PI)) * directions) + directions) % directions;
    ways.set(way, [...(ways.get(way) ?? []), thing]);
  }
  return [...ways.values()].sort((a, b) => b.length - a.length).map(([thing]) => thing);
}

export class EdgeMarkers implements FramePart {
  private readonly page_: Pick<Page, "world" | "viewer" | "framing">;
  private readonly root_: HTMLElement;
  private readonly markers_: HTMLButtonElement[] = [];
  private readonly parts_ = new Map<number, Part>();
  private readonly point_ = new Vector3();
  private wait_ = 0;

  constructor(page: Pick<Page, "world" | "viewer" | "framing">, root: HTMLElement) {
    this.page_ = page;
    this.root_ = root;
  }

  draw(seconds: number): void {
    this.wait_ -= seconds;
    if (this.wait_ > 0) return;
    this.wait_ = lookEverySeconds;
    const away = this.page_.viewer.presenting ? [] : this.findAway_();
    for (let index = 0; index < Math.max(away.length, this.markers_.length); index++) {
      if (index === this.markers_.length) this.markers_.push(this.makeMarker_());
      const marker = this.markers_[index];
      marker.hidden = index >= away.length;
      if (!marker.hidden) this.place_(marker, away[index].middle);
    }
  }

  /** The articulates that are completely out of view, one for each direction, those with most first. None if all or most are: then the
   * user looks elsewhere. */
  private findAway_(): readonly Part[] {
    const { world: { entities, poses } } = this.page_;
    const { body, membership } = entities;
    this.parts_.clear();
    for (let index = 0; index < body.pickableCount; index++) {
      const slot = body.pickable[index];
      const articulate = membership.articulateOf(slot);
      let part = this.parts_.get(articulate);
      if (part === undefined) this.parts_.set(articulate, part = { bodies: 0, inView: 0, middle: new Vector3() });
      this.point_.fromArray(poses.position, 3 * slot);
      part.middle.add(this.point_);
      part.bodies++;
      if (this.isInView_(this.point_)) part.inView++;
    }
    const parts = [...this.parts_.values()];
    const away = parts.filter((part) => part.inView === 0);
    if (2 * away.length > parts.length) return [];
    for (const part of away) part.middle.divideScalar(part.bodies);
    return away.length <= most ? away : oneOfEach(away, ({ middle }) => this.edgeOf_(middle).angle).slice(0, most);
  }

  private isInView_(place: Vector3): boolean {
    const seen = place.project(this.page_.viewer.camera);
    return Math.abs(seen.x) < 1 && Math.abs(seen.y) < 1 && seen.z < 1;
  }

  /** The position of a place beyond the edge: -1 .. 1 across and up, and the direction, rad, clockwise from the right. */
  private edgeOf_(middle: Vector3): { x: number; y: number; angle: number } {
    const { camera } = this.page_.viewer;
    const seen = this.point_.copy(middle).applyMatrix4(camera.matrixWorldInverse);
    const depth = Math.max(Math.abs(seen.z), 1e-9);
    let x = (seen.x * camera.projectionMatrix.elements[0]) / depth;
    let y = (seen.y * camera.projectionMatrix.elements[5]) / depth;
    // Markers for bodies behind the camera are at the sides or below.
    const size = Math.max(Math.abs(x), Math.abs(y), 1e-6);
    if (seen.z > 0 || size > 1) {
      x /= size;
      y /= size;
    }
    return { x, y, angle: Math.atan2(-y * innerHeight, x * innerWidth) };
  }

  private place_(marker: HTMLElement, middle: Vector3): void {
    const { x, y, angle } = this.edgeOf_(middle);
    const top = Math.min(Math.max(((1 - y) / 2) * innerHeight, margin), innerHeight - margin - 70);
    // Beside the panel of controls, not below it.
    const panel = document.getElementById("panel")?.getBoundingClientRect();
    const right = panel !== undefined && panel.width > 0 && top < panel.bottom + margin ? panel.left : innerWidth;
    const left = Math.min(Math.max(((x + 1) / 2) * innerWidth, margin), right - margin);
    marker.style.transform = `translate(${Math.round(left - 22)}px, ${Math.round(top - 22)}px) rotate(${angle.toFixed(2)}rad)`;
  }

  private makeMarker_(): HTMLButtonElement {
    const marker = make("button", "away", "➤");
    marker.type = "button";
    marker.setAttribute("aria-label", "Something is out of view: show everything");
    marker.title = "Something is out of view: show everything";
    marker.addEventListener("click", () => this.page_.framing.showAll());
    this.root_.append(marker);
    return marker;
  }
}
