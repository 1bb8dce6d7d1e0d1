// SPDX-License-Identifier: Apache-2.0
// When a picture is due: after a change, until all easing has ended.

/** How long frames are drawn after the last change, in the frames' own time, s. */
const drawOn = 0.7;

export class Redraw {
  private left_ = drawOn;

  /** Something looks different. */
  ask(): void {
    this.left_ = drawOn;
  }

  /** Whether nothing has changed for a while. */
  get isResting(): boolean {
    return this.left_ <= 0;
  }

  /**
   * Once a frame; whether it is drawn. `seconds` as the parts of the page are told: where frames take long, easing needs as many of
   * them, and so more time.
   */
  isDue(seconds: number): boolean {
    const due = this.left_ > 0;
    this.left_ -= seconds;
    return due;
  }
}
