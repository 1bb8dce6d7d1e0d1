// SPDX-License-Identifier: Apache-2.0
import { expect, it } from "vitest";
import { startOfZero } from "../src/ui/plot.ts";

it("the line of zero begins beside a number that it would strike through, elsewhere at the edge", () => {
  const numbers = [{ at: 12, width: 30 }, { at: 92, width: 20 }];
  expect(startOfZero(50, numbers)).toBe(4);
  expect(startOfZero(8, numbers)).toBe(38);
  expect(startOfZero(91, numbers)).toBe(28);
  expect(startOfZero(94.5, numbers)).toBe(4);
});
