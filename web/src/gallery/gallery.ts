// SPDX-License-Identifier: Apache-2.0
// The page with pictures of all studies; each leads to its world on the same server. Served by `iota gallery`.

import { takeToken } from "../net/token.ts";
import { make } from "../ui/dom.ts";

interface Study {
  readonly name: string;
  readonly text: string;
}

/** A picture with the name and a sentence below it. */
function makeCard({ name, text }: Study): HTMLAnchorElement {
  const card = make("a", "card");
  card.href = `world.html?${new URLSearchParams({ world: name }).toString()}`;
  const picture = make("img");
  picture.src = `studies/${name}.jpg`;
  picture.alt = "";
  picture.width = 480;
  picture.height = 270;
  picture.addEventListener("error", () => picture.classList.add("missing"));
  // A number and its unit stay in one line.
  card.append(picture, make("h2", "", name), make("p", "", text.replaceAll(/(\d) (?=\p{L})/gu, "$1\u00A0")));
  return card;
}

async function main(): Promise<void> {
  // Kept for this tab, so that the worlds' pages can read it.
  takeToken();
  const list = document.querySelector("main")!;
  try {
    const answer = await fetch("studies.json");
    if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
    list.append(...((await answer.json()) as Study[]).map(makeCard));
  } catch (error) {
    list.append(make("p", "", `The list of studies was not received: ${error instanceof Error ? error.message : String(error)}. Reload the page.`));
  }
  list.removeAttribute("aria-busy");
}

void main();
