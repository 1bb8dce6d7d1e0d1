// SPDX-License-Identifier: Apache-2.0
// The surroundings: a ground up to the horizon, warm key light with a soft shadow, cool fill, and a small studio of
// soft boxes for reflections. All of it is computed, nothing is downloaded, and it scales with the scene.

import {
  CircleGeometry, Color, DirectionalLight, Fog, Group, HemisphereLight, Mesh, MeshLambertMaterial, Scene, Sphere, SphereGeometry,
  Vector3, type PerspectiveCamera, type WebGLRenderer,
} from "three";
import { ContactShadow } from "./contact_shadow.ts";
import { openness } from "./materials.ts";
import type { NearShadow } from "./near_shadow.ts";
import { makeSky, Reflections, type SkyColors } from "./reflections.ts";
import { makeFloorColor } from "./textures.ts";

interface Theme {
  /** At the end of the ground and above it, and overhead. */
  readonly horizon: string;
  readonly zenith: string;
  readonly ground: string;
  /** How much darker the ground is at a distance, where it does not fade into a brighter horizon. */
  readonly pool: number;
  readonly key: number;
  readonly fill: number;
  /** Soft boxes that surfaces mirror. */
  readonly lamps: number;
  /** Share of the surroundings' diffuse light: by day as much as leaves a face that is lit from the side in the color that it was given. */
  readonly openness: number;
}

/** The script's colors and light; null: the theme's. */
export interface Surroundings {
  readonly sky: string | null;
  readonly horizon: string | null;
  readonly ground: string | null;
  /** A factor of the theme's. */
  readonly light: number;
}

const themes: Record<"light" | "dark", Theme> = {
  light: { horizon: "#d5d7d7", zenith: "#8ea7bb", ground: "#c9c0b2", pool: 0.04, key: 3.2, fill: 0.3, lamps: 1, openness: 0.5 },
  dark: { horizon: "#2f3338", zenith: "#0d1013", ground: "#5a5651", pool: 0.3, key: 2.4, fill: 0.22, lamps: 0.7, openness: 1 },
};

/** Relative to the size of the scene (half the diagonal of its box): the ground, its texture, start and end of its
 * fading. */
const groundRadius = 120;
const tileSize = 2;
const contactStrength = 0.75;
/** Ambient light on the ground, also in shadows. */
const groundAmbient = 1.15;
/** Mean of the ground's texture, linear. */
const floorMean = 0.912;
/** To the key light. */
const keyDirection = new Vector3(0.55, 1.35, 0.75);
/** Shadows are drawn on a ground that is so far below, in sizes of the scene. */
const farGround = 3;
/** Sizes of the lit ball in distances of the camera: from the larger on, what is near has a shadow of its own, down to the smaller. */
const wide = [3, 5] as const;
/** Triangles of a picture up to which it is so, and up to which it stays so: all are drawn once more for it. */
const few = [100_000, 250_000] as const;
/** Frames for which it has to be so first: the first pictures of a page have few triangles. */
const settled = 30;
const fogNear = 1.5;
const fogFar = 24;

