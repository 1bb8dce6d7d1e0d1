# SPDX-License-Identifier: Apache-2.0
"""Reads and checks protocol/schema.json and the kinds of entities in protocol/entities."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

# Wire size in bytes of each scalar; strings, bytes and arrays begin with a count of four.
SCALARS = {
    "u8": 1,
    "bool": 1,
    "u16": 2,
    "u32": 4,
    "u64": 8,
    "f32": 4,
    "f64": 8,
    "vec3": 12,
    "quat": 16,
    "id": 8,
}
INTEGERS = ("u8", "u16", "u32", "u64")
REALS = ("f32", "f64")
NUMBERS = INTEGERS + REALS


class SchemaError(Exception):
    """The schema has an error."""


@dataclass(frozen=True)
class Type:
    """The type of a field: a scalar, "string", "bytes", "struct" or "array"."""

    kind: str
    max: int = 0  # bytes of a string, items of an array
    enum: str = ""  # of a u8
    struct: str = ""  # name
    item: Type | None = None  # of an array

    @property
    def element(self) -> Type:
        """The type of an array's items."""
        assert self.item is not None
        return self.item


@dataclass(frozen=True)
class Field:
    name: str
    type: Type
    doc: str


@dataclass(frozen=True)
class Struct:
    """A struct, a message (`number` is its type on the wire), an entity (`kind` is its name on the wire) or an event of
    the server, which is not on the wire. receiver: the script, or the server, which answers the message itself. viewers:
    "allowed", "told" that they only watch, or "ignored"."""

    name: str
    doc: str
    fields: tuple[Field, ...]
    number: int = 0
    kind: str = ""
    in_place: bool = False
    receiver: str = "script"
    viewers: str = "told"


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
    entities: tuple[Struct, ...]
    client: tuple[Struct, ...]
    server: tuple[Struct, ...]
    events: tuple[Struct, ...] = ()

    @property
    def inputs(self) -> tuple[Struct, ...]:
        """Everything that a script is told of clients."""
        return (*(message for message in self.client if message.receiver == "script"), *self.events)

    @property
    def records(self) -> tuple[Struct, ...]:
        """The inputs, and before them the structs in them."""
        used: set[str] = set()
        for struct in reversed((*self.structs.values(), *self.inputs)):
            if struct in self.inputs or struct.name in used:
                used |= {name for _, name in structs_in(struct)}
        return (*(struct for struct in self.structs.values() if struct.name in used), *self.inputs)

    @property
    def messages(self) -> tuple[Struct, ...]:
        return self.client + self.server

    @property
    def coded(self) -> tuple[Struct, ...]:
        """All encoded types, in order of dependency."""
        return (*self.structs.values(), *self.entities, *self.messages)

    def smallest(self, type: Type) -> int:
        """Least number of bytes of a value on the wire."""
        if type.kind == "struct":
            return sum(self.smallest(field.type) for field in self.structs[type.struct].fields)
        return SCALARS.get(type.kind, 4)


