// SPDX-License-Identifier: Apache-2.0
// Frames that the script moves: not drawn, but things can be on them.

import type { FrameEntity } from "../../protocol/generated.ts";
import type { PoseBuffer } from "../pose_buffer.ts";
import type { EntityView } from "./entity.ts";

export class FrameView implements EntityView<FrameEntity> {
  private readonly frames_: Map<number, FrameEntity>;

  constructor({ frames }: PoseBuffer) {
    this.frames_ = frames;
  }

  create(entity: FrameEntity): void {
    this.frames_.set(entity.id.slot, entity);
  }

  change(entity: FrameEntity): void {
    this.create(entity);
  }

  destroy(slot: number): void {
    this.frames_.delete(slot);
  }
}
