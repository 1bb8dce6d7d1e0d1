// SPDX-License-Identifier: Apache-2.0
// The generated protocol against golden bytes that an independent encoder made (protocol/make_golden.py).
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import * as protocol from '../src/protocol/generated';

interface GoodVector {
  name: string;
  sender: 'client' | 'server';
  message: string;
  values: Record<string, unknown>;
}

interface BadVector {
  name: string;
  sender: 'client' | 'server';
  error: string;
}

const folder = new URL('../../protocol/golden/', import.meta.url);

function readGolden(file: string): string {
  return readFileSync(new URL(file, folder), 'utf-8');
}

function bytesOf(name: string): Uint8Array {
  const digits = readGolden(`${name}.hex`).trim();
  return Uint8Array.from(digits.match(/../g) ?? [], (byte) => parseInt(byte, 16));
}

function camel(name: string): string {
  return name.replace(/_([a-z])/g, (_, letter: string) => letter.toUpperCase());
}

/** Typed arrays as plain ones. */
function plain(value: unknown): unknown {
  if (ArrayBuffer.isView(value)) return [...(value as Uint8Array)];
  if (Array.isArray(value)) return value.map(plain);
  if (typeof value !== 'object' || value === null) return value;
  return Object.fromEntries(Object.entries(value).map(([key, inner]) => [key, plain(inner)]));
}

/** The same values with the keys that the generated interfaces use. */
function camelKeys(value: unknown): unknown {
  if (Array.isArray(value)) return value.map(camelKeys);
  if (typeof value !== 'object' || value === null) return value;
  return Object.fromEntries(Object.entries(value).map(([key, inner]) => [camel(key), camelKeys(inner)]));
}

function decode(sender: 'client' | 'server', data: Uint8Array): protocol.ClientMessage | protocol.ServerMessage {
  return sender === 'client' ? protocol.decodeClientMessage(data) : protocol.decodeServerMessage(data);
}

interface EntityVector {
  kind: string;
  values: Record<string, unknown>;
}

const { good, bad, entities } = JSON.parse(readGolden('vectors.json')) as {
  good: GoodVector[];
  bad: BadVector[];
  entities: EntityVector[];
};

describe('golden bytes', () => {
  it.each(good)('$name is decoded to its values', ({ name, sender, message, values }) => {
    expect(plain(decode(sender, bytesOf(name)))).toEqual({ type: camel(message), ...(camelKeys(values) as object) });
  });

  it.each(good)('$name is encoded to its bytes', ({ name, sender }) => {
    const bytes = bytesOf(name);
    const message = decode(sender, bytes);
    const encoded =
      sender === 'client'
        ? protocol.encodeClientMessage(message as protocol.ClientMessage)
        : protocol.encodeServerMessage(message as protocol.ServerMessage);
    expect(new Uint8Array(encoded)).toEqual(bytes);
  });

  it.each(bad)('$name is refused with its reason', ({ name, sender, error }) => {
    expect(() => decode(sender, bytesOf(name))).toThrow(error);
  });

  it('covers every message', () => {
    const seen = new Set(good.map(({ message }) => camel(message)));
    expect([...seen].sort()).toEqual(Object.keys(protocol.MessageType).sort());
  });

  it.each(good)('$name is refused when it is cut short anywhere', ({ name, sender }) => {
    const bytes = bytesOf(name);
    for (let size = 0; size < bytes.length; size++) {
      expect(() => decode(sender, bytes.slice(0, size))).toThrow(protocol.ProtocolError);
    }
  });
});

