// SPDX-License-Identifier: Apache-2.0
// Round strokes from point to point, drawn as quads that face the viewer and are shaded as tubes, cones and balls: two triangles
// each, one call for thousands. A stroke of length 0 is a ball; one of radius 0 has a constant thickness on the screen.

import {
  Color, DoubleSide, DynamicDrawUsage, GLSL3, InstancedBufferAttribute, InstancedBufferGeometry, Float32BufferAttribute, Mesh, ShaderMaterial,
} from "three";

const vertexShader = /* glsl */ `
in vec3 from;
in vec3 to;
in vec2 radii;
in vec3 color;
out vec2 at;
out vec3 place;
flat out vec2 radius;
flat out float span;
flat out float thin;
flat out vec3 shade;
flat out vec3 along;
flat out vec3 across;
void main() {
  vec3 a = (modelViewMatrix * vec4(from, 1.0)).xyz;
  vec3 b = (modelViewMatrix * vec4(to, 1.0)).xyz;
  thin = radii.x == 0.0 && radii.y == 0.0 ? 1.0 : 0.0;
  // Behind the viewer an angle is undefined: a stroke that passes there keeps the thickness of its nearer end.
  radius = thin > 0.5 ? vec2(0.0011) * max(vec2(-a.z, -b.z), vec2(0.02)) : radii;
  vec3 way = b - a;
  span = length(way);
  along = span > 1e-9 ? way / span : vec3(1.0, 0.0, 0.0);
  vec3 toViewer = projectionMatrix[3][3] == 1.0 ? vec3(0.0, 0.0, 1.0) : -normalize(0.5 * (a + b));
  across = cross(toViewer, along);
  float sine = length(across);
  // Seen along its length it is a disc.
  if (span <= 1e-9 || sine < 1e-4) { along = normalize(cross(vec3(0.0, 1.0, 0.0), toViewer)); across = cross(toViewer, along); sine = 1.0; }
  across /= sine;
  float most = max(radius.x, radius.y);
  at = vec2(position.x < 0.5 ? -most : span + most, (2.0 * position.y - 1.0) * most);
  place = a + along * at.x + across * at.y;
  shade = color;
  bool isHidden = radii.x < 0.0;
#ifdef SHADOW
  // A stroke of constant thickness on the screen has none in the world, so it has no shadow.
  isHidden = isHidden || thin > 0.5;
#endif
  gl_Position = isHidden ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * vec4(place, 1.0);
}`;

const fragmentShader = /* glsl */ `
in vec2 at;
in vec3 place;
flat in vec2 radius;
flat in float span;
flat in float thin;
flat in vec3 shade;
flat in vec3 along;
flat in vec3 across;
uniform mat4 projectionMatrix;
out vec4 pixel;
void main() {
  float t = span > 1e-9 ? clamp(at.x / span, 0.0, 1.0) : 0.0;
  float r = mix(radius.x, radius.y, t);
  vec2 off = vec2(at.x - t * span, at.y);
  float away = r > 0.0 ? length(off) / r : 2.0;
  if (away > 1.0) discard;
  float toward = sqrt(1.0 - away * away);
  vec3 front = normalize(cross(along, across));
  bool fromBehind = projectionMatrix[3][3] == 1.0 ? front.z < 0.0 : dot(front, -place) < 0.0;
  if (fromBehind) front = -front;
  vec3 normal = normalize((along * off.x + across * off.y) / r + front * toward);
  vec3 light = normalize((viewMatrix * vec4(0.35, 0.85, 0.4, 0.0)).xyz);
  vec3 up = (viewMatrix * vec4(0.0, 1.0, 0.0, 0.0)).xyz;
  float lit = 0.45 + 0.2 * (0.5 + 0.5 * dot(normal, up)) + 0.45 * max(dot(normal, light), 0.0);
  pixel = vec4(shade * mix(lit, 1.0, thin), 1.0);
  vec4 deep = projectionMatrix * vec4(place + front * (toward * r), 1.0);
  gl_FragDepth = clamp(0.5 + 0.5 * deep.z / deep.w, 0.0, 1.0);
  #include <colorspace_fragment>
}`;

