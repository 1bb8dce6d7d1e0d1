// SPDX-License-Identifier: Apache-2.0
// The page behind a link to a room that may be on any machine: waits until it serves, and goes there.

import { addressAfterMove, whereIs, type Whereabouts } from "../net/gateway.ts";
import { byId } from "../ui/dom.ts";

const everyMs = 500;

const here = new URL(location.href);
const room = here.searchParams.get("room") ?? "";
const token = here.searchParams.get("token") ?? "";
const told = byId("told", HTMLElement);
byId("name", HTMLElement).textContent = room;

function tell(text: string): void {
  if (told.textContent !== text) told.textContent = text;
}

function sentence({ state, trouble }: Whereabouts): string {
  if (state === "closed") return "It is closed. This page goes there when it opens.";
  if (state === "starting") return trouble === "" ? "It starts \u2026" : `${trouble[0]!.toUpperCase()}${trouble.slice(1)}.`;
  return trouble === "" ? "It starts \u2026" : `It cannot be shown: ${trouble}`;
}

async function look(): Promise<void> {
  try {
    const found = await whereIs(here.origin, room, token);
    const there = addressAfterMove(here, found.url, "");
    if (there !== null) {
      location.replace(there);
      return;
    }
    told.classList.toggle("calm", found.state !== "failed");
    tell(sentence(found));
  } catch (error) {
    told.classList.remove("calm");
    tell(error instanceof Error ? error.message : String(error));
  }
  window.setTimeout(() => void look(), everyMs);
}

void look();
