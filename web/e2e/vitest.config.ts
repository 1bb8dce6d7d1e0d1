// SPDX-License-Identifier: Apache-2.0
import path from "node:path";
import { defineConfig } from "vitest/config";

// One browser and one server at a time, since software rendering needs all of the few cores.
export default defineConfig({
  root: path.resolve(import.meta.dirname, ".."),
  test: {
    include: ["e2e/**/*.test.ts"], fileParallelism: false, testTimeout: 120_000, hookTimeout: 240_000,
    // The usual second is too short for a busy machine.
    expect: { poll: { timeout: 30_000, interval: 50 } },
  },
});
