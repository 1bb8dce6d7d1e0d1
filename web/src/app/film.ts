// SPDX-License-Identifier: Apache-2.0
// The pictures of a film, for `iota record`: the browser draws one of them while the one before is encoded, sent and
// written to the file. In software, drawing keeps all cores busy only if it never waits for the rest.

import type { PlotEntity } from "../protocol/generated.ts";
import { drawPlots } from "../ui/plot.ts";
import type { PageParts } from "../page/page_parts.ts";

/** A picture that is still being drawn; its size in px, and what is drawn over it. */
interface Drawn {
  readonly width: number;
  readonly height: number;
  readonly plots: HTMLCanvasElement | null;
}

export class Film {
  private readonly viewer_: PageParts["viewer"];
  private readonly world_: PageParts["world"];
  private readonly gl_: WebGL2RenderingContext;
  private readonly buffer_: WebGLBuffer;
  private readonly canvas_ = document.createElement("canvas");
  private drawn_: Drawn | null = null;

  constructor({ viewer, world }: Pick<PageParts, "viewer" | "world">) {
    this.viewer_ = viewer;
    this.world_ = world;
    this.gl_ = viewer.renderer.getContext() as WebGL2RenderingContext;
    this.buffer_ = this.gl_.createBuffer();
    // Nobody sees the page itself: to show it would cost an eighth of the time of a picture.
    document.body.style.display = "none";
  }

  /** Begins to draw the next picture. Returns the one before as the address of a JPEG, empty if there is none. */
  next(plots: readonly PlotEntity[]): string {
    const read = this.read_();
    this.world_.poses.exact = true;
    this.viewer_.drawFilmFrame();
    this.drawn_ = this.copy_(plots);
    return read();
  }

  /** The picture that was begun last. */
  last(): string {
    return this.read_()();
  }

  /** Requests the pixels of what is drawn. The browser clears a shown picture, so this is in the task that draws it. */
  private copy_(plots: readonly PlotEntity[]): Drawn {
    const { gl_: gl, viewer_: viewer } = this;
    const { width, height } = viewer.renderer.domElement;
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, this.buffer_);
    gl.bufferData(gl.PIXEL_PACK_BUFFER, 4 * width * height, gl.STREAM_READ);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, 0);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    gl.flush();
    if (plots.length === 0) return { width, height, plots: null };
    const over = document.createElement("canvas");
    [over.width, over.height] = [width, height];
    const context = over.getContext("2d", { willReadFrequently: true });
    if (context !== null) drawPlots(context, plots, width, height);
    return { width, height, plots: over };
  }

  /** Waits for the pixels; the function that it returns encodes them. */
  private read_(): () => string {
    const { gl_: gl, drawn_: drawn } = this;
    this.drawn_ = null;
    if (drawn === null) return () => "";
    const { width, height, plots } = drawn;
    const upward = new Uint32Array(width * height);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, this.buffer_);
    gl.getBufferSubData(gl.PIXEL_PACK_BUFFER, 0, upward);
    gl.bindBuffer(gl.PIXEL_PACK_BUFFER, null);
    return () => {
      // From the lowest row up, and opaque.
      const pixels = new Uint32Array(width * height);
      for (let row = 0; row < height; row++) pixels.set(upward.subarray(row * width, (row + 1) * width), (height - 1 - row) * width);
      for (let at = 0; at < pixels.length; at++) pixels[at] |= 0xff000000;
      [this.canvas_.width, this.canvas_.height] = [width, height];
      const context = this.canvas_.getContext("2d", { willReadFrequently: true });
      if (context === null) return "";
      context.putImageData(new ImageData(new Uint8ClampedArray(pixels.buffer), width, height), 0, 0);
      if (plots !== null) context.drawImage(plots, 0, 0);
      return this.canvas_.toDataURL("image/jpeg", 0.95);
    };
  }
}
