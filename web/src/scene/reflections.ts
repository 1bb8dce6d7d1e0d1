// SPDX-License-Identifier: Apache-2.0
// The sky, and the picture of sky, ground and soft boxes that surfaces mirror. It is drawn again when colors or lights of the stage change.

import {
  BackSide, Color, Mesh, MeshBasicMaterial, PlaneGeometry, PMREMGenerator, Scene, ShaderMaterial, SphereGeometry, type WebGLRenderTarget,
  type WebGLRenderer,
} from "three";

/** As seen on the screen, not radiances. */
export interface SkyColors {
  readonly horizon: { readonly value: Color };
  readonly zenith: { readonly value: Color };
}

/** Zero slope at the horizon, into which the ground fades: otherwise a line would be seen there. */
const skyOf = `
uniform vec3 horizon, zenith;
varying vec3 vDirection;
vec3 skyOf(float height) {
  return mix(horizon, zenith, smoothstep(0.0, 0.75, height));
}`;

/** Sky by the height of each pixel's direction; noise of half a step of the screen's colors hides their bands. */
export function makeSky(colors: SkyColors): ShaderMaterial {
  return new ShaderMaterial({
    side: BackSide, depthWrite: false, depthTest: false, fog: false, toneMapped: false,
    uniforms: { ...colors },
    vertexShader: `
      varying vec3 vDirection;
      void main() {
        vDirection = position;
        gl_Position = (projectionMatrix * vec4(mat3(modelViewMatrix) * position, 1.0)).xyww;
      }`,
    fragmentShader: `
      ${skyOf}
      void main() {
        gl_FragColor = vec4(skyOf(normalize(vDirection).y), 1.0);
        #include <colorspace_fragment>
        gl_FragColor.rgb += (fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5) / 255.0;
      }`,
  });
}

/** Radiances of sky and ground. The sky's is the one that tone mapping (ACES, as in three.js) turns into its color. */
function makeSurroundings(colors: SkyColors, ground: { value: Color }, exposure: number): ShaderMaterial {
  return new ShaderMaterial({
    side: BackSide, depthWrite: false, toneMapped: false,
    uniforms: { ...colors, ground, exposure: { value: exposure } },
    vertexShader: `
      varying vec3 vDirection;
      void main() {
        vDirection = position;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: `
      uniform vec3 ground;
      uniform float exposure;
      ${skyOf}
      const mat3 toFilm = mat3(0.59719, 0.076, 0.0284, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
      const mat3 fromFilm = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
      void main() {
        float height = normalize(vDirection).y;
        // Radiances of nearly white are too great to be mirrored by things beside it.
        vec3 film = max(inverse(fromFilm) * min(skyOf(height), 0.9), 0.0);
        vec3 a = 1.0 - 0.983729 * film, b = 0.4329510 * film - 0.0245786, c = 0.238081 * film + 0.000090537;
        vec3 sky = inverse(toFilm) * ((b + sqrt(b * b + 4.0 * a * c)) / (2.0 * a)) * 0.6 / exposure;
        // Things need contrast: the studio is dark overhead, and below a thing is its shadow.
        float open = mix(1.0, 0.15, smoothstep(0.14, 0.36, height)) * mix(1.0, 0.15, smoothstep(-0.2, -0.6, height));
        sky = max(sky, 0.0);
        if (ground.r >= 0.0) sky = mix(sky, ground, smoothstep(0.0, -0.06, height));
        gl_FragColor = vec4(open * sky, 1.0);
      }`,
  });
}

interface SoftBox {
  readonly size: readonly [number, number];
  readonly strength: number;
  readonly tint: string;
  readonly at: readonly [number, number, number];
}

const softBoxes: readonly SoftBox[] = [
  { size: [3.4, 2.4], strength: 20, tint: "#fff1dc", at: [3.2, 4.4, 3.4] },
  { size: [1.4, 4.6], strength: 7, tint: "#dfeaff", at: [-5.4, 1.8, 2.2] },
  { size: [5.0, 0.8], strength: 10, tint: "#ffffff", at: [0, 4.6, -3.4] },
  { size: [0.6, 4.2], strength: 6, tint: "#fff6e8", at: [4.6, 1.6, -4.2] },
  // In front of the scene: flat faces towards the user mirror these, with a gap between them.
  { size: [4.2, 3.0], strength: 0.7, tint: "#fff4e6", at: [2.6, 1.8, 5.6] },
  { size: [0.9, 3.4], strength: 1.6, tint: "#e8f0ff", at: [-2.6, 1.6, 5.4] },
];

/** Frames from one drawing to the next, so that colors that a script changes in each frame cost little. */
const patience = 5;

export class Reflections {
  private readonly generator_: PMREMGenerator;
  private readonly sky_: SkyColors;
  private readonly studio_ = new Scene();
  private readonly lamps_: readonly MeshBasicMaterial[];
  private readonly ground_ = { value: new Color() };
  private target_: WebGLRenderTarget | null = null;
  /** All colors and lights of the picture, and of the newest one that was drawn. */
  private wanted_ = "";
  private drawn_ = "";
  private wait_ = 0;

  constructor(renderer: WebGLRenderer, colors: SkyColors) {
    this.sky_ = colors;
    this.generator_ = new PMREMGenerator(renderer);
    this.studio_.add(new Mesh(new SphereGeometry(20, 32, 16), makeSurroundings(colors, this.ground_, renderer.toneMappingExposure)));
    this.lamps_ = softBoxes.map(({ size, at }) => {
      const lamp = new Mesh(new PlaneGeometry(...size), new MeshBasicMaterial({ toneMapped: false }));
      lamp.position.set(...at);
      lamp.lookAt(0, 0.5, 0);
      this.studio_.add(lamp);
      return lamp.material;
    });
  }

  /** `light`: of the soft boxes, times the usual. `ground`: radiance; null: there is none. Call it when colors of the sky change, too. */
  set(light: number, ground: Color | null): void {
    softBoxes.forEach(({ strength, tint }, index) => this.lamps_[index].color.set(tint).multiplyScalar(light * strength));
    if (ground === null) this.ground_.value.setRGB(-1, -1, -1);
    else this.ground_.value.copy(ground);
    const { horizon, zenith } = this.sky_;
    this.wanted_ = [light, ...[this.ground_, horizon, zenith].flatMap(({ value }) => value.toArray())].join();
  }

  /** Call it before each picture of the scene. Each drawing takes as long as several pictures. */
  update(scene: Scene): void {
    if (--this.wait_ > 0 || this.wanted_ === this.drawn_) return;
    this.drawn_ = this.wanted_;
    this.wait_ = patience;
    const before = this.target_;
    this.target_ = this.generator_.fromScene(this.studio_, 0.025);
    scene.environment = this.target_.texture;
    before?.dispose();
  }
}
