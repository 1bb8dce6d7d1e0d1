// SPDX-License-Identifier: Apache-2.0
// This page's connection to a world: passes the server's messages on, and sends the user's requests. A body is a slot
// on the page and a full id on the wire, so that a late request cannot reach another body in the same slot.

import { keepName } from "../net/name.ts";
import { Connection, type ConnectionListener, type LinkState, type JoinRequest } from "../net/connection.ts";
import { ControlCommand, Role, type ClientMessage, type Id, type PosesBuffer, type ServerMessage } from "../protocol/generated.ts";
import type { World } from "../world/world.ts";
import type { Events, PageNotice } from "./events.ts";
import type { PictureViewer } from "./picture.ts";
import { smooth, type Viewer } from "./viewer.ts";

type SessionViewer = PictureViewer & Pick<Viewer, "invalidate" | "timing">;

const noId: Id = { slot: 0, generation: 0 };
/** In one message. */
const mostBodies = 4096;
/** The card about a world that goes on where an earlier process left it has this id, see python/iota/world/stepper.py. */
const keptId = "iota kept";
/** The card asks for so long. */
const questionS = 20;

export class Session implements ConnectionListener {
  readonly connection: Connection;
  /** Called with the user's name when the connection is lost. */
  onLost: ((name: string) => void) | null = null;

  private readonly world_: World;
  private readonly viewer_: SessionViewer;
  private readonly events_: Events;
  private readonly url_: string;

  constructor(url: string, request: JoinRequest, world: World, viewer: SessionViewer, events: Events) {
    this.world_ = world;
    this.viewer_ = viewer;
    this.events_ = events;
    this.url_ = url;
    this.connection = new Connection(url, request, this);
  }

  get clientId(): number {
    return this.connection.clientId;
  }

  /** The role of this page's user, which the server has told. */
  get role(): Role {
    return this.world_.clients.find(({ client }) => client === this.clientId)?.role ?? Role.host;
  }

  /** Why the user may not do what hosts, or all but viewers (`actor`), may do; empty: they may. */
  refusal(least: typeof Role.host | typeof Role.actor): string {
    const { role } = this;
    if (role === Role.viewer) return "You only watch this world";
    return least === Role.host && role !== Role.host ? "Only the host does that" : "";
  }

  /** Sends if connected; otherwise drops the message, because old gestures are stale. */
  send(message: ClientMessage): void {
    this.connection.send(message);
  }

  /** The name by which others see this user, from now on and when the page is opened again. */
  rename(name: string): void {
    const told = name.trim();
    this.connection.name = told;
    keepName(told);
    this.send({ type: "rename", name: told });
  }

  /** Pause, play, single step, reset, speed. */
  control(command: ControlCommand, value = 0): void {
    this.send({ type: "control", command, value });
  }

  /** Runs an action of the script on these bodies, as one edit. */
  act(name: string, bodies: readonly number[]): void {
    for (let from = 0; from === 0 || from < bodies.length; from += mostBodies) {
      const [body = noId, ...others] = bodies.slice(from, from + mostBodies).map((slot) => this.idOf(slot));
      this.send({ type: "action", name, body, others });
    }
  }

  /** Sends this page's selection to the server, -1: nothing. */
  select(body: number): void {
    this.send({ type: "select", body: this.idOf(body) });
  }

  /** The id of the body in a slot; null for none. */
  idOf(body: number): Id {
    return this.world_.entities.body.idOf(body) ?? noId;
  }

  // --- ConnectionListener

  message(message: ServerMessage): void {
    this.viewer_.invalidate();
    if (message.type === "notice") this.events_.notice({ ...message, ...(message.id === "" ? {} : { key: message.id }), ...(message.id === keptId ? this.question_() : {}) });
    else if (message.type === "askPicture") void import("./picture.ts").then(({ sendPicture }) => sendPicture(this.viewer_, message.request, (part) => this.send(part)));
    else if (message.type === "effect") this.events_.effect(message.kind, message.position, message.volume);
    else if (message.type === "pulse") this.events_.pulse(message.hand, message.strength, message.seconds);
    else this.world_.take(message);
  }

  /** Whether a world that was kept goes on, which it does until somebody says otherwise: it as it was, and the choice. */
  private question_(): Partial<PageNotice> {
    const picture = new URL("kept.png", this.url_.replace(/^ws/, "http"));
    picture.search = new URL(this.url_).search;
    const choices = [
      { text: "Go on", choose: () => undefined },
      { text: "Begin anew", choose: () => this.control(ControlCommand.reset) },
    ];
    const asks = { title: "Go on where it was?", hint: "", choices, seconds: questionS };
    return { picture: picture.href, ...(this.refusal(Role.host) === "" ? asks : {}) };
  }

  poses(poses: PosesBuffer, now: number): void {
    const started = performance.now();
    const { world_: world, viewer_: viewer } = this;
    // Also the end of the last hold, and the first poses of a connection, which end its description.
    if (poses.step !== world.step || poses.holds.count + world.holdCount > 0 || !world.described) viewer.invalidate();
    world.takePoses(poses, now);
    viewer.timing.decodeMs = smooth(viewer.timing.decodeMs, performance.now() - started);
  }

  state(state: LinkState, reason: string): void {
    this.events_.link(state, reason);
  }

  lost(): void {
    this.onLost?.(this.connection.name);
  }
}
