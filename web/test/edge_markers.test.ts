// SPDX-License-Identifier: Apache-2.0
import { expect, it } from "vitest";
import { oneOfEach } from "../src/ui/edge_markers.ts";

it("of many things that have left the view, one of each direction has a marker", () => {
  const angles = [0.1, -3.1, 3.1, -0.1, 0, 1.6];
  expect(oneOfEach(angles, (angle) => angle)).toEqual([0.1, -3.1, 1.6]);
});
