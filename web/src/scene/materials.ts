// SPDX-License-Identifier: Apache-2.0
// The palette of all worlds, and the shader patches for tinted instances and outlines.

import {
  BackSide, Color, FrontSide, MeshBasicMaterial, MeshStandardMaterial, ShaderChunk, type Material, type MeshStandardMaterialParameters, type Side, type Texture,
} from "three";
import { makeBrushedRoughness, makePlain, makeRopeColor, makeRopeNormals, makeWoodColor } from "./textures.ts";

/** Colors with a meaning, the same in page, headset and bar. */
export const palette = {
  held: new Color("#e8452c"),
  aboutToBreak: new Color("#f2a324"),
  calm: new Color("#4fb3a5"),
  selected: new Color("#2f9d92"),
  hoverOnLight: new Color("#2e3338"),
  hoverOnDark: new Color("#f6f1e7"),
} as const;

/** Line color for a force in N: sea glass when gentle, amber near 10 N, coral from 60 N. */
export function forceColor(newtons: number, out: Color): Color {
  const strain = Math.min(Math.max(Math.log10(Math.max(newtons, 0.1) / 1) / 1.8, 0), 1);
  return strain < 0.5
    ? out.lerpColors(palette.calm, palette.aboutToBreak, strain * 2)
    : out.lerpColors(palette.aboutToBreak, palette.held, strain * 2 - 1);
}

const textures = new Map<string, Texture>();

function texture(name: string, make: () => Texture): Texture {
  let found = textures.get(name);
  if (found === undefined) {
    found = make();
    textures.set(name, found);
  }
  return found;
}

const white = () => texture("white", () => makePlain(255, 255, 255));

/** Every material has all three textures, plain ones if necessary, so that all share one program, compiled at the
 * start. */
function makeBase(name: string): MeshStandardMaterial {
  const material = new MeshStandardMaterial({
    dithering: true,
    map: white(),
    roughnessMap: white(),
    normalMap: texture("flat", () => makePlain(128, 128, 255)),
  });
  const set = (values: MeshStandardMaterialParameters) => material.setValues(values);
  switch (name) {
    case "steel":
      set({ color: "#959ba1", metalness: 1, roughness: 0.3, roughnessMap: texture("brushed", makeBrushedRoughness) });
      break;
    case "brass":
      set({ color: "#c0934a", metalness: 1, roughness: 0.26, roughnessMap: texture("brushed", makeBrushedRoughness) });
      break;
    case "rubber":
      set({ color: "#26282b", roughness: 0.86 });
      break;
    case "wood":
      set({ roughness: 0.45, map: texture("wood", makeWoodColor) });
      break;
    case "rope":
      set({ roughness: 0.9, map: texture("rope", makeRopeColor), normalMap: texture("rope_normals", makeRopeNormals) });
      break;
    case "glass":
      set({ color: "#8fc9bd", roughness: 0.18, transparent: true, opacity: 0.72 });
      break;
    default:
      // As plastic under a clear coat, which mirrors sharply; the color below it is soft.
      set({ color: "#c9c4ba", roughness: 0.4 });
      Object.assign(material.defines ?? {}, { USE_CLEARCOAT: "" });
  }
  return material;
}

/** Share of the surroundings' diffuse light that reaches surfaces: things near by hide the sky and shade the ground. */
export const openness = { value: 1 };

/** Mean brightness of the color texture of a material; 1 for plain ones. */
const meanLight: Record<string, number> = { wood: 0.19, rope: 0.24 };

/**
 * The normal of the seen part of a pixel, in place of its middle: beside a narrow triangle, as on a rounded edge, that would
 * be far beyond the normals of its corners, and edges would be dotted.
 */
function seenNormal(stage: "vertex" | "fragment"): [string, string] {
  const chunk = `normal_pars_${stage}` as const;
  return [`#include <${chunk}>`, ShaderChunk[chunk].replace("varying vec3 vNormal", "centroid varying vec3 vNormal")];
}

/** Leaves out grains of what fades. Only where something does: a discard keeps a headset from leaving out what is hidden. */
const discard = `
float grain = 32.0 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
if (fade > 0.5 && (fade < 32.5 ? grain > fade : grain < fade - 32.0)) discard;`;