/** No color of the script: the page chooses. */
const usualColor = 0x2f9d92;
export const noColor = 0xffffffff;

/** One program for all strokes, and one for their shadows. */
const materials = new Map<string, ShaderMaterial>();

function strokeMaterial(purpose: "PICTURE" | "SHADOW"): ShaderMaterial {
  let material = materials.get(purpose);
  if (material === undefined) {
    material = new ShaderMaterial({
      vertexShader, fragmentShader: fragmentShader.replace("#include <colorspace_fragment>", "pixel = linearToOutputTexel(pixel);"),
      glslVersion: GLSL3, defines: { [purpose]: "" },
      // Shadows are made of the backs of things unless told, and a quad that faces the light has none.
      shadowSide: DoubleSide,
    });
    materials.set(purpose, material);
  }
  return material;
}

const corners = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0];

export class Strokes {
  readonly mesh: Mesh<InstancedBufferGeometry, ShaderMaterial>;

  private readonly geometry_ = new InstancedBufferGeometry();
  private from_ = attribute(3, 0);
  private to_ = attribute(3, 0);
  private radii_ = attribute(2, 0);
  private colors_ = attribute(3, 0);
  private capacity_ = 0;
  private readonly color_ = new Color();

  constructor() {
    this.geometry_.setAttribute("position", new Float32BufferAttribute(corners, 3));
    this.geometry_.setIndex([0, 1, 2, 0, 2, 3]);
    this.geometry_.instanceCount = 0;
    this.mesh = new Mesh(this.geometry_, strokeMaterial("PICTURE"));
    this.mesh.customDepthMaterial = strokeMaterial("SHADOW");
    this.mesh.castShadow = true;
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
    this.reserve(16);
  }

  get count(): number {
    return this.geometry_.instanceCount;
  }

  /** Grows to this many strokes and keeps written ones. */
  reserve(count: number): void {
    if (count <= this.capacity_) return;
    this.capacity_ = Math.max(count, 2 * this.capacity_);
    // Otherwise the renderer keeps drawing the number of the first capacity.
    this.geometry_.dispose();
    this.from_ = grown(this.from_, this.capacity_);
    this.to_ = grown(this.to_, this.capacity_);
    this.radii_ = grown(this.radii_, this.capacity_);
    this.colors_ = grown(this.colors_, this.capacity_);
    this.geometry_.setAttribute("from", this.from_);
    this.geometry_.setAttribute("to", this.to_);
    this.geometry_.setAttribute("radii", this.radii_);
    this.geometry_.setAttribute("color", this.colors_);
  }

  /** Removes all strokes. */
  clear(): void {
    this.geometry_.instanceCount = 0;
  }

  /** From one place (m) to another; radius at both ends, m; 0 both: thin. `color`: 0xRRGGBB or `noColor`. */
  add(
    fx: number, fy: number, fz: number, tx: number, ty: number, tz: number, fromRadius: number, toRadius: number, color: number,
  ): void {
    const index = this.geometry_.instanceCount++;
    this.reserve(index + 1);
    this.from_.setXYZ(index, fx, fy, fz);
    this.to_.setXYZ(index, tx, ty, tz);
    this.radii_.setXY(index, fromRadius, toRadius);
    const { r, g, b } = this.color_.setHex(color === noColor ? usualColor : color);
    this.colors_.setXYZ(index, r, g, b);
  }

  /** Call it after strokes were added. */
  upload(): void {
    this.mesh.visible = this.count > 0;
    for (const each of [this.from_, this.to_, this.radii_, this.colors_]) each.needsUpdate = true;
  }

  dispose(): void {
    this.mesh.removeFromParent();
    this.geometry_.dispose();
  }
}

function attribute(size: number, count: number): InstancedBufferAttribute {
  return new InstancedBufferAttribute(new Float32Array(size * count), size).setUsage(DynamicDrawUsage);
}

function grown(before: InstancedBufferAttribute, count: number): InstancedBufferAttribute {
  const after = attribute(before.itemSize, count);
  (after.array as Float32Array).set(before.array as Float32Array);
  return after;
}
