// SPDX-License-Identifier: Apache-2.0
// Adds the command to enter VR if there is a headset, or an emulated one was requested. The rest of this folder is
// loaded only then, so that a page without a headset stays small.

import type { Page } from "../page/page.ts";
import type { Headset } from "./headset.ts";

/** Adds the command if immersive VR is possible. Never rejects. */
export async function offerHeadset(page: Page, canvas: HTMLCanvasElement): Promise<void> {
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
      const found = new Headset(page);
      headset = found;
      page.commands.add({
        name: "enter xr",
        places: ["bar"],
        title: () => "Enter VR",
        label: () => "VR",
        run: () => void found.enter().catch((error: unknown) => say(page, "The headset refused this page", error)),
      });
      if (emulation !== null) emulation.desk.plates = found.boards;
      if (await system.isSessionSupported("immersive-ar").catch(() => false)) {
        page.commands.add({
          name: "enter ar",
          places: ["bar"],
          title: () => "Enter, and see your surroundings behind the world",
          label: () => "AR",
          run: () => void found.enter("immersive-ar").catch((error: unknown) => say(page, "The headset did not let this page in", error)),
        });
      }
      window.iotaXR = (await import("./debug.ts")).makeXrDebug(page, found, emulation?.device ?? null);
    };
    system.addEventListener?.("devicechange", () => void look());
    await look();
  } catch (error) {
    say(page, "VR is not available", error);
  }
}

function say({ events }: Pick<Page, "events">, title: string, error: unknown): void {
  const text = error instanceof Error ? error.message : String(error);
  events.notice({ level: 1, title, text, hint: "" });
}
