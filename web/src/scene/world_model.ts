// SPDX-License-Identifier: Apache-2.0
// What the server has said about the world, read and checked; knows neither three.js nor the page.

import { NO_BODY, type BodyArticulate, type ClientEntry, type PosesBuffer, type Structure } from "../protocol/generated.ts";
import { numbers, parseRotation, parseShape, placeShape, type PlacedShape, type Quat, type Shape, type Vec3 } from "./shapes/shape.ts";

export type BodyKind = "dynamic" | "static" | "scripted" | "inactive";

export interface BodyEntry {
  readonly body: number;
  readonly className: string;
  readonly odd: boolean;
  readonly kind: BodyKind;
  /** Replaces the length of cylinders and capsules, m. */
  readonly length: number | null;
}

export interface StaticEntry {
  readonly shape: Shape;
  readonly position: Vec3;
  readonly rotation: Quat;
}

/** A point of a body, in its frame; of the world without a body. m. */
export interface TieEnd {
  readonly body: number | null;
  readonly point: Vec3;
}

/** What ties two bodies together, and is drawn between them. */
export interface TieEntry {
  readonly kind: TieKind;
  readonly className: string;
  readonly a: TieEnd;
  readonly b: TieEnd;
  /** Of a spring at rest, a rope pulled taut, a rod, m. */
  readonly length: number;
}

export type TieKind = "spring" | "rope" | "rod";

export interface ActionEntry {
  readonly name: string;
  readonly key: string;
  readonly label: string;
  readonly help: string;
  readonly on: "body" | "world";
  /** Controller face button. */
  readonly button: "a" | "b" | null;
}

export interface WorldSettings {
  readonly title: string;
  readonly looks: readonly string[];
  readonly look: string;
  readonly camera: { readonly position: Vec3; readonly target: Vec3 } | null;
  /** Height of the ground, m; null: none. */
  readonly ground: number | null;
  readonly dt: number;
}

/** One hand on one body as the server last told. */
export interface Hold {
  client: number;
  hold: number;
  body: number;
  readonly point: Float32Array;
  readonly target: Float32Array;
  /** N. */
  force: number;
}

/** Which part of the model changed; listeners redraw only that. */
export type Change = "world" | "bodies" | "ties" | "statics" | "actions" | "structure" | "clients" | "look";

const emptyWorld: WorldSettings = { title: "", looks: [], look: "", camera: null, ground: null, dt: 0 };

type Json = Record<string, unknown>;

function object(value: unknown, name: string): Json {
  if (typeof value !== "object" || value === null || Array.isArray(value)) throw new Error(`${name} must be an object`);
  return value as Json;
}

function list(value: unknown, name: string): unknown[] {
  if (!Array.isArray(value)) throw new Error(`${name} must be a list`);
  return value;
}

function text(value: unknown, fallback: string): string {
  return typeof value === "string" ? value : fallback;
}

function vec3(value: unknown, name: string): Vec3 {
  const [x, y, z] = numbers(value, 3, name, [0, 0, 0]);
  return [x, y, z];
}

export class WorldModel {
  settings: WorldSettings = emptyWorld;
  /** CLASS -> LOOK (or "*") -> shapes. */
  classes = new Map<string, Map<string, readonly Shape[]>>();
  bodies = new Map<number, BodyEntry>();
  statics: readonly StaticEntry[] = [];
  ties: readonly TieEntry[] = [];
  actions: readonly ActionEntry[] = [];
  clients: readonly ClientEntry[] = [];
  articulates: readonly BodyArticulate[] = [];
  /** Body -> articulate. */
  readonly articulateOf = new Map<number, number>();
  structureVersion = 0;
  step = 0;
  time = 0;
  paused = false;
  speed = 1;
  stepMs = 0;
  kinetic = 0;
  potential = 0;
  gap = 0;
  /** The first `holdCount` are valid; entries are reused. */
  readonly holds: Hold[] = [];
  holdCount = 0;
  /** Name of the look that this page draws. */
  look = "";

  private lookChosen_ = false;
  private readonly changed_: (change: Change) => void;

  constructor(changed: (change: Change) => void) {
    this.changed_ = changed;
  }

  /** Takes one keyed part of the scene. Throws an Error that names what is wrong; the old part stays. */
  setScene(key: string, json: string): void {
    const value: unknown = JSON.parse(json);
    switch (key) {
      case "world":
        this.settings = value === null ? emptyWorld : readWorld(object(value, key));
        if (!this.lookChosen_ || !this.settings.looks.includes(this.look)) this.applyLook_(this.settings.look);
        this.changed_("world");
        break;
      case "classes":
        this.classes = value === null ? new Map() : readClasses(object(value, key));
        this.changed_("bodies");
        break;
      case "bodies":
        this.bodies = readBodies(value === null ? [] : list(value, key));
        this.changed_("bodies");
        break;
      case "ties":
        this.ties = value === null ? [] : list(value, key).map(readTie);
        this.changed_("ties");
        break;
      case "statics":
        this.statics = value === null ? [] : list(value, key).map(readStatic);
        this.changed_("statics");
        break;
      case "actions":
        this.actions = value === null ? [] : list(value, key).map(readAction);
        this.changed_("actions");
        break;
      default:
        // A newer server may know more keys than this page: what it cannot draw does not harm it.
        break;
    }
  }

  /** Draws the world in another of its looks, on this page only. */
  setLook(look: string): void {
    this.lookChosen_ = true;
    this.applyLook_(look);
  }

