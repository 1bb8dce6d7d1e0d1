// SPDX-License-Identifier: Apache-2.0
// Shapes as the script describes them, their distance functions and their place on a body.
// Pure arithmetic: drawing (geometry.ts) and picking (interact/picking.ts) both rest on it.

import { meshDistance, meshReach, parseMesh, type MeshData } from "./mesh.ts";

export type ShapeType = "cylinder" | "capsule" | "sphere" | "torus" | "box" | "mesh";
export type Vec3 = readonly [number, number, number];
/** x, y, z, w. */
export type Quat = readonly [number, number, number, number];

/** One primitive; lengths in meters. Cylinder and capsule lie along +x, a torus in the x-y plane. */
export interface Shape {
  readonly type: ShapeType;
  readonly radius: number;
  /** Cylinder: face to face. Capsule: between the centers of its hemispheres. */
  readonly length: number;
  /** Radius of a torus' tube. */
  readonly tube: number;
  /** Extra straight length of a torus along x: a real chain link. */
  readonly stretch: number;
  readonly size: Vec3;
  /** Of a mesh alone. */
  readonly mesh: MeshData | null;
  readonly material: string;
  readonly color: string | null;
  readonly offset: Vec3;
  readonly rotation: Quat;
  /** Extra turn about the body's x axis on odd bodies, rad. */
  readonly turn: number;
}

const shapeTypes: readonly string[] = ["cylinder", "capsule", "sphere", "torus", "box", "mesh"];

function number(value: unknown, name: string, fallback: number): number {
  if (value === undefined || value === null) return fallback;
  if (typeof value !== "number" || !Number.isFinite(value)) {
    throw new Error(`${name} must be a finite number, it is ${JSON.stringify(value)}`);
  }
  return value;
}

function positive(value: unknown, name: string, fallback: number): number {
  const result = number(value, name, fallback);
  if (result <= 0) throw new Error(`${name} must be positive, it is ${result}`);
  return result;
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

/** Reads one shape of the scene description; throws an Error that names the wrong field. */
export function parseShape(value: unknown): Shape {
  if (typeof value !== "object" || value === null) throw new Error("a shape must be an object");
  const json = value as Record<string, unknown>;
  const type = json["type"];
  if (typeof type !== "string" || !shapeTypes.includes(type)) {
    throw new Error(`unknown shape type ${JSON.stringify(type)}; known: ${shapeTypes.join(", ")}`);
  }
  const radius = positive(json["radius"], "radius", 0.05);
  const size = numbers(json["size"], 3, "size", [0.1, 0.1, 0.1]);
  if (size.some((side) => side <= 0)) throw new Error("size must be positive");
  const offset = numbers(json["offset"], 3, "offset", [0, 0, 0]);
  return {
    type: type as ShapeType,
    radius,
    length: positive(json["length"], "length", 0.1),
    tube: positive(json["tube"], "tube", radius * 0.3),
    stretch: Math.max(0, number(json["stretch"], "stretch", 0)),
    size: [size[0], size[1], size[2]],
    mesh: type === "mesh" ? parseMesh(json["vertices"], json["triangles"]) : null,
    material: typeof json["material"] === "string" ? json["material"] : "paint",
    color: typeof json["color"] === "string" ? json["color"] : null,
    offset: [offset[0], offset[1], offset[2]],
    rotation: parseRotation(json["rotation"]),
    turn: number(json["turn"], "turn", 0),
  };
}

/** Distance in meters from a point in the shape's own frame to its surface, negative inside. */
export function shapeDistance(shape: Shape, x: number, y: number, z: number): number {
  switch (shape.type) {
    case "sphere":
      return Math.hypot(x, y, z) - shape.radius;
    case "capsule": {
      const along = Math.max(0, Math.abs(x) - shape.length / 2);
      return Math.hypot(along, y, z) - shape.radius;
    }
    case "cylinder": {
      const radial = Math.hypot(y, z) - shape.radius;
      const axial = Math.abs(x) - shape.length / 2;
      return Math.min(Math.max(radial, axial), 0) + Math.hypot(Math.max(radial, 0), Math.max(axial, 0));
    }
    case "torus": {
      const along = Math.max(0, Math.abs(x) - shape.stretch / 2);
      const ring = Math.hypot(along, y) - shape.radius;
      return Math.hypot(ring, z) - shape.tube;
    }
    case "box": {
      const dx = Math.abs(x) - shape.size[0] / 2;
      const dy = Math.abs(y) - shape.size[1] / 2;
      const dz = Math.abs(z) - shape.size[2] / 2;
      const outside = Math.hypot(Math.max(dx, 0), Math.max(dy, 0), Math.max(dz, 0));
      return outside + Math.min(Math.max(dx, dy, dz), 0);
    }
    case "mesh":
      return shape.mesh === null ? Infinity : meshDistance(shape.mesh, x, y, z);
  }
}

/** Radius in meters of the smallest sphere about the shape's own origin that holds it. */
export function shapeReach(shape: Shape): number {
  switch (shape.type) {
    case "sphere":
      return shape.radius;
    case "capsule":
      return shape.length / 2 + shape.radius;
    case "cylinder":
      return Math.hypot(shape.length / 2, shape.radius);
    case "torus":
      return shape.stretch / 2 + shape.radius + shape.tube;
    case "box":
      return Math.hypot(shape.size[0], shape.size[1], shape.size[2]) / 2;
    case "mesh":
      return shape.mesh === null ? 0 : meshReach(shape.mesh);
  }
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
 * replaces that of a cylinder or capsule.
 */
export function placeShape(shape: Shape, odd: boolean, length: number | null): PlacedShape {
  const angle = odd ? shape.turn : 0;
  const turn: Quat = [Math.sin(angle / 2), 0, 0, Math.cos(angle / 2)];
  const [x, y, z] = shape.offset;
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  const stretchable = shape.type === "cylinder" || shape.type === "capsule";
  return {
    shape: stretchable && length !== null ? { ...shape, length } : shape,
    offset: [x, c * y - s * z, s * y + c * z],
    rotation: multiply(turn, shape.rotation),
  };
}

/** Radius in meters of the sphere about the body's origin that holds all its shapes. */
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
