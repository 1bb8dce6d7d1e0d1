// SPDX-License-Identifier: Apache-2.0
// The other users: a head with a visor where each looks from, the hands of a headset, and the name. This page tells them where its own
// user is. Fetched when a second client comes.

import { BoxGeometry, BufferAttribute, Group, Mesh, Quaternion, SphereGeometry, Vector3, type BufferGeometry } from "three";
import { NO_BODY, NO_COLOR, type Stance, type Vec3 } from "../protocol/generated.ts";
import { materialOf } from "../scene/materials.ts";
import type { World } from "../world/world.ts";
import { others } from "./highlights.ts";
import type { Session } from "./session.ts";
import type { FramePart, Viewer } from "./viewer.ts";

/** Radius of the head of a user, m, and of a hand. */
const headRadius = 0.1;
const handRadius = 0.04;
/** A head that is nearer to the own eyes is not drawn: who looks from the same place would be in it. */
const tooNear = 0.4;
const tellEverySeconds = 0.1;
/** The script alone needs the place, for what is near it to be simulated in full. */
const tellAloneSeconds = 0.25;
/** Heads glide to where they are told to be. */
const glideSeconds = 0.08;
/** A scene from this to that size is walked in at its real size, any other at that of a table, as in a headset. */
const realSizes = [0.12, 20] as const;

/** The length of one meter of a user before a flat screen, m of the world. */
export function scaleOf(size: number): number {
  return size >= realSizes[0] && size <= realSizes[1] ? 1 : size / 0.5;
}

class Person {
  readonly root = new Group();
  readonly head = new Group();
  private readonly hands_: Mesh[] = [];
  private readonly color_: string;
  private readonly goal_ = new Vector3();
  private readonly turn_ = new Quaternion();
  private isNew_ = true;

  constructor(client: number) {
    this.color_ = `#${others[client % others.length].getHexString()}`;
    const face = solid(new SphereGeometry(headRadius, 32, 20).scale(0.85, 1.1, 1), this.color_);
    const visor = solid(new BoxGeometry(1.5 * headRadius, 0.55 * headRadius, 0.5 * headRadius), "#22262a");
    visor.position.set(0, 0.2 * headRadius, -0.85 * headRadius);
    this.head.add(face, visor);
    this.root.add(this.head);
  }

  stand({ head, rotation, scale, hands }: Stance): void {
    this.goal_.fromArray(head);
    this.turn_.fromArray(rotation);
    this.head.scale.setScalar(scale);
    while (3 * this.hands_.length < hands.length) {
      const hand = solid(new SphereGeometry(handRadius, 20, 14), this.color_);
      this.hands_.push(hand);
      this.root.add(hand);
    }
    this.hands_.forEach((hand, index) => {
      hand.visible = 3 * index < hands.length;
      if (hand.visible) hand.position.fromArray(hands, 3 * index);
      hand.scale.setScalar(scale);
    });
  }

  /** Moves towards its place; returns whether it still moves. */
  glide(seconds: number): boolean {
    const ease = this.isNew_ ? 1 : 1 - Math.exp(-seconds / glideSeconds);
    this.isNew_ = false;
    const { position, quaternion, scale } = this.head;
    position.lerp(this.goal_, ease);
    quaternion.slerp(this.turn_, ease);
    return position.distanceTo(this.goal_) > 1e-3 * scale.x || quaternion.angleTo(this.turn_) > 1e-3;
  }

  dispose(): void {
    this.root.removeFromParent();
    this.root.traverse((item) => {
      if (item instanceof Mesh) (item.geometry as BufferGeometry).dispose();
    });
  }
}

function solid(geometry: BufferGeometry, color: string): Mesh {
  geometry.setAttribute("tint", new BufferAttribute(new Float32Array(4 * geometry.getAttribute("position").count), 4));
  return new Mesh(geometry, materialOf({ material: "paint", color }));
}

export class People implements FramePart {
  readonly root = new Group();
  private readonly world_: World;
  private readonly session_: Session;
  private readonly viewer_: Viewer;
  private readonly people_ = new Map<number, Person>();
  private readonly head_ = new Vector3();
  private readonly turn_ = new Quaternion();
  private seen_: unknown = null;
  private wait_ = 0;
  private told_ = "";

  constructor(world: World, session: Session, viewer: Viewer) {
    this.world_ = world;
    this.session_ = session;
    this.viewer_ = viewer;
  }

  draw(seconds: number): void {
    this.tell_(seconds);
    const { people } = this.world_;
    if (people !== this.seen_) {
      this.seen_ = people;
      this.show_();
    }
    for (const [client, person] of this.people_) {
      if (person.glide(seconds)) this.viewer_.invalidate();
      const { position, scale: { x: scale } } = person.head;
      person.root.visible = position.distanceTo(this.head_) > tooNear * scale;
      this.name_(client, person.root.visible ? position : null, scale);
    }
  }

  private show_(): void {
    const there = new Set<number>();
    for (const { client, stance } of this.world_.people) {
      if (client === this.session_.clientId) continue;
      there.add(client);
      let person = this.people_.get(client);
      if (person === undefined) {
        person = new Person(client);
        this.people_.set(client, person);
        this.root.add(person.root);
      }
      person.stand(stance);
    }
    for (const [client, person] of this.people_) {
      if (there.has(client)) continue;
      person.dispose();
      this.name_(client, null, 1);
      this.people_.delete(client);
    }
  }

  /** A label over a head, in a slot that no label of the script has. */
  private name_(client: number, at: Vector3 | null, scale: number): void {
    const { label } = this.world_.entities;
    const slot = -client;
    const text = this.world_.clients.find((entry) => entry.client === client)?.name ?? "";
    if (at === null || text === "") return label.destroy(slot);
    const place = { body: NO_BODY, point: at.toArray() };
    const entity = {
      id: { slot, generation: 1 }, a: place, b: place, offset: [0, 2.2 * headRadius * scale, 0] as Vec3, text, height: 0, color: NO_COLOR,
    };
    if (label.textOf(slot) === undefined) label.create(entity);
    else label.change(entity);
  }

  /** Tells the others where this user is, after a change. */
  private tell_(seconds: number): void {
    const { viewer_: { camera, room, presenting, size, user, filming } } = this;
    if (user.head === null) camera.getWorldPosition(this.head_);
    else this.head_.copy(user.head);
    this.wait_ -= seconds;
    const { clients, budgetMs } = this.world_;
    if (this.wait_ > 0 || (clients.length < 2 && budgetMs === 0) || filming) return;
    camera.getWorldQuaternion(this.turn_);
    const scale = presenting ? room.scale.x : scaleOf(size);
    const round = (value: number) => Number(value.toPrecision(5));
    const stance: Stance = {
      head: this.head_.toArray().map(round) as unknown as Vec3, rotation: this.turn_.toArray().map(round) as unknown as Stance["rotation"],
      scale: round(scale), hands: Float32Array.from(user.hands, round),
    };
    const told = JSON.stringify([stance, [...stance.hands], this.world_.clients.length]);
    this.wait_ = clients.length < 2 ? tellAloneSeconds : tellEverySeconds;
    if (told === this.told_) return;
    this.told_ = told;
    this.session_.send({ type: "presence", stance });
  }
}
