// SPDX-License-Identifier: Apache-2.0
// Particles of emitters, by the thousand. Each pose frame lists all of them, without ids, so they are drawn where the newest frame
// has them: glowing points, two triangles each, without shadows, and not to be picked.

import {
  Color, CustomBlending, DynamicDrawUsage, Group, InstancedBufferAttribute, InstancedMesh, Matrix4, OneFactor, OneMinusSrcAlphaFactor,
  PlaneGeometry, ShaderMaterial,
} from "three";
import type { ParticleSetEntity, PoseSparkColumns } from "../../protocol/generated.ts";
import type { Points } from "../points.ts";
import { EntityRecords } from "./entity.ts";

/** Radius of sparks without one, m. */
const usualRadius = 0.01;
/** At most so many instances are reserved for one set in advance: a world may have many sets and few sparks. */
const mostReserved = 4096;

/** A bright ball with a halo around it: what is in the middle covers, the halo only adds light. */
function makeGlow(): ShaderMaterial {
  return new ShaderMaterial({
    transparent: true, depthWrite: false, fog: false, toneMapped: false,
    uniforms: { glow: { value: 0.3 } },
    blending: CustomBlending, blendSrc: OneFactor, blendDst: OneMinusSrcAlphaFactor,
    vertexShader: `
      varying vec2 vPlace;
      varying vec3 vColor;
      void main() {
        vPlace = 3.0 * position.xy;
        vColor = instanceColor;
        vec4 center = modelViewMatrix * instanceMatrix * vec4(0.0, 0.0, 0.0, 1.0);
        center.xy += vPlace * instanceMatrix[0][0];
        gl_Position = projectionMatrix * center;
      }`,
    fragmentShader: `
      uniform float glow;
      varying vec2 vPlace;
      varying vec3 vColor;
      void main() {
        float radius = length(vPlace);
        float ball = 1.0 - smoothstep(0.85, 1.05, radius);
        float halo = glow * pow(max(1.0 - radius / 3.0, 0.0), 2.5);
        float hot = max(1.0 - radius, 0.0);
        vec3 shown = ball * mix(1.15 * vColor, vec3(1.0, 0.97, 0.88), 0.75 * hot * hot * vColor.r) + halo * vColor;
        gl_FragColor = vec4(shown, 0.92 * ball);
        #include <colorspace_fragment>
      }`,
  });
}

export class ParticleSetView extends EntityRecords<ParticleSetEntity> {
  readonly root = new Group();

  private readonly mesh_ = new InstancedMesh(new PlaneGeometry(2, 2), makeGlow(), 0);
  private readonly matrix_ = new Matrix4();
  private readonly color_ = new Color();

  constructor() {
    super();
    this.mesh_.frustumCulled = false;
    this.mesh_.count = 0;
    this.mesh_.renderOrder = 1;
    this.mesh_.visible = false;
    this.root.add(this.mesh_);
    this.reserve_(64);
  }

  /** A bright ground shows less of a halo. */
  setTheme(theme: "light" | "dark"): void {
    this.mesh_.material.uniforms["glow"].value = theme === "dark" ? 0.32 : 0.07;
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
