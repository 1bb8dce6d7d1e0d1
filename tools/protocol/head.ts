// SPDX-License-Identifier: Apache-2.0
// Made by tools/generate_protocol.py from protocol/schema.json; changes here are lost.
//
// Messages between server and page: little-endian, the first byte is the message's type.
// Every encode and decode function throws ProtocolError; decoders check bounds, counts,
// UTF-8, enumerators, finite floats and trailing bytes.
/* eslint-disable */

/** Three numbers; meters wherever it is a place. */
export type Vec3 = [number, number, number];

/** x y z w. */
export type Quat = [number, number, number, number];

/** Names an entity among those of its kind: a slot is used again under another generation. Null: generation 0. */
export interface Id {
  slot: number;
  generation: number;
}

/** Why a frame cannot be read or written. */
export class ProtocolError extends Error {
  constructor(text: string) {
    super(text);
    this.name = 'ProtocolError';
  }
}
