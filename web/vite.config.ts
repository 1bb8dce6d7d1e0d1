// SPDX-License-Identifier: Apache-2.0
import { defineConfig } from "vitest/config";

// base "./": the page is served from any folder of the Python package.
// No inlined assets: the server sends a content security policy without data: or inline sources.
export default defineConfig({
  base: "./",
  build: {
    outDir: "dist",
    emptyOutDir: true,
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1200,
    // The minifier drops notices: the texts of everything that was bundled go along in a file of their own.
    license: { fileName: "licenses.txt" },
  },
  test: { include: ["test/**/*.test.ts"] },
});
