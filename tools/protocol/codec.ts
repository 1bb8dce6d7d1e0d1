// SPDX-License-Identifier: Apache-2.0
const encoder = new TextEncoder();
const decoder = new TextDecoder('utf-8', { fatal: true, ignoreBOM: true });
const NO_BYTES = new DataView(new ArrayBuffer(0));

class Writer {
  private bytes = new Uint8Array(256);
  private view: DataView = new DataView(this.bytes.buffer);
  private at = 0;

  start(type: number): void {
    this.at = 0;
    this.u8(type, 'type');
  }
  startRecords(): void {
    this.at = 0;
  }
  finish(): ArrayBuffer {
    return this.bytes.slice(0, this.at).buffer;
  }
  u8(value: number, field: string): void {
    this.at = this.room(1, this.whole(value, 0xff, field));
    this.view.setUint8(this.at - 1, value);
  }
  bool(value: boolean): void {
    this.at = this.room(1, 0);
    this.view.setUint8(this.at - 1, value ? 1 : 0);
  }
  u16(value: number, field: string): void {
    this.at = this.room(2, this.whole(value, 0xffff, field));
    this.view.setUint16(this.at - 2, value, true);
  }
  u32(value: number, field: string): void {
    this.at = this.room(4, this.whole(value, 0xffffffff, field));
    this.view.setUint32(this.at - 4, value, true);
  }
  u64(value: number, field: string): void {
    this.at = this.room(8, this.whole(value, Number.MAX_SAFE_INTEGER, field));
    this.view.setUint32(this.at - 8, value % 0x100000000, true);
    this.view.setUint32(this.at - 4, Math.floor(value / 0x100000000), true);
  }
  f32(value: number, field: string): void {
    this.at = this.room(4, this.finite(Math.fround(value), field));
    this.view.setFloat32(this.at - 4, value, true);
  }
  f64(value: number, field: string): void {
    this.at = this.room(8, this.finite(value, field));
    this.view.setFloat64(this.at - 8, value, true);
  }
  vec3(value: Readonly<Vec3>, field: string): void {
    this.f32(value[0], field);
    this.f32(value[1], field);
    this.f32(value[2], field);
  }
  quat(value: Readonly<Quat>, field: string): void {
    for (const component of value) this.f32(component, field);
  }
  id(value: Readonly<Id>, field: string): void {
    this.u32(value.slot, field);
    this.u32(value.generation, field);
  }
  count(count: number, limit: number, field: string): void {
    if (count > limit) {
      throw new ProtocolError(`${field}: ${count} is above the limit of ${limit}`);
    }
    this.u32(count, field);
  }
  text(value: string, limit: number, field: string): void {
    this.raw(encoder.encode(value), limit, field);
  }
  raw(bytes: Uint8Array, limit: number, field: string): void {
    this.count(bytes.length, limit, field);
    this.at = this.room(bytes.length, 0);
    this.bytes.set(bytes, this.at - bytes.length);
  }

  private room(size: number, _checked: number): number {
    const end = this.at + size;
    if (end > this.bytes.length) {
      const larger = new Uint8Array(Math.max(end, 2 * this.bytes.length));
      larger.set(this.bytes);
      this.bytes = larger;
      this.view = new DataView(larger.buffer);
    }
    return end;
  }
  private whole(value: number, limit: number, field: string): number {
    if (!Number.isInteger(value) || value < 0 || value > limit) {
      throw new ProtocolError(`${field}: ${value} is not a whole number up to ${limit}`);
    }
    return value;
  }
  private finite(value: number, field: string): number {
    if (!Number.isFinite(value)) throw new ProtocolError(`${field}: is not a finite number`);
    return value;
  }
}

class Reader {
  private view: DataView = NO_BYTES;
  private at = 0;

