// SPDX-License-Identifier: Apache-2.0
import { expect, it } from "vitest";
import { written } from "../src/ui/panel.ts";

it.each([[5e-13, 1e-12, "5e-13"], [2.5e-5, 1e-4, "0.000025"], [0.3, 1, "0.3"], [1234567.8, 1e7, "1234568"], [1.234e29, 2e30, "1.234e+29"]])("the value %s of a slider over %s is written as %s", (value, span, text) => {
  expect(written(value, span)).toBe(text);
});
