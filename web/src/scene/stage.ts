// SPDX-License-Identifier: Apache-2.0
// The quiet workshop: ground that fades into the horizon, warm key light with a soft shadow, cool
// fill, and a small studio of soft boxes for reflections. All of it computed, nothing downloaded.

import {
  BackSide, BoxGeometry, BufferAttribute, CircleGeometry, Color, DirectionalLight, Fog, Group, HemisphereLight, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, PlaneGeometry, PMREMGenerator, Scene, SphereGeometry, Vector3,
  type Texture, type WebGLRenderer,
} from "three";
import { makeFloorColor } from "./textures.ts";

interface Theme {
  readonly horizon: string;
  readonly zenith: string;
  readonly ground: string;
  readonly key: number;
  readonly fill: number;
  readonly environment: number;
}

const themes: Record<"light" | "dark", Theme> = {
  light: { horizon: "#dcd9d3", zenith: "#f1f0ed", ground: "#cbc7bf", key: 2.9, fill: 0.55, environment: 0.7 },
  dark: { horizon: "#25282c", zenith: "#14161a", ground: "#4a4a4b", key: 2.6, fill: 0.25, environment: 0.55 },
};

const groundRadius = 60;

/** Color of sky and ground by height, as vertex colors of a large sphere. */
function paintSky(geometry: SphereGeometry, theme: Theme): void {
  const position = geometry.getAttribute("position");
  const colors = new Float32Array(position.count * 3);
  const low = new Color(theme.horizon);
  const high = new Color(theme.zenith);
  const mixed = new Color();
  for (let index = 0; index < position.count; index++) {
    const height = Math.max(position.getY(index) / geometry.parameters.radius, 0);
    mixed.lerpColors(low, high, Math.min(1, height * 1.6)).toArray(colors, index * 3);
  }
  geometry.setAttribute("color", new BufferAttribute(colors, 3));
}

function makeStudio(renderer: WebGLRenderer): Texture {
  const studio = new Scene();
  const walls = new Mesh(new BoxGeometry(12, 6, 12), new MeshBasicMaterial({ color: "#a4a7aa", side: BackSide }));
  walls.position.y = 2;
  const floor = new Mesh(new PlaneGeometry(12, 12), new MeshBasicMaterial({ color: "#6b655d" }));
  floor.rotation.x = -Math.PI / 2;
  floor.position.y = -0.95;
  studio.add(walls, floor);
  const panel = (width: number, height: number, strength: number, tint: string, at: Vector3) => {
    const light = new Mesh(
      new PlaneGeometry(width, height),
      new MeshBasicMaterial({ color: new Color(tint).multiplyScalar(strength), toneMapped: false }),
    );
    light.position.copy(at);
    light.lookAt(0, 0.5, 0);
    studio.add(light);
  };
  panel(3.2, 2.2, 11, "#fff1dc", new Vector3(3.2, 4.4, 3.4));
  panel(1.2, 4.2, 6, "#dfeaff", new Vector3(-5.4, 1.8, 1.5));
  panel(5.0, 0.7, 7, "#ffffff", new Vector3(0, 4.6, -3.4));
  panel(0.5, 4.0, 5, "#fff6e8", new Vector3(4.6, 1.6, -4.2));
  const generator = new PMREMGenerator(renderer);
  const target = generator.fromScene(studio, 0.025);
  generator.dispose();
  studio.traverse((item) => {
    if (item instanceof Mesh) {
      (item.geometry as PlaneGeometry).dispose();
      (item.material as MeshBasicMaterial).dispose();
    }
  });
  return target.texture;
}

