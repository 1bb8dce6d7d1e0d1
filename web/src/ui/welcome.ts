// SPDX-License-Identifier: Apache-2.0
// The hint of the start. It lies where it covers no nail, as what hangs from one is framed up to the edge of the window, and not under
// the script's controls.

import { Vector3 } from "three";
import type { Page } from "../page/page.ts";

/** From the edges, css px. */
const margin = 12;
/** The gap between a pin and what is around it, css px. */
const gap = 16;

export class Welcome {
  private readonly page_: Pick<Page, "world" | "viewer">;
  private readonly element_: HTMLElement;
  private readonly foot_: HTMLElement;

  constructor(page: Pick<Page, "world" | "viewer">, element: HTMLElement, foot: HTMLElement) {
    this.page_ = page;
    this.element_ = element;
    this.foot_ = foot;
    this.place();
  }

  say(text: string): void {
    this.element_.textContent = text;
    this.place();
  }

  leave(): void {
    this.element_.classList.add("gone");
  }

  /** At the top, in one of its corners, or above the bar: the first of these that covers no nail and no control. */
  place(): void {
    const { element_: element, page_: { world, viewer: { camera } } } = this;
    if (element.classList.contains("gone")) return;
    const { offsetWidth: width, offsetHeight: height } = element;
    const nails: Vector3[] = [];
    camera.updateMatrixWorld();
    world.entities.nail.forEachPlace((place) => nails.push(place.clone().project(camera)));
    const middle = (innerWidth - width) / 2;
    const panel = document.querySelector("#panel:not([hidden])")?.getBoundingClientRect();
    const isUnder = (left: number, top: number) => panel !== undefined
      && left + width > panel.left && left < panel.right && top + height > panel.top && top < panel.bottom;
    const covers = ([left, top]: readonly [number, number]) => isUnder(left, top) || nails.some(({ x, y, z }) => (
      z < 1 && Math.abs(((1 + x) * innerWidth - width) / 2 - left) < width / 2 + gap
      && Math.abs(((1 - y) * innerHeight - height) / 2 - top) < height / 2 + gap
    ));
    const places = [
      [middle, margin], [margin, margin], [innerWidth - width - margin, margin],
      [middle, this.foot_.getBoundingClientRect().top - height - margin],
    ] as const;
    const [left, top] = places.find((place) => !covers(place)) ?? places[0];
    element.style.left = `${left}px`;
    element.style.top = `max(${top}px, env(safe-area-inset-top))`;
  }
}
