// SPDX-License-Identifier: Apache-2.0
// Thousands of particles of emitters. Each pose frame lists all of them, without ids, so they are drawn at their places
// in the newest frame: glowing points, two triangles each, without shadows or picking.

import {
  Color, CustomBlending, DynamicDrawUsage, Group, InstancedBufferAttribute, InstancedMesh, OneFactor, OneMinusSrcAlphaFactor,
  PlaneGeometry, ShaderMaterial,
} from "three";
import type { ParticleSetEntity, PoseSparkColumns } from "../../protocol/generated.ts";
import type { Points } from "../points.ts";
import { EntityRecords } from "./entity.ts";

/** Radius of sparks without one, m. */
const usualRadius = 0.01;
/** Largest number of instances reserved for a set in advance: a world may have many sets and few sparks. */
const mostReserved = 4096;
/** Linear values of the 256 values of a channel. */
const linear = Float32Array.from({ length: 256 }, (_, value) => new Color().setHex(value).b);

/**
 * A bright ball with a halo. At night the ball covers the background, and the halo only adds light. By day light that is added to a bright
 * sky would be a rim around the ball, so the halo covers, too, and only hot sparks have a white middle. Pictures are mixed in the screen's
 * colors: edges cover as much as is seen.
 */
function makeGlow(): ShaderMaterial {
  return new ShaderMaterial({
    transparent: true, depthWrite: false, fog: false, toneMapped: false,
    uniforms: { day: { value: 1 } },
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
      uniform float day;
      varying vec2 vPlace;
      varying vec3 vColor;
      vec3 onScreen(vec3 light) { return linearToOutputTexel(vec4(light, 1.0)).rgb; }
      void main() {
        float radius = length(vPlace);
        float ball = pow(1.0 - smoothstep(0.2, 1.1, radius), 1.0 + day);
        float halo = pow(max(1.0 - radius / 3.0, 0.0), 2.5);
        float hot = 1.0 - smoothstep(0.0, 1.0, radius);
        vec3 color = mix(1.15 * vColor, vec3(1.0, 0.97, 0.88), 0.75 * hot * hot * vColor.r * mix(1.0, vColor.g, day));
        float cover = onScreen(vec3(ball)).r, veil = 0.6 * day * halo * (1.0 - cover);
        gl_FragColor = vec4(onScreen(ball * color + 0.32 * (1.0 - day) * halo * vColor) + veil * onScreen(vColor), cover + veil);
      }`,
  });
}

export class ParticleSetView extends EntityRecords<ParticleSetEntity> {
  readonly root = new Group();

  private readonly mesh_ = new InstancedMesh(new PlaneGeometry(2, 2), makeGlow(), 0);
  private colors_ = new InstancedBufferAttribute(new Float32Array(0), 3);

  constructor() {
    super();
    this.mesh_.frustumCulled = false;
    this.mesh_.count = 0;
    this.mesh_.renderOrder = 1;
    this.mesh_.visible = false;
    this.root.add(this.mesh_);
    this.reserve_(64);
  }

  setTheme(theme: "light" | "dark"): void {
    this.mesh_.material.uniforms["day"].value = theme === "light" ? 1 : 0;
  }

  /** Number of shown sparks. */
  get count(): number {
    return this.mesh_.count;
  }

  override create(entity: ParticleSetEntity): void {
    super.create(entity);
    this.reserve_(Math.min(entity.capacity, mostReserved));
  }

  /** Adds the places of sparks, only some of them if there are many. */
  addPoints(points: Points): void {
    const { array } = this.mesh_.instanceMatrix;
    const every = Math.ceil(this.count / 500);
    for (let index = 0; index < this.count; index += every) points.add(array[16 * index + 12], array[16 * index + 13], array[16 * index + 14]);
  }

  /** Replaces the shown sparks. */
  takeSparks(sparks: PoseSparkColumns): void {
    if (sparks.count === 0 && this.count === 0) return;
    this.reserve_(sparks.count);
    const { mesh_: mesh } = this;
    const { position, radius, color } = sparks;
    const matrices = mesh.instanceMatrix.array;
    const colors = this.colors_.array;
    // Written here, not by the functions of three.js: there are thousands, in each frame.
    for (let index = 0, at = 0; index < sparks.count; index++, at += 16) {
      matrices[at] = matrices[at + 5] = matrices[at + 10] = radius[index] > 0 ? radius[index] : usualRadius;
      matrices[at + 12] = position[3 * index];
      matrices[at + 13] = position[3 * index + 1];
      matrices[at + 14] = position[3 * index + 2];
      matrices[at + 15] = 1;
      const hex = color[index];
      colors[3 * index] = linear[(hex >> 16) & 255];
      colors[3 * index + 1] = linear[(hex >> 8) & 255];
      colors[3 * index + 2] = linear[hex & 255];
    }
    mesh.count = sparks.count;
    mesh.visible = sparks.count > 0;
    mesh.instanceMatrix.needsUpdate = true;
    this.colors_.needsUpdate = true;
  }

  /** Grows in place, with the same mesh. */
  private reserve_(count: number): void {
    if (count <= this.mesh_.instanceMatrix.count) return;
    const capacity = Math.max(count, 2 * this.mesh_.instanceMatrix.count);
    const matrices = new InstancedBufferAttribute(new Float32Array(16 * capacity), 16);
    matrices.setUsage(DynamicDrawUsage);
    matrices.array.set(this.mesh_.instanceMatrix.array);
    const colors = new InstancedBufferAttribute(new Float32Array(3 * capacity), 3);
    colors.setUsage(DynamicDrawUsage);
    colors.array.set(this.colors_.array);
    this.mesh_.instanceMatrix = matrices;
    this.mesh_.instanceColor = this.colors_ = colors;
  }
}
