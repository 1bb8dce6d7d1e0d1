// SPDX-License-Identifier: Apache-2.0
// Shapes as the script describes them, and their place on a body. Drawing and picking both use the list of kinds, so
// that they agree.

import type { BufferGeometry } from "three";
import { parseMesh } from "./mesh.ts";
import type { Detail, Solid } from "./kind.ts";
import { shapeKind } from "./shape_list.ts";

export type Vec3 = readonly [number, number, number];
/** x, y, z, w. */
export type Quat = readonly [number, number, number, number];

/** A solid, its material, and its place on its body. */
export interface Shape extends Solid {
  readonly material: string;
  readonly color: string | null;
  /** 1: opaque. */
  readonly opacity: number;
  readonly offset: Vec3;
  readonly rotation: Quat;
  /** Extra turn about the body's x axis on odd bodies, rad. */
  readonly turn: number;
}

function number(value: unknown, name: string, fallback: number): number {
  if (value === undefined || value === null) return fallback;
  if (typeof value !== "number" || !Number.isFinite(value)) {
    throw new Error(`${name} must be a finite number, it is ${JSON.stringify(value)}`);
  }
  return value;
}

/** A list of `count` finite numbers, or the fallback when there is none. */
export function numbers(value: unknown, count: number, name: string, fallback: readonly number[]): number[] {
  if (value === undefined || value === null) return [...fallback];
  if (!Array.isArray(value) || value.length !== count) throw new Error(`${name} must be ${count} numbers`);
  return value.map((item: unknown, index) => number(item, `${name}[${index}]`, 0));
}

function unit(q: number[]): Quat {
  const norm = Math.hypot(q[0], q[1], q[2], q[3]);
  if (norm < 1e-9) throw new Error("rotation must not be zero");
  return [q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm];
}

export function parseRotation(value: unknown): Quat {
  return unit(numbers(value, 4, "rotation", [0, 0, 0, 1]));
}

/** Sizes of a kind, checked: all finite, and as many as the kind has. Missing ones at the end are 0. */
function parseSizes(value: unknown, count: number): number[] {
  if (value === undefined) return Array<number>(count).fill(0);
  if (!Array.isArray(value) || value.length > count) throw new Error(`sizes must be at most ${count} numbers`);
  return Array.from({ length: count }, (_, index) => number(value[index], `sizes[${index}]`, 0));
}

/** Reads one shape of the scene description; throws an Error that names the wrong field. */
export function parseShape(value: unknown): Shape {
  if (typeof value !== "object" || value === null) throw new Error("a shape must be an object");
  const json = value as Record<string, unknown>;
  const kind = shapeKind(String(json["kind"]));
  const offset = numbers(json["offset"], 3, "offset", [0, 0, 0]);
  return {
    kind,
    sizes: parseSizes(json["sizes"], kind.sizes.length),
    mesh: kind.name === "mesh" ? parseMesh(json["vertices"], json["triangles"]) : null,
    material: typeof json["material"] === "string" ? json["material"] : "paint",
    color: typeof json["color"] === "string" ? json["color"] : null,
    opacity: number(json["opacity"], "opacity", 1),
    offset: [offset[0], offset[1], offset[2]],
    rotation: parseRotation(json["rotation"]),
    turn: number(json["turn"], "turn", 0),
  };
}

/** One of its sizes by name; 0 if there is none of that name. */
export function sizeOf({ kind, sizes }: Solid, name: string): number {
  const index = kind.sizes.indexOf(name);
  return index < 0 ? 0 : sizes[index];
}

/** A copy with one size changed, if it has that. */
export function withSize<S extends Solid>(solid: S, name: string, value: number): S {
  const index = solid.kind.sizes.indexOf(name);
  return index < 0 ? solid : { ...solid, sizes: solid.sizes.with(index, value) };
}

