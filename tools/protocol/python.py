# SPDX-License-Identifier: Apache-2.0
"""The Python side: constants, enums, and the fields of the entities that scripts make."""

from __future__ import annotations

from protocol.schema import Schema, Struct, Type, pascal

HEAD = '''\
# SPDX-License-Identifier: Apache-2.0
# Made by tools/generate_protocol.py from protocol/schema.json; changes here are lost.
"""Numbers of the protocol between server and page."""

from enum import IntEnum

# Of structs and entities by their name: name, type, limit of bytes or items (0: none), limit of each item.
Fields = dict[str, tuple[tuple[str, str, int, int], ...]]
'''


def make(schema: Schema) -> str:
    lines = [HEAD, f"PROTOCOL_VERSION = {schema.version}"]
    for constant in schema.constants:
        lines.append(f"{constant.name.upper()} = {constant.value}  # {constant.doc}")
    for enum in schema.enums.values():
        lines += ["", "", f"class {pascal(enum.name)}(IntEnum):", f'    """{enum.doc}"""', ""]
        lines += [f"    {name.upper()} = {value}" for name, value in enum.values]
    for title, structs in (("STRUCTS", schema.structs.values()), ("ENTITIES", schema.entities)):
        lines += ["", f"{title}: Fields = {{"]
        for struct in structs:
            lines += [f'    "{struct.kind or struct.name}": (', *fields(struct), "    ),"]
        lines.append("}")
    return "\n".join([*lines, ""])


def fields(struct: Struct) -> list[str]:
    """Name, type, limit in bytes or items, and limit of each item."""
    lines = []
    for field in struct.fields:
        item_max = field.type.element.max if field.type.kind == "array" else 0
        lines.append(f'        ("{field.name}", "{word_of(field.type)}", {field.type.max}, {item_max}),')
    return lines


def word_of(kind: Type) -> str:
    """f32, struct anchor, array string."""
    if kind.kind == "struct":
        return f"struct {kind.struct}"
    return f"array {word_of(kind.element)}" if kind.kind == "array" else kind.kind
