# SPDX-License-Identifier: Apache-2.0
"""The C++ side: one header, and one with golden values for its tests."""

from __future__ import annotations

from typing import Any

from protocol import fragment
from protocol.schema import INTEGERS, REALS, Schema, SchemaError, Struct, Type, pascal

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
    for struct in (*schema.coded, *schema.events):
        lines += definition(struct, schema)
    kinds = ", ".join(pascal(entity.name) for entity in schema.entities)
    lines += ["", "/// A record of each kind of entities: what one refers to comes before it."]
    lines.append(f"using EntityKinds = std::tuple<{kinds}>;")
    for direction, messages in (("client", schema.client), ("server", schema.server)):
        names = ", ".join(pascal(message.name) for message in messages)
        lines += ["", f"using {pascal(direction)}Message = std::variant<{names}>;"]
    inputs = ", ".join(pascal(each.name) for each in schema.inputs)
    lines += ["", "/// Everything that a script is told of clients.", f"using Input = std::variant<{inputs}>;", ""]
    for name in (*schema.enums, *(record.name for record in schema.records)):
        lines.append(f'template <>\ninline constexpr const char* record_name<{pascal(name)}> = "{pascal(name)}";')
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


def definition(struct: Struct, schema: Schema) -> list[str]:
    name = pascal(struct.name)
    lines = ["", f"/// {struct.doc}", f"struct {name} {{"]
    if struct.number:
        lines.append(f"  static constexpr MessageType message_type = MessageType::{struct.name};")
    if struct.kind:
        lines.append(f'  static constexpr std::string_view kind_name = "{struct.kind}";')
    if struct in schema.client:
        lines.append(f'  static constexpr std::string_view message_name = "{struct.name}";')
        lines.append(f"  static constexpr Viewers viewers = Viewers::{struct.viewers};")
        is_for_script = "true" if struct.receiver == "script" else "false"
        lines.append(f"  static constexpr bool is_for_script = {is_for_script};")
    for field in struct.fields:
        note = f"  ///< {field.doc}" if field.doc else ""
        lines.append(f"  {type_name(field.type)} {field.name}{{}};{note}")
    if struct in (*schema.structs.values(), *schema.client, *schema.events):
        names = ", ".join(field.name for field in struct.fields)
        lines.append(f"  auto fields() const {{ return std::tie({names}); }}")
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


def make_vectors(schema: Schema, vectors: dict[str, Any]) -> str:
    """The values of protocol/golden/vectors.json: each message by its name, and a record of each kind of entities."""
    lines = [
        "// SPDX-License-Identifier: Apache-2.0",
        "#pragma once",
        "",
        "#include <iota_protocol.h>",
        "",
        "#include <map>",
        "#include <string>",
        "#include <variant>",
        "",
        "namespace iota::protocol {",
    ]
    messages = {message.name: message for message in schema.messages}
    for sender in ("client", "server"):
        lines += ["", f"inline const std::map<std::string, {pascal(sender)}Message> {sender}_vectors{{"]
        for vector in vectors["good"]:
            if vector["sender"] == sender:
                value = struct_literal(messages[vector["message"]], vector["values"], schema)
                lines.append(f'    {{"{vector["name"]}", {value}}},')
        lines.append("};")
    records = {vector["kind"]: vector["values"] for vector in vectors["entities"]}
    lines += ["", "inline const EntityKinds entity_vectors{"]
    for entity in schema.entities:
        if entity.kind not in records:
            raise SchemaError(f"protocol/make_golden.py has no record of the kind {entity.kind!r}")
        lines.append(f"    {struct_literal(entity, records[entity.kind], schema)},")
    lines[-1] = lines[-1].removesuffix(",")
    return "\n".join([*lines, "};", "", "}  // namespace iota::protocol", ""])


def struct_literal(struct: Struct, values: dict[str, Any], schema: Schema) -> str:
    if set(values) != {field.name for field in struct.fields}:
        raise SchemaError(f"protocol/make_golden.py: {struct.name} has other fields than {', '.join(values)}")
    fields = ", ".join(literal(field.type, values[field.name], schema) for field in struct.fields)
    return f"{pascal(struct.name)}{{{fields}}}"


def literal(type: Type, value: Any, schema: Schema) -> str:
    if type.kind == "struct":
        return struct_literal(schema.structs[type.struct], value, schema)
    if type.kind in ("array", "bytes"):
        item = Type("u8") if type.kind == "bytes" else type.element
        return f"{type_name(type)}{{{', '.join(literal(item, each, schema) for each in value)}}}"
    if type.kind == "string":
        text = "".join(f"\\{byte:03o}" for byte in value.encode())
        return f'std::string("{text}")'
    if type.kind == "id":
        return f"Id{{{value['slot']}U, {value['generation']}U}}"
    if type.kind in ("vec3", "quat"):
        return f"{type_name(type)}{{{', '.join(literal(Type('f32'), each, schema) for each in value)}}}"
    if type.kind == "bool":
        return "true" if value else "false"
    if type.kind in REALS:
        return f"{float(value)!r}{'F' if type.kind == 'f32' else ''}"
    return f"{type_name(type)}{{{value}U{'LL' if type.kind == 'u64' else ''}}}"
