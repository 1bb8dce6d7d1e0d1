// SPDX-License-Identifier: Apache-2.0
// Small helpers for the overlay.

/** The element of index.html with this id; throws if there is none. */
export function byId<T extends HTMLElement>(id: string, type: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof type)) throw new Error(`index.html has no ${type.name} with the id ${id}`);
  return found;
}

export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K, className = "", text = "",
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  if (className !== "") element.className = className;
  if (text !== "") element.textContent = text;
  return element;
}

/** The text of a key on the page. */
export function keyName(key: string): string {
  const names: Record<string, string> = { " ": "space", Escape: "esc", ArrowUp: "↑", ArrowDown: "↓", ArrowLeft: "←", ArrowRight: "→", Enter: "enter" };
  return names[key] ?? key;
}

/** Moves a fixed element next to a place in css px, kept inside the window. */
export function placeNear(element: HTMLElement, x: number, y: number, gap: number): void {
  const { offsetWidth: width, offsetHeight: height } = element;
  const left = x + gap + width + 8 > innerWidth ? x - gap - width : x + gap;
  const top = y + gap + height + 8 > innerHeight ? y - gap - height : y + gap;
  element.style.transform = `translate(${Math.round(Math.max(8, left))}px, ${Math.round(Math.max(8, top))}px)`;
}

const svgNamespace = "http://www.w3.org/2000/svg";

/** A sign of lines in a 24 x 24 square, as the path of an SVG. */
export function makeSign(lines: string): SVGSVGElement {
  const picture = document.createElementNS(svgNamespace, "svg");
  picture.setAttribute("viewBox", "0 0 24 24");
  picture.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(svgNamespace, "path");
  path.setAttribute("d", lines);
  picture.append(path);
  return picture;
}
