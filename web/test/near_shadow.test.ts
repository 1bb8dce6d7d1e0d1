// SPDX-License-Identifier: Apache-2.0
import { ShaderChunk, Sphere, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { NearShadow, withNearShadow } from "../src/scene/near_shadow.ts";

const toLight = new Vector3(0.55, 1.35, 0.75);
const lit = new Sphere(new Vector3(3, 2, -4), 40);

describe("the shadow of what is near", () => {
  it("finds its place in the text of three.js, once", () => {
    const text = withNearShadow("a directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ] b");
    expect(text).toContain("nearEdge");
    new NearShadow();
    new NearShadow();
    expect(ShaderChunk.lights_fragment_begin.split("vec2 nearEdge").length).toBe(2);
  });

  it("covers a place and all that may throw shadows on it", () => {
    const near = new NearShadow();
    for (const place of [[0, 0, 0], [20, 1, -20], [-10, 8, 12]]) {
      near.aim(new Vector3(...place), 5, toLight, lit);
      const { light, light: { shadow: { camera } } } = near;
      light.updateMatrixWorld();
      light.target.updateMatrixWorld();
      light.shadow.updateMatrices(light);
      const seen = new Vector3(...place).project(camera);
      expect(Math.hypot(seen.x, seen.y)).toBeLessThan(2e-3);
      const highest = toLight.clone().setLength(lit.radius).add(lit.center);
      const lowest = toLight.clone().setLength(-lit.radius).add(lit.center);
      expect(Math.abs(highest.project(camera).z)).toBeLessThan(1);
      expect(Math.abs(lowest.project(camera).z)).toBeLessThan(1);
    }
  });

  it("moves by whole pixels, so that edges do not flicker", () => {
    const near = new NearShadow();
    near.aim(new Vector3(1, 0, 1), 5, toLight, lit);
    near.light.updateMatrixWorld();
    const at = () => {
      near.light.updateMatrixWorld();
      near.light.target.updateMatrixWorld();
      near.light.shadow.updateMatrices(near.light);
      return new Vector3(0.3, 0.2, 0.1).applyMatrix4(near.light.shadow.matrix).multiplyScalar(near.light.shadow.mapSize.x);
    };
    const before = at();
    near.aim(new Vector3(1.2345, 0, 1.5432), 5, toLight, lit);
    const moved = at().sub(before);
    expect(moved.x).toBeCloseTo(Math.round(moved.x), 6);
    expect(moved.y).toBeCloseTo(Math.round(moved.y), 6);
    expect(Math.abs(moved.x)).toBeGreaterThan(1);
  });
});
