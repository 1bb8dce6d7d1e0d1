# SPDX-License-Identifier: Apache-2.0
"""The Python side: constants, enums, records of what scripts are told of clients, and the fields of the entities that
scripts make."""

from __future__ import annotations

from protocol.schema import INTEGERS, REALS, Schema, Struct, Type, pascal

HEAD = '''\
# SPDX-License-Identifier: Apache-2.0
# Made by tools/generate_protocol.py from protocol/schema.json; changes here are lost.
"""Numbers and records of the protocol between server and page."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from iota._core import Vec3

# The fields of structs and entities by their name: name, type, limit of bytes or items (0: none), limit of each item.
Fields = dict[str, tuple[tuple[str, str, int, int], ...]]


class Id(NamedTuple):
    """Names an entity among those of its kind; false if it names none."""

    slot: int
    generation: int

    def __bool__(self) -> bool:
        return self.generation != 0

'''

TYPES = (
    {
        "bool": "bool",
        "string": "str",
        "bytes": "bytes",
        "vec3": "Vec3",
        "quat": "tuple[float, float, float, float]",
        "id": "Id",
    }
    | dict.fromkeys(INTEGERS, "int")
    | dict.fromkeys(REALS, "float")
)


def make(schema: Schema) -> str:
    lines = [HEAD, f"PROTOCOL_VERSION = {schema.version}"]
    for constant in schema.constants:
        lines.append(f"{constant.name.upper()} = {constant.value}  # {constant.doc}")
    for enum in schema.enums.values():
        lines += ["", "", f"class {pascal(enum.name)}(IntEnum):", f'    """{enum.doc}"""', ""]
        lines += [f"    {name.upper()} = {value}" for name, value in enum.values]
    for struct in schema.records:
        lines += record(struct)
    inputs = [pascal(each.name) for each in schema.inputs]
    lines += ["", "", "# Everything that a script is told of clients.", f"Input = {' | '.join(inputs)}"]
    for title, structs in (("STRUCTS", schema.structs.values()), ("ENTITIES", schema.entities)):
        lines += ["", f"{title}: Fields = {{"]
        for struct in structs:
            lines += [f'    "{struct.kind or struct.name}": (', *fields(struct), "    ),"]
        lines.append("}")
    return "\n".join([*lines, ""])


def record(struct: Struct) -> list[str]:
    lines = ["", "", "@dataclass(frozen=True, slots=True)", f"class {pascal(struct.name)}:", f'    """{struct.doc}"""']
    if struct.fields:
        lines.append("")
    for field in struct.fields:
        lines.append(f"    {field.name}: {type_of(field.type)}{f'  # {field.doc}' if field.doc else ''}")
    return lines


def type_of(type: Type) -> str:
    if type.kind == "array":
        return f"tuple[{type_of(type.element)}, ...]"
    if type.kind == "struct" or type.enum:
        return pascal(type.struct or type.enum)
    return TYPES[type.kind]


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
