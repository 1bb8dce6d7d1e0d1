// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from "vitest";
import { Strokes } from "../src/scene/strokes.ts";

describe("strokes", () => {
  it("have the renderer look at them anew when there is room for more, or it draws no more than before", () => {
    const strokes = new Strokes();
    let seen = strokes.mesh.geometry.getAttribute("from").count;
    strokes.mesh.geometry.addEventListener("dispose", () => { seen = Infinity; });
    for (let index = 0; index < 40; index++) strokes.add(0, 0, 0, 1, 0, index, 0, 0, 0);
    expect(strokes.count).toBe(40);
    expect(strokes.count).toBeLessThanOrEqual(seen);
    expect(strokes.mesh.geometry.getAttribute("from").count).toBeGreaterThanOrEqual(40);
  });
});
