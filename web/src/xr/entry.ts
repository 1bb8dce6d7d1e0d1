// SPDX-License-Identifier: Apache-2.0
// Offers to enter VR where a headset is, or an emulated one was asked for. Everything else of this
// folder is fetched only then, so that a page without a headset stays small.

import type { Page } from "../app/page.ts";
import { make } from "../ui/dom.ts";
import type { Headset } from "./headset.ts";

/** Puts the button into `place` when immersive VR is possible. Never rejects. */
export async function offerHeadset(page: Page, canvas: HTMLCanvasElement, place: HTMLElement): Promise<void> {
  try {
    const wanted = new URLSearchParams(location.search).get("emulate");
    const emulation = wanted === null ? null : (await import("./emulate.ts")).emulate(page, canvas, wanted);
    const system = navigator.xr;
    if (system === undefined) return;
    let headset: Headset | null = null;
    const look = async () => {
      const able = await system.isSessionSupported("immersive-vr").catch(() => false);
      if (!able || headset !== null) return;
      const { Headset } = await import("./headset.ts");
      headset = new Headset(page);
      place.append(makeButton(page, headset));
      if (emulation !== null) emulation.desk.plates = headset.boards;
      window.iotaXR = (await import("./debug.ts")).makeXrDebug(page, headset, emulation?.device ?? null);
    };
    system.addEventListener?.("devicechange", () => void look());
    await look();
  } catch (error) {
    say(page, "VR is not available", error);
  }
}

function makeButton(page: Page, headset: Headset): HTMLButtonElement {
  const button = make("button", "text", "VR");
  button.type = "button";
  button.id = "enter-xr";
  button.title = "Enter VR: stand before it in a headset";
  button.setAttribute("aria-label", "Enter VR");
  button.addEventListener("click", () => {
    headset.enter().catch((error: unknown) => say(page, "The headset did not let this page in", error));
  });
  return button;
}

function say(page: Page, title: string, error: unknown): void {
  const text = error instanceof Error ? error.message : String(error);
  for (const listener of page.listeners) listener.notice?.({ level: 1, title, text, hint: "" });
}
