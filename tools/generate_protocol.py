#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Generate the C++ and TypeScript sides of the protocol from protocol/schema.json.

    python3 tools/generate_protocol.py --cpp FILE --ts FILE

Needs the standard library only. A file is replaced atomically, and only when its
contents change, so that build tools do not rebuild for nothing. A wrong schema ends
with one line on stderr and exit code 1.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

SCHEMA = Path(__file__).resolve().parent.parent / "protocol" / "schema.json"

# Wire size in bytes of each scalar; a string's or array's is that of its count.
SIZES = {"u8": 1, "bool": 1, "u16": 2, "u32": 4, "u64": 8, "f32": 4, "f64": 8, "vec3": 12}
CPP_TYPES = {
    "u8": "std::uint8_t",
    "bool": "bool",
    "u16": "std::uint16_t",
    "u32": "std::uint32_t",
    "u64": "std::uint64_t",
    "f32": "float",
    "f64": "double",
    "vec3": "Vec3",
    "string": "std::string",
}
TS_TYPES = {"bool": "boolean", "vec3": "Vec3", "string": "string"}
TS_COLUMNS = {
    "u8": "Uint8Array",
    "bool": "Uint8Array",
    "u16": "Uint16Array",
    "u32": "Uint32Array",
    "u64": "Float64Array",
    "f32": "Float32Array",
    "f64": "Float64Array",
    "vec3": "Float32Array",
}


class SchemaError(Exception):
    """The schema says something that cannot be generated."""


@dataclass(frozen=True)
class Field:
    """One field of a struct or message; `item` names the struct of an array."""

    name: str
    kind: str  # a key of CPP_TYPES, or "array"
    item: str
    max: int
    enum: str
    doc: str


@dataclass(frozen=True)
class Struct:
    """A struct, or a message when `type` is not None."""

    name: str
    doc: str
    fields: tuple[Field, ...]
    type: int | None
    in_place: bool


@dataclass(frozen=True)
class Enum:
    name: str
    doc: str
    values: tuple[tuple[str, int], ...]


@dataclass(frozen=True)
class Constant:
    name: str
    kind: str
    value: int
    doc: str


@dataclass(frozen=True)
class Schema:
    version: int
    constants: tuple[Constant, ...]
    enums: dict[str, Enum]
    structs: dict[str, Struct]
    client: tuple[Struct, ...]
    server: tuple[Struct, ...]

    @property
    def messages(self) -> tuple[Struct, ...]:
        return self.client + self.server

    def smallest(self, struct: Struct) -> int:
        """Fewest bytes that `struct` can take on the wire."""
        return sum(SIZES.get(field.kind, 4) for field in struct.fields)


