// SPDX-License-Identifier: Apache-2.0
// Starts the page of rooms: asks the server for the list, again and again, and for changes.

import { takeToken } from "../net/token.ts";
import { byId, make } from "../ui/dom.ts";
import { RoomList, type Change, type Listing } from "./rooms.ts";

const everyMs = 1500;

const token = takeToken() ?? "";
const told = byId("told", HTMLElement);
const source = byId("source", HTMLSelectElement);
const name = byId("name", HTMLInputElement);
const place = byId("rooms", HTMLElement);
let isLost = false;

/** The list; throws with a sentence for users. */
async function request(path: string, query: Record<string, string>, method: "GET" | "POST"): Promise<Listing> {
  let answer: Response;
  try {
    answer = await fetch(`${path}?${new URLSearchParams({ ...query, token }).toString()}`, { method, cache: "no-store" });
  } catch {
    throw new Error("iota rooms is not running. Rooms that run go on; this list comes back with it.");
  }
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return (await answer.json()) as Listing;
}

function tell(text: string): void {
  if (told.textContent !== text) told.textContent = text;
}

const list = new RoomList(place, token, (change, room) => void ask(change, room));

function show(listing: Listing): void {
  if (source.options.length === 0) {
    for (const { name: each, text } of listing.sources) {
      const option = make("option", "", each);
      option.value = each;
      option.title = text;
      source.append(option);
    }
    suggestName(listing);
    source.addEventListener("change", () => suggestName(listing));
  }
  list.refresh(listing, new URL(location.href));
  place.removeAttribute("aria-busy");
  if (isLost) tell("");
  isLost = false;
}

/** A name that nobody has typed follows the choice. */
let suggested = "";
function suggestName({ rooms }: Listing): void {
  if (name.value !== suggested) return;
  const plain = source.value.replace(/\.py$/, "").toLowerCase().replaceAll(/[^a-z0-9]+/g, "-").replaceAll(/^-+|-+$/g, "").slice(0, 36);
  const taken = new Set(rooms.map((room) => room.name));
  suggested = plain;
  for (let number = 2; taken.has(suggested); ++number) suggested = `${plain}-${number}`;
  name.value = suggested;
}

async function ask(change: Change, room: string, from = ""): Promise<void> {
  try {
    const listing = await request("rooms/change", { do: change, room, source: from }, "POST");
    tell("");
    show(listing);
    if (change === "make") {
      name.value = suggested;
      suggestName(listing);
    }
  } catch (error) {
    tell(error instanceof Error ? error.message : String(error));
  }
}

byId("make", HTMLFormElement).addEventListener("submit", (event) => {
  event.preventDefault();
  void ask("make", name.value, source.value);
});

async function look(): Promise<void> {
  try {
    show(await request("rooms.json", {}, "GET"));
  } catch (error) {
    isLost = true;
    tell(error instanceof Error ? error.message : String(error));
  }
  window.setTimeout(() => void look(), everyMs);
}

void look();
