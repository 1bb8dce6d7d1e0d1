// SPDX-License-Identifier: Apache-2.0
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { brotliCompressSync, constants, gzipSync } from "node:zlib";
import { build } from "vite";
import { defineConfig } from "vitest/config";
import { withoutUnusedShaders } from "./unused_shaders.ts";

/** Puts compressed copies beside the files, which the server sends to browsers that take them. */
function compressed() {
  let folder = "";
  return {
    name: "compressed",
    apply: "build" as const,
    configResolved: ({ root, build }: { root: string; build: { outDir: string } }) => {
      folder = path.resolve(root, build.outDir);
    },
    closeBundle: () => {
      for (const file of readdirSync(folder, { recursive: true, encoding: "utf8" })) {
        if (!/\.(js|css|html|svg|txt)$/.test(file) || file.startsWith("player")) continue;
        const bytes = readFileSync(path.join(folder, file));
        const quality = { params: { [constants.BROTLI_PARAM_QUALITY]: 11, [constants.BROTLI_PARAM_SIZE_HINT]: bytes.length } };
        for (const [ending, copy] of [[".br", brotliCompressSync(bytes, quality)], [".gz", gzipSync(bytes, { level: 9 })]] as const) {
          if (copy.length < 0.9 * bytes.length) writeFileSync(path.join(folder, file + ending), copy);
        }
      }
    },
  };
}

/** Puts what all pages have in their heads into each. */
function commonHead() {
  const head = readFileSync(new URL("head.html", import.meta.url), "utf8").trim().split("\n").slice(1);
  return {
    name: "common-head",
    transformIndexHtml: {
      order: "pre" as const,
      handler: (html: string) => html.replace("<head>\n", `<head>\n${head.map((line) => `  ${line}\n`).join("")}`),
    },
  };
}

function withoutShaders() {
  return {
    name: "without-unused-shaders",
    apply: "build" as const,
    transform: (code: string, id: string) => {
      if (id.includes("three.module")) return withoutUnusedShaders(code);
      // The minifier leaves comments in shaders, which are strings.
      return id.includes("/src/scene/") ? code.replace(/^ *\/\/ .*\n/gm, "") : undefined;
    },
  };
}

/** The player of recordings as one script and one style sheet, which `iota record` puts into a file that needs no server. */
function player() {
  let folder = "";
  return {
    name: "player",
    apply: "build" as const,
    configResolved: ({ root, build }: { root: string; build: { outDir: string } }) => {
      folder = path.resolve(root, build.outDir, "player");
    },
    closeBundle: async () => {
      await build({
        configFile: false,
        logLevel: "warn",
        plugins: [withoutShaders()],
        build: {
          outDir: folder,
          target: "es2022",
          copyPublicDir: false,
          chunkSizeWarningLimit: 1200,
          lib: { entry: "src/player/player.ts", formats: ["iife"], name: "iotaPlayer", fileName: () => "player.js", cssFileName: "player" },
        },
      });
    },
  };
}

// base "./": the page is served from any folder of the Python package.
// No inlined assets: the server sends a content security policy without data: or inline sources.
export default defineConfig({
  base: "./",
  plugins: [commonHead(), withoutShaders(), player(), compressed()],
  build: {
    outDir: "dist",
    emptyOutDir: true,
    target: "es2022",
    assetsInlineLimit: 0,
    // What is imported later needs nothing that is not there by then, but its styles: a list of it would be a part of the first chunk.
    modulePreload: { polyfill: false, resolveDependencies: (_, files, { hostType }) => (hostType === "html" ? files : files.filter((file) => file.endsWith(".css"))) },
    chunkSizeWarningLimit: 1200,
    // The minifier drops notices: the license texts of all bundled packages are in a separate file.
    rolldownOptions: {
      input: ["index.html", "gallery.html", "rooms.html", "enter.html"],
      // Parts that are loaded later share three.js and picking with the page: one file, as each costs a header of its own.
      output: { codeSplitting: { groups: [
        { name: "shared", test: /node_modules\/three\/|src\/interact\/picking/ },
        // The other pages need these too, but not three.js.
        { name: "small", test: /src\/(net\/token|ui\/dom)/ },
      ] } },
    },
    license: { fileName: "licenses.txt" },
  },
  // A busy machine may need longer than the usual 5 s.
  test: { include: ["test/**/*.test.ts"], testTimeout: 60_000 },
});
