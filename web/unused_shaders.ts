// SPDX-License-Identifier: Apache-2.0
// Takes shader text of three.js that the page never compiles out of the bundle. If a material needs some of it, the first
// browser test shows it; then remove its line here.

/** Chunks of features, and programs of materials, that the page does not use. */
const unusedChunks = /^(?:alphahash_|batching_|bumpmap_|clearcoat_|displacementmap_|gradientmap_|iridescence_|lights_toon_|lights_phong_|lightprobes_|logdepthbuf_|morph|skin|transmission_)\w+$/;
const unusedPrograms = /^#define (?:TOON|PHONG|MATCAP|NORMAL|DISTANCE)\\n/;

/** Names that no material of the page defines: those of MeshPhysicalMaterial, and of maps and meshes of other kinds. */
const undefinedNames = new RegExp(`^(?:${[
  "PHYSICAL", "IOR", "USE_(?:CLEARCOAT|SHEEN|IRIDESCENCE|ANISOTROPY|TRANSMISSION|SPECULAR_|THICKNESS|DIFFUSE_ROUGHNESS|BATCHING|MORPH|SKINNING)\\w*",
  "USE_(?:SPECULAR|DISPERSION|RETROREFLECTION|ALPHAHASH|MATCAP|BUMPMAP|DISPLACEMENTMAP|REVERSED_DEPTH_BUFFER|LOGARITHMIC_DEPTH_BUFFER|PACKED_NORMALMAP)",
  "DECODE_VIDEO_TEXTURE\\w*", "FOG_EXP2", "SHADOWMAP_TYPE_VSM", "PHONG", "TOON",
].join("|")})$`);
/** Numbers that are zero in every program of the page. */
const zeroNumbers = /^NUM_(?:RECT_AREA_LIGHTS|SUN_LIGHTS|SUN_LIGHT_SHADOWS|LIGHT_PROBE_GRIDS|CLIPPING_PLANES)$/;

/** Whether a condition of the preprocessor is never (false) or always (true) met; null if that depends on the material. */
function known(keyword: string, condition: string): boolean | null {
  if (keyword === "ifdef") return undefinedNames.test(condition) ? false : null;
  if (keyword === "ifndef") return undefinedNames.test(condition) ? true : null;
  // With one part that is never met, all parts joined by "and" are not.
  if (condition.includes("||") || condition.includes("!")) return null;
  const never = condition.split("&&").some((part) => {
    const [, name = ""] = /^[\s(]*defined\s*\(\s*(\w+)[\s)]*$/.exec(part) ?? [];
    const [, number = ""] = /^[\s(]*(\w+) > 0[\s)]*$/.exec(part) ?? [];
    return undefinedNames.test(name) || zeroNumbers.test(number);
  });
  return never ? false : null;
}

interface Branches {
  /** Whether the lines around the condition are kept. */
  readonly outer: boolean;
  /** Whether a directive of it is kept, and with it its #endif. */
  open: boolean;
  /** Whether a branch is always taken, so that no later one is. */
  readonly taken: boolean;
}

/** `text` without branches that are never compiled. */
export function withoutDeadBranches(text: string): string {
  const kept: string[] = [];
  const stack: Branches[] = [];
  let live = true;
  for (const line of text.split("\n")) {
    const [, keyword = "", condition = ""] = /^\s*#\s*(ifdef|ifndef|if|elif|else|endif)\b\s*(.*?)\s*$/.exec(line) ?? [];
    const top = stack.at(-1);
    if (keyword.startsWith("if")) {
      const met: boolean | null = live ? known(keyword, condition) : null;
      const branches = { outer: live, open: live && met === null, taken: met === true };
      stack.push(branches);
      if (branches.open) kept.push(line);
      live = live && met !== false;
    } else if (keyword === "elif" && top !== undefined) {
      const met: boolean | null = known("if", condition);
      live = top.outer && !top.taken && met !== false;
      if (!live) continue;
      kept.push(top.open ? line : line.replace("elif", "if"));
      top.open = true;
    } else if (keyword === "else" && top !== undefined) {
      live = top.outer && !top.taken;
      if (live && top.open) kept.push(line);
    } else if (keyword === "endif" && top !== undefined) {
      if (top.open) kept.push(line);
      live = top.outer;
      stack.pop();
    } else if (live) {
      kept.push(line);
    }
  }
  if (stack.length > 0) throw new Error(`a condition is not closed: ${text.slice(0, 80)}`);
  return kept.join("\n");
}

/** The module three.js without the shader text that the page does not use. */
export function withoutUnusedShaders(code: string): string {
  return code.replaceAll(/^(var|const) ([\w$]+) = "((?:[^"\\]|\\.)*)";/gm, (all: string, keyword: string, name: string, text: string) => {
    if (unusedChunks.test(name) || unusedPrograms.test(text)) return `${keyword} ${name} = "";`;
    if (!text.includes("#if")) return all;
    return `${keyword} ${name} = ${JSON.stringify(withoutDeadBranches(JSON.parse(`"${text}"`) as string))};`;
  });
}
