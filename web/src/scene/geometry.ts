// SPDX-License-Identifier: Apache-2.0
// Triangles for the shapes of the scene description. Rods and links carry a texture coordinate u in
// tiles along their length (whole tiles, so that neighbors match) and v once around.

import { BufferAttribute, BufferGeometry, SphereGeometry } from "three";
import { RoundedBoxGeometry } from "three/examples/jsm/geometries/RoundedBoxGeometry.js";
import { toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import type { MeshData } from "./mesh.ts";
import type { Shape } from "./shape.ts";

/** fine: a few bodies seen near; coarse: hundreds, where vertices are what costs. */
export type Detail = "fine" | "coarse";

/** Rope strands on the surface; the bump texture lays the same number. */
export const strandCount = 3;
/** Length of a texture tile in radii of the rod: a strand goes once around in strandCount tiles. */
export const tilePerRadius = 4.7;

/** Height 0..1 of a laid rope's surface at u tiles along and v turns around. */
export function strandHeight(u: number, v: number): number {
  const phase = strandCount * v + u;
  const across = 2 * (phase - Math.floor(phase)) - 1;
  return Math.sqrt(Math.max(0, 1 - across * across));
}

/** Writes point and normal of a surface at row i, column j. */
type Surface = (i: number, j: number, point: number[], normal: number[], uv: number[]) => void;

function sweep(rows: number, columns: number, surface: Surface): BufferGeometry {
  const count = (rows + 1) * (columns + 1);
  const positions = new Float32Array(count * 3);
  const normals = new Float32Array(count * 3);
  const uvs = new Float32Array(count * 2);
  const indices: number[] = [];
  const point = [0, 0, 0];
  const normal = [0, 0, 0];
  const uv = [0, 0];
  for (let i = 0; i <= rows; i++) {
    for (let j = 0; j <= columns; j++) {
      const at = i * (columns + 1) + j;
      surface(i, j, point, normal, uv);
      positions.set(point, at * 3);
      normals.set(normal, at * 3);
      uvs.set(uv, at * 2);
      if (i === rows || j === columns) continue;
      indices.push(at, at + columns + 1, at + 1, at + 1, at + columns + 1, at + columns + 2);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new BufferAttribute(normals, 3));
  geometry.setAttribute("uv", new BufferAttribute(uvs, 2));
  geometry.setIndex(indices);
  return geometry;
}

interface ProfilePoint {
  /** Along the axis and away from it, m. */
  readonly x: number;
  readonly r: number;
  readonly nx: number;
  readonly nr: number;
}

function arc(profile: ProfilePoint[], cx: number, cr: number, radius: number, from: number, to: number, steps: number): void {
  for (let step = 0; step <= steps; step++) {
    const angle = from + ((to - from) * step) / steps;
    const nx = -Math.cos(angle);
    const nr = Math.sin(angle);
    profile.push({ x: cx + radius * nx, r: Math.max(cr + radius * nr, 0), nx, nr });
  }
}

/** Profile from -x to +x; ends are hemispheres, or flat with a small rounded edge that catches light. */
function rodProfile(shape: Shape, detail: Detail, lengthRows: number): ProfilePoint[] {
  const profile: ProfilePoint[] = [];
  const half = shape.length / 2;
  const round = shape.type === "capsule";
  const edge = round ? shape.radius : Math.min(shape.radius * 0.2, half * 0.5);
  const steps = detail === "fine" ? (round ? 6 : 3) : round ? 2 : 1;
  const x = round ? half : half - edge;
  if (!round) profile.push({ x: -half, r: 0, nx: -1, nr: 0 });
  arc(profile, -x, shape.radius - edge, edge, 0, Math.PI / 2, steps);
  for (let row = 1; row < lengthRows; row++) {
    profile.push({ x: -x + (2 * x * row) / lengthRows, r: shape.radius, nx: 0, nr: 1 });
  }
  arc(profile, x, shape.radius - edge, edge, Math.PI / 2, Math.PI, steps);
  if (!round) profile.push({ x: half, r: 0, nx: 1, nr: 0 });
  return profile;
}

function makeRod(shape: Shape, detail: Detail): BufferGeometry {
  const laid = shape.material === "rope" && detail === "fine";
  const tiles = Math.max(1, Math.round(shape.length / (tilePerRadius * shape.radius)));
  const profile = rodProfile(shape, detail, laid ? tiles * 6 : 1);
  const columns = detail === "fine" ? (laid ? 30 : 28) : 9;
  return sweep(profile.length - 1, columns, (i, j, point, normal, uv) => {
    const { x, r, nx, nr } = profile[i];
    const v = j / columns;
    const u = (x / shape.length + 0.5) * tiles;
    const c = Math.cos(2 * Math.PI * v);
    const s = -Math.sin(2 * Math.PI * v); // this way round the faces look outward
    // Strands are laid into the outline too, so that a rope near the eye is not a smooth pipe.
    const radius = laid ? r * (0.9 + 0.1 * strandHeight(u, v)) : r;
    point[0] = x;
    point[1] = radius * c;
    point[2] = radius * s;
    normal[0] = nx;
    normal[1] = nr * c;
    normal[2] = nr * s;
    uv[0] = u;
    uv[1] = v;
  });
}

/** A ring, or with `stretch` the stadium of a chain link: two half circles and two straight sides. */
function makeLink(shape: Shape, detail: Detail): BufferGeometry {
  const bends = detail === "fine" ? 20 : 6;
  const columns = detail === "fine" ? 18 : 7;
  const center: { x: number; y: number; nx: number; ny: number; at: number }[] = [];
  const half = shape.stretch / 2;
  const bend = Math.PI * shape.radius;
  const around = 2 * (bend + shape.stretch);
  for (const side of [1, -1]) {
    const start = side === 1 ? 0 : bend + shape.stretch;
    for (let step = 0; step <= bends; step++) {
      const angle = -Math.PI / 2 + (Math.PI * step) / bends;
      const nx = side * Math.cos(angle);
      const ny = side * Math.sin(angle);
      center.push({ x: side * half + shape.radius * nx, y: shape.radius * ny, nx, ny, at: start + (bend * step) / bends });
    }
  }
  center.push({ ...center[0], at: around });
  const tiles = Math.max(1, Math.round(around / (2 * Math.PI * shape.tube)));
  return sweep(center.length - 1, columns, (i, j, point, normal, uv) => {
    const c = center[i];
    const angle = (2 * Math.PI * j) / columns;
    const out = Math.cos(angle);
    const up = Math.sin(angle);
    point[0] = c.x + shape.tube * out * c.nx;
    point[1] = c.y + shape.tube * out * c.ny;
    point[2] = shape.tube * up;
    normal[0] = out * c.nx;
    normal[1] = out * c.ny;
    normal[2] = up;
    uv[0] = (c.at / around) * tiles;
    uv[1] = j / columns;
  });
}

/** Texture coordinates of a box by meters, u along its longest side: grain and brushing run along a beam. */
function layAlong(geometry: BufferGeometry, size: readonly number[]): void {
  const position = geometry.getAttribute("position");
  const normal = geometry.getAttribute("normal");
  const uv = geometry.getAttribute("uv");
  const long = size.indexOf(Math.max(...size));
  const [a, b] = [0, 1, 2].filter((axis) => axis !== long);
  for (let index = 0; index < position.count; index++) {
    const at = [position.getX(index), position.getY(index), position.getZ(index)];
    const facing = [normal.getX(index), normal.getY(index), normal.getZ(index)].map(Math.abs);
    const end = facing[long] > facing[a] && facing[long] > facing[b];
    const across = end || facing[a] < facing[b] ? at[a] : at[b] + 0.37 * size[a];
    uv.setXY(index, end ? at[b] / 0.9 : at[long] / 0.9, across / 0.22);
  }
}

/** Edges sharper than this are seen as edges, others as a smooth surface, rad. */
const creaseAngle = 0.6;

/** Faces as they are given; texture coordinates by meters on the side that a face looks to. */
function makeMesh(mesh: MeshData): BufferGeometry {
  const indexed = new BufferGeometry();
  indexed.setAttribute("position", new BufferAttribute(mesh.positions, 3));
  indexed.setIndex(new BufferAttribute(mesh.triangles, 1));
  const geometry = toCreasedNormals(indexed, creaseAngle);
  indexed.dispose();
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

/** Geometry of a shape in its own frame; the caller disposes of it. */
export function makeGeometry(shape: Shape, detail: Detail): BufferGeometry {
  switch (shape.type) {
    case "cylinder":
    case "capsule":
      return makeRod(shape, detail);
    case "torus":
      return makeLink(shape, detail);
    case "sphere":
      return detail === "fine" ? new SphereGeometry(shape.radius, 40, 24) : new SphereGeometry(shape.radius, 16, 10);
    case "box": {
      const [x, y, z] = shape.size;
      const geometry = new RoundedBoxGeometry(x, y, z, detail === "fine" ? 3 : 1, Math.min(x, y, z) * 0.06);
      layAlong(geometry, shape.size);
      return geometry;
    }
    case "mesh":
      return shape.mesh === null ? new BufferGeometry() : makeMesh(shape.mesh);
  }
}

/** A coil spring along x with straight ends: wire of radius `tube` wound at `radius`, `length` from end to end, m. */
export function makeCoil(radius: number, tube: number, length: number): BufferGeometry {
  const turns = Math.max(4, Math.min(40, Math.round(length / (5 * tube))));
  const straight = 0.12;
  const rows = 14 * turns;
  const center = (t: number): [number, number, number] => {
    const wound = Math.min(1, Math.max(0, (t - straight) / (1 - 2 * straight)));
    // The wire comes in from the axis and leaves to it.
    const grown = Math.min(1, 6 * Math.min(t, 1 - t));
    const angle = 2 * Math.PI * turns * wound;
    return [(t - 0.5) * length, grown * radius * Math.cos(angle), grown * radius * Math.sin(angle)];
  };
  return sweep(rows, 6, (i, j, point, normal, uv) => {
    const t = i / rows;
    const here = center(t);
    const ahead = center(Math.min(1, t + 0.25 / rows));
    const behind = center(Math.max(0, t - 0.25 / rows));
    const tangent = [ahead[0] - behind[0], ahead[1] - behind[1], ahead[2] - behind[2]];
    const size = Math.hypot(tangent[0], tangent[1], tangent[2]);
    // Away from the axis, made square to the wire.
    const away = Math.hypot(here[1], here[2]) > 1e-9 * radius ? [0, here[1], here[2]] : [0, 1, 0];
    const part = (away[1] * tangent[1] + away[2] * tangent[2]) / (size * size);
    const u = [away[0] - part * tangent[0], away[1] - part * tangent[1], away[2] - part * tangent[2]];
    const us = Math.hypot(u[0], u[1], u[2]);
    const v = [
      (tangent[1] * u[2] - tangent[2] * u[1]) / (size * us),
      (tangent[2] * u[0] - tangent[0] * u[2]) / (size * us),
      (tangent[0] * u[1] - tangent[1] * u[0]) / (size * us),
    ];
    const angle = (-2 * Math.PI * j) / 6;
    for (let axis = 0; axis < 3; axis++) {
      normal[axis] = (Math.cos(angle) * u[axis]) / us + Math.sin(angle) * v[axis];
      point[axis] = here[axis] + tube * normal[axis];
    }
    uv[0] = t * turns;
    uv[1] = j / 6;
  });
}