function tint(material: MeshStandardMaterial, light: number, fades: boolean): void {
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, { meanLight: { value: light }, openness, clearcoat: { value: 1 }, clearcoatRoughness: { value: 0.08 } });
    shader.vertexShader = shader.vertexShader.replace(...seenNormal("vertex"));
    shader.fragmentShader = shader.fragmentShader.replace(...seenNormal("fragment"));
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nattribute vec4 tint;\nattribute vec3 hue;\nvarying vec4 vTint;\nvarying vec3 vHue;")
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvTint = tint;\nvHue = hue;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", "#include <common>\nvarying vec4 vTint;\nvarying vec3 vHue;\nuniform float meanLight, openness;\nconst vec3 luma = vec3(0.3, 0.6, 0.1);")
      .replace(
        "#include <color_fragment>",
        `#include <color_fragment>
// There are no values between 0 and 1, so 0.5 is safe from rounding. The brightness of the texture is kept.
float fade = floor(0.5 * vTint.a + 0.25), tinted = vTint.a - 2.0 * fade;${fades ? discard : ""}
if (vHue.r > 0.5) diffuseColor.rgb = (vHue - 1.0) * dot(diffuseColor.rgb, luma) / (meanLight * max(dot(diffuse, luma), 0.02));
float shade = 0.55 + 0.45 * min(1.0, 1.6 * max(diffuseColor.r, diffuseColor.g));
diffuseColor.rgb = mix(diffuseColor.rgb, vTint.rgb * shade, tinted);`,
      )
      .replace("#include <lights_fragment_maps>", "#include <lights_fragment_maps>\niblIrradiance *= openness;")
      .replace("#include <metalnessmap_fragment>", "#include <metalnessmap_fragment>\nmetalnessFactor *= 1.0 - 0.8 * tinted;")
      .replace("#include <emissivemap_fragment>", "#include <emissivemap_fragment>\ntotalEmissiveRadiance += vTint.rgb * tinted * 0.3;");
  };
  material.customProgramCacheKey = () => `iota-tint${fades}`;
}

const materials = new Map<string, MeshStandardMaterial>();
const images = new Map<string, Texture>();

/** Shows an image on the materials with its name behind a #; undefined: it is gone. */
export function setImage(name: string, image: Texture | undefined): void {
  if (image !== undefined) images.set(name, image);
  else images.delete(name);
  for (const [key, material] of materials) {
    if (!key.includes(`#${name} `)) continue;
    if (image !== undefined) material.map = image;
    else materials.delete(key);
  }
}

export interface MaterialOptions {
  /** Its name; paint for unknown ones. May have a # and the name of an image behind it. */
  readonly material: string;
  /** "#rrggbb", replaces its own. */
  readonly color: string | null;
  readonly opacity?: number;
  readonly side?: Side;
  /** Whether something that it is for fades in or out. */
  readonly fades?: boolean;
}

/**
 * For meshes with an attribute `tint` (rgb, and amount plus 2 n: n of 32 grains of the picture are drawn, or above 32 those that a fade by
 * n - 32 does not draw), which also dulls metal and glows a little, and perhaps one `hue`: 0, or a color to
 * draw in place of the material's, plus 1. It is shared: do not dispose of it.
 */
export function materialOf({ material: name, color, opacity = 1, side = FrontSide, fades = false }: MaterialOptions): MeshStandardMaterial {
  const key = `${name} ${color ?? ""} ${opacity} ${side} ${fades}`;
  let material = materials.get(key);
  if (material === undefined) {
    const [base, image] = name.split("#");
    material = makeBase(base);
    material.side = side;
    // The image has the colors.
    if (image !== undefined) material.setValues({ color: "#fff", map: images.get(image) ?? white() });
    if (color !== null && /^#[0-9a-fA-F]{6}$/.test(color)) material.color.set(color);
    if (opacity < 1) material.setValues({ transparent: true, opacity: opacity * material.opacity });
    tint(material, meanLight[name] ?? 1, fades);
    materials.set(key, material);
  }
  return material;
}

/** Thickness is an angle (m at 1 m), so that an outline is equally wide at a distance and in a headset. */
export interface OutlineMaterial extends Material {
  readonly color: Color;
  readonly thickness: { value: number };
}

export function makeOutlineMaterial(color: Color): OutlineMaterial {
  const thickness = { value: 0.003 };
  const material = new MeshBasicMaterial({ color, side: BackSide, toneMapped: false, fog: false });
  material.onBeforeCompile = (shader) => {
    shader.uniforms["thickness"] = thickness;
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nuniform float thickness;")
      .replace(
        "#include <project_vertex>",
        "#include <project_vertex>\nmvPosition.xyz += normalize(normalMatrix * normal) * thickness * -mvPosition.z;\ngl_Position = projectionMatrix * mvPosition;",
      );
  };
  material.customProgramCacheKey = () => "iota-outline";
  return Object.assign(material, { thickness });
}
