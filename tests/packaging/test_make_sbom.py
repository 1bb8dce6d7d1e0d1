# SPDX-License-Identifier: Apache-2.0
"""The bill of materials names what the wheel holds, and nothing in it is left out."""

import hashlib
import json
import re
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def tool(load_tool: Callable[[str], ModuleType]) -> ModuleType:
    return load_tool("make_sbom")


@pytest.fixture
def wheel() -> Path:
    return next((ROOT / "build" / "wheel").glob("iota_worlds-*.whl"))


@pytest.fixture
def sbom(tool: ModuleType, wheel: Path, tmp_path: Path) -> dict[str, Any]:
    out = tmp_path / "new" / "sbom.json"
    assert tool.main(str(wheel), str(out)) == 0
    return json.loads(out.read_text())


def test_each_shared_library_of_the_wheel_is_in_it_with_its_digest(wheel: Path, sbom: dict[str, Any]) -> None:
    archive = zipfile.ZipFile(wheel)
    held = {
        hashlib.sha256(archive.read(name)).hexdigest(): name
        for name in archive.namelist()
        if re.search(r"\.so(\.|$)", name) and "/_core." not in name
    }
    assert len(held) >= 3
    told = {h["content"]: c for c in sbom["components"] for h in c.get("hashes", []) if h["alg"] == "SHA-256"}
    assert told.keys() == held.keys()
    for digest, component in told.items():
        assert component["evidence"]["occurrences"] == [{"location": held[digest]}]


def test_each_package_of_the_page_and_each_requirement_is_in_it(wheel: Path, sbom: dict[str, Any]) -> None:
    archive = zipfile.ZipFile(wheel)
    packages = dict(
        re.findall(r"^## (\S+) - (\S+)", archive.read("iota/page/licenses.txt").decode(), flags=re.MULTILINE)
    )
    told = {c["name"]: c.get("version") for c in sbom["components"] if c["purl"].startswith("pkg:npm/")}
    assert told == packages and "three" in told
    metadata = archive.read(next(n for n in archive.namelist() if n.endswith("/METADATA"))).decode()
    needed = re.findall(r"^Requires-Dist: ([\w-]+)", metadata, flags=re.MULTILINE)
    scopes = {c["name"]: c["scope"] for c in sbom["components"] if "scope" in c}
    assert scopes.keys() == set(needed)
    assert (scopes["numpy"], scopes["mujoco"]) == ("required", "optional")


def test_it_says_what_is_compiled_into_the_extension_and_all_licenses_are_in_the_wheel(sbom: dict[str, Any]) -> None:
    names = [c["name"] for c in sbom["components"]]
    assert {"nanobind", "robin-map", "Boost (Asio, Beast)"} <= set(names) and len(names) == len(set(names))
    assert all(re.fullmatch(r"\d[\w.]*", c["version"]) for c in sbom["components"] if "scope" not in c)
    texts = {path.stem for path in (ROOT / "LICENSES").glob("*.txt")}
    held = {re.split(r" \(", c["name"])[0] for c in sbom["components"] if "scope" not in c}
    assert held - texts == {"Boost"}, "its license asks for no notice in binaries"


def test_it_is_cyclonedx_about_this_wheel(wheel: Path, sbom: dict[str, Any]) -> None:
    assert (sbom["bomFormat"], sbom["specVersion"], sbom["version"]) == ("CycloneDX", "1.6", 1)
    itself = sbom["metadata"]["component"]
    assert itself["hashes"] == [{"alg": "SHA-256", "content": hashlib.sha256(wheel.read_bytes()).hexdigest()}]
    assert wheel.name.startswith(f"{itself['name'].replace('-', '_')}-{itself['version']}-")
    references = [c["bom-ref"] for c in sbom["components"]]
    assert sbom["dependencies"] == [{"ref": itself["bom-ref"], "dependsOn": references}]
    assert len(set(references)) == len(references)


def test_a_library_that_nobody_described_is_an_error(
    tool: ModuleType, wheel: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other = tmp_path / wheel.name
    shutil.copy(wheel, other)
    with zipfile.ZipFile(other, "a") as archive:
        archive.writestr("iota_worlds.libs/libsecret-0123.so.1", b"\x7fELF")
    assert tool.main(str(other), str(tmp_path / "out.json")) == 1
    assert "does not describe iota_worlds.libs/libsecret-0123.so.1" in capsys.readouterr().err
