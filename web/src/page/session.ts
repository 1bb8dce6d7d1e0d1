// SPDX-License-Identifier: Apache-2.0
// This page's place in a world: takes what the server says to where it belongs, and tells the server what the user asks for.

import { Connection, type ConnectionListener, type LinkState } from "../net/connection.ts";
import { type ControlCommand, NO_BODY, type ClientMessage, type PosesBuffer, type ServerMessage } from "../protocol/generated.ts";
import type { WorldModel } from "../scene/world_model.ts";
import type { Events } from "./events.ts";

/** Where pose frames go. */
export interface PoseTaker {
  /** `fresh`: the first frame of a connection; what came before is of another world. The buffer is only valid during the call. */
  takePoses(poses: PosesBuffer, now: number, fresh: boolean): void;
}

export class Session implements ConnectionListener {
  readonly connection: Connection;

  private readonly world_: WorldModel;
  private readonly poses_: PoseTaker;
  private readonly events_: Events;
  private readonly stir_: () => void;
  private fresh_ = true;

  /** `stir` is called whenever something is to be drawn anew. */
  constructor(url: string, name: string, world: WorldModel, poses: PoseTaker, events: Events, stir: () => void) {
    this.world_ = world;
    this.poses_ = poses;
    this.events_ = events;
    this.stir_ = stir;
    this.connection = new Connection(url, name, this);
  }

  get clientId(): number {
    return this.connection.clientId;
  }

  open(): void {
    this.connection.open();
  }

  /** Sends when connected, else forgets it: old gestures are stale. */
  send(message: ClientMessage): void {
    this.connection.send(message);
  }

  /** Pause, play, single step, reset, speed. */
  control(command: ControlCommand, value = 0): void {
    this.send({ type: "control", command, value });
  }

  /** Runs an action of the script on a body, -1: none. */
  act(name: string, body: number): void {
    this.send({ type: "action", name, body: body < 0 ? NO_BODY : body });
  }

  /** Tells the server what this page has selected, -1: nothing. */
  select(body: number): void {
    this.send({ type: "select", body: body < 0 ? NO_BODY : body });
  }

  // --- ConnectionListener

  message(message: ServerMessage): void {
    this.stir_();
    switch (message.type) {
      case "welcome":
        this.fresh_ = true;
        break;
      case "scene":
        this.takeScene_(message.key, message.json);
        break;
      case "structure":
        this.world_.setStructure(message);
        break;
      case "clients":
        this.world_.setClients(message.clients);
        break;
      case "notice":
        this.events_.notice(message);
        break;
      case "effect":
        this.events_.effect(message.kind, message.position);
        break;
      default:
        break;
    }
  }

  poses(poses: PosesBuffer, now: number): void {
    if (poses.step !== this.world_.step || poses.holds.count > 0) this.stir_();
    this.world_.setState(poses);
    this.poses_.takePoses(poses, now, this.fresh_);
    this.fresh_ = false;
  }

  state(state: LinkState, reason: string): void {
    this.events_.link(state, reason);
  }

  private takeScene_(key: string, json: string): void {
    try {
      this.world_.setScene(key, json);
    } catch (error) {
      const text = error instanceof Error ? error.message : String(error);
      this.events_.notice({
        level: 2, title: `The scene's "${key}" cannot be drawn`, text, hint: "Look at the script's description of its shapes.",
      });
    }
  }
}
