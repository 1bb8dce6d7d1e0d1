// SPDX-License-Identifier: Apache-2.0
import { afterEach, describe, expect, it, vi } from "vitest";
import { TextureView } from "../src/scene/entities/texture.ts";
import { materialOf } from "../src/scene/materials.ts";
import { id } from "./test_world.ts";

/** What the browser is asked to decode. */
const asked: { settle: (bitmap: ImageBitmap) => void; fail: () => void }[] = [];
const bitmap = (width: number) => ({ width, height: width, close: vi.fn() }) as unknown as ImageBitmap & { close: ReturnType<typeof vi.fn> };
const told: string[] = [];
let changes = 0;

function made(): TextureView {
  asked.length = told.length = changes = 0;
  vi.stubGlobal("createImageBitmap", () => new Promise<ImageBitmap>((settle, fail) => asked.push({ settle, fail })));
  return new TextureView(() => changes++, (title) => told.push(title));
}

const entity = (slot: number, name: string) => ({ id: id(slot), name, image: Uint8Array.of(1), repeatU: 2, repeatV: 3 });
const paint = (name: string) => materialOf({ material: `paint#${name}`, color: null });

afterEach(() => vi.unstubAllGlobals());

describe("an image of the script", () => {
  it("is on the materials with its name, made before it is there and after, as often as told", async () => {
    const view = made();
    const before = paint("one");
    view.create(entity(0, "one"));
    asked[0].settle(bitmap(100));
    await vi.waitFor(() => expect(changes).toBe(1));
    const after = materialOf({ material: "steel#one", color: "#ff0000" });
    expect(before.map).toBe(after.map);
    expect(before.map!.repeat.toArray()).toEqual([2, 3]);
    expect(paint("other").map).not.toBe(before.map);
    expect(before.color.getHex()).toBe(0xffffff);
    expect(after.color.getHex()).toBe(0xff0000);
  });

  it("is gone from new materials with the entity", async () => {
    const view = made();
    view.create(entity(0, "two"));
    asked[0].settle(bitmap(100));
    await vi.waitFor(() => expect(changes).toBe(1));
    const shown = paint("two");
    const { map } = shown;
    view.destroy(0);
    expect(paint("two")).not.toBe(shown);
    expect(paint("two").map).not.toBe(map);
  });

  it("is not shown where it was destroyed before it was decoded", async () => {
    const view = made();
    const picture = bitmap(100);
    view.create(entity(0, "three"));
    view.destroy(0);
    asked[0].settle(picture);
    await vi.waitFor(() => expect(picture.close).toHaveBeenCalled());
    expect(changes).toBe(0);
  });

  it("that the browser cannot decode causes a notice", async () => {
    const view = made();
    view.create(entity(0, "four"));
    asked[0].fail();
    await vi.waitFor(() => expect(told).toEqual(["An image cannot be shown"]));
  });
});
