// SPDX-License-Identifier: Apache-2.0
import { Matrix4, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { cardPlace } from "../src/xr/notices.ts";

/** Of the edges of a card of a height: degrees above the eyes and to the right of the head's direction. */
function seen(turn: number, sceneHeight: number, height: number): { low: number; high: number; right: number } {
  const head = new Matrix4().makeRotationY(turn).setPosition(0.4, 1.6, -0.7);
  const at = cardPlace(head, new Vector3(0, sceneHeight, -6), height, new Vector3()).applyMatrix4(head.invert());
  const degrees = 180 / Math.PI;
  const [low, high] = [-0.5, 0.5].map((share) => degrees * Math.atan2(at.y + share * height, -at.z));
  return { low, high, right: degrees * Math.atan2(at.x, -at.z) };
}

describe("a card in the headset", () => {
  it.each([0.15, 0.6])("of %s m is above work that is lower than the eyes, and below work that is higher", (height) => {
    for (const turn of [0, 1, -2.5]) {
      const over = seen(turn, 1.2, height);
      expect(over.low).toBeGreaterThan(13);
      expect(over.high).toBeLessThan(45);
      const under = seen(turn, 3.1, height);
      expect(under.high).toBeLessThan(-13);
      expect(under.low).toBeGreaterThan(-45);
      expect(over.right).toBeCloseTo(under.right);
      expect(over.right).toBeGreaterThan(10);
    }
  });
});
