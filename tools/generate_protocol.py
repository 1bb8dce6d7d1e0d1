#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Generate the C++, TypeScript and Python sides of the protocol from protocol/schema.json.

    python3 tools/generate_protocol.py --cpp FILE --ts FILE --python FILE --cpp-vectors FILE

Needs the standard library only. A file is replaced atomically, and only if its contents change, to avoid needless
rebuilds. `--cpp-vectors` makes the values of protocol/golden/vectors.json for the C++ tests. An invalid schema gives
one line on stderr and exit code 1.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from protocol.schema import Schema, SchemaError, read_schema

from protocol import cpp, python, typescript

SCHEMA = Path(__file__).resolve().parent.parent / "protocol" / "schema.json"
VECTORS = SCHEMA.parent / "golden" / "vectors.json"


def make_cpp_vectors(schema: Schema) -> str:
    return cpp.make_vectors(schema, json.loads(VECTORS.read_text(encoding="utf-8")))


MAKERS: dict[str, Callable[[Schema], str]] = {
    "cpp": cpp.make,
    "ts": typescript.make,
    "python": python.make,
    "cpp_vectors": make_cpp_vectors,
}


def write_if_changed(path: Path, text: str) -> None:
    """Replaces `path` atomically unless it already contains `text`."""
    data = text.encode("utf-8")
    if path.is_file() and path.read_bytes() == data:
        return
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


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--cpp", type=Path, help="C++ header to write")
    parser.add_argument("--ts", type=Path, help="TypeScript module to write")
    parser.add_argument("--python", type=Path, help="Python module to write")
    parser.add_argument("--cpp-vectors", type=Path, help="C++ header of golden values to write")
    parser.add_argument("--schema", type=Path, default=SCHEMA)
    arguments = parser.parse_args()
    files = {language: getattr(arguments, language) for language in MAKERS}
    if not any(files.values()):
        parser.error("give --cpp FILE, --ts FILE, --python FILE, --cpp-vectors FILE or several of them")
    try:
        schema = read_schema(arguments.schema)
        for language, file in files.items():
            if file is not None:
                write_if_changed(file, MAKERS[language](schema))
    except (SchemaError, OSError, ValueError, KeyError) as error:
        print(f"generate_protocol: {arguments.schema}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
