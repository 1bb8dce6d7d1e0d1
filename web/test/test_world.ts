// SPDX-License-Identifier: Apache-2.0
// A world built from messages like those of a server, without server, browser or drawing.

import { InstancedMesh } from "three";
import {
  BodyKind, decodePosesInto, encodeEntities, encodePoses, NO_COLOR, PosesBuffer, type BodyEntity, type EntityKind, type EntityRecords,
  type Id, type Part, type PoseBody, type Poses, type VisualEntity,
} from "../src/protocol/generated.ts";
import { World, type Change, type WorldListener } from "../src/world/world.ts";

export const span = 10;

export function packRotation(q: readonly number[]): number {
  let largest = 0;
  for (let axis = 1; axis < 4; axis++) if (Math.abs(q[axis]) > Math.abs(q[largest])) largest = axis;
  const sign = q[largest] < 0 ? -1 : 1;
  let packed = largest;
  for (let axis = 0; axis < 4; axis++) {
    if (axis !== largest) packed = packed * 1024 + Math.round(((q[axis] * sign + Math.SQRT1_2) / Math.SQRT2) * 1023);
  }
  return packed;
}

/** A pose frame as received from the socket; the box is 0 .. span m. */
export function frame(step: number, bodies: PoseBody[], extra: Partial<Poses> = {}): PosesBuffer {
  const poses: Poses = {
    type: "poses", step, time: step / 60, structureVersion: 1, keyframe: false, kinetic: 0, potential: 0, gap: 0,
    boxMin: [0, 0, 0], boxMax: [span, span, span], bodies, farBodies: [], sparks: [], holds: [], ...extra,
  };
  const buffer = new PosesBuffer();
  decodePosesInto(encodePoses(poses), buffer);
  return buffer;
}

export function body(slot: number, x: number, q: readonly number[] = [0, 0, 0, 1]): PoseBody {
  return { body: slot, x: Math.round((x / span) * 65535), y: 0, z: 0, rotation: packRotation(q) };
}

export function part(kind: string, sizes: readonly number[], extra: Partial<Part> = {}): Part {
  return {
    style: "*", shape: { kind, sizes: Float32Array.from(sizes), vertices: new Float32Array(0), triangles: new Uint32Array(0) },
    offset: [0, 0, 0], rotation: [0, 0, 0, 1], turn: 0, material: "paint", color: NO_COLOR, ...extra,
  };
}

export function id(slot: number, generation = 1): Id {
  return { slot, generation };
}

export function visual(slot: number, name: string, ...parts: Part[]): VisualEntity {
  return { id: id(slot), name, parts };
}

export function bodyEntity(slot: number, extra: Partial<BodyEntity> = {}): BodyEntity {
  return { id: id(slot), kind: BodyKind.dynamic, visual: 0, odd: false, length: 0, color: NO_COLOR, name: "", ...extra };
}

export class TestWorld implements WorldListener {
  readonly world = new World(this);
  readonly changes: Change[] = [];
  readonly goneBodies: number[] = [];
  readonly warnings: string[] = [];
  private step_ = 0;

  /** Joins: entities that are not sent again before the next poses are destroyed. */
  join(): void {
    this.world.take({ type: "welcome", version: 4, world: "", client: 1 });
  }

  set<K extends EntityKind>(kind: K, ...entities: readonly EntityRecords[K][]): void {
    this.world.take({ type: "entitiesSet", kind: snake(kind), records: encodeEntities(kind, entities) });
  }

  destroy(kind: EntityKind, ...ids: Id[]): void {
    this.world.take({ type: "entitiesDestroyed", kind: snake(kind), ids });
  }

  /** Receives a pose frame, 16 ms after the previous one, and updates the drawn poses. */
  poses(bodies: PoseBody[], extra: Partial<Poses> = {}): void {
    const step = ++this.step_;
    this.world.takePoses(frame(step, bodies, extra), 16 * step);
    this.update();
  }

  update(): void {
    this.world.entities.body.update(0.016, 16 * this.step_);
    this.world.entities.body.draw(0.016);
  }

  meshes(): InstancedMesh[] {
    return this.world.entities.body.root.children.filter((child) => child instanceof InstancedMesh);
  }

  // --- WorldListener

  changed(what: Change): void {
    this.changes.push(what);
  }

  bodyGone(slot: number): void {
    this.goneBodies.push(slot);
  }

  warn(title: string, text: string): void {
    this.warnings.push(`${title}: ${text}`);
  }
}

function snake(kind: string): string {
  return kind.replaceAll(/[A-Z]/g, (letter) => `_${letter.toLowerCase()}`);
}
