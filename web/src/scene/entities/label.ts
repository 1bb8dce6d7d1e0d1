// SPDX-License-Identifier: Apache-2.0
// Labels: text on a small plate that faces the viewer. Those without a height have a constant size on the screen, are in
// front of everything else, and are lifted where they would cover each other.

import { CanvasTexture, Group, Sprite, SpriteMaterial, SRGBColorSpace, Vector3, type PerspectiveCamera } from "three";
import type { LabelEntity } from "../../protocol/generated.ts";
import { moves, placeOf } from "../anchors.ts";
import { liftApart, upAt, type Plate } from "../label_layout.ts";
import type { Points } from "../points.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import { noColor } from "../strokes.ts";
import type { EntityView } from "./entity.ts";

/** px of the drawn text. */
const fontSize = 44;
const padding = { x: 22, y: 12 };
/** The height of a plate with one line; each further line adds `lineHeight`. */
const plateHeight = fontSize + 2 * padding.y;
const lineHeight = 1.15 * fontSize;
const mostWidth = 2048;
/** Height of a capital, relative to that of the plate. */
const capital = (0.72 * fontSize) / plateHeight;
/** Height of a line's plate at a distance of 1 m, m; less in a narrow window. */
const usualHeight = 0.036;
const font = `600 ${fontSize}px system-ui, sans-serif`;

interface Label {
  entity: LabelEntity;
  readonly sprite: Sprite;
  readonly canvas: HTMLCanvasElement;
  texture: CanvasTexture | null;
  /** As it is laid out, if it has a constant size. */
  readonly plate: Plate;
  /** Drawn lift, which follows that of the plate. */
  lift: number;
}

const liftSeconds = 0.08;

export class LabelView implements EntityView<LabelEntity> {
  readonly root = new Group();

  private readonly poses_: PoseBuffer;
  private readonly eye_: Vector3;
  private readonly labels_ = new Map<number, Label>();
  private readonly b_ = new Vector3();
  private readonly place_ = new Vector3();
  private readonly plates_: Plate[] = [];

  /** `eye`: place of the viewer, world, m; kept up to date by its owner. */
  constructor(poses: PoseBuffer, eye: Vector3) {
    this.poses_ = poses;
    this.eye_ = eye;
  }

  /** Text of a label; undefined if there is none. */
  textOf(slot: number): string | undefined {
    return this.labels_.get(slot)?.entity.text;
  }

  create(entity: LabelEntity): void {
    const material = new SpriteMaterial({ transparent: true, toneMapped: false, fog: false, depthWrite: false });
    const label: Label = { entity, sprite: new Sprite(material), canvas: document.createElement("canvas"), texture: null, plate: { direction: new Vector3(), width: 0, height: 0, lift: 0 }, lift: 0 };
    this.labels_.set(entity.id.slot, label);
    this.root.add(label.sprite);
    paint(label);
  }

  change(entity: LabelEntity): void {
    const label = this.labels_.get(entity.id.slot);
    if (label === undefined) return;
    const { text, color } = label.entity;
    label.entity = entity;
    if (text !== entity.text || color !== entity.color) paint(label);
  }

  destroy(slot: number): void {
    const label = this.labels_.get(slot);
    if (label === undefined) return;
    this.labels_.delete(slot);
    label.sprite.removeFromParent();
    label.sprite.material.dispose();
    label.texture?.dispose();
  }

  /** The places of labels, and their sizes at a distance of 1 (0 for those with a height of their own). `moving`: of those on bodies, or of all others. */
  forEachPlate(moving: boolean, visit: (place: Vector3, width: number, height: number) => void): void {
    for (const { entity, canvas } of this.labels_.values()) {
      if (canvas.width === 0 || moves(entity.a) !== moving) continue;
      const usual = entity.height > 0 ? 0 : this.usual_ / plateHeight;
      if (this.placeOf_(entity, this.place_)) visit(this.place_, usual * canvas.width, usual * canvas.height);
    }
  }

  /** The places of all on the screen of a camera, css px. */
  forEachBox(camera: PerspectiveCamera, visit: (left: number, top: number, width: number, height: number) => void): void {
    for (const { sprite } of this.labels_.values()) {
      if (!sprite.visible) continue;
      const seen = this.place_.copy(sprite.position).applyMatrix4(camera.matrixWorldInverse);
      const pixels = innerHeight * camera.projectionMatrix.elements[5] / (-2 * seen.z);
      if (!(seen.z < 0)) continue;
      const { x, y } = seen.applyMatrix4(camera.projectionMatrix);
      const [width, height] = [sprite.scale.x * pixels, sprite.scale.y * pixels];
      visit(((1 + x) * innerWidth - width) / 2, ((1 - y) * innerHeight - height) / 2, width, height);
    }
  }

