# SPDX-License-Identifier: Apache-2.0
"""The C++ side: one header."""

from __future__ import annotations

from protocol import fragment
from protocol.schema import INTEGERS, REALS, Schema, Struct, Type, pascal

TYPES = {
    "u8": "std::uint8_t",
    "bool": "bool",
    "u16": "std::uint16_t",
    "u32": "std::uint32_t",
    "u64": "std::uint64_t",
    "f32": "float",
    "f64": "double",
    "vec3": "Vec3",
    "quat": "Quat",
    "id": "Id",
    "string": "std::string",
    "bytes": "std::vector<std::uint8_t>",
}
KEYWORDS = {"break", "static", "switch", "default", "new", "delete"}


def make(schema: Schema) -> str:
    lines = [fragment("head.h"), "", f"inline constexpr std::uint16_t protocol_version = {schema.version};"]
    for constant in schema.constants:
        lines.append(f"/// {constant.doc}")
        lines.append(f"inline constexpr {TYPES[constant.kind]} {constant.name} = {constant.value}U;")
    lines += ["", "enum class MessageType : std::uint8_t {"]
    lines += [f"  {message.name} = {message.number}," for message in schema.messages]
    lines.append("};")
    for enum in schema.enums.values():
        lines += ["", f"/// {enum.doc}", f"enum class {pascal(enum.name)} : std::uint8_t {{"]
        lines += [f"  {spelled(name)} = {value}," for name, value in enum.values]
        lines.append("};")
    for struct in schema.coded:
        lines += definition(struct)
    kinds = ", ".join(pascal(entity.name) for entity in schema.entities)
    lines += ["", "/// A record of each kind of entities: what one refers to comes before it."]
    lines.append(f"using EntityKinds = std::tuple<{kinds}>;")
    for direction, messages in (("client", schema.client), ("server", schema.server)):
        names = ", ".join(pascal(message.name) for message in messages)
        lines += ["", f"using {pascal(direction)}Message = std::variant<{names}>;"]
    lines += ["", fragment("codec.h")]
    for struct in schema.coded:
        lines += codec(struct, schema)
    lines += ["", fragment("frames.h")]
    lines += decoder("client", schema.client)
    lines += decoder("server", schema.server)
    return "\n".join([*lines, "", "}  // namespace iota::protocol", ""])


def spelled(name: str) -> str:
    return f"{name}_" if name in KEYWORDS else name


def type_name(type: Type) -> str:
    if type.kind == "array":
        return f"std::vector<{type_name(type.element)}>"
    if type.kind == "struct":
        return pascal(type.struct)
    return pascal(type.enum) if type.enum else TYPES[type.kind]


def definition(struct: Struct) -> list[str]:
    name = pascal(struct.name)
    lines = ["", f"/// {struct.doc}", f"struct {name} {{"]
    if struct.number:
        lines.append(f"  static constexpr MessageType message_type = MessageType::{struct.name};")
    if struct.kind:
        lines.append(f'  static constexpr std::string_view kind_name = "{struct.kind}";')
    for field in struct.fields:
        note = f"  ///< {field.doc}" if field.doc else ""
        lines.append(f"  {type_name(field.type)} {field.name}{{}};{note}")
    return [*lines, f"  bool operator==(const {name}&) const = default;", "};"]


def write(type: Type, value: str, label: str) -> list[str]:
    """Statements that append a value to `out`; label: the field's name in error texts."""
    if type.enum or type.kind == "bool":
        return [f"out.integer(static_cast<std::uint8_t>({value}));"]
    if type.kind in INTEGERS:
        return [f"out.integer({value});"]
    if type.kind in REALS:
        return [f"out.real({value}, {label});"]
    if type.kind in ("vec3", "quat"):
        return [f"out.reals({value}, {label});"]
    if type.kind in ("string", "bytes"):
        return [f"out.{'text' if type.kind == 'string' else 'bytes'}({value}, {type.max}, {label});"]
    if type.kind == "array":
        inner = ["  " + line for line in write(type.element, "item", label)]
        return [
            f"out.count({value}.size(), {type.max}, {label});",
            f"for (const {type_name(type.element)}& item : {value}) {{",
            *inner,
            "}",
        ]
    return [f"write(out, {value});"]  # an id or a struct


def read(type: Type, value: str, label: str, schema: Schema) -> list[str]:
    """Statements that read a value from `in`."""
    if type.enum:
        return [f"in.enumerator({value}, {len(schema.enums[type.enum].values)}, {label});"]
    if type.kind in INTEGERS:
        return [f"in.integer({value}, {label});"]
    if type.kind in REALS:
        return [f"in.real({value}, {label});"]
    if type.kind in ("vec3", "quat"):
        return [f"in.reals({value}, {label});"]
    if type.kind == "bool":
        return [f"in.boolean({value}, {label});"]
    if type.kind in ("string", "bytes"):
        return [f"in.{'text' if type.kind == 'string' else 'bytes'}({value}, {type.max}, {label});"]
    if type.kind == "array":
        inner = ["  " + line for line in read(type.element, "item", label, schema)]
        return [
            f"{value}.resize(in.count({type.max}, {schema.smallest(type.element)}, {label}));",
            f"for ({type_name(type.element)}& item : {value}) {{",
            *inner,
            "}",
        ]
    return [f"read(in, {value}, {label});"] if type.kind == "id" else [f"read(in, {value});"]


def codec(struct: Struct, schema: Schema) -> list[str]:
    name = pascal(struct.name)
    lines = ["", f"inline void write(Writer& out, const {name}& value) {{"]
    for field in struct.fields:
        lines += ["  " + line for line in write(field.type, f"value.{field.name}", f'"{struct.name}.{field.name}"')]
    lines += ["}", "", f"inline void read(Reader& in, {name}& value) {{"]
    for field in struct.fields:
        statements = read(field.type, f"value.{field.name}", f'"{struct.name}.{field.name}"', schema)
        lines += ["  " + line for line in statements]
    return [*lines, "}"]


def decoder(direction: str, messages: tuple[Struct, ...]) -> list[str]:
    variant = f"{pascal(direction)}Message"
    lines = [
        "",
        f"/// A message that a {direction} sends, from the whole `bytes` of one frame.",
        f"inline Decoded<{variant}> decode_{direction}_message(std::span<const std::uint8_t> bytes) {{",
        '  if (bytes.empty()) return {std::nullopt, "the frame is empty"};',
        "  switch (bytes[0]) {",
    ]
    for message in messages:
        lines.append(f"    case {message.number}:")
        lines.append(f"      return detail::decode_as<{variant}, {pascal(message.name)}>(bytes.subspan(1));")
    return [
        *lines,
        "    default:",
        "      return {std::nullopt,",
        f'              "no message that a {direction} sends has the type " + std::to_string(bytes[0])}};',
        "  }",
        "}",
    ]