/** Fine lines each 0.1 m, stronger each 1 m, fading with distance; compiled in only while it is shown. */
function addGrid(material: MeshLambertMaterial): void {
  material.defines = {};
  material.onBeforeCompile = (shader) => {
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
diffuseColor.rgb *= 1.0 - 0.45 * max(0.35 * gridLine(vGround, 0.1), 0.8 * gridLine(vGround, 1.0));
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
  private readonly sky_: Mesh<SphereGeometry, MeshBasicMaterial>;
  private readonly key_ = new DirectionalLight("#fff0dc");
  private readonly fill_ = new HemisphereLight("#dce8f5", "#8a8073");
  private readonly middle_ = new Vector3(0, 1, 0);
  private radius_ = 0;

  constructor(scene: Scene, renderer: WebGLRenderer) {
    this.scene_ = scene;
    scene.environment = makeStudio(renderer);
    scene.fog = new Fog("#ffffff", 7, 34);
    const material = new MeshLambertMaterial({ map: makeFloorColor() });
    material.map?.repeat.set(40, 40);
    // Not a physical material: it fills most of the screen, and a matt floor needs no reflections.
    addGrid(material);
    this.ground = new Mesh(new CircleGeometry(groundRadius, 64), material);
    this.ground.rotation.x = -Math.PI / 2;
    this.ground.receiveShadow = true;
    this.sky_ = new Mesh(
      new SphereGeometry(groundRadius * 1.4, 24, 32),
      new MeshBasicMaterial({ side: BackSide, vertexColors: true, toneMapped: false, fog: false, depthWrite: false }),
    );
    this.sky_.renderOrder = -1;
    this.key_.castShadow = true;
    this.key_.shadow.mapSize.set(2048, 2048);
    this.key_.shadow.radius = 5;
    this.key_.shadow.normalBias = 0.004;
    this.key_.shadow.bias = -0.0004;
    this.root.add(this.ground, this.sky_, this.key_, this.key_.target, this.fill_);
    scene.add(this.root);
    this.setTheme("light");
    this.fit(-1, 0, -1, 1, 2, 1);
  }

  setTheme(name: "light" | "dark"): void {
    const theme = themes[name];
    paintSky(this.sky_.geometry, theme);
    this.scene_.fog?.color.set(theme.horizon);
    this.scene_.environmentIntensity = theme.environment;
    this.ground.material.color.set(theme.ground);
    this.key_.intensity = theme.key;
    this.fill_.intensity = theme.fill;
  }

  /** Height of the ground, m; null: none. */
  setGround(height: number | null): void {
    this.ground.visible = height !== null;
    if (height !== null) this.ground.position.y = height;
  }

  get gridShown(): boolean {
    return this.ground.material.defines?.["GRID"] !== undefined;
  }

  set gridShown(shown: boolean) {
    if (shown === this.gridShown) return;
    this.ground.material.defines = shown ? { GRID: "" } : {};
    this.ground.material.needsUpdate = true;
  }

  /** Keeps the shadow on the box of all bodies; moves only when the box has left it, so that edges do not swim. */
  fit(x0: number, y0: number, z0: number, x1: number, y1: number, z1: number): void {
    const floor = this.ground.visible ? Math.min(this.ground.position.y, y0) : y0;
    const radius = Math.max(0.5 * Math.hypot(x1 - x0, y1 - floor, z1 - z0), 0.3);
    const x = (x0 + x1) / 2;
    const y = (floor + y1) / 2;
    const z = (z0 + z1) / 2;
    const drift = Math.hypot(x - this.middle_.x, y - this.middle_.y, z - this.middle_.z);
    if (radius + drift <= this.radius_ && radius > this.radius_ * 0.4) return;
    this.middle_.set(x, y, z);
    this.radius_ = radius * 1.4;
    const reach = this.radius_ * 1.15;
    this.key_.target.position.copy(this.middle_);
    this.key_.position.set(x + reach * 0.55, y + reach * 1.35, z + reach * 0.75);
    const camera = this.key_.shadow.camera;
    camera.left = camera.bottom = -reach;
    camera.right = camera.top = reach;
    camera.near = 0.05;
    camera.far = reach * 3.2;
    camera.updateProjectionMatrix();
  }
}