  /** Corners of those with a height. */
  addPlaces(points: Points): void {
    for (const { entity: { height }, sprite: { position, scale, visible } } of this.labels_.values()) {
      if (height <= 0 || !visible) continue;
      const away = this.b_.subVectors(this.eye_, position);
      const level = Math.hypot(away.x, away.z) || 1;
      const [x, z] = [(away.z / level) * scale.x / 2, (-away.x / level) * scale.x / 2];
      for (const side of [-1, 1]) {
        for (const y of [-scale.y / 2, scale.y / 2]) points.add(position.x + side * x, position.y + y, position.z + side * z);
      }
    }
  }

  draw(seconds: number): void {
    const { plates_: plates, eye_: eye, usual_: usual } = this;
    plates.length = 0;
    for (const { entity, sprite, canvas, plate } of this.labels_.values()) {
      const { position } = sprite;
      const { height } = entity;
      sprite.visible = canvas.width > 0 && this.placeOf_(entity, position);
      if (!sprite.visible) continue;
      const away = position.distanceTo(eye);
      const line = height > 0 ? height / capital : usual * away;
      sprite.scale.set((line * canvas.width) / plateHeight, (line * canvas.height) / plateHeight, 1);
      sprite.material.depthTest = height > 0;
      sprite.renderOrder = height > 0 ? 0 : 10;
      if (height > 0 || !(away > 0)) continue;
      plate.direction.subVectors(position, eye).divideScalar(away);
      plate.width = sprite.scale.x / away;
      plate.height = sprite.scale.y / away;
      plates.push(plate);
    }
    liftApart(plates);
    const share = Math.min(1, seconds / liftSeconds);
    for (const label of this.labels_.values()) {
      if (!label.sprite.visible || label.entity.height > 0) continue;
      label.lift += share * (label.plate.lift - label.lift);
      const { position } = label.sprite;
      position.addScaledVector(upAt(label.plate.direction, this.b_), label.lift * position.distanceTo(eye));
    }
  }

  /** Height of a line's plate at a distance of 1 m, m, in this window. */
  private get usual_(): number {
    return usualHeight * Math.min(1, (1.2 * innerWidth) / innerHeight);
  }

  /** False if what it is on has no pose yet. */
  private placeOf_({ a, b, offset }: LabelEntity, out: Vector3): boolean {
    if (!placeOf(this.poses_, a, out) || !placeOf(this.poses_, b, this.b_)) return false;
    out.add(this.b_).multiplyScalar(0.5);
    out.x += offset[0];
    out.y += offset[1];
    out.z += offset[2];
    return true;
  }
}

function paint(label: Label): void {
  const { canvas, entity: { text, color }, sprite } = label;
  const context = canvas.getContext("2d");
  if (context === null) return;
  context.font = font;
  const lines = text.split("\n");
  const widest = Math.max(...lines.map((line) => context.measureText(line).width));
  const width = Math.min(Math.ceil(widest) + 2 * padding.x, mostWidth);
  const height = Math.ceil(plateHeight + lineHeight * (lines.length - 1));
  if (canvas.width !== width || canvas.height !== height || label.texture === null) {
    canvas.width = width;
    canvas.height = height;
    // A texture cannot change its size.
    label.texture?.dispose();
    label.texture = new CanvasTexture(canvas);
    label.texture.colorSpace = SRGBColorSpace;
    sprite.material.map = label.texture;
    sprite.material.needsUpdate = true;
  }
  context.clearRect(0, 0, width, height);
  if (text !== "") {
    context.fillStyle = "rgba(250, 248, 243, 0.86)";
    context.beginPath();
    context.roundRect(1, 1, width - 2, height - 2, plateHeight / 2);
    context.fill();
    context.fillStyle = color === noColor ? "#23272b" : `#${color.toString(16).padStart(6, "0")}`;
    context.font = font;
    context.textAlign = "center";
    context.textBaseline = "middle";
    lines.forEach((line, index) => context.fillText(line, width / 2, plateHeight / 2 + 2 + lineHeight * index, width - 2 * padding.x));
  }
  label.texture.needsUpdate = true;
}
