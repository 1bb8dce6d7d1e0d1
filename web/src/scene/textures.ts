// SPDX-License-Identifier: Apache-2.0
// Surfaces computed on the page: nothing is downloaded.

import { DataTexture, LinearFilter, LinearMipmapLinearFilter, RepeatWrapping, RGBAFormat, SRGBColorSpace, type Texture, type WebGLRenderer } from "three";
import { strandHeight } from "./shapes/rope.ts";

/** A number in 0..1 from a hash of two whole numbers. */
function hash(x: number, y: number): number {
  let h = Math.imul(x, 374761393) ^ Math.imul(y, 668265263);
  h = Math.imul(h ^ (h >>> 13), 1274126177);
  return ((h ^ (h >>> 16)) >>> 0) / 4294967296;
}

/** Smooth noise in 0..1 that repeats after `px` and `py` cells. */
function noise(x: number, y: number, px: number, py: number): number {
  const x0 = Math.floor(x);
  const y0 = Math.floor(y);
  const fx = x - x0;
  const fy = y - y0;
  const sx = fx * fx * (3 - 2 * fx);
  const sy = fy * fy * (3 - 2 * fy);
  const at = (i: number, j: number) => hash((((x0 + i) % px) + px) % px, (((y0 + j) % py) + py) % py);
  const low = at(0, 0) + (at(1, 0) - at(0, 0)) * sx;
  const high = at(0, 1) + (at(1, 1) - at(0, 1)) * sx;
  return low + (high - low) * sy;
}

let finest = 1;

/**
 * Sharper textures at grazing angles, for textures made from now on. Not with a software renderer: Mesa's llvmpipe took
 * tens of seconds for one such texture lookup, during which the page stopped.
 */
export function allowAnisotropy(renderer: WebGLRenderer): void {
  const gl = renderer.getContext();
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER));
  finest = /llvmpipe|swiftshader|software/i.test(name) ? 1 : Math.min(4, renderer.capabilities.getMaxAnisotropy());
}

export const finestAnisotropy = () => finest;

type Pixel = (u: number, v: number, out: number[]) => void;

function makeTexture(width: number, height: number, color: boolean, pixel: Pixel, anisotropy = finest): Texture {
  const data = new Uint8Array(width * height * 4);
  const out = [0, 0, 0];
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      pixel(x / width, y / height, out);
      const at = (y * width + x) * 4;
      for (let channel = 0; channel < 3; channel++) {
        data[at + channel] = Math.round(255 * Math.min(Math.max(out[channel], 0), 1));
      }
      data[at + 3] = 255;
    }
  }
  const texture = new DataTexture(data, width, height, RGBAFormat);
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.generateMipmaps = true;
  texture.anisotropy = anisotropy;
  if (color) texture.colorSpace = SRGBColorSpace;
  texture.needsUpdate = true;
  return texture;
}

/** One color all over. */
export function makePlain(red: number, green: number, blue: number): Texture {
  const texture = new DataTexture(new Uint8Array([red, green, blue, 255]), 1, 1, RGBAFormat);
  texture.needsUpdate = true;
  return texture;
}

/** Normal map of a height in 0..1; `strength` is height over tile in both directions. */
function makeNormals(width: number, height: number, strength: number, at: (u: number, v: number) => number): Texture {
  const du = 1 / width;
  const dv = 1 / height;
  return makeTexture(width, height, false, (u, v, out) => {
    const nx = (-strength * (at(u + du, v) - at(u - du, v))) / (2 * du);
    const ny = (-strength * (at(u, v + dv) - at(u, v - dv))) / (2 * dv);
    const norm = Math.hypot(nx, ny, 1);
    out[0] = 0.5 + 0.5 * (nx / norm);
    out[1] = 0.5 + 0.5 * (ny / norm);
    out[2] = 0.5 + 0.5 * (1 / norm);
  });
}

/** Yarns of a strand run nearly along the rope. */
function yarn(u: number, v: number): number {
  return 0.5 + 0.5 * Math.sin(2 * Math.PI * (33 * v - 4 * u));
}

function ropeHeight(u: number, v: number): number {
  return strandHeight(u, v) * 0.8 + yarn(u, v) * 0.13 + noise(u * 24, v * 96, 24, 96) * 0.07;
}

export function makeRopeColor(): Texture {
  return makeTexture(256, 256, true, (u, v, out) => {
    const shade = 0.42 + 0.46 * strandHeight(u, v) + 0.08 * yarn(u, v) + 0.1 * (noise(u * 16, v * 64, 16, 64) - 0.5);
    out[0] = 0.93 * shade;
    out[1] = 0.79 * shade;
    out[2] = 0.57 * shade;
  });
}

export function makeRopeNormals(): Texture {
  return makeNormals(256, 256, 0.09, ropeHeight);
}

/** Roughness in green, as glTF and three.js have it: fine lines along u. */
export function makeBrushedRoughness(): Texture {
  return makeTexture(128, 256, false, (u, v, out) => {
    const lines = 0.65 * noise(u * 5, v * 128, 5, 128) + 0.35 * noise(u * 11, v * 61, 11, 61);
    out[0] = out[2] = 0;
    out[1] = 0.62 + 0.38 * lines;
  });
}

export function makeWoodColor(): Texture {
  return makeTexture(256, 256, true, (u, v, out) => {
    const bend = 0.035 * noise(u * 2, v * 3, 2, 3) + 0.012 * noise(u * 6, v * 8, 6, 8);
    const ring = Math.abs(Math.sin(Math.PI * 6 * (v + bend)));
    const pore = noise(u * 10, v * 170, 10, 170);
    const shade = 0.8 + 0.14 * ring + 0.13 * (pore - 0.5);
    out[0] = 0.68 * shade;
    out[1] = 0.5 * shade;
    out[2] = 0.35 * shade;
  });
}

/** A worn, even floor: a faint structure, as a visual reference. */
export function makeFloorColor(): Texture {
  return makeTexture(256, 256, true, (u, v, out) => {
    const broad = noise(u * 5, v * 5, 5, 5) - 0.5;
    const fine = noise(u * 96, v * 96, 96, 96) - 0.5;
    out[0] = out[1] = out[2] = 0.96 + 0.035 * broad + 0.035 * fine;
  }, 1);
}
