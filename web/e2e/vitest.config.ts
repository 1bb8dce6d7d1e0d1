// SPDX-License-Identifier: Apache-2.0
import path from "node:path";
import { defineConfig } from "vitest/config";

// Two files at a time, in one browser: while one waits for its world, the other computes. Files of a worker share its modules, as loading
// them anew for each file takes two thirds of a second of processor time.
export default defineConfig({
  root: path.resolve(import.meta.dirname, ".."),
  test: {
    include: ["e2e/**/*.test.ts"], globalSetup: "e2e/shared_browser.ts", maxWorkers: 2, isolate: false, testTimeout: 120_000, hookTimeout: 240_000,
    // The usual second is too short for a busy machine. Limits end what hangs; a test with a shorter one of its own fails by load.
    expect: { poll: { timeout: 60_000, interval: 50 } },
  },
});
