// SPDX-License-Identifier: Apache-2.0
// Visuals: the shapes with which bodies or ties are drawn, in each style that the page can show.

import type { Part, VisualEntity } from "../../protocol/generated.ts";
import { readPart } from "../parts.ts";
import type { Shape } from "../shapes/shape.ts";
import type { EntityView } from "./entity.ts";

/** A part with this style belongs to each style that has no parts of its own. */
const anyStyle = "*";

/** Draws by visuals. */
export interface VisualUser {
  /** The parts of a visual have changed. */
  redraw(visual: number): void;
  /** The parts of all visuals have changed: the page shows another style. */
  redrawAll(): void;
}

export class Visuals implements EntityView<VisualEntity> {
  private readonly users_: VisualUser[] = [];
  private readonly entities_ = new Map<number, VisualEntity>();
  /** Parts in the shown style, read when first needed. */
  private readonly shapes_ = new Map<number, readonly Shape[]>();
  private readonly warn_: (title: string, text: string) => void;
  private style_ = "";

  /** `warn` is called for a part that cannot be drawn. */
  constructor(warn: (title: string, text: string) => void) {
    this.warn_ = warn;
  }

  addUser(user: VisualUser): void {
    this.users_.push(user);
  }

  create(entity: VisualEntity): void {
    this.entities_.set(entity.id.slot, entity);
    this.forget_(entity.id.slot);
  }

  /** An unchanged visual, sent again after a lost connection, does not change the meshes. */
  change(entity: VisualEntity): void {
    const before = this.entities_.get(entity.id.slot);
    this.entities_.set(entity.id.slot, entity);
    if (JSON.stringify(before?.parts) !== JSON.stringify(entity.parts)) this.forget_(entity.id.slot);
  }

  destroy(slot: number): void {
    this.entities_.delete(slot);
    this.forget_(slot);
  }

  showStyle(style: string): void {
    this.style_ = style;
    this.shapes_.clear();
    for (const user of this.users_) user.redrawAll();
  }

  /** The script's name of it. */
  nameOf(visual: number): string {
    return this.entities_.get(visual)?.name ?? "";
  }

  /** Shapes in the current style; if there are none, those for every style; if there are none, those of the first style
   * with shapes. */
  shapesOf(visual: number): readonly Shape[] {
    let shapes = this.shapes_.get(visual);
    if (shapes === undefined) {
      shapes = this.read_(visual);
      this.shapes_.set(visual, shapes);
    }
    return shapes;
  }

  private forget_(visual: number): void {
    this.shapes_.delete(visual);
    for (const user of this.users_) user.redraw(visual);
  }

  private read_(visual: number): readonly Shape[] {
    const entity = this.entities_.get(visual);
    if (entity === undefined) return [];
    const shapes: Shape[] = [];
    for (const part of partsIn(entity.parts, this.style_)) {
      try {
        shapes.push(readPart(part));
      } catch (error) {
        this.warn_(`A part of "${entity.name}" cannot be drawn`, error instanceof Error ? error.message : String(error));
      }
    }
    return shapes;
  }
}

function partsIn(parts: readonly Part[], style: string): readonly Part[] {
  for (const wanted of [style, anyStyle, parts.at(0)?.style]) {
    const found = parts.filter((part) => part.style === wanted);
    if (found.length > 0) return found;
  }
  return [];
}