def pascal(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def camel(name: str) -> str:
    text = pascal(name)
    return text[0].lower() + text[1:]


def read_schema(path: Path) -> Schema:
    """Raises SchemaError, OSError, ValueError or KeyError for an invalid schema."""
    data = json.loads(path.read_text(encoding="utf-8"))
    constants = tuple(
        Constant(checked_name(c["name"], "constant"), c["type"], int(c["value"]), c.get("doc", ""))
        for c in data["constants"]
    )
    enums = {entry["name"]: read_enum(entry) for entry in data["enums"]}
    structs = {entry["name"]: read_struct(entry, enums) for entry in data["structs"]}
    entities = read_entities(path.parent / "entities", enums)
    client = tuple(read_message(entry, enums) for entry in data["client_messages"])
    server = tuple(read_message(entry, enums) for entry in data["server_messages"])
    events = tuple(read_event(entry, enums) for entry in data.get("events", []))
    schema = Schema(int(data["version"]), constants, enums, structs, entities, client, server, events)
    check_names(schema)
    check_structs(schema)
    check_in_place(schema)
    return schema


def checked_name(value: object, where: str) -> str:
    if not isinstance(value, str) or not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", value):
        raise SchemaError(f"{where}: {value!r} is not a snake_case name")
    return value


def read_enum(entry: dict[str, Any]) -> Enum:
    name = checked_name(entry["name"], "enum")
    values = tuple((checked_name(v["name"], name), int(v["value"])) for v in entry["values"])
    if [value for _, value in values] != list(range(len(values))):
        raise SchemaError(f"{name}: values must count up from 0")
    return Enum(name, entry.get("doc", ""), values)


def read_type(entry: dict[str, Any], where: str, enums: dict[str, Enum]) -> Type:
    kind: object = entry.get("type")
    limit, enum = entry.get("max", 0), entry.get("enum", "")
    if isinstance(kind, dict) and set(kind) == {"struct"}:
        return Type("struct", struct=checked_name(kind["struct"], where))
    if isinstance(kind, dict) and set(kind) == {"array"}:
        check_limit(limit, where)
        item = kind["array"]
        if item in SCALARS or item == "string":
            return Type("array", limit, item=read_type({"type": item, "max": entry.get("item_max", 0)}, where, enums))
        return Type("array", limit, item=Type("struct", struct=checked_name(item, where)))
    if not isinstance(kind, str) or kind not in (*SCALARS, "string", "bytes"):
        raise SchemaError(f"{where}: unknown type {kind!r}")
    if kind in ("string", "bytes"):
        check_limit(limit, where)
    if enum and (enum not in enums or kind != "u8"):
        raise SchemaError(f"{where}: enum {enum!r} is unknown, or the field is not a u8")
    return Type(kind, limit, enum)


def check_limit(limit: object, where: str) -> None:
    if not isinstance(limit, int) or limit < 1:
        raise SchemaError(f"{where}: strings, bytes and arrays need a positive 'max' (strings in arrays an 'item_max')")


def read_fields(entry: dict[str, Any], enums: dict[str, Enum]) -> tuple[Field, ...]:
    owner = entry["name"]
    fields = tuple(
        Field(
            name := checked_name(field.get("name"), owner),
            read_type(field, f"{owner}.{name}", enums),
            field.get("doc", ""),
        )
        for field in entry.get("fields", [])
    )
    if any(field.name == "type" for field in fields):
        raise SchemaError(f"{owner}: 'type' is taken by the message's type")
    if len({field.name for field in fields}) != len(fields):
        raise SchemaError(f"{owner}: two fields have the same name")
    return fields


def read_struct(entry: dict[str, Any], enums: dict[str, Enum]) -> Struct:
    name, fields = checked_name(entry.get("name"), "struct"), read_fields(entry, enums)
    if not fields:
        raise SchemaError(f"{name}: has no fields")
    return Struct(name, entry.get("doc", ""), fields)


def read_event(entry: dict[str, Any], enums: dict[str, Enum]) -> Struct:
    return Struct(
        checked_name(entry.get("name"), "event"), entry.get("doc", ""), read_fields(entry, enums), viewers="allowed"
    )


def read_entities(folder: Path, enums: dict[str, Enum]) -> tuple[Struct, ...]:
    """The kinds of entities in the order in which their records are sent: what one refers to comes before it."""
    entries = {path: json.loads(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*.json"))}
    order = {path: entry.get("order") for path, entry in entries.items()}
    if sorted(order.values(), key=str) != sorted(range(len(order)), key=str):
        raise SchemaError(f"{folder.name}: the kinds must have the orders 0 to {len(order) - 1}, each once")
    return tuple(read_entity(path, entries[path], enums) for path in sorted(entries, key=lambda path: order[path]))


def read_entity(path: Path, entry: dict[str, Any], enums: dict[str, Enum]) -> Struct:
    """A kind of entities. Its records start with the id."""
    kind = checked_name(entry.get("name"), path.name)
    if kind != path.stem:
        raise SchemaError(f"{path.name}: names the kind {kind!r}")
    fields = (Field("id", Type("id"), ""), *read_fields(entry, enums))
    return Struct(f"{kind}_entity", entry.get("doc", ""), fields, kind=kind)


def read_message(entry: dict[str, Any], enums: dict[str, Enum]) -> Struct:
    name = checked_name(entry.get("name"), "message")
    number = entry.get("type")
    if not (isinstance(number, int) and 0 < number < 256):
        raise SchemaError(f"{name}: a message needs a type from 1 to 255")
    fields = read_fields(entry, enums)
    if not fields:
        raise SchemaError(f"{name}: has no fields")
    receiver = entry.get("for", "script")
    viewers = entry.get("viewers", "told" if receiver == "script" else "allowed")
    if receiver not in ("script", "server") or viewers not in ("allowed", "told", "ignored"):
        raise SchemaError(f"{name}: 'for' is script or server, 'viewers' is allowed, told or ignored")
    return Struct(
        name,
        entry.get("doc", ""),
        fields,
        number,
        in_place=bool(entry.get("in_place")),
        receiver=receiver,
        viewers=viewers,
    )


def check_names(schema: Schema) -> None:
    names = [struct.name for struct in (*schema.coded, *schema.events)] + list(schema.enums)
    if len(set(names)) != len(names):
        raise SchemaError("two entries have the same name")
    if len({message.number for message in schema.messages}) != len(schema.messages):
        raise SchemaError("two messages have the same type")


def structs_in(struct: Struct) -> Iterator[tuple[Field, str]]:
    """The structs of fields."""
    for field in struct.fields:
        type = field.type.element if field.type.kind == "array" else field.type
        if type.kind == "struct":
            yield field, type.struct


def check_structs(schema: Schema) -> None:
    known: set[str] = set()
    for struct in (*schema.coded, *schema.events):
        for field, name in structs_in(struct):
            if name not in known:
                raise SchemaError(f"{struct.name}.{field.name}: no struct {name!r} is listed before")
        if struct.name in schema.structs:
            known.add(struct.name)
        for field in struct.fields:
            if field.type.kind == "array" and field.type.element.kind == "bool":
                raise SchemaError(f"{struct.name}.{field.name}: arrays of bool are not supported")


def check_in_place(schema: Schema) -> None:
    """An in-place message is decoded into columns of numbers."""
    for message in schema.messages:
        if not message.in_place:
            continue
        columns = [f for _, name in structs_in(message) for f in schema.structs[name].fields]
        arrays = [f for f in message.fields if f.type.kind == "array"]
        others = [f for f in message.fields if f.type.kind != "array"]
        if any(f.type.element.kind != "struct" for f in arrays) or any(
            f.type.kind not in (*NUMBERS, "bool", "vec3") for f in (*others, *columns)
        ):
            raise SchemaError(
                f"{message.name}: an in_place message holds numbers, places and arrays of structs of them"
            )
