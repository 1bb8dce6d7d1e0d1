// SPDX-License-Identifier: Apache-2.0
// One instanced mesh with a variable number of members. It grows in place: the cost of adding or removing a member does
// not depend on the number of others.

import { InstancedBufferAttribute, InstancedMesh, type BufferGeometry, type Color, type MeshStandardMaterial, type Object3D } from "three";
import { casterLayer } from "./contact_shadow.ts";

export class InstancePool {
  readonly mesh: InstancedMesh<BufferGeometry, MeshStandardMaterial>;
  /** Slots of the members, in the order of their instances. */
  members = new Uint32Array(0);
  count = 0;
  /** Number of instances of one member. */
  readonly pieces: number;

  private capacity_: number;
  /** Colors plus 1, 0: none; made for the first color. */
  private hues_: InstancedBufferAttribute | null = null;
  /** The used part of the arrays, for the upload. */
  private readonly matrixRange_ = { start: 0, count: 0 };
  private readonly tintRange_ = { start: 0, count: 0 };

  /** Capacity for `capacity` members of `pieces` instances each. It owns the geometry and adds a `tint` for each
   * instance. */
  constructor(geometry: BufferGeometry, material: MeshStandardMaterial, capacity: number, pieces = 1) {
    this.pieces = pieces;
    this.capacity_ = Math.max(1, capacity);
    this.members = new Uint32Array(this.capacity_);
    this.mesh = new InstancedMesh(geometry, material, this.capacity_ * pieces);
    this.mesh.count = 0;
    // Bodies move each frame: updating a bounding sphere would cost more than culling saves.
    this.mesh.frustumCulled = false;
    this.mesh.castShadow = this.mesh.receiveShadow = true;
    this.mesh.layers.enable(casterLayer);
    geometry.setAttribute("tint", new InstancedBufferAttribute(new Float32Array(4 * this.capacity_ * pieces), 4));
  }

  get matrices(): Float32Array {
    return this.mesh.instanceMatrix.array as Float32Array;
  }

  /** rgb and amount of each instance. */
  get tints(): Float32Array {
    return this.mesh.geometry.getAttribute("tint").array as Float32Array;
  }

  /** Adds a member and returns its index; its instances are invisible until their matrices are written. */
  add(slot: number): number {
    if (this.count === this.capacity_) this.grow_();
    const index = this.count++;
    this.members[index] = slot;
    this.mesh.count = this.count * this.pieces;
    this.setHue(index, null);
    this.matrices.fill(0, 16 * index * this.pieces, 16 * (index + 1) * this.pieces);
    return index;
  }

  /** Removes a member; the last one takes its index. Returns the slot of the latter, or -1 if none moved. */
  remove(index: number): number {
    const last = --this.count;
    this.mesh.count = this.count * this.pieces;
    if (index === last) return -1;
    const { pieces, matrices } = this;
    this.members[index] = this.members[last];
    this.hues_?.array.copyWithin(3 * index * pieces, 3 * last * pieces, 3 * (last + 1) * pieces);
    if (this.hues_ !== null) this.hues_.needsUpdate = true;
    matrices.copyWithin(16 * index * pieces, 16 * last * pieces, 16 * (last + 1) * pieces);
    return this.members[index];
  }

  /** Draws a member in a color; null: in that of its material. */
  setHue(index: number, color: Color | null): void {
    if (color === null && this.hues_ === null) return;
    this.hues_ ??= this.setHues_(new InstancedBufferAttribute(new Float32Array(3 * this.capacity_ * this.pieces), 3));
    for (let piece = 0; piece < this.pieces; piece++) {
      const [r, g, b] = color === null ? [0, 0, 0] : [color.r + 1, color.g + 1, color.b + 1];
      this.hues_.setXYZ(index * this.pieces + piece, r, g, b);
    }
    this.hues_.needsUpdate = true;
  }

  /** Draws all members in the color of the material. */
  clearHues(): void {
    if (this.hues_ === null) return;
    (this.hues_.array as Float32Array).fill(0);
    this.hues_.needsUpdate = true;
  }

  /** Call it after the matrices were written. */
  upload(): void {
    uploadRange(this.mesh.instanceMatrix, this.matrixRange_, 16 * this.count * this.pieces);
  }

  /** Call it after the tints were written: most pools have none. */
  uploadTints(): void {
    uploadRange(this.mesh.geometry.getAttribute("tint") as InstancedBufferAttribute, this.tintRange_, 4 * this.count * this.pieces);
  }

  /** Replaces the geometry and disposes of the old one. */
  setGeometry(geometry: BufferGeometry): void {
    const before = this.mesh.geometry;
    geometry.setAttribute("tint", before.getAttribute("tint"));
    if (this.hues_ !== null) geometry.setAttribute("hue", this.hues_);
    this.mesh.geometry = geometry;
    before.dispose();
  }

  /** Disposes of the mesh. */
  dispose(): void {
    this.mesh.removeFromParent();
    this.mesh.geometry.dispose();
    this.mesh.dispose();
  }

  addTo(root: Object3D): this {
    root.add(this.mesh);
    return this;
  }

  private grow_(): void {
    this.capacity_ *= 2;
    const members = new Uint32Array(this.capacity_);
    members.set(this.members);
    this.members = members;
    const instances = this.capacity_ * this.pieces;
    this.mesh.instanceMatrix = larger(this.matrices, 16, instances);
    this.mesh.geometry.setAttribute("tint", larger(this.tints, 4, instances));
    if (this.hues_ !== null) this.hues_ = this.setHues_(larger(this.hues_.array as Float32Array, 3, instances));
  }

  private setHues_(hues: InstancedBufferAttribute): InstancedBufferAttribute {
    this.mesh.geometry.setAttribute("hue", hues);
    return hues;
  }
}

/** The range is one reused object; `addUpdateRange` would allocate a new one each time. */
function uploadRange(attribute: InstancedBufferAttribute, range: { start: number; count: number }, count: number): void {
  range.count = count;
  if (attribute.updateRanges.length === 0) attribute.updateRanges.push(range);
  attribute.needsUpdate = true;
}

function larger(array: Float32Array, itemSize: number, count: number): InstancedBufferAttribute {
  const grown = new Float32Array(itemSize * count);
  grown.set(array);
  return new InstancedBufferAttribute(grown, itemSize);
}
