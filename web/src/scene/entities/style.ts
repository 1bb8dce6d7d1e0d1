// SPDX-License-Identifier: Apache-2.0
// Styles: the shapes of a class of bodies or ties, in each look that the page can show. Bodies and ties are drawn with
// them.

import type { Part, StyleEntity } from "../../protocol/generated.ts";
import { readPart } from "../parts.ts";
import type { Shape } from "../shapes/shape.ts";
import type { EntityView } from "./entity.ts";

/** A part with this look belongs to each look that has no parts of its own. */
const anyLook = "*";

/** Draws by styles. */
export interface StyleUser {
  /** The parts of a style have changed. */
  restyle(style: number): void;
  /** The parts of all styles have changed: the page shows another look. */
  restyleAll(): void;
}

export class Styles implements EntityView<StyleEntity> {
  private readonly users_: StyleUser[] = [];
  private readonly entities_ = new Map<number, StyleEntity>();
  /** Parts in the shown look, read when first needed. */
  private readonly shapes_ = new Map<number, readonly Shape[]>();
  private readonly warn_: (title: string, text: string) => void;
  private look_ = "";

  /** `warn` is called for a part that cannot be drawn. */
  constructor(warn: (title: string, text: string) => void) {
    this.warn_ = warn;
  }

  addUser(user: StyleUser): void {
    this.users_.push(user);
  }

  create(entity: StyleEntity): void {
    this.entities_.set(entity.id.slot, entity);
    this.forget_(entity.id.slot);
  }

  /** An unchanged style, sent again after a lost connection, does not change the meshes. */
  change(entity: StyleEntity): void {
    const before = this.entities_.get(entity.id.slot);
    this.entities_.set(entity.id.slot, entity);
    if (JSON.stringify(before?.parts) !== JSON.stringify(entity.parts)) this.forget_(entity.id.slot);
  }

  destroy(slot: number): void {
    this.entities_.delete(slot);
    this.forget_(slot);
  }

  showLook(look: string): void {
    this.look_ = look;
    this.shapes_.clear();
    for (const user of this.users_) user.restyleAll();
  }

  /** The script's name of the class. */
  nameOf(style: number): string {
    return this.entities_.get(style)?.name ?? "";
  }

  /** Shapes in the current look; if there are none, those for every look; if there are none, those of the first look
   * with shapes. */
  shapesOf(style: number): readonly Shape[] {
    let shapes = this.shapes_.get(style);
    if (shapes === undefined) {
      shapes = this.read_(style);
      this.shapes_.set(style, shapes);
    }
    return shapes;
  }

  private forget_(style: number): void {
    this.shapes_.delete(style);
    for (const user of this.users_) user.restyle(style);
  }

  private read_(style: number): readonly Shape[] {
    const entity = this.entities_.get(style);
    if (entity === undefined) return [];
    const shapes: Shape[] = [];
    for (const part of partsIn(entity.parts, this.look_)) {
      try {
        shapes.push(readPart(part));
      } catch (error) {
        this.warn_(`A part of "${entity.name}" cannot be drawn`, error instanceof Error ? error.message : String(error));
      }
    }
    return shapes;
  }
}

function partsIn(parts: readonly Part[], look: string): readonly Part[] {
  for (const wanted of [look, anyLook, parts.at(0)?.look]) {
    const found = parts.filter((part) => part.look === wanted);
    if (found.length > 0) return found;
  }
  return [];
}
