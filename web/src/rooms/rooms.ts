// SPDX-License-Identifier: Apache-2.0
// The page of `iota rooms`: who is in which room, new rooms, invitations.

import { make } from "../ui/dom.ts";

export type RoomRole = "host" | "guest" | "viewer";

/** A room as the server tells of it, see python/iota/rooms/serving.py. picture: another text for another picture, empty without one. */
export interface Room {
  readonly name: string;
  readonly source: string;
  readonly title: string;
  readonly time: number;
  readonly state: "running" | "starting" | "ending" | "asleep" | "closed" | "failed" | "hanging";
  readonly trouble: string;
  readonly people: readonly { readonly name: string; readonly role: string }[];
  readonly port: number;
  readonly tokens: Readonly<Record<RoomRole, string>>;
  readonly picture: string;
}

/** base: where other machines reach this one, without a port; empty if they do not. is_proxied: rooms are at BASE/PORT/.
 * is_on_machines: rooms move between machines, so their links lead to this server, which knows where they are. */
export interface Listing {
  readonly rooms: readonly Room[];
  readonly sources: readonly { readonly name: string; readonly text: string }[];
  readonly base: string;
  readonly is_proxied: boolean;
  readonly is_on_machines: boolean;
}

export type Change = "make" | "close" | "open" | "begin_anew" | "delete";
/** Asks the server for a change. */
export type Ask = (change: Change, room: string, source?: string) => void;

const sureMs = 4000;

/** An address of a room. `here`: of this page; for others, unless it is this page's own machine that they can reach only. */
export function linkTo(room: Room, role: RoomRole, listing: Pick<Listing, "base" | "is_proxied" | "is_on_machines">, here: URL, isForOthers: boolean): string {
  const query = `?token=${room.tokens[role]}`;
  if (listing.is_on_machines) {
    const gateway = listing.is_proxied && isForOthers ? listing.base : here.origin;
    return `${gateway}/enter.html${query}&room=${room.name}`;
  }
  if (listing.is_proxied && (isForOthers || here.origin === listing.base)) return `${listing.base}/${room.port}/${query}`;
  const base = isForOthers && listing.base !== "" && !listing.is_proxied ? listing.base : `${here.protocol}//${here.hostname}`;
  return `${base}:${room.port}/${query}`;
}

/** "Ada, Ben (guest) and 2 more". */
export function peopleIn(room: Room, most = 4): string {
  if (room.people.length === 0) return "";
  const named = room.people.map(({ name, role }) => `${name === "" ? "somebody" : name}${role === "host" ? "" : ` (${role})`}`);
  const shown = named.slice(0, most);
  const more = named.length - shown.length;
  if (more > 0) return `${shown.join(", ")} and ${more} more`;
  return shown.length === 1 ? shown[0]! : `${shown.slice(0, -1).join(", ")} and ${shown.at(-1)!}`;
}

/** A sentence on the state of a room. */
export function tellState(room: Room): string {
  switch (room.state) {
    case "running": return room.people.length === 0 ? "nobody is here" : "";
    case "starting": return "";
    case "ending": return "";
    case "asleep": return "a visit wakes it";
    case "closed": return "nobody is let in";
    case "failed": return "";
    case "hanging": return "its world does not answer; close and open it";
  }
}

const clocks: readonly (readonly [number, string])[] = [[3600, "h"], [60, "min"]];

/** The time of a world: "12 s", "3 min", "2 h". */
export function tellTime(seconds: number): string {
  for (const [size, unit] of clocks) if (seconds >= size) return `${Math.floor(seconds / size)}\u00A0${unit}`;
  return `${Math.floor(seconds)}\u00A0s`;
}

const invitations: readonly (readonly [RoomRole, string])[] = [
  ["guest", "Guests touch; they do not pause or reset."],
  ["viewer", "Viewers only watch."],
  ["host", "Hosts may do everything."],
];

