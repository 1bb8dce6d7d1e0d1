// SPDX-License-Identifier: Apache-2.0
// Measures the cost of an edit on the page: `npm run bench`, after `npm run build`. A chain of 10 000 links is sent to
// the built page in a real browser, as by a server; then it is cut in the middle repeatedly, each time with two new
// bodies in place of one. Printed, not tested: the script time of one edit, from the arriving bytes to the additional
// work of the next frame.

import { BodyKind, encodeEntities, encodePoses, encodeServerMessage, NO_COLOR, PROTOCOL_VERSION, type EntityKind, type EntityRecords } from "../src/protocol/generated.ts";
import { preview } from "vite";
import { Browser } from "./browser.ts";

const links = 10_000;
const cuts = 20;
const limitMs = 4;

const kindNames = { visual: "visual", body: "body", membership: "membership" } as const;

function set<K extends EntityKind & keyof typeof kindNames>(kind: K, entities: readonly EntityRecords[K][]): number[] {
  return bytes(encodeServerMessage({ type: "entitiesSet", kind: kindNames[kind], records: encodeEntities(kind, entities) }));
}

function bytes(buffer: ArrayBuffer): number[] {
  return [...new Uint8Array(buffer)];
}

const id = (slot: number, generation = 1) => ({ slot, generation });
const link = (slot: number, generation = 1): EntityRecords["body"] => ({
  id: id(slot, generation), kind: BodyKind.dynamic, visual: 0, odd: slot % 2 === 1, length: 0.1, color: NO_COLOR, name: "",
});
const part = (style: string, kind: string, sizes: number[]) => ({
  style, shape: { kind, sizes: Float32Array.from(sizes), vertices: new Float32Array(0), triangles: new Uint32Array(0) },
  offset: [0, 0, 0] as [number, number, number], rotation: [0, 0, 0, 1] as [number, number, number, number], turn: 0, material: "steel", color: NO_COLOR,
});

/** All messages to a page that joins. */
const joining: number[][] = [
  bytes(encodeServerMessage({ type: "welcome", version: PROTOCOL_VERSION, world: "", client: 1 })),
  set("visual", [{ id: id(0), name: "link", parts: [part("rope", "capsule", [0.012, 0.1])] }]),
  set("body", Array.from({ length: links }, (_, slot) => link(slot))),
  set("membership", Array.from({ length: links }, (_, slot) => ({ id: id(slot), articulate: 0 }))),
  bytes(encodePoses({
    type: "poses", step: 1, time: 0, structureVersion: 1, keyframe: true, kinetic: 0, potential: 0, gap: 0,
    boxMin: [-1, 0, -1], boxMax: [1, 2, 1], farBodies: [], sparks: [], holds: [],
    bodies: Array.from({ length: links }, (_, body) => ({ body, x: (body * 653) % 65536, y: (body * 7919) % 65536, z: (body * 104729) % 65536, rotation: 0xe0080200 })),
  })),
];

/** Half of the chain gets another articulate; the link in the middle becomes two. */
function cut(number: number): number[][] {
  const middle = links / 2;
  return [
    bytes(encodeServerMessage({ type: "entitiesDestroyed", kind: "body", ids: [id(middle, number)] })),
    set("body", [link(middle, number + 1), link(links + number)]),
    set("membership", Array.from({ length: middle }, (_, slot) => ({ id: id(slot), articulate: number }))),
  ];
}

function summary(what: string, values: readonly number[]): string {
  const sorted = values.toSorted((a, b) => a - b);
  const at = (share: number) => sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))].toFixed(2);
  return `${what.padEnd(34)} median ${at(0.5)} ms, 90 % ${at(0.9)} ms, worst ${at(1)} ms`;
}

const server = await preview({ preview: { port: 0, host: "127.0.0.1" }, logLevel: "error" });
const browser = await Browser.start();
try {
  const page = await browser.context.newPage();
  await page.goto(server.resolvedUrls?.local[0] ?? "");
  await page.waitForFunction(() => globalThis.iota !== undefined);
  const result = await page.evaluate(({ join, edits }) => {
    const { session, world, viewer } = iota.page;
    const socket = session.connection as unknown as { receive_(data: ArrayBuffer): void };
    const receive = (messages: number[][]) => {
      const frames = messages.map((message) => new Uint8Array(message).buffer);
      const started = performance.now();
      for (const frame of frames) socket.receive_(frame);
      return performance.now() - started;
    };
    const update = () => {
      const started = performance.now();
      world.entities.body.update(0.016, started);
      world.entities.body.draw(0.016);
      return performance.now() - started;
    };
    const joinMs = receive(join);
    for (let frame = 0; frame < 20; frame++) update();
    const usual = Array.from({ length: 20 }, update).toSorted((a, b) => a - b)[10];
    const before = viewer.renderer.info.memory.geometries;
    const meshes = world.entities.body.root.children.length;
    const costs = edits.map((edit) => ({ receiving: receive(edit), additional: Math.max(0, update() - usual) }));
    return { joinMs, usual, costs, badFrames: session.connection.badFrames, remade: world.entities.body.root.children.length - meshes, geometries: viewer.renderer.info.memory.geometries - before };
  }, { join: joining, edits: Array.from({ length: cuts }, (_, number) => cut(number + 1)) });
  const whole = result.costs.map(({ receiving, additional }) => receiving + additional);
  console.log(`${links} bodies, ${cuts} cuts of the middle; limit ${limitMs} ms`);
  console.log(summary("receiving the messages", result.costs.map(({ receiving }) => receiving)));
  console.log(summary("additional time of the next frame", result.costs.map(({ additional }) => additional)));
  console.log(summary("one cut, total", whole));
  console.log(`joining ${result.joinMs.toFixed(1)} ms, a usual frame ${result.usual.toFixed(2)} ms, meshes made ${result.remade}, bad frames ${result.badFrames}`);
} finally {
  await browser.stop();
  await server.close();
}
