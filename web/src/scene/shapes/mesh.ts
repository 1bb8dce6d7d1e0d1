// SPDX-License-Identifier: Apache-2.0
// A closed surface of triangles: the only shape with tables.

import { BufferAttribute, BufferGeometry } from "three";
import { toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import { boxAbout, type Kind } from "./kind.ts";

/** A closed surface; from outside each triangle is counter-clockwise. */
export interface MeshData {
  /** Three numbers a vertex, m. */
  readonly positions: Float32Array;
  /** Three vertices a triangle. */
  readonly triangles: Uint32Array;
  readonly low: readonly number[];
  readonly high: readonly number[];
}

/** Limit of triangles, as meshes may be drawn many times; looks.py has the same limit. */
export const mostTriangles = 50_000;
/** Up to this number picking uses the triangles, above it their box: there may be a hundred picks a frame. */
const mostFelt = 1_000;

function list(value: unknown, name: string): number[] {
  if (!Array.isArray(value) || value.length % 3 !== 0) throw new Error(`${name} of a mesh must be a list of numbers in threes`);
  if (value.some((item) => typeof item !== "number" || !Number.isFinite(item))) {
    throw new Error(`${name} of a mesh must be finite numbers`);
  }
  return value as number[];
}

export function parseMesh(vertices: unknown, triangles: unknown): MeshData {
  const positions = Float32Array.from(list(vertices, "vertices"));
  const numbers = list(triangles, "triangles");
  const count = positions.length / 3;
  if (numbers.length === 0) throw new Error("a mesh needs triangles");
  if (numbers.length > 3 * mostTriangles) {
    throw new Error(`a mesh may have ${mostTriangles} triangles, this one has ${numbers.length / 3}`);
  }
  const wrong = numbers.find((vertex) => !Number.isInteger(vertex) || vertex < 0 || vertex >= count);
  if (wrong !== undefined) throw new Error(`a triangle names vertex ${wrong}, but there are ${count}`);
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((value, index) => {
    low[index % 3] = Math.min(low[index % 3], value);
    high[index % 3] = Math.max(high[index % 3], value);
  });
  return { positions, triangles: Uint32Array.from(numbers), low, high };
}

/** Radius in meters of the enclosing sphere about the mesh's origin. */
function meshReach(mesh: MeshData): number {
  let reach = 0;
  for (let at = 0; at < mesh.positions.length; at += 3) {
    reach = Math.max(reach, Math.hypot(mesh.positions[at], mesh.positions[at + 1], mesh.positions[at + 2]));
  }
  return reach;
}

function boxDistance(mesh: MeshData, x: number, y: number, z: number): number {
  const dx = Math.max(mesh.low[0] - x, x - mesh.high[0]);
  const dy = Math.max(mesh.low[1] - y, y - mesh.high[1]);
  const dz = Math.max(mesh.low[2] - z, z - mesh.high[2]);
  return Math.hypot(Math.max(dx, 0), Math.max(dy, 0), Math.max(dz, 0)) + Math.min(Math.max(dx, dy, dz), 0);
}

type Triangle = readonly [number, number, number, number, number, number, number, number, number];

/** Squared distance of the origin from a triangle: to its plane, or to the nearest of its edges. */
function squaredDistance([ax, ay, az, bx, by, bz, cx, cy, cz]: Triangle): number {
  const ux = bx - ax, uy = by - ay, uz = bz - az;
  const vx = cx - ax, vy = cy - ay, vz = cz - az;
  const uu = ux * ux + uy * uy + uz * uz, uv = ux * vx + uy * vy + uz * vz, vv = vx * vx + vy * vy + vz * vz;
  const au = -(ax * ux + ay * uy + az * uz), av = -(ax * vx + ay * vy + az * vz);
  const area = uu * vv - uv * uv;
  const s = (vv * au - uv * av) / area;
  const t = (uu * av - uv * au) / area;
  if (area > 0 && s >= 0 && t >= 0 && s + t <= 1) {
    const x = ax + s * ux + t * vx, y = ay + s * uy + t * vy, z = az + s * uz + t * vz;
    return x * x + y * y + z * z;
  }
  const edge = (px: number, py: number, pz: number, qx: number, qy: number, qz: number): number => {
    const dx = qx - px, dy = qy - py, dz = qz - pz;
    const along = -(px * dx + py * dy + pz * dz) / Math.max(dx * dx + dy * dy + dz * dz, 1e-30);
    const part = Math.min(1, Math.max(0, along));
    const x = px + part * dx, y = py + part * dy, z = pz + part * dz;
    return x * x + y * y + z * z;
  };
  return Math.min(edge(ax, ay, az, bx, by, bz), edge(bx, by, bz, cx, cy, cz), edge(cx, cy, cz, ax, ay, az));
}

/** Solid angle of a triangle at the origin (van Oosterom and Strackee 1983); over a closed surface: 4 pi inside, else 0. */
function solidAngle([ax, ay, az, bx, by, bz, cx, cy, cz]: Triangle): number {
  const a = Math.hypot(ax, ay, az), b = Math.hypot(bx, by, bz), c = Math.hypot(cx, cy, cz);
  const volume = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
  const ab = ax * bx + ay * by + az * bz, bc = bx * cx + by * cy + bz * cz, ca = cx * ax + cy * ay + cz * az;
  return 2 * Math.atan2(volume, a * b * c + ab * c + bc * a + ca * b);
}

/** Distance in meters to the surface, negative inside; for a mesh of many triangles to its box. */
function meshDistance(mesh: MeshData, x: number, y: number, z: number): number {
  const toBox = boxDistance(mesh, x, y, z);
  if (mesh.triangles.length > 3 * mostFelt) return toBox;
  const { positions: p, triangles: t } = mesh;
  let nearest = Infinity;
  let angle = 0;
  for (let at = 0; at < t.length; at += 3) {
    const a = 3 * t[at], b = 3 * t[at + 1], c = 3 * t[at + 2];
    const triangle: Triangle = [
      p[a] - x, p[a + 1] - y, p[a + 2] - z, p[b] - x, p[b + 1] - y, p[b + 2] - z, p[c] - x, p[c + 1] - y, p[c + 2] - z,
    ];
    nearest = Math.min(nearest, squaredDistance(triangle));
    if (toBox < 0) angle += solidAngle(triangle);
  }
  return Math.abs(angle) > 2 * Math.PI ? -Math.sqrt(nearest) : Math.sqrt(nearest);
}

/** Edges sharper than this are shaded as edges, others as a smooth surface, rad. */
const creaseAngle = 0.6;

/** The given faces; texture coordinates as given, two a vertex, or in meters, projected along the axis nearest to a face's normal. */
export function drawTriangles(positions: Float32Array, triangles: Uint32Array, coordinates?: Float32Array): BufferGeometry {
  const indexed = new BufferGeometry();
  indexed.setAttribute("position", new BufferAttribute(positions, 3));
  indexed.setIndex(new BufferAttribute(triangles, 1));
  if (coordinates) indexed.setAttribute("uv", new BufferAttribute(coordinates, 2));
  const geometry = toCreasedNormals(indexed, creaseAngle);
  indexed.dispose();
  if (coordinates) return geometry;
  const position = geometry.getAttribute("position");
  const normal = geometry.getAttribute("normal");
  const uvs = new Float32Array(2 * position.count);
  for (let index = 0; index < position.count; index++) {
    const at = [position.getX(index), position.getY(index), position.getZ(index)];
    const facing = [normal.getX(index), normal.getY(index), normal.getZ(index)].map(Math.abs);
    const side = facing.indexOf(Math.max(...facing));
    const [along, across] = [0, 1, 2].filter((axis) => axis !== side);
    uvs.set([at[along] / 0.9, at[across] / 0.22], 2 * index);
  }
  geometry.setAttribute("uv", new BufferAttribute(uvs, 2));
  return geometry;
}

export const mesh: Kind = {
  name: "mesh",
  sizes: [],
  word: () => "part",
  distance: ({ mesh: data }, x, y, z) => (data === null ? Infinity : meshDistance(data, x, y, z)),
  reach: ({ mesh: data }) => (data === null ? 0 : meshReach(data)),
  box: ({ mesh: data }) => data ?? boxAbout(0, 0, 0),
  draw: ({ mesh: data }) => (data === null ? new BufferGeometry() : drawTriangles(data.positions, data.triangles)),
};
