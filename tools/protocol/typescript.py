# SPDX-License-Identifier: Apache-2.0
"""The TypeScript side: one strict module."""

from __future__ import annotations

from protocol import fragment
from protocol.schema import NUMBERS, Field, Schema, Struct, Type, camel, pascal

TYPES = {
    "bool": "boolean",
    "vec3": "Vec3",
    "quat": "Quat",
    "id": "Id",
    "string": "string",
    "bytes": "Uint8Array",
}
# Typed arrays: of the numbers in an array, and of a column.
COLUMNS = {
    "u8": "Uint8Array",
    "bool": "Uint8Array",
    "u16": "Uint16Array",
    "u32": "Uint32Array",
    "u64": "Float64Array",
    "f32": "Float32Array",
    "f64": "Float64Array",
    "vec3": "Float32Array",
}


def make(schema: Schema) -> str:
    lines = [fragment("head.ts"), "", f"export const PROTOCOL_VERSION = {schema.version};"]
    for constant in schema.constants:
        lines.append(f"/** {constant.doc} */")
        lines.append(f"export const {constant.name.upper()} = {constant.value};")
    numbers = [(message.name, message.number) for message in schema.messages]
    lines += named_numbers("MessageType", "First byte of every frame.", numbers)
    for enum in schema.enums.values():
        lines += named_numbers(pascal(enum.name), enum.doc, list(enum.values))
    for struct in schema.coded:
        lines += interface(struct)
    lines += ["", fragment("codec.ts")]
    for struct in schema.coded:
        lines += codec(struct, schema)
    for message in schema.messages:
        lines += message_functions(message)
    for message in schema.messages:
        if message.in_place:
            lines += in_place(message, schema)
    lines += entity_kinds(schema.entities)
    lines += ["", fragment("poses.ts")]
    lines += direction_functions("client", schema.client)
    lines += direction_functions("server", schema.server)
    return "\n".join([*lines, ""])


def named_numbers(name: str, doc: str, values: list[tuple[str, int]]) -> list[str]:
    lines = ["", f"/** {doc} */", f"export const {name} = {{"]
    lines += [f"  {camel(key)}: {value}," for key, value in values]
    return [*lines, "} as const;", f"export type {name} = (typeof {name})[keyof typeof {name}];"]


def type_name(type: Type) -> str:
    if type.kind == "array":
        item = type.element
        return COLUMNS[item.kind] if item.kind in NUMBERS else f"{type_name(item)}[]"
    if type.kind == "struct":
        return pascal(type.struct)
    return pascal(type.enum) if type.enum else TYPES.get(type.kind, "number")


def interface(struct: Struct) -> list[str]:
    lines = ["", f"/** {struct.doc} */", f"export interface {pascal(struct.name)} {{"]
    if struct.number:
        lines.append(f"  type: '{camel(struct.name)}';")
    for field in struct.fields:
        if field.doc:
            lines.append(f"  /** {field.doc} */")
        lines.append(f"  {camel(field.name)}: {type_name(field.type)};")
    return [*lines, "}"]


def write(type: Type, value: str, label: str) -> list[str]:
    """Statements that append a value to the frame; label: the field's name in error texts."""
    if type.kind == "bool":
        return [f"writer.bool({value});"]
    if type.kind == "string":
        return [f"writer.text({value}, {type.max}, {label});"]
    if type.kind == "bytes":
        return [f"writer.raw({value}, {type.max}, {label});"]
    if type.kind == "struct":
        return [f"write{pascal(type.struct)}({value});"]
    if type.kind == "array":
        (statement,) = write(type.element, "item", label)
        return [f"writer.count({value}.length, {type.max}, {label});", f"for (const item of {value}) {statement}"]
    return [f"writer.{type.kind}({value}, {label});"]


def read(type: Type, label: str, schema: Schema) -> str:
    """An expression for the next value."""
    if type.enum:
        return f"reader.choice({len(schema.enums[type.enum].values)}, {label}) as {pascal(type.enum)}"
    if type.kind == "string":
        return f"reader.text({type.max}, {label})"
    if type.kind == "bytes":
        return f"reader.raw({type.max}, {label})"
    if type.kind == "struct":
        return f"read{pascal(type.struct)}()"
    if type.kind == "array":
        item = type.element
        arguments = f"{type.max}, {schema.smallest(item)}, {label}, () => {read(item, label, schema)}"
        if item.kind in NUMBERS:
            return f"readNumbers({arguments}, (count) => new {COLUMNS[item.kind]}(count))"
        return f"readArray({arguments})"
    return f"reader.{type.kind}({label})"


def codec(struct: Struct, schema: Schema) -> list[str]:
    name = pascal(struct.name)
    lines = ["", f"function write{name}(value: Readonly<{name}>): void {{"]
    for field in struct.fields:
        statements = write(field.type, f"value.{camel(field.name)}", f"'{struct.name}.{field.name}'")
        lines += ["  " + line for line in statements]
    lines += ["}", "", f"function read{name}(): {name} {{", "  return {"]
    if struct.number:
        lines.append(f"    type: '{camel(struct.name)}',")
    for field in struct.fields:
        label = f"'{struct.name}.{field.name}'"
        lines.append(f"    {camel(field.name)}: {read(field.type, label, schema)},")
    return [*lines, "  };", "}"]