  start(data: ArrayBuffer | Uint8Array, type: number): void {
    this.view =
      data instanceof Uint8Array
        ? new DataView(data.buffer, data.byteOffset, data.byteLength)
        : new DataView(data);
    this.at = 1;
    const found = messageTypeOf(data);
    if (found !== type) throw new ProtocolError(`the type is ${found}, not ${type}`);
  }
  startRecords(records: Uint8Array): void {
    this.view = new DataView(records.buffer, records.byteOffset, records.byteLength);
    this.at = 0;
  }
  finish(): void {
    const left = this.left();
    this.view = NO_BYTES;
    if (left > 0) throw new ProtocolError(`the frame has ${left} bytes too many`);
  }
  left(): number {
    return this.view.byteLength - this.at;
  }
  u8(field: string): number {
    return this.view.getUint8(this.take(1, field));
  }
  bool(field: string): boolean {
    const value = this.u8(field);
    if (value > 1) throw new ProtocolError(`${field} is neither 0 nor 1`);
    return value === 1;
  }
  choice(count: number, field: string): number {
    const value = this.u8(field);
    if (value >= count) throw new ProtocolError(`${field} has no meaning for the value ${value}`);
    return value;
  }
  u16(field: string): number {
    return this.view.getUint16(this.take(2, field), true);
  }
  u32(field: string): number {
    return this.view.getUint32(this.take(4, field), true);
  }
  /** Exact up to 2^53 - 1; a greater value is an error. */
  u64(field: string): number {
    const at = this.take(8, field);
    const value = this.view.getUint32(at, true) + 0x100000000 * this.view.getUint32(at + 4, true);
    if (value > Number.MAX_SAFE_INTEGER) throw new ProtocolError(`${field} is above 2^53 - 1`);
    return value;
  }
  f32(field: string): number {
    return this.finite(this.view.getFloat32(this.take(4, field), true), field);
  }
  f64(field: string): number {
    return this.finite(this.view.getFloat64(this.take(8, field), true), field);
  }
  vec3(field: string): Vec3 {
    return [this.f32(field), this.f32(field), this.f32(field)];
  }
  quat(field: string): Quat {
    return [this.f32(field), this.f32(field), this.f32(field), this.f32(field)];
  }
  id(field: string): Id {
    return { slot: this.u32(field), generation: this.u32(field) };
  }
  vec3Into(out: Float32Array, offset: number, field: string): void {
    out[offset] = this.f32(field);
    out[offset + 1] = this.f32(field);
    out[offset + 2] = this.f32(field);
  }
  count(limit: number, smallestItem: number, field: string): number {
    const count = this.u32(field);
    if (count > limit) {
      throw new ProtocolError(`${field} has ${count} entries, at most ${limit} are allowed`);
    }
    if (count * smallestItem > this.left()) throw new ProtocolError(`${field} ends early`);
    return count;
  }
  /** A view of the frame, not a copy. */
  raw(limit: number, field: string): Uint8Array {
    const size = this.count(limit, 1, field);
    const at = this.take(size, field);
    return new Uint8Array(this.view.buffer, this.view.byteOffset + at, size);
  }
  text(limit: number, field: string): string {
    const bytes = this.raw(limit, field);
    try {
      return decoder.decode(bytes);
    } catch {
      throw new ProtocolError(`${field} is not UTF-8`);
    }
  }

  private take(size: number, field: string): number {
    const at = this.at;
    if (this.left() < size) throw new ProtocolError(`${field} ends early`);
    this.at = at + size;
    return at;
  }
  private finite(value: number, field: string): number {
    if (!Number.isFinite(value)) throw new ProtocolError(`${field} is not a finite number`);
    return value;
  }
}

const writer = new Writer();
const reader = new Reader();

/** The type of the message in a frame: one of MessageType for a frame we know. */
export function messageTypeOf(data: ArrayBuffer | Uint8Array): number {
  if (data.byteLength === 0) throw new ProtocolError('the frame is empty');
  return (data instanceof Uint8Array ? data[0] : new Uint8Array(data, 0, 1)[0]) as number;
}

function readArray<T>(limit: number, smallestItem: number, field: string, read: () => T): T[] {
  const items = new Array<T>(reader.count(limit, smallestItem, field));
  for (let i = 0; i < items.length; i++) items[i] = read();
  return items;
}

function readNumbers<A extends { [index: number]: number; readonly length: number }>(
  limit: number,
  smallestItem: number,
  field: string,
  read: () => number,
  make: (count: number) => A,
): A {
  const numbers = make(reader.count(limit, smallestItem, field));
  for (let i = 0; i < numbers.length; i++) numbers[i] = read();
  return numbers;
}