/** Writes only what has changed, so that selections and focus stay. */
function write(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

/** A button; one that is not easily undone has to be pressed twice. */
function makeButton(text: string, press: () => void, sure = ""): HTMLButtonElement {
  const button = make("button", "", text);
  button.type = "button";
  let timer: number | undefined;
  const calm = () => {
    window.clearTimeout(timer);
    timer = undefined;
    button.classList.remove("sure");
    button.textContent = text;
  };
  button.addEventListener("click", () => {
    if (sure === "" || timer !== undefined) {
      calm();
      press();
      return;
    }
    button.classList.add("sure");
    button.textContent = sure;
    timer = window.setTimeout(calm, sureMs);
  });
  return button;
}

/** A link to copy, with a word on what it allows. */
class Invitation {
  readonly element = make("div", "invitation");
  private readonly input_ = make("input");

  constructor(role: RoomRole, text: string) {
    this.input_.readOnly = true;
    this.input_.setAttribute("aria-label", `Link for a ${role}`);
    const copy = makeButton("Copy", () => {
      this.input_.select();
      void navigator.clipboard?.writeText(this.input_.value).then(() => {
        copy.textContent = "Copied";
        window.setTimeout(() => (copy.textContent = "Copy"), sureMs);
      }, () => undefined);
    });
    this.element.append(make("span", "", text), this.input_, copy);
  }

  refresh(link: string): void {
    if (this.input_.value !== link) this.input_.value = link;
  }
}

/** One room. */
export class RoomCard {
  readonly element = make("article", "card");
  private readonly view_ = make("a", "view");
  private readonly picture_ = make("img");
  private readonly blank_ = make("div", "blank");
  private readonly state_ = make("span", "state");
  private readonly what_ = make("p");
  private readonly people_ = make("p", "people");
  private readonly trouble_ = make("p", "trouble");
  private readonly invitations_: readonly (readonly [RoomRole, Invitation])[];
  private readonly door_: HTMLButtonElement;
  private isClosed_ = false;
  private shown_ = "";
  private readonly token_: string;

  constructor(room: Room, token: string, ask: Ask) {
    this.token_ = token;
    this.picture_.alt = "";
    this.picture_.width = 480;
    this.picture_.height = 270;
    this.blank_.textContent = room.name.slice(0, 2);
    this.picture_.addEventListener("error", () => this.show_(false));
    this.show_(false);
    this.view_.append(this.picture_, this.blank_, this.state_);
    this.element.setAttribute("aria-label", room.name);
    const invite = make("details");
    invite.append(make("summary", "", "Invite"));
    this.invitations_ = invitations.map(([role, text]) => [role, new Invitation(role, text)] as const);
    for (const [, invitation] of this.invitations_) invite.append(invitation.element);
    const buttons = make("div", "buttons");
    this.door_ = makeButton("Close", () => ask(this.isClosed_ ? "open" : "close", room.name));
    buttons.append(
      this.door_,
      makeButton("Begin anew", () => ask("begin_anew", room.name), "Put this world aside?"),
      makeButton("Delete", () => ask("delete", room.name), "Delete this room?"),
    );
    this.element.append(
      this.view_, make("h2", "", room.name), this.what_, this.people_, this.trouble_, invite, buttons,
    );
  }

  refresh(room: Room, listing: Listing, here: URL): void {
    this.isClosed_ = room.state === "closed";
    this.element.classList.toggle("shut", this.isClosed_);
    const link = linkTo(room, "host", listing, here, false);
    if (this.view_.href !== link) this.view_.href = link;
    this.view_.setAttribute("aria-label", `Enter ${room.name}`);
    write(this.state_, room.state);
    if (this.state_.className !== `state ${room.state}`) this.state_.className = `state ${room.state}`;
    write(this.what_, room.time > 0 ? `${room.title}\u00A0· ${tellTime(room.time)}` : room.source);
    write(this.people_, peopleIn(room) || tellState(room));
    write(this.trouble_, room.trouble);
    // Close may be pressed while a room starts; that it takes a moment is told by the state.
    if (!this.door_.classList.contains("sure")) write(this.door_, this.isClosed_ ? "Open" : "Close");
    for (const [role, invitation] of this.invitations_) invitation.refresh(linkTo(room, role, listing, here, true));
    if (room.picture !== this.shown_) {
      this.shown_ = room.picture;
      this.show_(room.picture !== "");
      const query = new URLSearchParams({ room: room.name, picture: room.picture, token: this.token_ });
      if (room.picture !== "") this.picture_.src = `rooms/picture?${query.toString()}`;
    }
  }

  private show_(hasPicture: boolean): void {
    this.picture_.hidden = !hasPicture;
    this.blank_.hidden = hasPicture;
  }
}

/** All rooms. */
export class RoomList {
  private readonly cards_ = new Map<string, RoomCard>();
  private readonly nothing_ = make("p", "nothing", "There is no room yet. Make one above.");
  private readonly place_: HTMLElement;
  private readonly token_: string;
  private readonly ask_: Ask;

  constructor(place: HTMLElement, token: string, ask: Ask) {
    this.place_ = place;
    this.token_ = token;
    this.ask_ = ask;
  }

  refresh(listing: Listing, here: URL): void {
    const names = new Set(listing.rooms.map((room) => room.name));
    for (const [name, card] of this.cards_) {
      if (names.has(name)) continue;
      card.element.remove();
      this.cards_.delete(name);
    }
    listing.rooms.forEach((room, place) => {
      let card = this.cards_.get(room.name);
      if (card === undefined) {
        card = new RoomCard(room, this.token_, this.ask_);
        this.cards_.set(room.name, card);
        this.place_.insertBefore(card.element, this.place_.children[place] ?? null);
      }
      card.refresh(room, listing, here);
    });
    if (listing.rooms.length === 0) this.place_.append(this.nothing_);
    else this.nothing_.remove();
  }
}