describe('records of entities', () => {
  const kindOf = (name: string): protocol.EntityKind => {
    const kind = protocol.entityKindOf(name);
    if (kind === undefined) throw new Error(`there is no kind ${name}`);
    return kind;
  };

  it.each(entities)('of the kind $kind are decoded to their values and encoded back', ({ kind, values }) => {
    const bytes = bytesOf(`entity_${kind}`);
    const two = new Uint8Array([...bytes, ...bytes]);
    const decoded = protocol.decodeEntities(kindOf(kind), two);
    expect(plain(decoded)).toEqual([camelKeys(values), camelKeys(values)]);
    expect(protocol.encodeEntities(kindOf(kind), decoded)).toEqual(two);
  });

  it.each(entities)('of the kind $kind are refused when they are cut short', ({ kind }) => {
    const bytes = bytesOf(`entity_${kind}`);
    for (let size = 1; size < bytes.length; size++) {
      expect(() => protocol.decodeEntities(kindOf(kind), bytes.slice(0, size))).toThrow(protocol.ProtocolError);
    }
  });

  it('of no known kind have none', () => {
    expect(protocol.entityKindOf('hologram')).toBeUndefined();
  });
});

describe('poses', () => {
  it('are decoded into a buffer that is used again', () => {
    const buffer = new protocol.PosesBuffer();
    protocol.decodePosesInto(bytesOf('poses'), buffer);
    const column = buffer.bodies.x;
    expect(buffer.step).toBe(0x0001_0002_0003_0004);
    expect([...buffer.boxMax]).toEqual([1, 2, 4]);
    expect(buffer.bodies.count).toBe(2);
    expect([...buffer.bodies.body.subarray(0, 2)]).toEqual([0, 65535]);
    expect([...buffer.holds.target.subarray(0, 3)]).toEqual([0.5, 1.25, 1.5]);
    protocol.decodePosesInto(bytesOf('poses_nothing_moved'), buffer);
    expect(buffer.bodies.count).toBe(0);
    expect(buffer.farBodies.count).toBe(0);
    expect(buffer.keyframe).toBe(false);
    expect(buffer.bodies.x).toBe(column);
  });

  it('give positions in the box and far from it, and unit rotations', () => {
    const buffer = new protocol.PosesBuffer();
    protocol.decodePosesInto(bytesOf('poses'), buffer);
    const found = new Map<number, { position: number[]; rotation: number[] }>();
    protocol.forEachPose(buffer, (body, position, rotation) => {
      found.set(body, { position: [...position], rotation: [...rotation] });
    });
    expect([...found.keys()]).toEqual([0, 65535, 70000]);
    expect(found.get(0)?.position[0]).toBe(-1);
    expect(found.get(0)?.position[1]).toBe(2);
    expect(found.get(0)?.position[2]).toBeCloseTo(0, 3);
    expect(found.get(70000)?.position).toEqual([0, -4096.5, 8]);
    // 0xDFF7FDFF: the largest is w, the three others are 511, half a step below zero.
    const rotation = found.get(0)?.rotation ?? [];
    expect(rotation[3]).toBeCloseTo(1, 5);
    expect(rotation[0]).toBeCloseTo(-Math.SQRT1_2 / 1023, 6);
    for (const { rotation: q } of found.values()) expect(Math.hypot(...q)).toBeLessThan(1.3);
  });

  it('refuse a NaN', () => {
    const bytes = bytesOf('poses');
    new DataView(bytes.buffer).setFloat64(9, NaN, true);
    expect(() => protocol.decodePosesInto(bytes, new protocol.PosesBuffer())).toThrow('poses.time is not a finite number');
  });
});

describe('encoding', () => {
  it('refuses what a decoder would refuse', () => {
    expect(() => protocol.encodeSelect({ type: 'select', body: { slot: -1, generation: 1 } })).toThrow('select.body');
    expect(() => protocol.encodeSelect({ type: 'select', body: { slot: 0.5, generation: 1 } })).toThrow('select.body');
    expect(() => protocol.encodeGrabMove({ type: 'grabMove', hold: 1, target: [0, NaN, 0] })).toThrow('grab_move.target');
    expect(() => protocol.encodeAction({ type: 'action', name: 'x'.repeat(129), body: { slot: 0, generation: 0 }, others: [] })).toThrow('action.name');
  });

  it('survives long messages', () => {
    const message = { type: 'entitiesSet', kind: 'body', records: new Uint8Array(100_000).fill(7) } as const;
    expect(protocol.decodeServerMessage(protocol.encodeEntitiesSet(message))).toEqual(message);
  });
});
