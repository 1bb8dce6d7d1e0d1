// SPDX-License-Identifier: Apache-2.0
// window.iota: the page seen from a browser's console and from tests. Documented in README.md.

import {
  BoxGeometry, BufferAttribute, BufferGeometry, CanvasTexture, Color, CylinderGeometry, Group, Matrix4, Mesh,
  MeshBasicMaterial, MeshStandardMaterial, Quaternion, SphereGeometry, Vector3,
} from "three";
import type { Page } from "../page/page.ts";
import type { Film } from "./film.ts";
import type { CustomClass } from "../scene/entities/custom.ts";

const three = {
  BoxGeometry, BufferAttribute, BufferGeometry, CanvasTexture, Color, CylinderGeometry, Group, Matrix4, Mesh,
  MeshBasicMaterial, MeshStandardMaterial, Quaternion, SphereGeometry, Vector3,
};

export interface IotaDebug {
  readonly clientId: number;
  readonly connected: boolean;
  readonly step: number;
  /** Simulated, s. */
  readonly time: number;
  readonly paused: boolean;
  readonly structureVersion: number;
  /** -1: none. */
  readonly selected: number;
  /** -1: none. */
  readonly held: number;
  readonly style: string;
  readonly styles: readonly string[];
  readonly frameMs: number;
  /** Time of our script in a frame, ms. */
  readonly scriptMs: number;
  readonly roundTripMs: number;
  /** Frames from the server that could not be read. */
  readonly badFrames: number;
  /** All holds of all clients in the server's last message; force in N. */
  holds(): { client: number; hold: number; body: number; force: number; target: number[] }[];
  clients(): { client: number; name: string; selected: number }[];
  articulates(): Map<number, number>;
  /** Slots that are drawn, without obstacles. */
  bodies(): number[];
  /** World, m, as drawn. */
  bodyPosition(body: number): [number, number, number];
  /** x y z w, as drawn. */
  bodyRotation(body: number): [number, number, number, number];
  /** css px of a body's origin; null behind the camera. */
  screenPosition(body: number): [number, number] | null;
  setStyle(style: string): void;
  select(body: number): void;
  /** Draws one frame and returns it as the address of a JPEG; afterwards the page draws only on this call. */
  filmFrame(): Promise<string>;
  /** For `iota record`: begins to draw the next frame of a film and returns the frame before, empty at first.
   * `plots`: with those of the script. The page itself is not shown any more. */
  nextFilmFrame(plots: boolean): Promise<string>;
  /** The frame that was begun last, empty without one. */
  lastFilmFrame(): string;
  /** The parts of the page, for the console and for modules of the script. */
  readonly page: Page;
  /** Defines a class of objects that the script makes with `Drawings.custom`; see README.md. */
  define(name: string, made: CustomClass): void;
  /** The parts of three.js that the page itself uses, so that a module of the script needs no copy of its own. */
  readonly three: typeof three;
}

declare global {
  interface Window {
    iota: IotaDebug;
  }
}

export function makeDebug(page: Page, canvas: HTMLCanvasElement): IotaDebug {
  const point = new Vector3();
  let film: Film | null = null;
  const { body: bodies, membership } = page.world.entities;
  /** Obstacles are of no articulate. */
  const isTied = (body: number) => membership.articulateOf(body) >= 0;
  const positionOf = (body: number): [number, number, number] => {
    if (!bodies.has(body)) throw new Error(`body ${body} is not drawn`);
    const { position } = page.world.poses;
    return [position[3 * body], position[3 * body + 1], position[3 * body + 2]];
  };
  return {
    page,
    three,
    get clientId() { return page.session.connection.clientId; },
    get connected() { return page.session.connection.connected; },
    get step() { return page.world.step; },
    get time() { return page.world.time; },
    get paused() { return page.world.paused; },
    get structureVersion() { return page.world.structureVersion; },
    get selected() { return page.selection.selected; },
    get held() { return page.selection.held; },
    get style() { return page.world.style; },
    get styles() { return page.world.settings.styles; },
    get frameMs() { return page.viewer.timing.frameMs; },
    get scriptMs() { return page.viewer.timing.scriptMs; },
    get roundTripMs() { return page.session.connection.roundTripMs; },
    get badFrames() { return page.session.connection.badFrames; },
    holds: () => page.world.holds.slice(0, page.world.holdCount).map((hold) => ({
      client: hold.client, hold: hold.hold, body: hold.body, force: hold.force, target: [...hold.target],
    })),
    clients: () => page.world.clients.map(({ client, name, selected }) => ({ client, name, selected: bodies.slotOf(selected) })),
    articulates: () => new Map([...bodies.slots()].filter(isTied).map((body) => [body, membership.articulateOf(body)])),
    bodies: () => [...bodies.slots()].filter((body) => bodies.has(body) && isTied(body)),
    bodyPosition: positionOf,
    bodyRotation: (body) => {
      positionOf(body);
      const { rotation } = page.world.poses;
      return [rotation[4 * body], rotation[4 * body + 1], rotation[4 * body + 2], rotation[4 * body + 3]];
    },
    screenPosition: (body) => {
      point.set(...positionOf(body));
      page.viewer.camera.updateMatrixWorld();
      point.project(page.viewer.camera);
      if (point.z > 1) return null;
      const box = canvas.getBoundingClientRect();
      return [box.left + ((point.x + 1) / 2) * box.width, box.top + ((1 - point.y) / 2) * box.height];
    },
    setStyle: (style) => page.world.setStyle(style),
    select: (body) => page.selection.select(body),
    define: (name, made) => void import("../scene/entities/custom.ts").then(({ defineClass }) => defineClass(name, made)),
    filmFrame: async () => (await import("../page/picture.ts")).takeFilmFrame(page),
    nextFilmFrame: async (plots) => {
      film ??= new (await import("./film.ts")).Film(page);
      return film.next(plots ? page.world.entities.plot.all() : []);
    },
    lastFilmFrame: () => film?.last() ?? "",
  };
}