/** Darkened near bodies. */
function addContactShadow(material: MeshLambertMaterial, shadow: ContactShadow): void {
  const before = material.onBeforeCompile;
  material.onBeforeCompile = (shader, renderer) => {
    before.call(material, shader, renderer);
    Object.assign(shader.uniforms, { contactPicture: shadow.picture, contactMatrix: shadow.matrix, contactStrength: shadow.strength });
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nuniform mat4 contactMatrix;\nvarying vec2 vContact;")
      .replace("#include <project_vertex>", "#include <project_vertex>\nvContact = (contactMatrix * modelMatrix * vec4(transformed, 1.0)).xy;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "#include <common>\nuniform sampler2D contactPicture;\nuniform float contactStrength;\nvarying vec2 vContact;")
      .replace("#include <color_fragment>", `#include <color_fragment>
vec2 contactEdge = smoothstep(vec2(0.5), vec2(0.42), abs(vContact - 0.5));
float contact = texture2D(contactPicture, vContact).r * contactEdge.x * contactEdge.y;
diffuseColor.rgb *= 1.0 - contactStrength * (1.0 - exp(-5.0 * contact));`);
  };
}

/** The studio is in a pool of light, which gives depth; its ground is flat with one normal, so ambient light is one
 * number. */
function addPool(material: MeshLambertMaterial, ambient: { value: number }, pool: { value: number }): void {
  const before = material.onBeforeCompile;
  material.onBeforeCompile = (shader, renderer) => {
    before.call(material, shader, renderer);
    Object.assign(shader.uniforms, { groundAmbient: ambient, pool });
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nvarying vec2 vSizes;")
      .replace("#include <project_vertex>", "#include <project_vertex>\nvSizes = position.xy;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "#include <common>\nuniform float groundAmbient, pool;\nvarying vec2 vSizes;")
      .replace("#include <lights_fragment_maps>", "iblIrradiance += vec3(groundAmbient);")
      .replace("#include <color_fragment>", "#include <color_fragment>\ndiffuseColor.rgb *= 1.0 - pool * smoothstep(0.8, 8.0, length(vSizes));");
  };
}

/** Fine lines for each cell, stronger ones for each ten, fading with distance; compiled only while it is shown. */
function addGrid(material: MeshLambertMaterial, cell: { value: number }): void {
  material.defines = {};
  material.onBeforeCompile = (shader) => {
    shader.uniforms["gridCell"] = cell;
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\n#ifdef GRID\nvarying vec2 vGround;\n#endif")
      .replace(
        "#include <project_vertex>",
        "#include <project_vertex>\n#ifdef GRID\nvGround = (modelMatrix * vec4(transformed, 1.0)).xz;\n#endif",
      );
    shader.fragmentShader = shader.fragmentShader
      .replace(
        "#include <common>",
        `#include <common>
#ifdef GRID
varying vec2 vGround;
uniform float gridCell;
float gridLine(vec2 p, float cell) {
  vec2 w = fwidth(p / cell);
  vec2 d = abs(fract(p / cell - 0.5) - 0.5);
  vec2 l = 1.0 - smoothstep(vec2(0.0), w * 1.4, d);
  return max(l.x, l.y) * clamp(1.0 - 3.0 * max(w.x, w.y), 0.0, 1.0);
}
#endif`,
      )
      .replace(
        "#include <color_fragment>",
        `#include <color_fragment>
#ifdef GRID
diffuseColor.rgb *= 1.0 - 0.45 * max(0.35 * gridLine(vGround, gridCell), 0.8 * gridLine(vGround, 10.0 * gridCell));
#endif`,
      );
  };
}

export class Stage {
  /** Everything of the stage; a child of the scene. */
  readonly root = new Group();
  /** The ground, for a teleport ray; invisible when the world has none. */
  readonly ground: Mesh<CircleGeometry, MeshLambertMaterial>;

  private readonly scene_: Scene;
  private readonly renderer_: WebGLRenderer;
  private readonly invalidate_: () => void;
  private readonly skyColors_: SkyColors = { horizon: { value: new Color() }, zenith: { value: new Color() } };
  private readonly sky_ = new Mesh(new SphereGeometry(1, 16, 12), makeSky(this.skyColors_));
  private readonly reflections_: Reflections;
  private readonly key_ = new DirectionalLight("#fff0dc");
  private readonly fill_ = new HemisphereLight("#dce8f5", "#8a8073");
  private readonly fog_ = new Fog("#ffffff", fogNear, fogFar);
  private readonly cell_ = { value: 0.1 };
  private readonly ambient_ = { value: groundAmbient };
  private readonly pool_ = { value: 0 };
  private readonly contact_: ContactShadow;
  private readonly middle_ = new Vector3(0, 1, 0);
  /** The ball in which things are lit with shadows. */
  private readonly lit_ = new Sphere();
  /** Fetched once a camera is near a part of a wide scene. */
  private near_: NearShadow | null = null;
  private isWide_ = false;
  private wideFrames_ = 0;
  private size_ = 1;
  private hasGround_ = true;
  private passthrough_ = false;
  private theme_: Theme = themes.light;
  private surroundings_: Surroundings = { sky: null, horizon: null, ground: null, light: 1 };

  /** invalidate: requests a new picture. */
  constructor(scene: Scene, renderer: WebGLRenderer, invalidate: () => void) {
    this.scene_ = scene;
    this.renderer_ = renderer;
    this.invalidate_ = invalidate;
    this.reflections_ = new Reflections(renderer, this.skyColors_);
    scene.fog = this.fog_;
    const material = new MeshLambertMaterial({ map: makeFloorColor(), dithering: true });
    material.map?.repeat.set((2 * groundRadius) / tileSize, (2 * groundRadius) / tileSize);
    // Not a physical material: it fills most of the screen, and a matte floor needs no reflections.
    addGrid(material, this.cell_);
    this.contact_ = new ContactShadow(renderer);
    addContactShadow(material, this.contact_);
    addPool(material, this.ambient_, this.pool_);
    this.ground = new Mesh(new CircleGeometry(groundRadius, 64), material);
    this.ground.rotation.x = -Math.PI / 2;
    this.ground.receiveShadow = true;
    this.sky_.renderOrder = -1;
    this.sky_.frustumCulled = false;
    this.key_.castShadow = true;
    this.key_.shadow.mapSize.set(2048, 2048);
    this.key_.shadow.radius = 4;
    this.key_.shadow.bias = -0.0004;
    this.root.add(this.ground, this.sky_, this.key_, this.key_.target, this.fill_);
    scene.add(this.root);
    this.setTheme("light");
    this.setScene([0, 1, 0], 1.6);
  }

  setTheme(name: "light" | "dark"): void {
    this.theme_ = themes[name];
    this.paint_();
  }

  /** Colors (null: the theme's) and light (times the theme's) that a script gives the world. */
  setSurroundings(surroundings: Surroundings): void {
    this.surroundings_ = surroundings;
    this.paint_();
  }

  private paint_(): void {
    const { sky, horizon, ground, light } = this.surroundings_;
    const { theme_: theme, skyColors_: colors } = this;
    colors.horizon.value.set(horizon ?? theme.horizon);
    colors.zenith.value.set(sky ?? theme.zenith);
    this.fog_.color.copy(colors.horizon.value);
    this.ground.material.color.set(ground ?? theme.ground);
    this.key_.intensity = light * theme.key;
    this.fill_.intensity = light * theme.fill;
    this.ambient_.value = groundAmbient * light;
    this.pool_.value = theme.pool;
    openness.value = theme.openness;
    this.reflect_();
  }

  /** Surfaces mirror the ground as it is lit far from shadows. */
  private reflect_(): void {
    const { key_: key, fill_: fill, ground: { material: { color } } } = this;
    const lit = key.color.clone().multiplyScalar((key.intensity * keyDirection.y) / keyDirection.length())
      .add(fill.color.clone().multiplyScalar(fill.intensity)).addScalar(this.ambient_.value).multiply(color).multiplyScalar(floorMean / Math.PI);
    this.reflections_.set(this.surroundings_.light * this.theme_.lamps, this.hasGround_ ? lit : null);
  }

  /** Sky, ground and fog give way to what the cameras of a headset see. */
  set passthrough(on: boolean) {
    this.passthrough_ = on;
    this.sky_.visible = !on;
    this.ground.visible = !on && this.hasGround_;
  }

  get passthrough(): boolean {
    return this.passthrough_;
  }

  /** Height of the ground, m; null: none. */
  setGround(height: number | null): void {
    this.hasGround_ = height !== null;
    this.ground.visible = this.hasGround_ && !this.passthrough_;
    if (height !== null) this.ground.position.y = height;
    this.reflect_();
    this.lit_.makeEmpty();
  }

  get gridShown(): boolean {
    return this.ground.material.defines?.["GRID"] !== undefined;
  }

  set gridShown(shown: boolean) {
    if (shown === this.gridShown) return;
    this.ground.material.defines = shown ? { GRID: "" } : {};
    this.ground.material.needsUpdate = true;
  }

  /** Distance between two fine lines of the grid, m. */
  get gridCell(): number {
    return this.cell_.value;
  }

  /** Half the diagonal of the box around all that is there, m. */
  get size(): number {
    return this.size_;
  }

  /** Middle of the scene and half its diagonal, m. Ground and fog follow; the light only if the scene has left it, so
   * that edges of shadows do not move. */
  setScene(middle: readonly [number, number, number], size: number): void {
    this.middle_.set(...middle);
    // Ground, fog and grid keep their size during small changes of the scene.
    if (size > 1.5 * this.size_ || size < 0.6 * this.size_) {
      this.size_ = size;
      this.cell_.value = 10 ** Math.round(Math.log10(size / 16));
    }
    this.ground.scale.setScalar(this.size_);
    this.ground.position.x = tileSize * this.size_ * Math.round(middle[0] / (tileSize * this.size_));
    this.ground.position.z = tileSize * this.size_ * Math.round(middle[2] / (tileSize * this.size_));
    // The lit ball reaches down to a ground that is not far below, since shadows fall on it.
    const gap = this.hasGround_ ? middle[1] - size - this.ground.position.y : 0;
    const below = gap > 0 && gap < farGround * size ? gap / 2 : 0;
    const scene = new Sphere(new Vector3(middle[0], middle[1] - below, middle[2]), size + below);
    const lit = this.lit_;
    const isLit = scene.radius + lit.center.distanceTo(scene.center) <= lit.radius;
    if (isLit && scene.radius > 0.4 * lit.radius) return;
    scene.radius *= 1.35;
    // A scene that leaves the light, as one that falls does, takes along what was lit, so that no shadow ends.
    const both = scene.clone().union(lit);
    lit.copy(!isLit && both.radius < 2 * scene.radius ? both : scene);
    this.aimContacts_();
    this.light_(this.key_);
  }

  /** Updates range of view, fog and sky for the camera. `distance`: to its pivot, m. */
  followCamera(camera: PerspectiveCamera, distance: number): void {
    const apart = camera.getWorldPosition(this.sky_.position).distanceTo(this.middle_);
    this.fog_.near = apart + fogNear * this.size_;
    this.fog_.far = 2 * apart + fogFar * this.size_;
    this.sharpen_(camera, distance);
    const near = 0.01 * Math.min(Math.max(distance, 0.02 * this.size_), this.size_);
    const far = apart + 1.5 * groundRadius * this.size_;
    if (camera.near === near && camera.far === far) return;
    camera.near = near;
    camera.far = far;
    camera.updateProjectionMatrix();
  }

  /** Middle of the scene, m. */
  get middle(): Vector3 {
    return this.middle_;
  }

  /** The same for a headset, which sees as far as it likes. */
  followHead(head: Vector3): void {
    const apart = this.sky_.position.copy(head).distanceTo(this.middle_);
    this.fog_.near = this.passthrough_ ? 1e6 * this.size_ : apart + fogNear * this.size_;
    this.fog_.far = 2 * this.fog_.near + fogFar * this.size_;
    this.setWide_(false);
  }

  /** Renders what surfaces mirror, if it has changed; call it before each picture of the scene. */
  drawReflections(): void {
    this.reflections_.update(this.scene_);
  }

  /** Renders the contact shadow; call it before each picture of the scene. */
  drawContacts(): void {
    this.contact_.strength.value = this.ground.visible ? contactStrength : 0;
    if (this.ground.visible) this.contact_.update(this.scene_);
  }

  /** None in a headset, where they would need a pass for each frame. */
  hideContacts(): void {
    this.contact_.strength.value = 0;
  }

  /** Shadows of what is near the camera, `distance` from its pivot, in a wide scene. */
  private sharpen_(camera: PerspectiveCamera, distance: number): void {
    const { near_: near, lit_: lit } = this;
    const [size, most] = this.isWide_ ? [wide[0], few[1]] : [wide[1], few[0]];
    const { triangles } = this.renderer_.info.render;
    this.wideFrames_ = lit.radius > size * distance && triangles > 0 && triangles < most ? this.wideFrames_ + 1 : 0;
    this.setWide_(this.isWide_ ? this.wideFrames_ > 0 : this.wideFrames_ > settled);
    if (!this.isWide_ || near === null) return;
    near.follow(camera, distance, keyDirection, lit);
    this.aimContacts_();
  }

  private setWide_(isWide: boolean): void {
    if (isWide === this.isWide_) return;
    this.isWide_ = isWide;
    if (this.near_ !== null) this.near_.light.visible = isWide;
    else
      void import("./near_shadow.ts").then(({ NearShadow }) => {
        this.near_ ??= new NearShadow();
        this.near_.light.visible = this.isWide_;
        this.root.add(this.near_.light, this.near_.light.target);
        this.invalidate_();
      });
    this.aimContacts_();
  }

  private aimContacts_(): void {
    const { near_: near, lit_: lit, ground: { position: { y } } } = this;
    if (this.isWide_ && near !== null && near.reach > 0) this.contact_.aim(near.center.x, y, near.center.z, near.reach);
    else this.contact_.aim(lit.center.x, y, lit.center.z, lit.radius);
  }

  private light_(light: DirectionalLight): void {
    const { center, radius: reach } = this.lit_;
    light.target.position.copy(center);
    light.position.copy(keyDirection).multiplyScalar(reach).add(center);
    const { camera } = light.shadow;
    camera.left = camera.bottom = -reach;
    camera.right = camera.top = reach;
    camera.near = 0.02 * reach;
    camera.far = 3.2 * reach;
    light.shadow.normalBias = 0.002 * reach;
    camera.updateProjectionMatrix();
  }
}
