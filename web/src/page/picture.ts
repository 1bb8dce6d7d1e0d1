// SPDX-License-Identifier: Apache-2.0
// Pictures of the page: for the script, in parts that fit a frame, and as a file for the user.

import type { ClientMessage } from "../protocol/generated.ts";
import type { PageParts } from "./page_parts.ts";
import type { Viewer } from "./viewer.ts";

const partBytes = 60_000;

export type PictureViewer = Pick<Viewer, "renderer" | "scene" | "camera" | "presenting">;

/**
 * A PNG of the world as drawn now, without the controls, at full resolution even if the page draws at a lower one; null
 * if the browser cannot make one.
 */
export async function takePicture({ renderer, scene, camera, presenting }: PictureViewer): Promise<Blob | null> {
  const usual = renderer.getPixelRatio();
  const draw = (pixelRatio: number) => {
    if (!presenting && renderer.getPixelRatio() !== pixelRatio) renderer.setPixelRatio(pixelRatio);
    // The browser clears a drawn frame once it has shown it.
    renderer.render(scene, camera);
  };
  draw(Math.max(usual, Math.min(devicePixelRatio, 2)));
  const picture = new Promise<Blob | null>((resolve) => {
    renderer.domElement.toBlob(resolve, "image/png");
  });
  // The browser has copied the pixels when the call above returns.
  draw(usual);
  return picture;
}

/** The next frame of a film as the address of a JPEG, without the controls. The picture is read in the task that draws
 * it, since the browser clears a shown frame. */
export function takeFilmFrame({ viewer, world }: Pick<PageParts, "viewer" | "world">): string {
  world.poses.exact = true;
  viewer.drawFilmFrame();
  return viewer.renderer.domElement.toDataURL("image/jpeg", 0.95);
}

/** A hidden page has no frames. */
const longestWaitMs = 500;

/** Until what has come from the server is written for the renderer, which a frame does. */
async function nextFrame(): Promise<void> {
  await new Promise<unknown>((resolve) => {
    requestAnimationFrame(resolve);
    setTimeout(resolve, longestWaitMs);
  });
}

/** Answers the server's request, which can come together with what its script wants to see; with an empty part if there is no picture. */
export async function sendPicture(viewer: PictureViewer, request: number, send: (part: ClientMessage) => void): Promise<void> {
  await nextFrame();
  const picture = await takePicture(viewer).catch(() => null);
  const bytes = picture === null ? new Uint8Array() : new Uint8Array(await picture.arrayBuffer());
  for (let from = 0; from === 0 || from < bytes.length; from += partBytes) {
    const data = bytes.subarray(from, from + partBytes);
    send({ type: "picture", request, isLast: from + partBytes >= bytes.length, data });
  }
}

/** Downloads a file to the user. */
export async function savePicture(viewer: Viewer, name: string): Promise<void> {
  const picture = await takePicture(viewer);
  if (picture === null) throw new Error("the browser could not make a picture");
  const link = document.createElement("a");
  link.href = URL.createObjectURL(picture);
  link.download = `${name.replaceAll(/[^\p{L}\p{N}]+/gu, "_") || "iota"}.png`;
  link.click();
  window.setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
