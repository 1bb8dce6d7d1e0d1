// SPDX-License-Identifier: Apache-2.0
// The ray of a hand and the dot at its end. A ray fades while a near grab is possible.

import { BufferAttribute, Color, CylinderGeometry, Group, Mesh, MeshBasicMaterial, SphereGeometry, Vector3, type Matrix4 } from "three";
import { palette } from "../scene/materials.ts";
import type { Input } from "./input.ts";

/** Length of a ray without a hit, m. */
const idleLength = 0.9;
const startAhead = 0.035;
const fadeSeconds = 0.08;
const white = new Color("#ffffff");

/** Along -z from 0 to -1, fading towards its end. */
function makeRayGeometry(): CylinderGeometry {
  const geometry = new CylinderGeometry(0.0011, 0.002, 1, 8, 1, true);
  geometry.translate(0, 0.5, 0);
  geometry.rotateX(-Math.PI / 2);
  const position = geometry.getAttribute("position");
  const colors = new Float32Array(4 * position.count);
  for (let index = 0; index < position.count; index++) {
    colors.set([1, 1, 1, position.getZ(index) < -0.5 ? 0.2 : 1], 4 * index);
  }
  geometry.setAttribute("color", new BufferAttribute(colors, 4));
  return geometry;
}

const rayGeometry = makeRayGeometry();
const dotGeometry = new SphereGeometry(1, 16, 10);

export class RayView {
  readonly root = new Group();

  private readonly ray_: Mesh<CylinderGeometry, MeshBasicMaterial>;
  private readonly dot_: Mesh<SphereGeometry, MeshBasicMaterial>;
  private shown_ = 0;
  private readonly at_ = new Vector3();

  constructor() {
    this.ray_ = new Mesh(rayGeometry, new MeshBasicMaterial({
      transparent: true, vertexColors: true, toneMapped: false, fog: false, depthWrite: false,
    }));
    this.ray_.matrixAutoUpdate = false;
    this.ray_.renderOrder = 6;
    this.dot_ = new Mesh(dotGeometry, new MeshBasicMaterial({ toneMapped: false, fog: false }));
    this.dot_.renderOrder = 7;
    for (const mesh of [this.ray_, this.dot_]) mesh.frustumCulled = false;
    this.root.add(this.ray_, this.dot_);
  }

  /** `eye` in the world; `wanted`: false while an arc takes the ray's place; `scale`: meters of the world in one of the user's. */
  update(input: Input, eye: Vector3, wanted: boolean, scale: number, seconds: number): void {
    const { pointer } = input;
    const grab = pointer.grab;
    const near = grab !== null ? grab.near : pointer.near && pointer.hovered >= 0;
    const show = wanted && input.hasRay && !near && !input.touching;
    this.shown_ = Math.min(Math.max(this.shown_ + (show ? seconds : -seconds) / fadeSeconds, 0), 1);
    const length = this.lengthOf_(input);
    const meets = length > 0;
    // In the user's meters, as the ray's own frame has it.
    const along = Math.max((meets ? length / scale : idleLength) - startAhead, 0.01);
    this.ray_.visible = this.shown_ > 0;
    this.ray_.material.opacity = this.shown_ * (meets ? 1 : 0.55);
    this.ray_.material.color.copy(grab !== null ? palette.held : palette.selected);
    placeRay(this.ray_.matrix, input.ray, along);
    this.dot_.visible = wanted && input.hasRay && meets && grab === null && !input.touching;
    if (!this.dot_.visible) return;
    this.at_.fromArray(pointer.origin);
    this.dot_.position.fromArray(pointer.direction).multiplyScalar(length).add(this.at_);
    if (near) this.dot_.position.fromArray(pointer.hit.point);
    this.dot_.scale.setScalar((input.board === null ? 0.0042 : 0.0065) * Math.max(this.dot_.position.distanceTo(eye), 0.25 * scale));
    this.dot_.material.color.copy(input.board !== null ? palette.selected : white);
  }

  /** Distance along the ray to its target, m; 0: no target. */
  private lengthOf_(input: Input): number {
    const { pointer } = input;
    if (input.board !== null) return input.spot.distance;
    if (pointer.grab !== null) return this.at_.fromArray(pointer.grab.target).distanceTo(reuse.fromArray(pointer.origin));
    return pointer.hovered >= 0 ? pointer.hit.distance : 0;
  }
}

const reuse = new Vector3();

function placeRay(out: Matrix4, ray: Matrix4, along: number): void {
  out.copy(ray);
  const e = out.elements;
  for (let axis = 0; axis < 3; axis++) {
    e[12 + axis] -= startAhead * e[8 + axis];
    e[8 + axis] *= along;
  }
}
