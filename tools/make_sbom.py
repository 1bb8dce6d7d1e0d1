#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the bill of materials of a wheel: CycloneDX 1.6, as JSON.

    tools/make_sbom.py WHEEL OUT

It lists the libraries beside and in the extension, the packages in the page, and what is installed with the wheel. Versions
are read from the files themselves. A library in the wheel that is not described here is an error.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
import sys
import uuid
import zipfile
from email import message_from_bytes
from importlib.metadata import version
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
LOCK = ROOT / "web" / "package-lock.json"
SUNDIALS = ROOT / ".venv" / "sundials" / "include" / "sundials" / "sundials_config.h"
BOOST = Path("/usr/include/boost/version.hpp")

#: Shared libraries by the start of their name: name, license, source, pattern of the version in the file.
SHARED: dict[str, tuple[str, str, str, bytes]] = {
    "libtbb": ("oneTBB", "Apache-2.0", "pkg:github/uxlfoundation/oneTBB", rb"oneTBB: VERSION\s+([\d.]+)"),
    "libssl": ("OpenSSL (libssl)", "Apache-2.0", "pkg:github/openssl/openssl", rb"OpenSSL (\d[\w.]+)"),
    "libcrypto": ("OpenSSL (libcrypto)", "Apache-2.0", "pkg:github/openssl/openssl", rb"OpenSSL (\d[\w.]+)"),
}


class UnknownLibraryError(Exception):
    """The wheel holds a library that is not described; the text names it."""


def component(name: str, version: str, license: str, purl: str, **more: Any) -> dict[str, Any]:
    return {
        "type": "library",
        "bom-ref": f"{purl}@{version}#{name}",
        "name": name,
        "version": version,
        "licenses": [{"license": {"id": license}}],
        "purl": f"{purl}@{version}",
        **more,
    }


def sha256(data: bytes) -> list[dict[str, str]]:
    return [{"alg": "SHA-256", "content": hashlib.sha256(data).hexdigest()}]


def shared_libraries(archive: zipfile.ZipFile) -> list[dict[str, Any]]:
    """The libraries beside the extension."""
    found = []
    # libssl has no version of its own in every build: it is that of libcrypto, which it needs.
    texts = {name: archive.read(name) for name in sorted(archive.namelist()) if re.search(r"\.so(\.|$)", name)}
    for path, data in texts.items():
        name = Path(path).name
        if name.startswith("_core."):
            continue
        known = SHARED.get(re.split(r"[-.]", name)[0])
        if known is None:
            raise UnknownLibraryError(f"tools/make_sbom.py does not describe {path}")
        title, license, purl, pattern = known
        match = re.search(pattern, data) or next(
            filter(None, (re.search(pattern, other) for other in texts.values())), None
        )
        if match is None:
            raise UnknownLibraryError(f"{path} does not tell its version")
        where = {"evidence": {"occurrences": [{"location": path}]}}
        found.append(component(title, match[1].decode(), license, purl, hashes=sha256(data), **where))
    return found


def defined(header: Path, pattern: str) -> str:
    match = re.search(pattern, header.read_text())
    assert match, f"{header} has no version"
    return ".".join(match.groups())


def linked_libraries(extension: bytes) -> list[dict[str, Any]]:
    """The libraries that are compiled or linked into the extension."""
    import nanobind

    robin_map = Path(nanobind.__file__).parent / "ext" / "robin_map" / "include" / "tsl" / "robin_growth_policy.h"
    parts = r"\s+".join(rf"#define TSL_RH_VERSION_{part} (\d+)[^#]*" for part in ("MAJOR", "MINOR", "PATCH"))
    found = [
        component("nanobind", version("nanobind"), "BSD-3-Clause", "pkg:pypi/nanobind"),
        component("robin-map", defined(robin_map, parts), "MIT", "pkg:github/Tessil/robin-map"),
    ]
    boost = defined(BOOST, r'#define BOOST_LIB_VERSION "(\w+)"').replace("_", ".")
    found.append(component("Boost (Asio, Beast)", boost, "BSL-1.0", "pkg:github/boostorg/boost"))
    if b"kinsol_mem" in extension:
        number = defined(SUNDIALS, r'#define SUNDIALS_VERSION "([\d.]+)"')
        found.append(component("SUNDIALS (KINSOL)", number, "BSD-3-Clause", "pkg:github/LLNL/sundials"))
    return found


def page_packages(listed: str) -> list[dict[str, Any]]:
    """The npm packages in the page. listed: the list that the page's bundler has made."""
    locked = json.loads(LOCK.read_text())["packages"]
    found = []
    for name, number in re.findall(r"^## (\S+) - (\S+)", listed, re.MULTILINE):
        entry = locked[f"node_modules/{name}"]
        assert entry["version"] == number, f"the page was built with {name} {number}, not {entry['version']}"
        purl = f"pkg:npm/{name.replace('@', '%40')}"
        digest = base64.b64decode(entry["integrity"].removeprefix("sha512-")).hex()  # of the package's archive
        hashes = [{"alg": "SHA-512", "content": digest}]
        found.append(component(name, number, entry["license"], purl, hashes=hashes))
    return found


def requirements(metadata: Any) -> list[dict[str, Any]]:
    """The packages that pip installs along with the wheel, or with one of its extras."""
    found = []
    for line in metadata.get_all("Requires-Dist", []):
        name, versions, extra = re.fullmatch(r"([\w.-]+)\s*([^;]*?)(?:;.*extra == \"(\w+)\")?", line).groups()  # type: ignore[union-attr]
        found.append({
            "type": "library",
            "bom-ref": f"pkg:pypi/{name}",
            "name": name,
            "purl": f"pkg:pypi/{name}",
            "scope": "required" if extra is None else "optional",
            "description": f"Installed by pip, not in the wheel: {name}{versions}"
            + (f", with the extra {extra}" if extra else ""),
        })  # fmt: skip
    return found


def make_sbom(wheel: Path) -> dict[str, Any]:
    """The bill of materials of a wheel."""
    archive = zipfile.ZipFile(wheel)
    names = archive.namelist()
    metadata = message_from_bytes(archive.read(next(n for n in names if n.endswith(".dist-info/METADATA"))))
    extension = archive.read(next(n for n in names if re.fullmatch(r"iota/_core\..*so", n)))
    data = wheel.read_bytes()
    itself = component(metadata["Name"], metadata["Version"], "Apache-2.0", f"pkg:pypi/{metadata['Name']}")
    itself |= {"hashes": sha256(data), "description": metadata["Summary"]}
    held = [
        *shared_libraries(archive),
        *linked_libraries(extension),
        *page_packages(archive.read("iota/page/licenses.txt").decode()),
    ]
    needed = requirements(metadata)
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        # The same for the same wheel.
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, hashlib.sha256(data).hexdigest())}",
        "version": 1,
        "metadata": {"component": itself},
        "components": held + needed,
        "dependencies": [{"ref": itself["bom-ref"], "dependsOn": [each["bom-ref"] for each in held + needed]}],
    }


def main(wheel: str, out: str) -> int:
    try:
        made = make_sbom(Path(wheel))
    except UnknownLibraryError as error:
        print(error, file=sys.stderr)
        return 1
    Path(out).parent.mkdir(parents=True, exist_ok=True)
    Path(out).write_text(json.dumps(made, indent=2) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
