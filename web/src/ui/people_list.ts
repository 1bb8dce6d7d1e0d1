// SPDX-License-Identifier: Apache-2.0
// The people at this world, each with the color that others see of them: a field for one's own name, and a button for a host to send
// others away. Fetched when it is first opened.

import type { Page } from "../page/page.ts";
import { others } from "../page/highlights.ts";
import { Role, type ClientEntry } from "../protocol/generated.ts";
import { make } from "./dom.ts";
import "./people_list.css";

type ListedPage = Pick<Page, "world" | "session">;

const roleNames: Record<Role, string> = { [Role.host]: "host", [Role.actor]: "guest", [Role.viewer]: "watches" };
/** After the first press of a button, in which the second one counts. */
const askedMs = 4000;
const longestName = 40;

export class PeopleList {
  private readonly page_: ListedPage;
  private readonly root_ = make("section", "pill");
  private readonly name_ = make("input", "name");
  private shown_ = "";
  /** Whom the next press sends away; 0: nobody. */
  private asked_ = 0;
  private forget_: number | undefined;

  /** `foot`: the list is shown above it. */
  constructor(page: ListedPage, foot: HTMLElement) {
    this.page_ = page;
    this.root_.id = "people-list";
    this.root_.hidden = true;
    this.root_.setAttribute("aria-label", "People");
    this.root_.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      this.close();
    });
    Object.assign(this.name_, { id: "own-name", type: "text", maxLength: longestName, placeholder: "Your name", autocomplete: "nickname" });
    this.name_.setAttribute("aria-label", "Your name, as others see it");
    this.name_.addEventListener("change", () => this.page_.session.rename(this.name_.value));
    this.name_.addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.name_.blur();
    });
    foot.append(this.root_);
  }

  get isOpen(): boolean {
    return !this.root_.hidden;
  }

  toggle(): void {
    this.root_.hidden = !this.root_.hidden;
    this.ask_(0);
  }

  close(): void {
    if (this.isOpen) this.toggle();
  }

  /** Shows the present list. Elements stay where nothing has changed, so that none goes away under a press. */
  refresh(): void {
    if (this.root_.hidden) return;
    const { world: { clients }, session: { role, clientId } } = this.page_;
    const now = JSON.stringify([clients.map(({ client, name, role: theirs }) => [client, name, theirs]), role, clientId, this.asked_]);
    if (now === this.shown_) return;
    this.shown_ = now;
    const rows = clients.flatMap((client) => this.makeRow_(client));
    // A press of a button asks once more in the same place: the keyboard stays on it.
    const focused = this.root_.contains(document.activeElement) ? document.activeElement?.id : undefined;
    this.root_.replaceChildren(...rows);
    if (focused) document.getElementById(focused)?.focus();
  }

  private makeRow_({ client, name, role }: ClientEntry): HTMLElement[] {
    const { session } = this.page_;
    const isSelf = client === session.clientId;
    const called = name === "" ? `Page ${client}` : name;
    if (isSelf && document.activeElement !== this.name_) this.name_.value = name;
    const swatch = make("span", "swatch");
    swatch.style.background = `#${others[client % others.length].getHexString()}`;
    const row = [swatch, isSelf ? this.name_ : make("span", "name", called), make("span", "role", isSelf ? `${roleNames[role]}, you` : roleNames[role])];
    if (session.role !== Role.host || isSelf) return [...row, make("span")];
    const isAsked = this.asked_ === client;
    const button = make("button", isAsked ? "text sure" : "text", isAsked ? "Press again" : "Send away");
    button.id = `send-away-${client}`;
    button.type = "button";
    button.setAttribute("aria-label", `${isAsked ? "Press again to send away" : "Send away"}: ${called}`);
    button.title = "Closes that page. From another machine it does not come back as a guest or viewer while this world is served.";
    button.addEventListener("click", () => {
      if (isAsked) session.send({ type: "sendAway", client });
      this.ask_(isAsked ? 0 : client);
    });
    return [...row, button];
  }

  private ask_(client: number): void {
    this.asked_ = client;
    window.clearTimeout(this.forget_);
    if (client !== 0) this.forget_ = window.setTimeout(() => this.ask_(0), askedMs);
    this.refresh();
  }
}
