// SPDX-License-Identifier: Apache-2.0
// Writes the npm packages @iota/protocol, @iota/scene, @iota/xr and @iota/app, which other applications import:
// `npm run packages`, then `npm pack` in ../build/packages/NAME. The folders of src are divided among them; an import
// from a folder of another package becomes one of that package.

import { execFileSync } from "node:child_process";
import { copyFileSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import path from "node:path";

interface Package {
  readonly about: string;
  readonly folders: readonly string[];
  /** From npm; those that the application has as well are peers. */
  readonly needs: readonly string[];
}

const packages: Readonly<Record<string, Package>> = {
  protocol: { about: "messages of Iota's server, and the socket", folders: ["protocol", "net"], needs: [] },
  scene: {
    about: "draws a world of Iota with three.js, picks and grabs its bodies",
    folders: ["commands", "scene", "navigate", "interact", "world", "page", "embed"], needs: ["three", "three-mesh-bvh"],
  },
  xr: { about: "the headset of Iota's page", folders: ["xr"], needs: ["three", "iwer"] },
  app: { about: "Iota's page", folders: ["ui", "app"], needs: ["three"] },
};

const web = path.resolve(import.meta.dirname, "..");
const compiled = path.resolve(web, "..", "build", "packages", "compiled");
const { version, license, dependencies } = JSON.parse(readFileSync(path.join(web, "package.json"), "utf8")) as {
  version: string; license: string; dependencies: Readonly<Record<string, string>>;
};

function packageOf(folder: string): string {
  const found = Object.entries(packages).find(([, { folders }]) => folders.includes(folder));
  if (found === undefined) throw new Error(`no package has the folder src/${folder}`);
  return found[0];
}

/** `file` of a package, in `compiled`: the names of its imports within the packages, and the packages that it needs. */
function rewrite(name: string, file: string, needed: Set<string>): string {
  const text = readFileSync(file, "utf8");
  return text.replaceAll(/((?:from|import)\s*\(?\s*")(\.[^"]+)(")/g, (_all, before: string, target: string, after: string) => {
    // The compiler leaves .ts in declarations.
    const found = path.relative(path.join(compiled, "src"), path.resolve(path.dirname(file), target)).replace(/\.ts$/, ".js");
    const owner = packageOf(found.split(path.sep)[0]);
    if (owner !== name) {
      needed.add(owner);
      return `${before}@iota/${owner}/${found}${after}`;
    }
    const isIndex = path.dirname(file) === path.join(compiled, "packages");
    const from = isIndex ? "" : path.relative(path.join(compiled, "src"), path.dirname(file));
    const relative = path.relative(from, found);
    return `${before}${relative.startsWith(".") ? relative : `./${relative}`}${after}`;
  });
}

function write(name: string, { about, folders, needs }: Package): void {
  const target = path.join(path.dirname(compiled), name);
  rmSync(target, { recursive: true, force: true });
  mkdirSync(target, { recursive: true });
  const needed = new Set<string>();
  for (const folder of folders) {
    const from = path.join(compiled, "src", folder);
    for (const file of readdirSync(from, { recursive: true, encoding: "utf8" })) {
      if (!/\.(js|d\.ts)$/.test(file)) continue;
      mkdirSync(path.dirname(path.join(target, folder, file)), { recursive: true });
      writeFileSync(path.join(target, folder, file), rewrite(name, path.join(from, file), needed));
    }
    for (const file of readdirSync(path.join(web, "src", folder))) {
      if (file.endsWith(".css")) copyFileSync(path.join(web, "src", folder, file), path.join(target, folder, file));
    }
  }
  for (const ending of ["js", "d.ts"]) {
    writeFileSync(path.join(target, `index.${ending}`), rewrite(name, path.join(compiled, "packages", `${name}.${ending}`), needed));
  }
  if (name === "app") {
    const page = readFileSync(path.join(web, "index.html"), "utf8");
    writeFileSync(path.join(target, "page.html"), page.replaceAll(/\s*<(link|script)\b[^>]*\.\/[^>]*>(<\/script>)?/g, ""));
  }
  copyFileSync(path.join(web, "..", "LICENSE"), path.join(target, "LICENSE"));
  const versions = Object.fromEntries(needs.map((need) => [need, dependencies[need]]));
  const { three, ...others } = versions;
  writeFileSync(path.join(target, "package.json"), `${JSON.stringify({
    name: `@iota/${name}`, version, description: `${about[0].toUpperCase()}${about.slice(1)}.`, license, type: "module",
    exports: { ".": { types: "./index.d.ts", default: "./index.js" }, "./*": "./*" },
    ...(three === undefined ? {} : { peerDependencies: { three } }),
    dependencies: { ...others, ...Object.fromEntries([...needed].toSorted().map((owner) => [`@iota/${owner}`, version])) },
  }, null, 2)}\n`);
}

rmSync(compiled, { recursive: true, force: true });
execFileSync(process.execPath, [path.join(web, "node_modules", "typescript", "bin", "tsc"), "-p", path.join(web, "packages")], { stdio: "inherit" });
for (const [name, described] of Object.entries(packages)) write(name, described);
