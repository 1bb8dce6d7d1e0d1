// SPDX-License-Identifier: Apache-2.0
// The world in the server's description: settings, state, entities and poses. Independent of the rest of the page.

import { Vector3 } from "three";
import {
  NO_BODY, type ActionEntry, type ClientEntry, type Cost, type LevelGroup, type Listens, type Person, type PosesBuffer, type ServerMessage, type WorldSettings,
} from "../protocol/generated.ts";
import { makeEntityViews, type Entities } from "../scene/entities/entity_list.ts";
import { PoseBuffer } from "../scene/pose_buffer.ts";
import { EntityStore } from "./entity_store.ts";

/** One hand on one body, from the server's last message. */
export interface Hold {
  client: number;
  hold: number;
  body: number;
  readonly point: Float32Array;
  readonly target: Float32Array;
  /** N. */
  force: number;
}

/** The part of the world that changed; listeners redraw only that. */
export type Change = "settings" | "actions" | "clients" | "look" | "budget";

/** Listens to events of the world. */
export interface WorldListener {
  changed(what: Change): void;
  /** A body was destroyed; called before its slot can be used again. */
  bodyGone(body: number): void;
  /** Something cannot be shown: `title` names it, `text` the reason. */
  warn(title: string, text: string): void;
}

const noSettings: WorldSettings = {
  type: "worldSettings", title: "", styles: [], style: "", hasCamera: false, cameraPosition: [0, 0, 0], cameraTarget: [0, 0, 0], hasGround: false, ground: 0,
  modules: [],
};

export class World {
  settings: Readonly<WorldSettings> = noSettings;
  actions: readonly ActionEntry[] = [];
  clients: readonly ClientEntry[] = [];
  /** The places of users that have reported them; another array after a change. */
  people: readonly Person[] = [];
  paused = false;
  /** Times real time. */
  speed = 1;
  stepMs = 0;
  /** The costs of a step, by its parts, while this page or another shows them. */
  costs: readonly Cost[] = [];
  /** Processor time that a step may take, ms; 0: any. */
  budgetMs = 0;
  /** The levels of what a budget manages, the best first, and the latest changes in words; while a page shows costs. */
  levels: readonly LevelGroup[] = [];
  levelChanges: readonly string[] = [];
  step = 0;
  /** Simulated, s. */
  time = 0;
  structureVersion = 0;
  /** Largest hinge separation, m. */
  gap = 0;
  /** The first `holdCount` are valid; entries are reused. */
  readonly holds: Hold[] = [];
  holdCount = 0;
  readonly poses = new PoseBuffer();
  /** Place of the viewer, world, m; written by the page. */
  readonly eye = new Vector3();
  /** Bodies that this page's user points at, has selected and holds, -1: none; written by the page. */
  readonly marks = { hovered: -1, selected: -1, held: -1 };
  /** The events that the script listens to, besides holds and selections. */
  listens: Pick<Listens, "clicks" | "hovers" | "moves" | "keys"> = { clicks: false, hovers: false, moves: false, keys: [] };
  readonly entities: Entities;

  private readonly store_: EntityStore;
  private readonly listener_: WorldListener;
  private style_ = "";
  private styleChosen_ = false;
  private described_ = false;
  /** A connection's description is coming. */
  private joined_ = false;

  constructor(listener: WorldListener) {
    this.listener_ = listener;
    const warn = (title: string, text: string) => listener.warn(title, text);
    this.entities = makeEntityViews({
      poses: this.poses, eye: this.eye, marks: this.marks, bodyGone: (body) => listener.bodyGone(body), warn,
      changed: () => listener.changed("look"),
    });
    this.store_ = new EntityStore(this.entities, warn);
  }

  /** A connection's complete description has come, with poses. Before that, entities can be there without the bodies among them, and
   * after a lost connection those of another world. */
  get described(): boolean {
    return this.described_ && !this.joined_;
  }

  /** Height of the ground, m; null: none. */
  get ground(): number | null {
    return this.settings.hasGround ? this.settings.ground : null;
  }

  /** Name of the style that this page draws. */
  get style(): string {
    return this.style_;
  }

  /** Switches to another style, on this page only. */
  setStyle(style: string): void {
    this.styleChosen_ = true;
    this.showStyle_(style);
  }

  /** Handles all messages except poses; ignores messages that are not about the world. */
  take(message: ServerMessage): void {
    switch (message.type) {
      case "welcome":
        this.joined_ = true;
        this.store_.beginPicture();
        break;
      case "worldSettings":
        this.settings = message;
        if (!this.styleChosen_ || !message.styles.includes(this.style_)) this.showStyle_(message.style);
        this.listener_.changed("settings");
        break;
      case "worldState":
        this.paused = message.paused;
        this.speed = message.speed;
        this.stepMs = message.stepMs;
        this.costs = message.costs;
        this.levels = message.levels;
        this.levelChanges = message.changes;
        if (message.budgetMs !== this.budgetMs) {
          this.budgetMs = message.budgetMs;
          this.listener_.changed("budget");
        }
        break;
      case "actions":
        this.actions = message.actions;
        this.listener_.changed("actions");
        break;
      case "listens":
        this.listens = message;
        break;
      case "clients":
        this.clients = message.clients;
        this.listener_.changed("clients");
        break;
      case "people":
        this.people = message.people;
        break;
      case "entitiesSet":
        this.store_.set(message);
        break;
      case "entitiesDestroyed":
        this.store_.destroy(message);
        break;
      default:
        break;
    }
  }

  /** A pose frame, which is only valid during the call; allocates nothing. `now` in ms of performance.now(). */
  takePoses(poses: PosesBuffer, now: number): void {
    if (this.joined_) {
      // The first frame of a connection follows the complete description; earlier poses may be of another time.
      this.joined_ = false;
      this.described_ = true;
      this.store_.endPicture();
      this.poses.clear();
    }
    this.step = poses.step;
    this.time = poses.time;
    this.structureVersion = poses.structureVersion;
    this.gap = poses.gap;
    this.takeHolds_(poses);
    this.poses.push(poses, now);
    this.entities.particleSet.takeSparks(poses.sparks);
    this.entities.trace.view?.takePoses(poses.time);
  }

  private showStyle_(style: string): void {
    if (style === this.style_) return;
    this.style_ = style;
    this.entities.visual.showStyle(style);
    this.listener_.changed("look");
  }

  private takeHolds_({ holds: rows }: PosesBuffer): void {
    while (this.holds.length < rows.count) {
      this.holds.push({
        client: 0, hold: 0, body: NO_BODY, point: new Float32Array(3), target: new Float32Array(3), force: 0,
      });
    }
    this.holdCount = rows.count;
    for (let row = 0; row < rows.count; row++) {
      const hold = this.holds[row];
      hold.client = rows.client[row];
      hold.hold = rows.hold[row];
      hold.body = rows.body[row];
      hold.force = rows.force[row];
      for (let axis = 0; axis < 3; axis++) {
        hold.point[axis] = rows.point[3 * row + axis];
        hold.target[axis] = rows.target[3 * row + axis];
      }
    }
  }
}
