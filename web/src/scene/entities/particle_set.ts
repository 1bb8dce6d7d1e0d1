// SPDX-License-Identifier: Apache-2.0
// Particles of emitters, by the thousand. Each pose frame lists all of them, without ids, so they are drawn where the newest frame
// has them: one instanced ball, without shadows, and not to be picked.

import { Color, DynamicDrawUsage, Group, IcosahedronGeometry, InstancedBufferAttribute, InstancedMesh, Matrix4, MeshStandardMaterial } from "three";
import type { ParticleSetEntity, PoseSparkColumns } from "../../protocol/generated.ts";
import type { Points } from "../points.ts";
import { EntityRecords } from "./entity.ts";

/** Radius of sparks without one, m. */
const usualRadius = 0.01;
/** At most so many instances are reserved for one set in advance: a world may have many sets and few sparks. */
const mostReserved = 4096;

export class ParticleSetView extends EntityRecords<ParticleSetEntity> {
  readonly root = new Group();

  private readonly mesh_ = new InstancedMesh(new IcosahedronGeometry(1, 2), new MeshStandardMaterial({ roughness: 0.5 }), 0);
  private readonly matrix_ = new Matrix4();
  private readonly color_ = new Color();

  constructor() {
    super();
    this.mesh_.frustumCulled = false;
    this.mesh_.count = 0;
    this.mesh_.visible = false;
    this.root.add(this.mesh_);
    this.reserve_(64);
  }

  /** How many sparks are shown. */
  get count(): number {
    return this.mesh_.count;
  }

  override create(entity: ParticleSetEntity): void {
    super.create(entity);
    this.reserve_(Math.min(entity.capacity, mostReserved));
  }

  /** Adds the places of sparks, of some of them where there are many. */
  addPoints(points: Points): void {
    const { array } = this.mesh_.instanceMatrix;
    const every = Math.ceil(this.count / 500);
    for (let index = 0; index < this.count; index += every) points.add(array[16 * index + 12], array[16 * index + 13], array[16 * index + 14]);
  }

  /** Shows these in place of those before. */
  takeSparks(sparks: PoseSparkColumns): void {
    if (sparks.count === 0 && this.count === 0) return;
    this.reserve_(sparks.count);
    const { mesh_: mesh, matrix_: matrix, color_: color } = this;
    const { position } = sparks;
    for (let index = 0; index < sparks.count; index++) {
      const radius = sparks.radius[index] > 0 ? sparks.radius[index] : usualRadius;
      matrix.makeScale(radius, radius, radius);
      matrix.setPosition(position[3 * index], position[3 * index + 1], position[3 * index + 2]);
      mesh.setMatrixAt(index, matrix);
      mesh.setColorAt(index, color.setHex(sparks.color[index]));
    }
    mesh.count = sparks.count;
    mesh.visible = sparks.count > 0;
    mesh.instanceMatrix.needsUpdate = true;
    if (mesh.instanceColor !== null) mesh.instanceColor.needsUpdate = true;
  }

  /** Makes room in place: the mesh is never made anew. */
  private reserve_(count: number): void {
    if (count <= this.mesh_.instanceMatrix.count) return;
    const capacity = Math.max(count, 2 * this.mesh_.instanceMatrix.count);
    const matrices = new InstancedBufferAttribute(new Float32Array(16 * capacity), 16);
    matrices.setUsage(DynamicDrawUsage);
    matrices.array.set(this.mesh_.instanceMatrix.array);
    const colors = new InstancedBufferAttribute(new Float32Array(3 * capacity), 3);
    if (this.mesh_.instanceColor !== null) colors.array.set(this.mesh_.instanceColor.array);
    this.mesh_.instanceMatrix = matrices;
    this.mesh_.instanceColor = colors;
  }
}
