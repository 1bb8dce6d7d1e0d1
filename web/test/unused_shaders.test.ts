// SPDX-License-Identifier: Apache-2.0
import { ShaderChunk, ShaderLib } from "three";
import { describe, expect, it } from "vitest";
import { withoutDeadBranches, withoutUnusedShaders } from "../unused_shaders.ts";

const lines = (...text: string[]) => text.join("\n");

describe("shader text of three.js", () => {
  it("loses a branch that no material of the page compiles, with its condition", () => {
    expect(withoutDeadBranches(lines("a", "#ifdef USE_SHEEN", "b", "#ifdef USE_MAP", "c", "#endif", "#endif", "d"))).toBe(lines("a", "d"));
    expect(withoutDeadBranches(lines("#if ( NUM_RECT_AREA_LIGHTS > 0 ) && defined( RE_Direct_RectArea )", "b", "#endif"))).toBe("");
  });

  it("keeps the other branch", () => {
    expect(withoutDeadBranches(lines("#ifdef USE_CLEARCOAT", "a", "#else", "b", "#endif"))).toBe("b");
    expect(withoutDeadBranches(lines("#ifndef USE_CLEARCOAT", "a", "#else", "b", "#endif"))).toBe("a");
    expect(withoutDeadBranches(lines("#if defined( USE_SHEEN )", "a", "#elif defined( USE_MAP )", "b", "#else", "c", "#endif")))
      .toBe(lines("#if defined( USE_MAP )", "b", "#else", "c", "#endif"));
    expect(withoutDeadBranches(lines("#if defined( USE_MAP )", "a", "#elif defined( SHADOWMAP_TYPE_VSM )", "b", "#else", "c", "#endif")))
      .toBe(lines("#if defined( USE_MAP )", "a", "#else", "c", "#endif"));
  });

  it("keeps every branch that depends on the material", () => {
    for (const condition of ["#ifdef USE_MAP", "#if NUM_POINT_LIGHTS > 0", "#if defined( USE_SHEEN ) || defined( USE_MAP )", "#if ! defined( USE_SHEEN )"]) {
      const text = lines(condition, "a", "#else", "b", "#endif");
      expect(withoutDeadBranches(text)).toBe(text);
    }
  });

  it("keeps all directives in pairs, in every chunk", () => {
    const count = (text: string, word: RegExp) => text.match(word)?.length ?? 0;
    for (const text of [...Object.values(ShaderChunk), ...Object.values(ShaderLib).flatMap((shader) => [shader.vertexShader, shader.fragmentShader])]) {
      const left = withoutDeadBranches(text);
      expect(count(left, /#\s*if/g)).toBe(count(left, /#\s*endif/g));
    }
  });

  it("is replaced where the module defines it, and nowhere else", () => {
    const module = String.raw`var sheen = "a\n#ifdef USE_SHEEN\n\tb\n#endif\nc";
const vertex$4 = "#define TOON\nvoid main() {}";
const other = "plain";`;
    expect(withoutUnusedShaders(module)).toBe(String.raw`var sheen = "a\nc";
const vertex$4 = "";
const other = "plain";`);
  });
});
