// SPDX-License-Identifier: Apache-2.0
// Another application with the npm packages, outside of this repository: a three.js scene of its own that shows a world,
// and Iota's page as a part of it. `npm run packages`, `npm pack` and Vite make it; iota.Server serves it.

import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { Browser, small } from "./browser.ts";
import { freePort, WorldServer } from "./server.ts";

const web = path.resolve(import.meta.dirname, "..");
const names = ["protocol", "scene", "xr", "app"];

const sceneSource = `
import { EmbeddedWorld } from "@iota/scene";
import { PROTOCOL_VERSION } from "@iota/protocol";
import { BoxGeometry, DirectionalLight, HemisphereLight, Mesh, MeshStandardMaterial, PerspectiveCamera, Raycaster, Scene, Vector2, WebGLRenderer } from "three";

const renderer = new WebGLRenderer({ preserveDrawingBuffer: true });
renderer.setSize(innerWidth, innerHeight);
document.body.append(renderer.domElement);
const scene = new Scene();
const camera = new PerspectiveCamera(50, innerWidth / innerHeight, 0.05, 100);
camera.position.set(0, 1.2, 4);
camera.lookAt(0, 1.2, 0);
const box = new Mesh(new BoxGeometry(0.3, 0.3, 0.3), new MeshStandardMaterial({ color: "#00c000" }));
box.position.set(-1.5, 1.2, 0);
scene.add(box, new HemisphereLight("#ffffff", "#808080", 2), new DirectionalLight("#ffffff", 2));

const url = new URL("ws" + location.search, document.baseURI);
url.protocol = "ws:";
const notices: string[] = [];
const world = new EmbeddedWorld(url.href, { name: "another application", notice: ({ title }) => notices.push(title) });
scene.add(world.root);
let last = performance.now();
renderer.setAnimationLoop((now: number) => {
  world.update((now - last) / 1000, camera);
  last = now;
  renderer.render(scene, camera);
});

const caster = new Raycaster();
const other = {
  world, notices, version: PROTOCOL_VERSION,
  pickAt(x: number, y: number) {
    caster.setFromCamera(new Vector2(x, y), camera);
    return world.pick(caster.ray);
  },
  pixel(place: readonly [number, number, number]) {
    const at = box.position.clone().set(...place).project(camera);
    const { width, height } = renderer.domElement;
    const x = Math.round(((at.x + 1) / 2) * width), y = Math.round(((at.y + 1) / 2) * height);
    const rgba = new Uint8Array(4);
    const gl = renderer.getContext();
    gl.readPixels(x, y, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
    return [...rgba];
  },
};
declare global { var other: unknown }
globalThis.other = other;
`;

interface Other {
  readonly world: {
    readonly world: { readonly time: number; readonly holdCount: number; readonly clients: readonly { name: string }[]; readonly entities: { readonly body: { readonly pickableCount: number } } };
    pick(ray: unknown): { body: number; point: [number, number, number] } | null;
    grab(picked: unknown): { move(target: readonly [number, number, number]): void; end(): void };
    placeOf(body: number): [number, number, number];
    act(name: string, body?: number): void;
  };
  readonly notices: string[];
  pickAt(x: number, y: number): { body: number; point: [number, number, number] } | null;
  pixel(place: readonly number[]): number[];
}

declare global {
  var other: Other;
}

let folder = "";
let server: WorldServer;
let browser: Browser;

