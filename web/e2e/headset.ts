// SPDX-License-Identifier: Apache-2.0
// Simulates a user with an emulated headset: looks, points, pulls triggers, pinches, presses panels.

import { mkdirSync, writeFileSync } from "node:fs";
import path from "node:path";
import type { Browser, Tab } from "./browser.ts";
import { artifacts } from "./server.ts";
import type { IotaXR } from "../src/xr/debug.ts";

declare global {
  var iotaXR: IotaXR | undefined;
}

export type Side = "left" | "right";
type Point = readonly [number, number, number];
export type ButtonId = "trigger" | "squeeze" | "a-button" | "b-button" | "x-button" | "y-button";

export class HeadsetTab {
  readonly tab: Tab;

  constructor(tab: Tab) {
    this.tab = tab;
  }

  static async open(browser: Browser, url: string, options: { readonly shadows?: boolean } = {}): Promise<HeadsetTab> {
    return new HeadsetTab(await browser.open(`${url}&emulate=quest3`, options));
  }

  async enter(): Promise<void> {
    await this.tab.press("#enter-xr");
    // The button is there before the module that makes iotaXR has come.
    await this.tab.until("the session runs", () => globalThis.iotaXR?.presenting === true && globalThis.iotaXR.inputs().length === 2);
  }

  /** The result of a function of the page, after some frames. */
  async frames(count: number): Promise<void> {
    await this.tab.page.evaluate(async (frames) => {
      for (let frame = 0; frame < frames; frame++) await new Promise((resolve) => requestAnimationFrame(resolve));
    }, count);
  }

  /** Puts a controller or hand somewhere (reference space) and points its ray at a point of the same space. */
  async point(side: Side, at: Point, target: Point): Promise<void> {
    await this.tab.page.evaluate(([which, from, to]) => {
      const device = iotaXR!.device!;
      const length = Math.hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
      const [x, y, z] = [0, 1, 2].map((axis) => (to[axis] - from[axis]) / length);
      // The rotation that takes -z to the direction: half-way quaternion of (0, 0, -1) and it.
      const half = Math.hypot(y, -x, 1 - z);
      for (const part of [device.controllers[which], device.hands[which]]) {
        part?.position.set(from[0], from[1], from[2]);
        part?.quaternion.set(y / half, -x / half, 0, (1 - z) / half);
      }
    }, [side, at, target] as const);
    await this.frames(2);
  }

  /** The same, at a body of the world. */
  async pointAtBody(side: Side, at: Point, body: number): Promise<void> {
    const target = await this.tab.page.evaluate((id) => iotaXR!.toSpace(iota.bodyPosition(id)), body);
    await this.point(side, at, target);
  }

  async bodyInSpace(body: number): Promise<[number, number, number]> {
    return this.tab.page.evaluate((id) => iotaXR!.toSpace(iota.bodyPosition(id)), body);
  }

  async button(side: Side, id: ButtonId, value: number): Promise<void> {
    await this.tab.page.evaluate(([which, name, amount]) => iotaXR!.device!.controllers[which]!.updateButtonValue(name, amount), [side, id, value] as const);
    await this.frames(2);
  }

  async click(side: Side, id: ButtonId): Promise<void> {
    await this.button(side, id, 1);
    await this.button(side, id, 0);
  }

  async stick(side: Side, x: number, y: number): Promise<void> {
    await this.tab.page.evaluate(([which, right, down]) => iotaXR!.device!.controllers[which]!.updateAxes("thumbstick", right, down), [side, x, y] as const);
    await this.frames(2);
  }

  async pinch(side: Side, value: number): Promise<void> {
    await this.tab.page.evaluate(([which, amount]) => iotaXR!.device!.hands[which]!.updatePinchValue(amount), [side, value] as const);
    await this.frames(2);
  }

  async useHands(hands: boolean): Promise<void> {
    await this.tab.page.evaluate((wanted) => {
      iotaXR!.device!.primaryInputMode = wanted ? "hand" : "controller";
    }, hands);
    await this.tab.until("hands and controllers have changed over", (wanted) => {
      const inputs = iotaXR!.inputs();
      return inputs.length === 2 && inputs.every((input) => input.hand === wanted);
    }, hands);
  }

