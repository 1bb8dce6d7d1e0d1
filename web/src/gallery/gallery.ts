// SPDX-License-Identifier: Apache-2.0
// The page with pictures of all studies; each leads to its world on the same server. Served by `iota gallery`.

import { takeToken } from "../net/token.ts";
import { make } from "../ui/dom.ts";

interface Study {
  readonly name: string;
  readonly title: string;
  readonly text: string;
}

interface Group {
  readonly group: string;
  readonly studies: readonly Study[];
}

/** A key in a sentence, with what comes before it from the last mark on. A letter behind a number is a unit. */
const firstKey = /[,.:;][^,.:;]*(?<!\d)\s[b-z](?=[\s,.;])/;

/** A sentence, the part of which that names keys is not shown where there is no keyboard. */
function makeText(text: string): HTMLElement {
  // A number and its unit stay in one line.
  const whole = text.replaceAll(/(\d) (?=\p{L})/gu, "$1\u00A0");
  const from = firstKey.exec(whole)?.index ?? whole.length;
  const paragraph = make("p", "", whole.slice(0, from));
  if (from === whole.length) return paragraph;
  paragraph.append(make("span", "keys", whole.slice(from)), make("span", "keyless", "."));
  return paragraph;
}

/** A title with cards below it. */
function makeGroup({ group, studies }: Group): HTMLElement {
  const section = make("section");
  const cards = make("div", "cards");
  cards.append(...studies.map(makeCard));
  section.append(make("h2", "", group), cards);
  return section;
}

/** A picture with the name and a sentence below it. */
function makeCard({ name, title, text }: Study): HTMLAnchorElement {
  const card = make("a", "card");
  card.href = `world.html?${new URLSearchParams({ world: name }).toString()}`;
  const picture = make("img");
  picture.src = `studies/${name}.jpg`;
  picture.alt = "";
  picture.width = 480;
  picture.height = 270;
  picture.addEventListener("error", () => picture.classList.add("missing"));
  card.append(picture, make("h3", "", title), makeText(text));
  return card;
}

async function main(): Promise<void> {
  // Kept for this tab, so that the worlds' pages can read it.
  takeToken();
  const list = document.querySelector("main")!;
  try {
    const answer = await fetch("studies.json");
    if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
    list.append(...((await answer.json()) as Group[]).map(makeGroup));
  } catch (error) {
    list.append(make("p", "", `The list of studies was not received: ${error instanceof Error ? error.message : String(error)}. Reload the page.`));
  }
  list.removeAttribute("aria-busy");
}

void main();