def pascal(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def camel(name: str) -> str:
    text = pascal(name)
    return text[0].lower() + text[1:]


# ---------------------------------------------------------------- reading the schema


def checked_name(value: object, where: str) -> str:
    if not isinstance(value, str) or not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", value):
        raise SchemaError(f"{where}: {value!r} is not a snake_case name")
    return value


def read_field(entry: dict[str, Any], where: str, enums: dict[str, Enum]) -> Field:
    name = checked_name(entry.get("name"), where)
    where = f"{where}.{name}"
    kind: object = entry.get("type")
    item = ""
    if isinstance(kind, dict) and set(kind) == {"array"}:
        item = checked_name(next(iter(kind.values())), where)
        kind = "array"
    if not isinstance(kind, str) or (kind != "array" and kind not in CPP_TYPES):
        raise SchemaError(f"{where}: unknown type {kind!r}")
    limit = entry.get("max", 0)
    if kind in ("array", "string") and (not isinstance(limit, int) or limit < 1):
        raise SchemaError(f"{where}: a string or array needs a positive 'max'")
    enum = entry.get("enum", "")
    if enum and (enum not in enums or kind != "u8"):
        raise SchemaError(f"{where}: enum {enum!r} is unknown, or the field is not a u8")
    return Field(name, kind, item, limit, enum, entry.get("doc", ""))


def read_struct(entry: dict[str, Any], enums: dict[str, Enum], is_message: bool) -> Struct:
    name = checked_name(entry.get("name"), "struct or message")
    fields = tuple(read_field(field, name, enums) for field in entry.get("fields", []))
    if any(field.name == "type" for field in fields):
        raise SchemaError(f"{name}: 'type' is taken by the message's type")
    if not fields or len({field.name for field in fields}) != len(fields):
        raise SchemaError(f"{name}: needs fields with different names")
    number = entry.get("type")
    if is_message and not (isinstance(number, int) and 0 < number < 256):
        raise SchemaError(f"{name}: a message needs a type from 1 to 255")
    in_place = bool(entry.get("in_place"))
    return Struct(name, entry.get("doc", ""), fields, number if is_message else None, in_place)


def read_schema(path: Path) -> Schema:
    """Read and check the schema. Raises SchemaError, OSError or json.JSONDecodeError."""
    data = json.loads(path.read_text(encoding="utf-8"))
    constants = tuple(
        Constant(checked_name(c["name"], "constant"), c["type"], int(c["value"]), c.get("doc", ""))
        for c in data["constants"]
    )
    enums = {
        e["name"]: Enum(
            checked_name(e["name"], "enum"),
            e.get("doc", ""),
            tuple((checked_name(v["name"], e["name"]), int(v["value"])) for v in e["values"]),
        )
        for e in data["enums"]
    }
    for enum in enums.values():
        if [value for _, value in enum.values] != list(range(len(enum.values))):
            raise SchemaError(f"{enum.name}: values must count up from 0")
    structs: dict[str, Struct] = {}
    for entry in data["structs"]:
        struct = read_struct(entry, enums, is_message=False)
        if any(field.kind == "array" for field in struct.fields):
            raise SchemaError(f"{struct.name}: arrays inside structs are not supported")
        structs[struct.name] = struct
    client = tuple(read_struct(e, enums, is_message=True) for e in data["client_messages"])
    server = tuple(read_struct(e, enums, is_message=True) for e in data["server_messages"])
    schema = Schema(int(data["version"]), constants, enums, structs, client, server)
    check_whole(schema)
    return schema


def check_whole(schema: Schema) -> None:
    names = [m.name for m in schema.messages] + list(schema.structs) + list(schema.enums)
    if len(set(names)) != len(names):
        raise SchemaError("two entries have the same name")
    if len({m.type for m in schema.messages}) != len(schema.messages):
        raise SchemaError("two messages have the same type")
    for message in schema.messages:
        for field in message.fields:
            if field.kind == "array" and field.item not in schema.structs:
                raise SchemaError(f"{message.name}.{field.name}: no struct {field.item!r}")
            if message.in_place and field.kind == "array":
                if any(f.kind == "string" for f in schema.structs[field.item].fields):
                    raise SchemaError(f"{message.name}: in_place arrays cannot hold strings")
            if message.in_place and field.kind == "string":
                raise SchemaError(f"{message.name}: an in_place message cannot hold strings")


# ------------------------------------------------------------------------------- C++

CPP_HEAD = """\
// SPDX-License-Identifier: Apache-2.0
// Made by tools/generate_protocol.py from protocol/schema.json; changes here are lost.
//
// Messages between server and page: little-endian, the first byte is the message's type.
// encode() throws std::length_error (string or array above its limit) or
// std::invalid_argument (a float that is not finite). decode_...() never throws for bad
// bytes: it checks bounds, counts, UTF-8, enumerators, finite floats and trailing bytes,
// and gives a message or a reason.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace iota::protocol {

using Vec3 = std::array<float, 3>;

/// A decoded message, or the reason why there is none.
template <class T>
struct Decoded {
  std::optional<T> value;
  std::string error;
  explicit operator bool() const { return value.has_value(); }
};
"""

CPP_DETAIL = """
namespace detail {

/// Whether `text` is well-formed UTF-8 (no overlong forms, no surrogates).
inline bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    if (lead < 0x80) continue;
    const int more = lead >= 0xC2 && lead <= 0xDF   ? 1
                     : lead >= 0xE0 && lead <= 0xEF ? 2
                     : lead >= 0xF0 && lead <= 0xF4 ? 3
                                                    : 0;
    if (more == 0 || text.size() - i < static_cast<std::size_t>(more)) return false;
    for (int k = 0; k < more; ++k) {
      const auto next = static_cast<unsigned char>(text[i++]);
      unsigned char low = 0x80;
      unsigned char high = 0xBF;
      if (k == 0 && lead == 0xE0) low = 0xA0;
      if (k == 0 && lead == 0xED) high = 0x9F;
      if (k == 0 && lead == 0xF0) low = 0x90;
      if (k == 0 && lead == 0xF4) high = 0x8F;
      if (next < low || next > high) return false;
    }
  }
  return true;
}

class Writer {
 public:
  explicit Writer(std::vector<std::uint8_t>& out) : out_(out) {}

  template <class UInt>
  void integer(UInt value) {
    const std::size_t at = out_.size();
    out_.resize(at + sizeof(UInt));
    for (std::size_t i = 0; i < sizeof(UInt); ++i) {
      out_[at + i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
    }
  }
  void real(float value, const char* field) {
    check_finite(value, field);
    integer(std::bit_cast<std::uint32_t>(value));
  }
  void real(double value, const char* field) {
    check_finite(value, field);
    integer(std::bit_cast<std::uint64_t>(value));
  }
  void vec3(const Vec3& value, const char* field) {
    for (const float component : value) real(component, field);
  }
  void count(std::size_t count, std::size_t limit, const char* field) {
    if (count > limit) {
      throw std::length_error(std::string(field) + ": " + std::to_string(count) +
                              " is above the limit of " + std::to_string(limit));
    }
    integer(static_cast<std::uint32_t>(count));
  }
  void text(std::string_view value, std::size_t limit, const char* field) {
    count(value.size(), limit, field);
    if (!is_utf8(value)) throw std::invalid_argument(std::string(field) + ": is not UTF-8");
    out_.insert(out_.end(), value.begin(), value.end());
  }

 private:
  static void check_finite(double value, const char* field) {
    if (!std::isfinite(value)) {
      throw std::invalid_argument(std::string(field) + ": is not a finite number");
    }
  }
  std::vector<std::uint8_t>& out_;
};

/// Reads fields in order; after the first failure all further reads do nothing.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <class UInt>
  void integer(UInt& value, const char* field) {
    if (!has(sizeof(UInt), field)) return;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(UInt); ++i) {
      bits |= static_cast<std::uint64_t>(bytes_[at_ + i]) << (8 * i);
    }
    at_ += sizeof(UInt);
    value = static_cast<UInt>(bits);
  }
  void boolean(bool& value, const char* field) {
    std::uint8_t byte = 0;
    integer(byte, field);
    if (byte > 1) fail(field, "is neither 0 nor 1");
    value = byte == 1;
  }
  template <class E>
  void enumerator(E& value, unsigned count, const char* field) {
    std::uint8_t byte = 0;
    integer(byte, field);
    if (byte >= count) {
      fail(field, "has no meaning for the value " + std::to_string(byte));
    } else {
      value = static_cast<E>(byte);
    }
  }
  void real(float& value, const char* field) {
    std::uint32_t bits = 0;
    integer(bits, field);
    value = std::bit_cast<float>(bits);
    if (!std::isfinite(value)) fail(field, "is not a finite number");
  }
  void real(double& value, const char* field) {
    std::uint64_t bits = 0;
    integer(bits, field);
    value = std::bit_cast<double>(bits);
    if (!std::isfinite(value)) fail(field, "is not a finite number");
  }
  void vec3(Vec3& value, const char* field) {
    for (float& component : value) real(component, field);
  }
  /// Checked against the bytes left before anything is allocated for it.
  std::size_t count(std::size_t limit, std::size_t smallest_item, const char* field) {
    std::uint32_t count = 0;
    integer(count, field);
    if (!ok()) return 0;
    if (count > limit) {
      fail(field, "has " + std::to_string(count) + " entries, at most " + std::to_string(limit) +
                      " are allowed");
    } else if (count > left() / smallest_item) {
      fail(field, "ends early");
    }
    return ok() ? count : 0;
  }
  void text(std::string& value, std::size_t limit, const char* field) {
    const std::size_t size = count(limit, 1, field);
    if (!ok()) return;
    value.assign(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                 bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + size));
    at_ += size;
    if (!is_utf8(value)) fail(field, "is not UTF-8");
  }
  void fail(const char* field, std::string_view what) {
    if (error_.empty()) error_.append(field).append(" ").append(what);
  }
  bool ok() const { return error_.empty(); }
  std::size_t left() const { return bytes_.size() - at_; }
  const std::string& error() const { return error_; }

 private:
  bool has(std::size_t size, const char* field) {
    if (ok() && left() < size) fail(field, "ends early");
    return ok();
  }
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  std::string error_;
};
"""


def cpp_type(field: Field) -> str:
    if field.kind == "array":
        return f"std::vector<{pascal(field.item)}>"
    return pascal(field.enum) if field.enum else CPP_TYPES[field.kind]


def cpp_struct(struct: Struct) -> list[str]:
    lines = ["", f"/// {struct.doc}", f"struct {pascal(struct.name)} {{"]
    if struct.type is not None:
        lines.append(f"  static constexpr MessageType message_type = MessageType::{struct.name};")
    for field in struct.fields:
        note = f"  ///< {field.doc}" if field.doc else ""
        lines.append(f"  {cpp_type(field)} {field.name}{{}};{note}")
    name = pascal(struct.name)
    return lines + [f"  bool operator==(const {name}&) const = default;", "};"]


def cpp_write_field(field: Field, owner: str) -> list[str]:
    value, label = f"value.{field.name}", f'"{owner}.{field.name}"'
    if field.enum:
        return [f"out.integer(static_cast<std::uint8_t>({value}));"]
    if field.kind in ("u8", "u16", "u32", "u64"):
        return [f"out.integer({value});"]
    if field.kind == "bool":
        return [f"out.integer(static_cast<std::uint8_t>({value}));"]
    if field.kind in ("f32", "f64"):
        return [f"out.real({value}, {label});"]
    if field.kind == "vec3":
        return [f"out.vec3({value}, {label});"]
    if field.kind == "string":
        return [f"out.text({value}, {field.max}, {label});"]
    return [
        f"out.count({value}.size(), {field.max}, {label});",
        f"for (const {pascal(field.item)}& item : {value}) write(out, item);",
    ]


def cpp_read_field(field: Field, owner: str, schema: Schema) -> list[str]:
    value, label = f"value.{field.name}", f'"{owner}.{field.name}"'
    if field.enum:
        return [f"in.enumerator({value}, {len(schema.enums[field.enum].values)}, {label});"]
    if field.kind in ("u8", "u16", "u32", "u64"):
        return [f"in.integer({value}, {label});"]
    if field.kind == "bool":
        return [f"in.boolean({value}, {label});"]
    if field.kind in ("f32", "f64"):
        return [f"in.real({value}, {label});"]
    if field.kind == "vec3":
        return [f"in.vec3({value}, {label});"]
    if field.kind == "string":
        return [f"in.text({value}, {field.max}, {label});"]
    smallest = schema.smallest(schema.structs[field.item])
    return [
        f"{value}.resize(in.count({field.max}, {smallest}, {label}));",
        f"for ({pascal(field.item)}& item : {value}) read(in, item);",
    ]


def cpp_codec(struct: Struct, schema: Schema) -> list[str]:
    name = pascal(struct.name)
    lines = ["", f"inline void write(Writer& out, const {name}& value) {{"]
    for field in struct.fields:
        lines += ["  " + line for line in cpp_write_field(field, struct.name)]
    lines += ["}", "", f"inline void read(Reader& in, {name}& value) {{"]
    for field in struct.fields:
        lines += ["  " + line for line in cpp_read_field(field, struct.name, schema)]
    return lines + ["}"]


def cpp_decode(direction: str, messages: tuple[Struct, ...]) -> list[str]:
    variant = f"{pascal(direction)}Message"
    lines = [
        "",
        f"/// A message that a {direction} sends, from the whole `bytes` of one frame.",
        f"inline Decoded<{variant}> decode_{direction}_message(std::span<const std::uint8_t> bytes) {{",
        '  if (bytes.empty()) return {std::nullopt, "the frame is empty"};',
        "  switch (bytes[0]) {",
    ]
    for message in messages:
        name = pascal(message.name)
        lines.append(f"    case {message.type}:")
        lines.append(f"      return detail::decode_as<{variant}, {name}>(bytes.subspan(1));")
    return lines + [
        "    default:",
        "      return {std::nullopt,",
        f'              "no message that a {direction} sends has the type " + std::to_string(bytes[0])}};',
        "  }",
        "}",
    ]


CPP_ENCODE = """
/// Appends the frame of `message` to `out`; on an exception `out` is as it was.
template <class Message>
void encode(const Message& message, std::vector<std::uint8_t>& out) {
  const std::size_t before = out.size();
  try {
    out.push_back(static_cast<std::uint8_t>(Message::message_type));
    detail::Writer writer(out);
    detail::write(writer, message);
  } catch (...) {
    out.resize(before);
    throw;
  }
}

/// The frame of `message`.
template <class Message>
std::vector<std::uint8_t> encode(const Message& message) {
  std::vector<std::uint8_t> out;
  encode(message, out);
  return out;
}
"""

CPP_DECODE_AS = """
template <class Variant, class Message>
Decoded<Variant> decode_as(std::span<const std::uint8_t> bytes) {
  Reader in(bytes);
  Message message;
  read(in, message);
  if (in.ok() && in.left() > 0) {
    in.fail("the frame", "has " + std::to_string(in.left()) + " bytes too many");
  }
  if (!in.ok()) return {std::nullopt, in.error()};
  return {Variant(std::move(message)), {}};
}

}  // namespace detail
"""


def make_cpp(schema: Schema) -> str:
    lines = [
        CPP_HEAD,
        f"inline constexpr std::uint16_t protocol_version = {schema.version};",
    ]
    for constant in schema.constants:
        lines.append(f"/// {constant.doc}")
        kind = CPP_TYPES[constant.kind]
        lines.append(f"inline constexpr {kind} {constant.name} = {constant.value}U;")
    lines += ["", "enum class MessageType : std::uint8_t {"]
    lines += [f"  {message.name} = {message.type}," for message in schema.messages]
    lines.append("};")
    for enum in schema.enums.values():
        lines += ["", f"/// {enum.doc}", f"enum class {pascal(enum.name)} : std::uint8_t {{"]
        lines += [f"  {name} = {value}," for name, value in enum.values]
        lines.append("};")
    for struct in (*schema.structs.values(), *schema.messages):
        lines += cpp_struct(struct)
    for direction, messages in (("client", schema.client), ("server", schema.server)):
        names = ", ".join(pascal(message.name) for message in messages)
        lines += ["", f"using {pascal(direction)}Message = std::variant<{names}>;"]
    lines.append(CPP_DETAIL.rstrip("\n"))
    for struct in (*schema.structs.values(), *schema.messages):
        lines += cpp_codec(struct, schema)
    lines.append(CPP_DECODE_AS.rstrip("\n"))
    lines.append(CPP_ENCODE.rstrip("\n"))
    lines += cpp_decode("client", schema.client)
    lines += cpp_decode("server", schema.server)
    return "\n".join([*lines, "", "}  // namespace iota::protocol", ""])


# ------------------------------------------------------------------------ TypeScript

TS_HEAD = """\
// SPDX-License-Identifier: Apache-2.0
// Made by tools/generate_protocol.py from protocol/schema.json; changes here are lost.
//
// Messages between server and page: little-endian, the first byte is the message's type.
// Every encode and decode function throws ProtocolError; decoders check bounds, counts,
// UTF-8, enumerators, finite floats and trailing bytes.
/* eslint-disable */

/** Three numbers; meters wherever it is a place. */
export type Vec3 = [number, number, number];

/** Why a frame cannot be read or written. */
export class ProtocolError extends Error {
  constructor(text: string) {
    super(text);
    this.name = 'ProtocolError';
  }
}
"""

TS_DETAIL = """
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
  count(count: number, limit: number, field: string): void {
    if (count > limit) {
      throw new ProtocolError(`${field}: ${count} is above the limit of ${limit}`);
    }
    this.u32(count, field);
  }
  text(value: string, limit: number, field: string): void {
    const bytes = encoder.encode(value);
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
  text(limit: number, field: string): string {
    const size = this.count(limit, 1, field);
    const at = this.take(size, field);
    try {
      return decoder.decode(
        new Uint8Array(this.view.buffer, this.view.byteOffset + at, size),
      );
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
"""

TS_POSES = """
const ROTATION_STEP = Math.SQRT2 / 1023;

/** Unit quaternion (x y z w) of a packed rotation, written to out[offset .. offset + 3]. */
export function unpackRotation(packed: number, out: Float32Array, offset: number): void {
  const largest = packed >>> 30;
  let rest = 1;
  let shift = 20;
  for (let i = 0; i < 4; i++) {
    if (i === largest) continue;
    const value = ((packed >>> shift) & 1023) * ROTATION_STEP - Math.SQRT1_2;
    out[offset + i] = value;
    rest -= value * value;
    shift -= 10;
  }
  out[offset + largest] = Math.sqrt(Math.max(rest, 0));
}

/** Position (world, m) of row `i` of `poses.bodies`, written to out[offset .. offset + 2]. */
export function unpackPosition(
  poses: PosesBuffer,
  i: number,
  out: Float32Array,
  offset: number,
): void {
  const { bodies, boxMin, boxMax } = poses;
  const lowX = boxMin[0] as number;
  const lowY = boxMin[1] as number;
  const lowZ = boxMin[2] as number;
  out[offset] = lowX + ((bodies.x[i] as number) / 65535) * ((boxMax[0] as number) - lowX);
  out[offset + 1] = lowY + ((bodies.y[i] as number) / 65535) * ((boxMax[1] as number) - lowY);
  out[offset + 2] = lowZ + ((bodies.z[i] as number) / 65535) * ((boxMax[2] as number) - lowZ);
}

const scratchPosition = new Float32Array(3);
const scratchRotation = new Float32Array(4);

/**
 * Calls `set` for every body of the frame, near and far: slot, position (x y z, world, m), unit quaternion (x y z w).
 * The two arrays are reused by the next call: copy what has to stay.
 */
export function forEachPose(
  poses: PosesBuffer,
  set: (body: number, position: Float32Array, rotation: Float32Array) => void,
): void {
  const { bodies, farBodies } = poses;
  for (let i = 0; i < bodies.count; i++) {
    unpackPosition(poses, i, scratchPosition, 0);
    unpackRotation(bodies.rotation[i] as number, scratchRotation, 0);
    set(bodies.body[i] as number, scratchPosition, scratchRotation);
  }
  for (let i = 0; i < farBodies.count; i++) {
    for (let k = 0; k < 3; k++) scratchPosition[k] = farBodies.position[3 * i + k] as number;
    unpackRotation(farBodies.rotation[i] as number, scratchRotation, 0);
    set(farBodies.body[i] as number, scratchPosition, scratchRotation);
  }
}
"""


def ts_constant(name: str) -> str:
    return name.upper()


def ts_type(field: Field) -> str:
    if field.kind == "array":
        return f"{pascal(field.item)}[]"
    return pascal(field.enum) if field.enum else TS_TYPES.get(field.kind, "number")


def ts_interface(struct: Struct) -> list[str]:
    lines = ["", f"/** {struct.doc} */", f"export interface {pascal(struct.name)} {{"]
    if struct.type is not None:
        lines.append(f"  type: '{camel(struct.name)}';")
    for field in struct.fields:
        if field.doc:
            lines.append(f"  /** {field.doc} */")
        lines.append(f"  {camel(field.name)}: {ts_type(field)};")
    return lines + ["}"]


def ts_write_field(field: Field, owner: str) -> list[str]:
    value, label = f"value.{camel(field.name)}", f"'{owner}.{field.name}'"
    if field.kind == "bool":
        return [f"writer.bool({value});"]
    if field.kind == "string":
        return [f"writer.text({value}, {field.max}, {label});"]
    if field.kind == "array":
        return [
            f"writer.count({value}.length, {field.max}, {label});",
            f"for (const item of {value}) write{pascal(field.item)}(item);",
        ]
    return [f"writer.{field.kind}({value}, {label});"]


def ts_read(field: Field, owner: str, schema: Schema) -> str:
    label = f"'{owner}.{field.name}'"
    if field.enum:
        count = len(schema.enums[field.enum].values)
        return f"reader.choice({count}, {label}) as {pascal(field.enum)}"
    if field.kind == "string":
        return f"reader.text({field.max}, {label})"
    if field.kind == "array":
        smallest = schema.smallest(schema.structs[field.item])
        return f"readArray({field.max}, {smallest}, {label}, read{pascal(field.item)})"
    return f"reader.{field.kind}({label})"


def ts_codec(struct: Struct, schema: Schema) -> list[str]:
    name = pascal(struct.name)
    lines = ["", f"function write{name}(value: Readonly<{name}>): void {{"]
    for field in struct.fields:
        lines += ["  " + line for line in ts_write_field(field, struct.name)]
    lines += ["}", "", f"function read{name}(): {name} {{", "  return {"]
    if struct.type is not None:
        lines.append(f"    type: '{camel(struct.name)}',")
    for field in struct.fields:
        lines.append(f"    {camel(field.name)}: {ts_read(field, struct.name, schema)},")
    lines += ["  };", "}"]
    if struct.type is None:
        return lines
    return lines + [
        "",
        f"export function encode{name}(message: Readonly<{name}>): ArrayBuffer {{",
        f"  writer.start({struct.type});",
        f"  write{name}(message);",
        "  return writer.finish();",
        "}",
        "",
        f"export function decode{name}(data: ArrayBuffer | Uint8Array): {name} {{",
        f"  reader.start(data, {struct.type});",
        f"  const message = read{name}();",
        "  reader.finish();",
        "  return message;",
        "}",
    ]


def ts_columns(struct: Struct) -> list[str]:
    """A growing struct of arrays, so that a frame is decoded without allocation."""
    name = f"{pascal(struct.name)}Columns"
    lines = [
        "",
        f"/** Columns of {camel(struct.name)}; rows from `count` on are left over from earlier. */",
        f"export class {name} {{",
        "  count = 0;",
        "  capacity = 0;",
    ]
    widths = {field.name: 3 if field.kind == "vec3" else 1 for field in struct.fields}
    for field in struct.fields:
        if widths[field.name] == 3:
            lines.append("  /** Three numbers a row. */")
        lines.append(f"  {camel(field.name)} = new {TS_COLUMNS[field.kind]}(0);")
    lines += ["", "  /** Makes room for `rows`; contents are lost when it has to grow. */"]
    lines += ["  reserve(rows: number): void {", "    if (rows <= this.capacity) return;"]
    lines.append("    this.capacity = Math.max(rows, 2 * this.capacity, 64);")
    for field in struct.fields:
        size = "this.capacity" if widths[field.name] == 1 else "3 * this.capacity"
        lines.append(f"    this.{camel(field.name)} = new {TS_COLUMNS[field.kind]}({size});")
    return lines + ["  }", "}"]


def ts_in_place(message: Struct, schema: Schema) -> list[str]:
    name = pascal(message.name)
    lines: list[str] = []
    for field in message.fields:
        if field.kind == "array":
            lines += ts_columns(schema.structs[field.item])
    lines += [
        "",
        f"/** {message.doc}",
        f" *  One buffer is filled again and again by decode{name}Into. */",
        f"export class {name}Buffer {{",
    ]
    for field in message.fields:
        if field.doc:
            lines.append(f"  /** {field.doc} */")
        if field.kind == "array":
            lines.append(f"  {camel(field.name)} = new {pascal(field.item)}Columns();")
        elif field.kind == "vec3":
            lines.append(f"  {camel(field.name)} = new Float32Array(3);")
        else:
            initial = "false" if field.kind == "bool" else "0"
            lines.append(f"  {camel(field.name)} = {initial};")
    lines += [
        "}",
        "",
        f"/** Decodes a {message.name} frame into `out` without allocating once it is large enough.",
        " *  After a ProtocolError its contents are a mixture of old and new. */",
        f"export function decode{name}Into(data: ArrayBuffer | Uint8Array, out: {name}Buffer): void {{",
        f"  reader.start(data, {message.type});",
    ]
    for field in message.fields:
        lines += ["  " + line for line in ts_read_into(field, message.name, schema)]
    return lines + ["  reader.finish();", "}"]


def ts_read_into(field: Field, owner: str, schema: Schema) -> list[str]:
    target, label = f"out.{camel(field.name)}", f"'{owner}.{field.name}'"
    if field.kind == "vec3":
        return [f"reader.vec3Into({target}, 0, {label});"]
    if field.kind != "array":
        return [f"{target} = {ts_read(field, owner, schema)};"]
    struct = schema.structs[field.item]
    rows = camel(field.name)
    lines = [
        f"const {rows} = {target};",
        f"{rows}.count = 0;",
        f"const {rows}Count = reader.count({field.max}, {schema.smallest(struct)}, {label});",
        f"{rows}.reserve({rows}Count);",
        f"for (let i = 0; i < {rows}Count; i++) {{",
    ]
    for inner in struct.fields:
        column, label = f"{rows}.{camel(inner.name)}", f"'{struct.name}.{inner.name}'"
        if inner.kind == "vec3":
            lines.append(f"  reader.vec3Into({column}, 3 * i, {label});")
        else:
            value = ts_read(inner, struct.name, schema)
            lines.append(f"  {column}[i] = {value}{' ? 1 : 0' if inner.kind == 'bool' else ''};")
    return [*lines, "}", f"{rows}.count = {rows}Count;"]


def ts_directions(direction: str, messages: tuple[Struct, ...]) -> list[str]:
    union = f"{pascal(direction)}Message"
    lines = ["", f"/** Any message that a {direction} sends. */", f"export type {union} ="]
    lines += [f"  | {pascal(message.name)}" for message in messages]
    lines[-1] += ";"
    lines += ["", f"export function encode{union}(message: Readonly<{union}>): ArrayBuffer {{"]
    lines.append("  switch (message.type) {")
    for message in messages:
        lines.append(f"    case '{camel(message.name)}':")
        lines.append(f"      return encode{pascal(message.name)}(message);")
    lines += ["  }", "}", ""]
    lines.append(f"export function decode{union}(data: ArrayBuffer | Uint8Array): {union} {{")
    lines += ["  const type = messageTypeOf(data);", "  switch (type) {"]
    for message in messages:
        lines.append(f"    case {message.type}:")
        lines.append(f"      return decode{pascal(message.name)}(data);")
    return lines + [
        "    default:",
        f"      throw new ProtocolError(`no message that a {direction} sends has the type ${{type}}`);",
        "  }",
        "}",
    ]


TS_READ_ARRAY = """
function readArray<T>(limit: number, smallestItem: number, field: string, read: () => T): T[] {
  const items = new Array<T>(reader.count(limit, smallestItem, field));
  for (let i = 0; i < items.length; i++) items[i] = read();
  return items;
}
"""


def ts_numbers(name: str, doc: str, values: list[tuple[str, int]]) -> list[str]:
    lines = ["", f"/** {doc} */", f"export const {name} = {{"]
    lines += [f"  {camel(key)}: {value}," for key, value in values]
    return lines + [
        "} as const;",
        f"export type {name} = (typeof {name})[keyof typeof {name}];",
    ]


def make_ts(schema: Schema) -> str:
    lines = [TS_HEAD, f"export const PROTOCOL_VERSION = {schema.version};"]
    for constant in schema.constants:
        lines.append(f"/** {constant.doc} */")
        lines.append(f"export const {ts_constant(constant.name)} = {constant.value};")
    numbers = [(message.name, message.type or 0) for message in schema.messages]
    lines += ts_numbers("MessageType", "First byte of every frame.", numbers)
    for enum in schema.enums.values():
        lines += ts_numbers(pascal(enum.name), enum.doc, list(enum.values))
    for struct in (*schema.structs.values(), *schema.messages):
        lines += ts_interface(struct)
    lines.append(TS_DETAIL.rstrip("\n"))
    lines.append(TS_READ_ARRAY.rstrip("\n"))
    for struct in (*schema.structs.values(), *schema.messages):
        lines += ts_codec(struct, schema)
    for message in schema.messages:
        if message.in_place:
            lines += ts_in_place(message, schema)
    lines.append(TS_POSES.rstrip("\n"))
    lines += ts_directions("client", schema.client)
    lines += ts_directions("server", schema.server)
    return "\n".join([*lines, ""])


# --------------------------------------------------------------------------- writing


def write_if_changed(path: Path, text: str) -> bool:
    """Replace `path` atomically unless it already holds `text`; whether it was replaced."""
    data = text.encode("utf-8")
    if path.is_file() and path.read_bytes() == data:
        return False
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise
    return True


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--cpp", type=Path, help="C++ header to write")
    parser.add_argument("--ts", type=Path, help="TypeScript module to write")
    parser.add_argument("--schema", type=Path, default=SCHEMA)
    arguments = parser.parse_args()
    if arguments.cpp is None and arguments.ts is None:
        parser.error("give --cpp FILE, --ts FILE or both")
    try:
        schema = read_schema(arguments.schema)
        if arguments.cpp is not None:
            write_if_changed(arguments.cpp, make_cpp(schema))
        if arguments.ts is not None:
            write_if_changed(arguments.ts, make_ts(schema))
    except (SchemaError, OSError, ValueError, KeyError) as error:
        print(f"generate_protocol: {arguments.schema}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
