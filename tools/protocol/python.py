# SPDX-License-Identifier: Apache-2.0
"""The Python side: constants and enums. Frames are written and read in C++."""

from __future__ import annotations

from protocol.schema import Schema, pascal

HEAD = '''\
# SPDX-License-Identifier: Apache-2.0
# Made by tools/generate_protocol.py from protocol/schema.json; changes here are lost.
"""Numbers of the protocol between server and page."""

from enum import IntEnum
'''


def make(schema: Schema) -> str:
    lines = [HEAD, f"PROTOCOL_VERSION = {schema.version}"]
    for constant in schema.constants:
        lines.append(f"{constant.name.upper()} = {constant.value}  # {constant.doc}")
    for enum in schema.enums.values():
        lines += ["", "", f"class {pascal(enum.name)}(IntEnum):", f'    """{enum.doc}"""', ""]
        lines += [f"    {name.upper()} = {value}" for name, value in enum.values]
    return "\n".join([*lines, ""])
