// SPDX-License-Identifier: Apache-2.0
// A world in the three.js scene of another application: `scene.add(embedded.root)`, and `embedded.update(seconds, camera)`
// before each picture. Lights, camera and input stay those of the application.

import { Group, type Camera, type Ray } from "three";
import { Hit, pickRay, toWorld } from "../interact/picking.ts";
import { Connection, type LinkState } from "../net/connection.ts";
import { Role, type Id, type Notice } from "../protocol/generated.ts";
import type { EntityView } from "../scene/entities/entity.ts";
import { World } from "../world/world.ts";

export interface EmbedOptions {
  /** Id of the world; empty: the server's first one. */
  readonly world?: string;
  readonly role?: Role;
  /** Shown to the others. */
  readonly name?: string;
  /** A card of the world, or a thing that cannot be drawn. */
  notice?(notice: Pick<Notice, "title" | "text">): void;
  /** `reason` is a sentence for the user, may be empty. */
  link?(state: LinkState, reason: string): void;
}

/** A body and the place that a ray met. */
export interface Picked {
  readonly body: number;
  /** In the body's frame, m. */
  readonly localPoint: readonly [number, number, number];
  /** World, m. */
  readonly point: readonly [number, number, number];
}

const triple = (from: ArrayLike<number>): [number, number, number] => [from[0], from[1], from[2]];

export class EmbeddedWorld {
  readonly root = new Group();
  readonly world: World;
  readonly connection: Connection;

  private readonly hit_ = new Hit();
  private readonly place_ = new Float32Array(3);
  private grabs_ = 0;

  /** `socketUrl`: of the server, as wss://host:port/ws?token=TOKEN. */
  constructor(socketUrl: string, options: EmbedOptions = {}) {
    this.world = new World({
      changed: () => {},
      bodyGone: () => {},
      warn: (title, text) => options.notice?.({ title, text }),
    });
    for (const { root } of this.views_()) if (root !== undefined) this.root.add(root);
    const request = { world: options.world ?? "", role: options.role ?? Role.actor, name: options.name ?? "" };
    this.connection = new Connection(socketUrl, request, {
      message: (message) => (message.type === "notice" ? options.notice?.(message) : this.world.take(message)),
      poses: (poses, now) => this.world.takePoses(poses, now),
      state: (state, reason) => options.link?.(state, reason),
    });
    this.connection.open();
  }

  /** Before each picture. seconds: since the last one. */
  update(seconds: number, camera: Camera): void {
    camera.getWorldPosition(this.world.eye);
    const now = performance.now();
    for (const view of this.views_()) view.update?.(seconds, now);
    for (const view of this.views_()) view.draw?.(seconds);
  }

  /** The nearest body on a ray in the frame of `root`; null: none. tolerance: m aside, for each m of distance. */
  pick({ origin, direction }: Ray, tolerance = 0.01, farthest = 1e4): Picked | null {
    const hit = this.hit_;
    if (!pickRay(this.world.entities.body, origin.toArray(), direction.toArray(), tolerance, farthest, hit)) return null;
    return { body: hit.body, localPoint: triple(hit.localPoint), point: triple(hit.point) };
  }

  /** Takes hold of a body; the returned functions move the hand, and let go. */
  grab({ body, localPoint, point }: Picked): { move(target: readonly [number, number, number]): void; end(): void } {
    const hold = this.grabs_++ % 32;
    this.connection.send({ type: "grabStart", hold, body: this.idOf_(body), localPoint: [...localPoint], target: [...point], pointer: "" });
    return {
      move: (target) => void this.connection.send({ type: "grabMove", hold, target: [...target] }),
      end: () => void this.connection.send({ type: "grabEnd", hold }),
    };
  }

  /** Runs an action of the script, on a body or on the world. */
  act(name: string, body = -1): void {
    this.connection.send({ type: "action", name, body: this.idOf_(body), others: [] });
  }

  /** World, m: a place of a body's frame, its origin without one. */
  placeOf(body: number, localPoint: readonly [number, number, number] = [0, 0, 0]): [number, number, number] {
    toWorld(this.world.entities.body, body, Float32Array.from(localPoint), this.place_);
    return triple(this.place_);
  }

  close(): void {
    this.connection.close();
    this.root.removeFromParent();
  }

  private idOf_(body: number): Id {
    return this.world.entities.body.idOf(body) ?? { slot: 0, generation: 0 };
  }

  private views_(): readonly EntityView<never>[] {
    return Object.values<EntityView<never>>(this.world.entities);
  }
}