/** Distance in meters from a point in the shape's own frame to its surface, negative inside. */
export function shapeDistance(solid: Solid, x: number, y: number, z: number): number {
  return solid.kind.distance(solid, x, y, z);
}

/** The usual word for a thing of these shapes: by the largest of them. */
export function wordOf(placed: readonly PlacedShape[]): string {
  if (placed.length === 0) return "thing";
  const { shape } = placed.reduce((largest, each) => (shapeReach(each.shape) > shapeReach(largest.shape) ? each : largest));
  return shape.kind.word?.(shape) ?? shape.kind.name.replaceAll("_", " ");
}

/** Radius in meters of the smallest enclosing sphere about the shape's origin. */
export function shapeReach(solid: Solid): number {
  return solid.kind.reach(solid);
}

/** Lays an image once over a geometry of a kind of shape. */
export type Lay = (geometry: BufferGeometry, kind: string) => void;

let layImage: Lay | null = null;
/** Geometries for images, made before the code that lays these was fetched. */
const unlaid: Parameters<Lay>[] = [];

export function setLay(lay: Lay): void {
  layImage = lay;
  for (const made of unlaid.splice(0)) lay(...made);
}

/** Triangles of a shape in its own frame; the caller disposes of them. */
export function makeGeometry(shape: Shape, detail: Detail): BufferGeometry {
  const geometry = shape.kind.draw(shape, detail, shape.material);
  if (shape.material.includes("#")) {
    if (layImage === null) unlaid.push([geometry, shape.kind.name]);
    else layImage(geometry, shape.kind.name);
  }
  return geometry;
}

/** A shape at its place in the body's frame. */
export interface PlacedShape {
  readonly shape: Shape;
  readonly offset: Vec3;
  readonly rotation: Quat;
}

export function multiply(a: Quat, b: Quat): Quat {
  return [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
  ];
}

/**
 * Places a shape on a body: odd bodies are turned about the body's x axis, and a body's own length
 * replaces that of a shape that has one.
 */
export function placeShape(shape: Shape, odd: boolean, length: number | null): PlacedShape {
  const angle = odd ? shape.turn : 0;
  const turn: Quat = [Math.sin(angle / 2), 0, 0, Math.cos(angle / 2)];
  const [x, y, z] = shape.offset;
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  return {
    shape: length === null ? shape : withSize(shape, "length", length),
    offset: [x, c * y - s * z, s * y + c * z],
    rotation: multiply(turn, shape.rotation),
  };
}

/** Radius in meters of the sphere about the body's origin that encloses all its shapes. */
export function bodyReach(shapes: readonly PlacedShape[]): number {
  let reach = 0;
  for (const placed of shapes) {
    const [x, y, z] = placed.offset;
    reach = Math.max(reach, Math.hypot(x, y, z) + shapeReach(placed.shape));
  }
  return reach;
}

/** Distance in meters from a point in the body's frame to the nearest of its shapes, negative inside. */
export function bodyDistance(shapes: readonly PlacedShape[], x: number, y: number, z: number): number {
  let nearest = Infinity;
  for (let index = 0; index < shapes.length; index++) {
    const placed = shapes[index];
    const px = x - placed.offset[0];
    const py = y - placed.offset[1];
    const pz = z - placed.offset[2];
    // Rotation by the conjugate quaternion, written out so that nothing is allocated.
    const qx = -placed.rotation[0];
    const qy = -placed.rotation[1];
    const qz = -placed.rotation[2];
    const qw = placed.rotation[3];
    const tx = 2 * (qy * pz - qz * py);
    const ty = 2 * (qz * px - qx * pz);
    const tz = 2 * (qx * py - qy * px);
    const distance = shapeDistance(
      placed.shape,
      px + qw * tx + qy * tz - qz * ty,
      py + qw * ty + qz * tx - qx * tz,
      pz + qw * tz + qx * ty - qy * tx,
    );
    if (distance < nearest) nearest = distance;
  }
  return nearest;
}