beforeAll(async () => {
  folder = mkdtempSync(path.join(tmpdir(), "iota-other-"));
  const environment = { ...process.env, PATH: `${path.resolve(web, "..", ".venv", "bin")}:${process.env["PATH"]}` };
  const run = (where: string, program: string, ...words: string[]) => execFileSync(program, words, { cwd: where, encoding: "utf8", stdio: "pipe", env: environment });
  run(web, "npm", "run", "packages");
  mkdirSync(path.join(folder, "node_modules", "@iota"), { recursive: true });
  for (const name of names) {
    const packed = run(path.resolve(web, "..", "build", "packages", name), "npm", "pack", "--pack-destination", folder).trim().split("\n").at(-1)!;
    // As npm would, which wants to ask its registry for the others.
    const target = path.join(folder, "node_modules", "@iota", name);
    mkdirSync(target);
    run(folder, "tar", "-xzf", packed, "-C", target, "--strip-components=1");
  }
  for (const name of ["three", "three-mesh-bvh", "iwer", "@types", "vite"]) symlinkSync(path.join(web, "node_modules", name), path.join(folder, "node_modules", name));
  const document = (body: string) => `<!doctype html><html lang="en"><head><meta charset="utf-8"><title>other</title></head><body style="margin:0">${body}</body></html>`;
  writeFileSync(path.join(folder, "package.json"), JSON.stringify({ name: "other", private: true, type: "module" }));
  writeFileSync(path.join(folder, "index.html"), document('<script type="module" src="./other.ts"></script>'));
  writeFileSync(path.join(folder, "other.ts"), sceneSource);
  const page = readFileSync(path.join(folder, "node_modules", "@iota", "app", "page.html"), "utf8");
  writeFileSync(path.join(folder, "page.html"), page.replace("</body>", '<script type="module">import "@iota/app";</script></body>'));
  writeFileSync(path.join(folder, "vite.config.js"), 'export default { base: "./", build: { target: "es2022", assetsInlineLimit: 0, modulePreload: { polyfill: false }, rolldownOptions: { input: ["index.html", "page.html"] } } };');
  run(folder, process.execPath, path.join(web, "node_modules", "vite", "bin", "vite.js"), "build");
  server = await WorldServer.start(["web/e2e/packages_probe.py"], await freePort(), undefined, { IOTA_PAGE_FOLDER: path.join(folder, "dist") });
  browser = await Browser.start({ ...small, draws: "always" });
});

afterAll(async () => {
  await browser?.stop();
  await server?.stop();
  if (folder !== "") rmSync(folder, { recursive: true, force: true });
});

describe("another application", () => {
  it("is checked by the compiler against the packages' types", () => {
    writeFileSync(path.join(folder, "tsconfig.json"), JSON.stringify({
      compilerOptions: { strict: true, noEmit: true, target: "ES2022", module: "ESNext", moduleResolution: "bundler", lib: ["ES2023", "DOM", "DOM.Iterable"], types: ["webxr"] },
      files: ["other.ts"],
    }));
    const check = () => execFileSync(process.execPath, [path.join(web, "node_modules", "typescript", "bin", "tsc"), "-p", folder], { encoding: "utf8" });
    expect(check()).toBe("");
    writeFileSync(path.join(folder, "other.ts"), sceneSource.replace("world.pick(caster.ray)", 'world.pick("no ray")'));
    expect(check).toThrow();
  });

  it("shows a world in its own scene, takes hold of a body, and runs an action", async () => {
    const page = await browser.context.newPage();
    const complaints: string[] = [];
    page.on("pageerror", (error) => complaints.push(String(error)));
    await page.goto(server.url);
    await page.waitForFunction(() => globalThis.other?.world.world.entities.body.pickableCount === 2 && other.world.world.time > 0.2);
    expect(await page.evaluate(() => other.world.world.clients.map(({ name }) => name))).toEqual(["another application"]);
    // Its own box is green, the red ball is where the world says.
    await page.waitForFunction(() => {
      const [r, g] = other.pixel([-1.5, 1.2, 0]);
      return g > 60 && g > 2 * r;
    });
    await page.waitForFunction(() => {
      const ball = [0, 1].find((body) => other.world.placeOf(body)[1] > 1)!;
      const [r, g] = other.pixel(other.world.placeOf(ball));
      return r > 60 && r > 2 * g;
    });
    const held = await page.evaluate(() => {
      const picked = other.pickAt(0, 0);
      if (picked === null) return null;
      other.world.grab(picked).move([0.8, picked.point[1], 0]);
      return picked.body;
    });
    expect(held).not.toBeNull();
    await page.waitForFunction((body) => other.world.world.holdCount === 1 && other.world.placeOf(body!)[0] > 0.3, held);
    await page.evaluate(() => other.world.act("hail"));
    await expect.poll(() => server.output).toContain("hailed");
    await page.evaluate(() => other.world.act("none"));
    await page.waitForFunction(() => other.notices.includes("Unknown action"));
    expect(complaints).toEqual([]);
    await page.close();
  });

  it("has Iota's page as a part, with its headset", async () => {
    const tab = await browser.open(`${server.url.replace("/?", "/page.html?")}&emulate=quest3`);
    expect(await tab.page.evaluate(() => iota.bodies().length)).toBe(2);
    await tab.press("#enter-xr");
    await tab.until("the session runs", () => globalThis.iotaXR?.presenting);
    expect(tab.complaints).toEqual([]);
    await tab.page.close();
  });
});
