// SPDX-License-Identifier: Apache-2.0
// window.iotaXR: the headset seen from a browser's console and from tests. Documented in README.md.

import { Vector3 } from "three";
import type { XRDevice } from "iwer";
import type { Page } from "../page/page.ts";
import type { Headset } from "./headset.ts";

export interface IotaXR {
  /** The emulated headset; null with a real one. Its space is the page's reference space. */
  readonly device: XRDevice | null;
  readonly presenting: boolean;
  enter(): Promise<void>;
  leave(): Promise<void>;
  /** The pose of the user's space in the world: m, rad about y, and meters of the world in one of the user's. */
  rig(): { position: [number, number, number]; yaw: number; scale: number };
  /** World, m. */
  head(): [number, number, number];
  /** State of each hand; bodies are -1 for none; `force` is what is written above it. */
  inputs(): { name: string; hand: boolean; hovered: number; held: number; near: boolean; panelButton: string; force: string }[];
  /** Names of the wrist panel's buttons. */
  panelButtons(): string[];
  /** Middle of a button in the reference space, m, and the direction it faces; null while the panel is hidden. */
  panelButton(name: string): { at: [number, number, number]; facing: [number, number, number] } | null;
  /** Titles of the shown cards. */
  cards(): string[];
  /** Target of a teleport, world, m; null: none. */
  landing(): [number, number, number] | null;
  /** A point of the world in the reference space, m. */
  toSpace(point: readonly number[]): [number, number, number];
  readonly headset: Headset;
}

declare global {
  interface Window {
    iotaXR?: IotaXR;
  }
}

export function makeXrDebug({ viewer }: Pick<Page, "viewer">, headset: Headset, device: XRDevice | null): IotaXR {
  const { rig, room } = viewer;
  const { panel, locomotion } = headset;
  return {
    device,
    headset,
    get presenting() { return headset.presenting; },
    enter: () => headset.enter(),
    leave: () => headset.leave(),
    rig: () => ({ position: rig.position.toArray(), yaw: rig.rotation.y, scale: room.scale.x }),
    head: () => headset.head.toArray(),
    inputs: () => headset.inputs.map((input) => ({
      name: input.pointer.name,
      hand: input.isHand,
      hovered: input.pointer.hovered,
      held: input.pointer.grab?.body ?? -1,
      near: input.pointer.near,
      force: headset.forceText(input),
      panelButton: input.board === panel.board && input.button >= 0 ? panel.layout.buttons[input.button].command.name : "",
    })),
    panelButtons: () => panel.layout.buttons.map((button) => button.command.name),
    panelButton: (name) => {
      const { board, layout } = panel;
      const button = layout.buttons.find((entry) => entry.command.name === name);
      if (button === undefined || !board.ready) return null;
      const at = new Vector3(
        (button.x + button.width / 2) / board.density - board.width / 2, board.height / 2 - (button.y + button.height / 2) / board.density, 0,
      ).applyMatrix4(board.mesh.matrix);
      return { at: at.toArray(), facing: new Vector3().setFromMatrixColumn(board.mesh.matrix, 2).toArray() };
    },
    cards: () => headset.notices.titles,
    landing: () => (locomotion.aiming !== null && locomotion.arc.valid ? [locomotion.arc.landing[0], locomotion.arc.landing[1], locomotion.arc.landing[2]] : null),
    toSpace: (point) => {
      rig.updateMatrixWorld();
      return room.worldToLocal(new Vector3(point[0], point[1], point[2])).toArray();
    },
  };
}
