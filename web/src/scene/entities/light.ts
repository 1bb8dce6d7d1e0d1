// SPDX-License-Identifier: Apache-2.0
// Lamps of the script, besides those of the stage. A change of their number compiles all materials anew, so lamps that are gone stay
// dark until others need them.

import { Color, DirectionalLight, Group, PointLight, SpotLight, Vector3 } from "three";
import { LightKind, type LightEntity } from "../../protocol/generated.ts";
import { placeOf } from "../anchors.ts";
import { textOf } from "../parts.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import type { EntityView } from "./entity.ts";

/** The irradiance of the page's own lamp, as in `stage.ts`, in the units of three.js. */
const usual = 3.2;
/** Dark ones beyond this number are given up; the script may have as many bright ones. */
const mostLamps = 8;
const shadowPixels = 1024;

type Lamp = PointLight | SpotLight | DirectionalLight;

export class LightView implements EntityView<LightEntity> {
  readonly root = new Group();

  private readonly poses_: PoseBuffer;
  private readonly size_: () => number;
  private readonly lit_ = new Map<number, { readonly entity: LightEntity; readonly lamp: Lamp }>();
  private readonly dark_: Lamp[] = [];
  private readonly down_ = new Vector3();
  private readonly color_ = new Color();

  /** `size`: half the diagonal of the scene, m. */
  constructor(poses: PoseBuffer, size: () => number) {
    this.poses_ = poses;
    this.size_ = size;
  }

  create(entity: LightEntity): void {
    const { kind, shadow, color } = entity;
    const found = this.dark_.findIndex((lamp) => lamp.castShadow === shadow && kindOf(lamp) === kind);
    const lamp = found < 0 ? this.make_(kind, shadow) : this.dark_.splice(found, 1)[0];
    lamp.color.copy(this.color_.set(textOf(color) ?? "#ffffff"));
    this.lit_.set(entity.id.slot, { entity, lamp });
  }

  change(entity: LightEntity): void {
    this.destroy(entity.id.slot);
    this.create(entity);
  }

  destroy(slot: number): void {
    const known = this.lit_.get(slot);
    if (known === undefined) return;
    this.lit_.delete(slot);
    known.lamp.intensity = 0;
    this.dark_.push(known.lamp);
    while (this.lit_.size + this.dark_.length > mostLamps && this.dark_.length > 0) {
      const lamp = this.dark_.shift()!;
      this.root.remove(lamp, ...("target" in lamp ? [lamp.target] : []));
      lamp.dispose();
    }
  }

  draw(): void {
    for (const { entity, lamp } of this.lit_.values()) this.place_(entity, lamp);
  }

  private place_({ at, to, intensity, reach, angle }: LightEntity, lamp: Lamp): void {
    const size = this.size_();
    const distance = reach > 0 ? reach : size;
    const known = placeOf(this.poses_, at, lamp.position);
    // A point or spot is brighter the nearer a thing is; the sun is everywhere the same.
    const bright = intensity * usual * (lamp instanceof DirectionalLight ? 1 : distance ** 2);
    lamp.intensity = known ? bright : 0;
    if (lamp instanceof PointLight) return;
    const target = lamp.target.position;
    if (!placeOf(this.poses_, to, target)) lamp.intensity = 0;
    // Without another place it points down.
    if (target.distanceTo(lamp.position) < 1e-6 * size) target.copy(lamp.position).add(this.down_.set(0, -distance, 0));
    if (lamp instanceof SpotLight) lamp.angle = angle;
    else this.spread_(lamp, size);
    if (lamp.castShadow) shadowOf(lamp, size);
  }

  /** The sun is far away: its box of shadows is around its target, as large as the scene. */
  private spread_({ position, target, shadow: { camera } }: DirectionalLight, size: number): void {
    this.down_.subVectors(position, target.position).setLength(3 * size);
    position.addVectors(target.position, this.down_);
    camera.left = camera.bottom = -1.5 * size;
    camera.right = camera.top = 1.5 * size;
  }

  private make_(kind: LightKind, shadow: boolean): Lamp {
    const lamp = kind === LightKind.point ? new PointLight() : kind === LightKind.spot ? new SpotLight() : new DirectionalLight();
    if (lamp instanceof SpotLight) lamp.penumbra = 0.3;
    lamp.castShadow = shadow;
    lamp.shadow.mapSize.set(shadowPixels, shadowPixels);
    lamp.shadow.radius = 3;
    lamp.shadow.bias = -0.0005;
    this.root.add(lamp, ...("target" in lamp ? [lamp.target] : []));
    return lamp;
  }
}

function kindOf(lamp: Lamp): LightKind {
  return lamp instanceof PointLight ? LightKind.point : lamp instanceof SpotLight ? LightKind.spot : LightKind.sun;
}

function shadowOf({ shadow }: SpotLight | DirectionalLight, size: number): void {
  const { camera } = shadow;
  const [near, far] = [0.02 * size, 6 * size];
  shadow.normalBias = 0.004 * size;
  if (camera.near === near && camera.far === far) return;
  camera.near = near;
  camera.far = far;
  camera.updateProjectionMatrix();
}
