// SPDX-License-Identifier: Apache-2.0
// The socket to the world: hello, back-off reconnect, ping. Decoded messages go to one listener;
// pose frames are decoded into one reused buffer.

import {
  decodePosesInto, decodeServerMessage, encodeClientMessage, MessageType, messageTypeOf, PosesBuffer,
  PROTOCOL_MAGIC, PROTOCOL_VERSION, SENT_AWAY_CLOSE_CODE, type ClientMessage, type Role, type ServerMessage,
} from "../protocol/generated.ts";

/** connecting: first attempt; lost: not connected, trying again; refused: by the server. */
export type LinkState = "connecting" | "connected" | "lost" | "refused";

/** The contents of a client's hello. */
export interface JoinRequest {
  /** Id of the world; empty: the server's first one. */
  readonly world: string;
  readonly role: Role;
  /** Name shown to others; may be empty. */
  readonly name: string;
}

export interface ConnectionListener {
  /** A message other than poses and pong. */
  message(message: ServerMessage): void;
  /** A pose frame; `poses` is only valid during the call. `now` in ms of performance.now(). */
  poses(poses: PosesBuffer, now: number): void;
  /** `reason` is a sentence for the user, may be empty. */
  state(state: LinkState, reason: string): void;
  /** The connection is lost, or did not come about, and is tried again. */
  lost?(): void;
}

const pingEveryMs = 2000;
/** Pose frames are sent at least once a second, so a socket that is silent between so many pings is dead. Counted, not timed:
 * after a long picture what was received meanwhile is handled before the next ping. */
const mostSilentPings = 3;
const firstDelayMs = 250;
const longestDelayMs = 4000;

export class Connection {
  state: LinkState = "connecting";
  /** This client's number at the server; 0 before the first welcome. */
  clientId = 0;
  /** By which the user is called when the page connects. */
  name: string;
  /** Last measured round trip, ms. */
  roundTripMs = 0;
  /** Frames that could not be read since the page was loaded. */
  badFrames = 0;

  private readonly url_: string;
  private readonly listener_: ConnectionListener;
  private readonly request_: JoinRequest;
  private readonly poses_ = new PosesBuffer();
  private socket_: WebSocket | null = null;
  private delayMs_ = firstDelayMs;
  private retry_: number | undefined;
  private ping_: number | undefined;
  private silentPings_ = 0;
  private opened_ = false;
  private refusal_ = "";

  constructor(url: string, request: JoinRequest, listener: ConnectionListener) {
    this.url_ = url;
    this.request_ = request;
    this.name = request.name;
    this.listener_ = listener;
    const retryNow = () => this.retryNow();
    window.addEventListener("online", retryNow);
    document.addEventListener("visibilitychange", () => {
      if (document.visibilityState === "visible") retryNow();
    });
  }

  get connected(): boolean {
    return this.state === "connected";
  }

  open(): void {
    this.close_();
    this.opened_ = false;
    this.refusal_ = "";
    const socket = new WebSocket(this.url_);
    socket.binaryType = "arraybuffer";
    this.socket_ = socket;
    this.silentPings_ = 0;
    socket.onopen = () => {
      this.opened_ = true;
      this.silentPings_ = 0;
      this.sendNow_({
        type: "hello", magic: PROTOCOL_MAGIC, version: PROTOCOL_VERSION, ...this.request_, name: this.name,
      });
    };
    socket.onmessage = (event: MessageEvent<unknown>) => this.receive_(event.data);
    socket.onclose = ({ code }) => {
      if (this.socket_ !== socket) return;
      if (!this.opened_) void this.explain_();
      this.lost_(code !== SENT_AWAY_CLOSE_CODE);
    };
    this.ping_ = window.setInterval(() => this.checkAlive_(), pingEveryMs);
  }

  /** Sends if connected; returns whether it was sent. Nothing is queued, since old gestures are stale. */
  send(message: ClientMessage): boolean {
    if (this.state !== "connected") return false;
    this.sendNow_(message);
    return true;
  }

  /** Tries again immediately instead of waiting for the back-off. */
  retryNow(): void {
    if (this.retry_ === undefined) return;
    this.delayMs_ = firstDelayMs;
    window.clearTimeout(this.retry_);
    this.retry_ = undefined;
    this.open();
  }

  /** For good. */
  close(): void {
    this.close_();
    window.clearTimeout(this.retry_);
    this.retry_ = undefined;
  }

  private sendNow_(message: ClientMessage): void {
    if (this.socket_?.readyState === WebSocket.OPEN) this.socket_.send(encodeClientMessage(message));
  }

  private checkAlive_(): void {
    // Also one that does not come about: a browser waits for minutes where a network has gone.
    if (++this.silentPings_ > mostSilentPings) {
      this.lost_();
      return;
    }
    this.sendNow_({ type: "ping", clientTime: performance.now() / 1000 });
  }

  private receive_(data: unknown): void {
    const now = performance.now();
    this.silentPings_ = 0;
    try {
      if (!(data instanceof ArrayBuffer)) throw new Error("a text frame");
      if (messageTypeOf(data) === MessageType.poses) {
        decodePosesInto(data, this.poses_);
        this.listener_.poses(this.poses_, now);
        return;
      }
      this.handle_(decodeServerMessage(data), now);
    } catch (error) {
      this.badFrames++;
      // Only the first few are logged, so that a stream of errors does not fill the console.
      if (this.badFrames <= 5) console.warn("iota: a frame from the server was dropped:", error);
    }
  }

  private handle_(message: ServerMessage, now: number): void {
    switch (message.type) {
      case "welcome":
        this.clientId = message.client;
        this.delayMs_ = firstDelayMs;
        this.change_("connected", "");
        break;
      case "refused":
        this.refusal_ = message.reason;
        return;
      case "pong":
        this.roundTripMs = now - message.clientTime * 1000;
        return;
      default:
        break;
    }
    this.listener_.message(message);
  }

  private lost_(triesAgain = true): void {
    this.close_();
    if (this.refusal_ !== "") this.change_("refused", this.refusal_);
    else this.change_("lost", "");
    if (!triesAgain) return;
    this.listener_.lost?.();
    this.retry_ = window.setTimeout(() => {
      this.retry_ = undefined;
      this.open();
    }, this.delayMs_ * (0.8 + 0.4 * Math.random()));
    this.delayMs_ = Math.min(this.delayMs_ * 1.7, longestDelayMs);
  }

  /** A page cannot distinguish a refused upgrade from a dead server; the health address can. */
  private async explain_(): Promise<void> {
    try {
      const answer = await fetch("healthz", { cache: "no-store" });
      if (answer.ok && this.state !== "connected" && !this.opened_) {
        this.change_("refused", "The server is running but does not accept this address. Open the address that the terminal printed; it ends in a token.");
      }
    } catch {
      // The server is not running: the state is already "lost".
    }
  }

  private close_(): void {
    window.clearInterval(this.ping_);
    if (this.socket_ === null) return;
    this.socket_.onopen = this.socket_.onmessage = this.socket_.onclose = null;
    this.socket_.close();
    this.socket_ = null;
  }

  private change_(state: LinkState, reason: string): void {
    this.state = state;
    this.listener_.state(state, reason);
  }
}
