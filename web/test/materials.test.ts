// SPDX-License-Identifier: Apache-2.0
import { ShaderLib, type WebGLProgramParametersWithUniforms, type WebGLRenderer } from "three";
import { expect, it } from "vitest";
import { materialOf } from "../src/scene/materials.ts";

it("a pixel at a narrow facet has the normal of its seen part, in both stages of the shader", () => {
  const { vertexShader, fragmentShader } = ShaderLib.standard;
  const shader = { uniforms: {}, vertexShader, fragmentShader } as unknown as WebGLProgramParametersWithUniforms;
  materialOf({ material: "steel", color: null }).onBeforeCompile(shader, {} as WebGLRenderer);
  for (const text of [shader.vertexShader, shader.fragmentShader]) {
    expect(text).toContain("centroid varying vec3 vNormal;");
    expect(text).not.toMatch(/#include <normal_pars_/);
  }
});