  setStructure(structure: Structure): void {
    this.structureVersion = structure.structureVersion;
    this.articulates = structure.articulates;
    this.articulateOf.clear();
    for (const entry of structure.articulates) this.articulateOf.set(entry.body, entry.articulate);
    this.changed_("structure");
  }

  setClients(clients: readonly ClientEntry[]): void {
    this.clients = clients;
    this.changed_("clients");
  }

  /** Takes all of a pose frame but the poses, without allocating. */
  setState(poses: PosesBuffer): void {
    this.step = poses.step;
    this.time = poses.time;
    this.paused = poses.paused;
    this.speed = poses.speed;
    this.stepMs = poses.stepMs;
    this.kinetic = poses.kinetic;
    this.potential = poses.potential;
    this.gap = poses.gap;
    const rows = poses.holds;
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

  private applyLook_(look: string): void {
    if (look === this.look) return;
    this.look = look;
    this.changed_("look");
  }

  /** Shapes of a class in a look: that look's, else those for every look ("*"), else of any look. */
  shapesOfClass(className: string, look: string): readonly Shape[] {
    const looks = this.classes.get(className);
    if (looks === undefined) return [];
    return looks.get(look) ?? looks.get("*") ?? looks.values().next().value ?? [];
  }

  /** Ties that are drawn alike. */
  tiesByClass(): Map<string, TieEntry[]> {
    const classes = new Map<string, TieEntry[]>();
    for (const tie of this.ties) {
      const members = classes.get(tie.className);
      if (members === undefined) classes.set(tie.className, [tie]);
      else members.push(tie);
    }
    return classes;
  }

  /** Shapes of a body at their places, in a look. */
  placedShapes(entry: BodyEntry, look: string): PlacedShape[] {
    return this.shapesOfClass(entry.className, look).map((shape) => placeShape(shape, entry.odd, entry.length));
  }
}

function readWorld(json: Json): WorldSettings {
  const looks = Array.isArray(json["looks"]) ? json["looks"].filter((item): item is string => typeof item === "string") : [];
  const camera = typeof json["camera"] === "object" && json["camera"] !== null ? object(json["camera"], "camera") : null;
  const ground = json["ground"];
  return {
    title: text(json["title"], ""),
    looks,
    look: text(json["look"], looks[0] ?? ""),
    camera: camera === null
      ? null
      : { position: vec3(camera["position"], "camera.position"), target: vec3(camera["target"], "camera.target") },
    ground: typeof ground === "number" && Number.isFinite(ground) ? ground : null,
    dt: typeof json["dt"] === "number" ? json["dt"] : 0,
  };
}

function readClasses(json: Json): Map<string, Map<string, readonly Shape[]>> {
  const classes = new Map<string, Map<string, readonly Shape[]>>();
  for (const [className, value] of Object.entries(json)) {
    const looks = new Map<string, readonly Shape[]>();
    for (const [look, shapes] of Object.entries(object(value, className))) {
      const items = Array.isArray(shapes) ? shapes : [shapes];
      looks.set(look, items.map((shape) => parseShape(shape)));
    }
    classes.set(className, looks);
  }
  return classes;
}

const kinds: readonly string[] = ["dynamic", "static", "scripted", "inactive"];

function readSlot(value: unknown): number {
  if (typeof value !== "number" || !Number.isInteger(value) || value < 0 || value > 0xffff) {
    throw new Error(`body must be a slot from 0 to 65535, it is ${JSON.stringify(value)}`);
  }
  return value;
}

function readBodies(items: unknown[]): Map<number, BodyEntry> {
  const bodies = new Map<number, BodyEntry>();
  for (const item of items) {
    const json = object(item, "body");
    const body = readSlot(json["body"]);
    const kind = text(json["kind"], "dynamic");
    const length = json["length"];
    bodies.set(body, {
      body,
      className: text(json["class"], ""),
      odd: json["odd"] === 1 || json["odd"] === true,
      kind: (kinds.includes(kind) ? kind : "dynamic") as BodyKind,
      length: typeof length === "number" && length > 0 ? length : null,
    });
  }
  return bodies;
}

function readStatic(item: unknown): StaticEntry {
  const json = object(item, "static");
  return { shape: parseShape(json["shape"]), position: vec3(json["position"], "position"), rotation: parseRotation(json["rotation"]) };
}

const tieKinds: readonly string[] = ["spring", "rope", "rod"];

function readTie(item: unknown): TieEntry {
  const json = object(item, "tie");
  const kind = text(json["kind"], "");
  if (!tieKinds.includes(kind)) throw new Error(`unknown kind of tie ${JSON.stringify(kind)}; known: ${tieKinds.join(", ")}`);
  const end = (name: string): TieEnd => {
    const of = object(json[name], name);
    return { body: of["body"] === null ? null : readSlot(of["body"]), point: vec3(of["point"], `${name}.point`) };
  };
  const length = json["length"];
  return {
    kind: kind as TieKind,
    className: text(json["class"], kind),
    a: end("a"),
    b: end("b"),
    length: typeof length === "number" && length > 0 ? length : 0,
  };
}

function readAction(item: unknown): ActionEntry {
  const json = object(item, "action");
  const name = text(json["name"], "");
  if (name === "") throw new Error("an action must have a name");
  const button = json["button"];
  return {
    name,
    key: text(json["key"], ""),
    label: text(json["label"], name),
    help: text(json["help"], ""),
    on: json["on"] === "body" ? "body" : "world",
    button: button === "a" || button === "b" ? button : null,
  };
}
