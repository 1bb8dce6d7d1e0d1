// SPDX-License-Identifier: Apache-2.0
// The soft shadow under bodies on the ground or near it: a small, blurred picture of the scene from below, brighter for
// nearer bodies, darkens the ground. Bodies high above the ground have no such shadow.

import {
  Color, Matrix4, Mesh, MeshDepthMaterial, NoBlending, OrthographicCamera, PlaneGeometry, Scene, ShaderMaterial, Vector2, WebGLRenderTarget,
  type Texture, type WebGLRenderer,
} from "three";

/** Objects on this layer darken the ground. */
export const casterLayer = 1;

const pixels = 512;
/** Height of the picture's box relative to its width. */
const flatness = 0.12;

function makeBlur(): ShaderMaterial {
  return new ShaderMaterial({
    uniforms: { picture: { value: null }, step: { value: new Vector2() } },
    depthTest: false, depthWrite: false, blending: NoBlending,
    vertexShader: "varying vec2 vUv; void main() { vUv = uv; gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0); }",
    fragmentShader: `
      uniform sampler2D picture;
      uniform vec2 step;
      varying vec2 vUv;
      void main() {
        float sum = 0.0;
        for (int i = -4; i <= 4; i++) sum += exp(-0.125 * float(i * i)) * texture2D(picture, vUv + float(i) * step).r;
        gl_FragColor = vec4(sum / 4.9);
      }`,
  });
}

export class ContactShadow {
  /** World -> place in the picture, 0 .. 1 in x and y. */
  readonly matrix = { value: new Matrix4() };
  readonly picture: { value: Texture };
  readonly strength = { value: 0 };

  private readonly renderer_: WebGLRenderer;
  private readonly camera_ = new OrthographicCamera();
  private readonly first_ = new WebGLRenderTarget(pixels, pixels);
  private readonly second_ = new WebGLRenderTarget(pixels, pixels, { depthBuffer: false });
  private readonly depth_ = new MeshDepthMaterial();
  private readonly blur_ = makeBlur();
  private readonly screen_ = new Scene();

  constructor(renderer: WebGLRenderer) {
    this.renderer_ = renderer;
    this.picture = { value: this.first_.texture };
    this.camera_.layers.set(casterLayer);
    // From below, with the top of the picture towards -z.
    this.camera_.rotation.set(Math.PI / 2, 0, 0);
    const sheet = new Mesh(new PlaneGeometry(), this.blur_);
    sheet.frustumCulled = false;
    sheet.layers.set(casterLayer);
    this.screen_.add(sheet);
  }

  /** Covers `reach` m about a place on the ground. */
  aim(x: number, ground: number, z: number, reach: number): void {
    const camera = this.camera_;
    camera.position.set(x, ground, z);
    camera.left = camera.bottom = -reach;
    camera.right = camera.top = reach;
    camera.near = 0;
    camera.far = flatness * reach;
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.matrix.value.makeScale(0.5, 0.5, 0.5).setPosition(0.5, 0.5, 0.5)
      .multiply(camera.projectionMatrix).multiply(camera.matrixWorldInverse);
  }

  /** Renders the picture again. */
  update(scene: Scene): void {
    const { renderer_: renderer } = this;
    const target = renderer.getRenderTarget();
    const { background, overrideMaterial } = scene;
    const shadows = renderer.shadowMap.autoUpdate;
    const clear = renderer.getClearColor(new Color());
    const alpha = renderer.getClearAlpha();
    const xr = renderer.xr.enabled;
    renderer.xr.enabled = false;
    renderer.shadowMap.autoUpdate = false;
    scene.background = null;
    scene.overrideMaterial = this.depth_;
    renderer.setClearColor(0x000000, 1);
    renderer.setRenderTarget(this.first_);
    renderer.clear();
    renderer.render(scene, this.camera_);
    scene.overrideMaterial = overrideMaterial;
    scene.background = background;
    for (let pass = 0; pass < 2; pass++) {
      this.blurInto_(this.first_, this.second_, 1.6 / pixels, 0);
      this.blurInto_(this.second_, this.first_, 0, 1.6 / pixels);
    }
    renderer.setRenderTarget(target);
    renderer.setClearColor(clear, alpha);
    renderer.shadowMap.autoUpdate = shadows;
    renderer.xr.enabled = xr;
  }

  private blurInto_(from: WebGLRenderTarget, to: WebGLRenderTarget, x: number, y: number): void {
    const { picture, step } = this.blur_.uniforms;
    picture.value = from.texture;
    (step.value as Vector2).set(x, y);
    this.renderer_.setRenderTarget(to);
    this.renderer_.render(this.screen_, this.camera_);
  }
}

