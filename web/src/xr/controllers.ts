// SPDX-License-Identifier: Apache-2.0
// A simple model of a controller: handle, head with stick and two buttons, trigger that moves.

import {
  CapsuleGeometry, CylinderGeometry, Group, Mesh, MeshStandardMaterial, SphereGeometry, Vector3, type BufferGeometry, type Material,
} from "three";
import { RoundedBoxGeometry } from "three/examples/jsm/geometries/RoundedBoxGeometry.js";
import { palette } from "../scene/materials.ts";
import type { FaceButton, Input } from "./input.ts";

const shell = new MeshStandardMaterial({ color: "#3b4046", roughness: 0.55 });
const face = new MeshStandardMaterial({ color: "#23262a", roughness: 0.7 });
const knob = new MeshStandardMaterial({ color: "#d9d4ca", roughness: 0.5 });
/** Buttons with an action in this world have this color. */
const joins = new MeshStandardMaterial({ color: palette.calm, roughness: 0.45, emissive: palette.calm, emissiveIntensity: 0.25 });
const breaks = new MeshStandardMaterial({ color: palette.aboutToBreak, roughness: 0.45, emissive: palette.aboutToBreak, emissiveIntensity: 0.25 });

const up = new Vector3(0, 1, 0);
const pressDepth = 0.0012;

function part(parent: Group, geometry: BufferGeometry, material: Material, x: number, y: number, z: number): Mesh {
  const mesh = new Mesh(geometry, material);
  mesh.position.set(x, y, z);
  parent.add(mesh);
  return mesh;
}

/** Drawn in the frame of the target ray: -z ahead, the ray starts at the front of the head. */
export class ControllerView {
  readonly root = new Group();

  private readonly buttons_: Record<FaceButton, Mesh>;
  private readonly stick_ = new Group();
  private readonly trigger_ = new Group();
  private readonly buttonHeight_: number;

  constructor(handedness: XRHandedness) {
    // Buttons lie on the inner side: left of the stick on the right hand.
    const inner = handedness === "left" ? 1 : -1;
    this.root.matrixAutoUpdate = false;
    const handle = part(this.root, new CapsuleGeometry(0.0155, 0.07, 6, 16), shell, 0, -0.045, 0.075);
    handle.quaternion.setFromUnitVectors(up, new Vector3(0, 0.72, -0.69).normalize());
    const head = new Group();
    head.position.set(0, -0.008, 0.032);
    head.rotation.x = 0.42;
    this.root.add(head);
    const disc = part(head, new CylinderGeometry(0.0255, 0.021, 0.017, 32), shell, 0, 0, 0);
    disc.scale.z = 1.12;
    const top = part(head, new CylinderGeometry(0.0225, 0.0235, 0.003, 32), face, 0, 0.0092, 0);
    top.scale.z = 1.12;
    this.stick_.position.set(-inner * 0.0085, 0.0105, -0.003);
    head.add(this.stick_);
    part(this.stick_, new CylinderGeometry(0.0032, 0.0042, 0.008, 16), face, 0, 0.003, 0);
    const cap = part(this.stick_, new CylinderGeometry(0.0072, 0.0065, 0.003, 24), knob, 0, 0.0075, 0);
    cap.scale.y = 0.9;
    this.buttonHeight_ = 0.0115;
    const button = new CylinderGeometry(0.0041, 0.0041, 0.003, 20);
    this.buttons_ = {
      a: part(head, button, knob, inner * 0.0095, this.buttonHeight_, 0.0085),
      b: part(head, button, knob, inner * 0.0125, this.buttonHeight_, -0.003),
    };
    this.trigger_.position.set(0, -0.012, 0.018);
    this.root.add(this.trigger_);
    part(this.trigger_, new RoundedBoxGeometry(0.017, 0.021, 0.016, 3, 0.006), knob, 0, -0.012, -0.004);
    part(this.root, new SphereGeometry(0.0125, 20, 14), shell, 0, -0.009, 0.013);
  }

  /** Colors the face buttons that have an action of the script. */
  mark(onA: boolean, onB: boolean): void {
    this.buttons_.a.material = onA ? joins : knob;
    this.buttons_.b.material = onB ? breaks : knob;
  }

  update(input: Input): void {
    this.root.matrix.copy(input.rayLocal);
    const buttons = input.source.gamepad?.buttons;
    this.trigger_.rotation.x = -0.32 * (buttons?.[0]?.value ?? 0);
    this.stick_.rotation.set(-0.4 * input.stick.y, 0, -0.4 * input.stick.x);
    this.buttons_.a.position.y = this.buttonHeight_ - (buttons?.[4]?.pressed === true ? pressDepth : 0);
    this.buttons_.b.position.y = this.buttonHeight_ - (buttons?.[5]?.pressed === true ? pressDepth : 0);
  }
}