def message_functions(message: Struct) -> list[str]:
    name = pascal(message.name)
    return [
        "",
        f"export function encode{name}(message: Readonly<{name}>): ArrayBuffer {{",
        f"  writer.start({message.number});",
        f"  write{name}(message);",
        "  return writer.finish();",
        "}",
        "",
        f"export function decode{name}(data: ArrayBuffer | Uint8Array): {name} {{",
        f"  reader.start(data, {message.number});",
        f"  const message = read{name}();",
        "  reader.finish();",
        "  return message;",
        "}",
    ]


def entity_kinds(entities: tuple[Struct, ...]) -> list[str]:
    lines = ["", "/** The record of each kind of entities. */", "export interface EntityRecords {"]
    lines += [f"  {camel(entity.kind)}: {pascal(entity.name)};" for entity in entities]
    lines += ["}", "export type EntityKind = keyof EntityRecords;", ""]
    lines += [
        "interface EntityCodec<Record> {",
        "  write(value: Readonly<Record>): void;",
        "  read(): Record;",
        "}",
        "",
    ]
    lines += ["const entityCodecs: { [K in EntityKind]: EntityCodec<EntityRecords[K]> } = {"]
    for entity in entities:
        name = pascal(entity.name)
        lines.append(f"  {camel(entity.kind)}: {{ write: write{name}, read: read{name} }},")
    lines += ["};", "", "const entityKindsByName = new Map<string, EntityKind>(["]
    lines += [f"  ['{entity.kind}', '{camel(entity.kind)}']," for entity in entities]
    return [*lines, "]);", "", fragment("entities.ts")]


def columns(struct: Struct) -> list[str]:
    """A growing struct of arrays, so that a frame is decoded without allocation."""
    name = f"{pascal(struct.name)}Columns"
    lines = [
        "",
        f"/** Columns of {camel(struct.name)}; rows from `count` on are left over from earlier. */",
        f"export class {name} {{",
        "  count = 0;",
        "  capacity = 0;",
    ]
    for field in struct.fields:
        if field.type.kind == "vec3":
            lines.append("  /** Three numbers a row. */")
        lines.append(f"  {camel(field.name)} = new {COLUMNS[field.type.kind]}(0);")
    lines += ["", "  /** Makes room for `rows`; contents are lost when it has to grow. */"]
    lines += ["  reserve(rows: number): void {", "    if (rows <= this.capacity) return;"]
    lines.append("    this.capacity = Math.max(rows, 2 * this.capacity, 64);")
    for field in struct.fields:
        size = "3 * this.capacity" if field.type.kind == "vec3" else "this.capacity"
        lines.append(f"    this.{camel(field.name)} = new {COLUMNS[field.type.kind]}({size});")
    return [*lines, "  }", "}"]


def in_place(message: Struct, schema: Schema) -> list[str]:
    name = pascal(message.name)
    lines: list[str] = []
    for field in message.fields:
        if field.type.kind == "array":
            lines += columns(schema.structs[field.type.element.struct])
    lines += [
        "",
        f"/** {message.doc}",
        f" *  One buffer is filled again and again by decode{name}Into. */",
        f"export class {name}Buffer {{",
    ]
    for field in message.fields:
        if field.doc:
            lines.append(f"  /** {field.doc} */")
        lines.append(f"  {camel(field.name)} = {initial_value(field.type)};")
    lines += [
        "}",
        "",
        f"/** Decodes a {message.name} frame into `out` without allocating once it is large enough.",
        " *  After a ProtocolError its contents are a mixture of old and new. */",
        f"export function decode{name}Into(data: ArrayBuffer | Uint8Array, out: {name}Buffer): void {{",
        f"  reader.start(data, {message.number});",
    ]
    for field in message.fields:
        lines += ["  " + line for line in read_into(field, message.name, schema)]
    return [*lines, "  reader.finish();", "}"]


def initial_value(type: Type) -> str:
    if type.kind == "array":
        return f"new {pascal(type.element.struct)}Columns()"
    return {"vec3": "new Float32Array(3)", "bool": "false"}.get(type.kind, "0")


def read_into(field: Field, owner: str, schema: Schema) -> list[str]:
    target, label = f"out.{camel(field.name)}", f"'{owner}.{field.name}'"
    if field.type.kind == "vec3":
        return [f"reader.vec3Into({target}, 0, {label});"]
    if field.type.kind != "array":
        return [f"{target} = {read(field.type, label, schema)};"]
    struct = schema.structs[field.type.element.struct]
    rows = camel(field.name)
    lines = [
        f"const {rows} = {target};",
        f"{rows}.count = 0;",
        f"const {rows}Count = reader.count({field.type.max}, {schema.smallest(field.type.element)}, {label});",
        f"{rows}.reserve({rows}Count);",
        f"for (let i = 0; i < {rows}Count; i++) {{",
    ]
    for inner in struct.fields:
        column, label = f"{rows}.{camel(inner.name)}", f"'{struct.name}.{inner.name}'"
        if inner.type.kind == "vec3":
            lines.append(f"  reader.vec3Into({column}, 3 * i, {label});")
        else:
            value = read(inner.type, label, schema)
            lines.append(f"  {column}[i] = {value}{' ? 1 : 0' if inner.type.kind == 'bool' else ''};")
    return [*lines, "}", f"{rows}.count = {rows}Count;"]


def direction_functions(direction: str, messages: tuple[Struct, ...]) -> list[str]:
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
        lines.append(f"    case {message.number}:")
        lines.append(f"      return decode{pascal(message.name)}(data);")
    return [
        *lines,
        "    default:",
        f"      throw new ProtocolError(`no message that a {direction} sends has the type ${{type}}`);",
        "  }",
        "}",
    ]