  /** Both eyes' views side by side, as drawn: taken from the canvas within a frame, which no busy compositor can delay. */
  async picture(name: string): Promise<void> {
    await this.tab.showing(async () => {
      const address = await this.tab.page.evaluate(() => new Promise<string>((resolve) => {
        requestAnimationFrame(() => resolve(iota.page.viewer.renderer.domElement.toDataURL("image/png")));
      }));
      mkdirSync(artifacts, { recursive: true });
      writeFileSync(path.join(artifacts, `${name}.png`), Buffer.from(address.slice(address.indexOf(",") + 1), "base64"));
    });
  }

  /** Turns the head: rad to the left, rad up. */
  async look(yaw: number, pitch: number): Promise<void> {
    await this.tab.page.evaluate(([left, up]) => {
      const [cy, sy, cp, sp] = [Math.cos(left / 2), Math.sin(left / 2), Math.cos(up / 2), Math.sin(up / 2)];
      iotaXR!.device!.quaternion.set(cy * sp, sy * cp, -sy * sp, cy * cp);
    }, [yaw, pitch] as const);
    await this.frames(2);
  }

  /** Turns the back of the left hand to the eyes and looks there, as at a watch. */
  async lookAtWrist(): Promise<void> {
    await this.tab.page.evaluate(() => {
      const { controllers, hands, position: head } = iotaXR!.device!;
      const from = { x: head.x - 0.2, y: head.y - 0.24, z: head.z - 0.38 };
      // The rotation that takes +y to the direction of the eyes, the half-way quaternion of both, after a quarter turn about +y: the
      // hand points to the right, as that of who reads a watch.
      const length = Math.hypot(0.2, 0.24, 0.38);
      const [x, y, z] = [0.2 / length, 0.24 / length, 0.38 / length];
      const half = Math.SQRT2 * Math.hypot(1 + y, x, z);
      const turn = iota.page.viewer.camera.quaternion.clone().set((z - x) / half, -(1 + y) / half, -(x + z) / half, (1 + y) / half);
      for (const part of [controllers.left, hands.left]) part?.position.set(from.x, from.y, from.z);
      controllers.left?.quaternion.set(turn.x, turn.y, turn.z, turn.w);
      // The ray of a bare hand is not along its wrist.
      const bare = iotaXR!.headset.inputs.find(({ source, joints }) => source.handedness === "left" && joints !== null);
      if (bare !== undefined) {
        const wrist = iota.page.viewer.camera.matrix.clone().fromArray(bare.joints!.matrices, 0);
        const [ofRay, ofWrist] = [bare.rayLocal, wrist].map((matrix) => turn.clone().setFromRotationMatrix(matrix));
        turn.multiply(ofWrist.invert().multiply(ofRay));
      }
      hands.left?.quaternion.set(turn.x, turn.y, turn.z, turn.w);
    });
    await this.look(0.3, -0.25);
    await this.tab.until("the panel is at the wrist", () => iotaXR!.panelButtons().some((name) => iotaXR!.panelButton(name) !== null));
  }

  /** Points a ray at a button of the wrist panel, which the user looks at. */
  async pointAtPanel(side: Side, at: Point, name: string): Promise<void> {
    await this.lookAtWrist();
    await this.tab.until(`the panel has a button ${name}`, (wanted) => iotaXR!.panelButton(wanted), name);
    // The panel eases to its place: point again where it has gone on.
    for (let trial = 0; trial < 50; trial++) {
      await this.frames(3);
      const button = await this.tab.page.evaluate((wanted) => iotaXR!.panelButton(wanted), name);
      if (button !== null) await this.point(side, at, button.at);
      if (await this.tab.page.evaluate((wanted) => iotaXR!.inputs().some((input) => input.panelButton === wanted), name)) return;
    }
    await this.tab.until(`the ray is on ${name}`, (wanted) => iotaXR!.inputs().some((input) => input.panelButton === wanted), name);
  }
}
