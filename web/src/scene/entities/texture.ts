// SPDX-License-Identifier: Apache-2.0
// Images of the script on materials. A browser decodes them by itself, beside the page's script.

import { NearestFilter, RepeatWrapping, SRGBColorSpace, Texture } from "three";
import type { TextureEntity } from "../../protocol/generated.ts";
import { setImage } from "../materials.ts";
import { lay } from "../shapes/lay.ts";
import { setLay } from "../shapes/shape.ts";
import { finestAnisotropy } from "../textures.ts";
import type { EntityView } from "./entity.ts";

/** The pixels of images up to this size are seen as such: a checkerboard has sharp edges. */
const pixelArt = 64;

export class TextureView implements EntityView<TextureEntity> {
  private readonly shown_ = new Map<number, { readonly name: string; texture: Texture | null }>();
  private readonly changed_: () => void;
  private readonly warn_: (title: string, text: string) => void;

  /** `changed` is called when an image can be drawn, `warn` for one that cannot. */
  constructor(changed: () => void, warn: (title: string, text: string) => void) {
    setLay(lay);
    this.changed_ = changed;
    this.warn_ = warn;
  }

  create({ id: { slot }, name, image, repeatU, repeatV }: TextureEntity): void {
    const shown = { name, texture: null as Texture | null };
    this.shown_.set(slot, shown);
    const file = new Blob([Uint8Array.from(image)]);
    // With its lower row first, as texture coordinates go up.
    void createImageBitmap(file, { imageOrientation: "flipY", premultiplyAlpha: "none" }).then(
      (bitmap) => {
        if (this.shown_.get(slot) !== shown) return bitmap.close();
        const texture = new Texture(bitmap);
        texture.flipY = false;
        texture.wrapS = texture.wrapT = RepeatWrapping;
        texture.colorSpace = SRGBColorSpace;
        texture.anisotropy = finestAnisotropy();
        texture.repeat.set(repeatU, repeatV);
        if (Math.max(bitmap.width, bitmap.height) <= pixelArt) texture.magFilter = NearestFilter;
        texture.needsUpdate = true;
        shown.texture = texture;
        setImage(name, texture);
        this.changed_();
      },
      () => this.warn_("An image cannot be shown", "The browser cannot decode it; shapes with it are white."),
    );
  }

  change(entity: TextureEntity): void {
    this.destroy(entity.id.slot);
    this.create(entity);
  }

  destroy(slot: number): void {
    const shown = this.shown_.get(slot);
    if (shown === undefined) return;
    this.shown_.delete(slot);
    setImage(shown.name, undefined);
    shown.texture?.dispose();
  }
}
