# SPDX-License-Identifier: Apache-2.0
"""What holds for every file of the repository."""

import json
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LICENSE = re.compile(r"SPDX-License-Identifier: Apache-2\.0")
SOURCES = {".h", ".cpp", ".py", ".ts", ".sh", ".cmake"}


def files() -> list[Path]:
    """What is committed or could be, as git sees it."""
    done = subprocess.run(
        ["git", "-c", f"safe.directory={ROOT}", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    if done.returncode != 0:
        pytest.skip("this folder is not a git working tree")
    return [path for path in (ROOT / name for name in done.stdout.splitlines()) if path.is_file()]


def test_every_source_file_names_the_license_in_its_first_lines() -> None:
    without = []
    for path in files():
        if path.suffix in SOURCES:
            with path.open(encoding="utf-8") as text:
                opening = "".join(line for line, _ in zip(text, range(2), strict=False))
            if not LICENSE.search(opening):
                without.append(path.relative_to(ROOT).as_posix())
    assert not without


def test_a_comment_of_the_product_does_not_begin_with_a_word_that_leaves_its_subject_out() -> None:
    begin = re.compile(r"\s*(///?<?|#:?|/\*\*|\"\"\")\s*(Of|What|Where|Those|That)\b")
    goes_on = re.compile(r"\s*(//|#|\*)")
    found = []
    for path in files():
        name = path.relative_to(ROOT).as_posix()
        if path.suffix not in SOURCES or not name.startswith(
            ("src/", "include/", "bindings/", "python/", "tools/", "web/src/")
        ):
            continue
        before = ""
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if begin.match(line) and not goes_on.match(before):
                found.append(f"{name}:{number}: {line.strip()}")
            before = line
    assert not found, "\n".join(found)


def test_the_page_takes_no_text_for_markup_or_code() -> None:
    """Names and titles come from other people."""
    wrong = re.compile(r"\b(innerHTML|outerHTML|insertAdjacentHTML|srcdoc|document\.write|eval|new Function)\b")
    sources = [path for path in files() if path.is_relative_to(ROOT / "web" / "src") and path.suffix == ".ts"]
    assert len(sources) > 50
    assert not [f"{path.name}: {match[0]}" for path in sources if (match := wrong.search(path.read_text()))]


def test_every_python_requirement_is_pinned() -> None:
    for path in (ROOT / "tools").glob("requirements-*.txt"):
        for line in path.read_text().splitlines():
            requirement = line.split("#")[0].strip()
            assert not requirement or re.match(r"[\w.-]+==[\w.]+($|;)", requirement.replace(" ", "")), f"{path}: {line}"


def test_the_page_packages_are_pinned_and_name_no_download_host() -> None:
    package = json.loads((ROOT / "web" / "package.json").read_text())
    versions = {**package.get("dependencies", {}), **package.get("devDependencies", {})}
    assert versions
    assert all(re.fullmatch(r"\d+\.\d+\.\d+(-[\w.]+)?", version) for version in versions.values()), versions
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text())
    assert all("resolved" not in entry for entry in lock["packages"].values())
    assert all("integrity" in entry for name, entry in lock["packages"].items() if name)


def test_engine_and_page_have_the_version_of_the_package() -> None:
    version = re.search(r'^version = "(.*)"$', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)
    assert version
    assert json.loads((ROOT / "web" / "package.json").read_text())["version"] == version[1]


def test_every_link_between_pages_leads_somewhere() -> None:
    broken = []
    for page in (path for path in files() if path.suffix == ".md"):
        for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
            if not re.match(r"[a-z]+:|#", target) and not (page.parent / target.split("#")[0]).exists():
                broken.append(f"{page.relative_to(ROOT)}: {target}")
    assert not broken


def test_only_one_source_tells_how_to_install_an_extra() -> None:
    """PyPI's `iota` is another project; a checkout and a wheel need different commands: iota/extras.py knows both."""
    told = [
        path for path in (ROOT / "python").rglob("*.py") if re.search(r"pip install|requirements-", path.read_text())
    ]
    assert [path.name for path in told] == ["extras.py"]
    wrong = re.compile(r"pip install '?iota[\[\s']")
    assert not [path for path in files() if path.suffix in {".md", ".py"} and wrong.search(path.read_text())]


# A comment, a docstring or the doc of a field that begins with one of these words has no subject: "Of a user, m".
NO_SUBJECT = re.compile(r'^\s*(?://+<?|/\*+|\*|#|"""|.*"doc": ")\s*(?:Of|What|Where|Those)\b')
COMMENT = re.compile(r"^\s*(?://|/\*|\*|#)")
CLOSED_SENTENCE = re.compile(r"""[.:]["']?\s*$""")
# Older ones. The list may only become shorter.
WITHOUT_SUBJECTS = {
    "src/island/island.cpp", "src/island/island.h", "src/solver/pieces.h",
    "src/solver/problem.h",
}  # fmt: skip


def begins_without_a_subject(line: str, before: str) -> bool:
    """False for the middle of a sentence that happens to break before such a word."""
    is_open = COMMENT.match(before) and not LICENSE.search(before) and not CLOSED_SENTENCE.search(before)
    return bool(NO_SUBJECT.match(line)) and not is_open


def test_a_comment_begins_with_a_subject() -> None:
    assert begins_without_a_subject("/// Of each, m.", "") and begins_without_a_subject(
        '  """What it is."""', "def f():"
    )
    assert begins_without_a_subject("// Where it is.", "// It is drawn.")
    assert begins_without_a_subject("// What it is.", "// SPDX-License-Identifier: Apache-2.0")
    assert not begins_without_a_subject("// Of the others.", "// It is one")
    found = []
    for path in files():
        name = path.relative_to(ROOT).as_posix()
        if name in WITHOUT_SUBJECTS or path.suffix not in {".h", ".cpp", ".ts", ".py", ".json"}:
            continue
        if not name.startswith(("include/", "src/", "bindings/", "web/src/", "python/iota/", "protocol/")):
            continue
        before = ""
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if begins_without_a_subject(line, before):
                found.append(f"{name}:{number}: {line.strip()[:60]}")
            before = line
    assert found == [], "a subject and a verb, please"


CPP_TEST = re.compile(r"^(?:TEST|TEST_F|TEST_P|TYPED_TEST)\(\s*(\w+),\s*(\w+)\)", re.MULTILINE)


def test_every_cpp_test_is_named_as_a_sentence_in_snake_case() -> None:
    names = [
        f"{path.name}: {suite}.{name}"
        for path in (ROOT / "tests" / "cpp").rglob("*.cpp")
        for suite, name in CPP_TEST.findall(path.read_text(encoding="utf-8"))
        if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)+", name)
    ]
    assert not names


def test_folders_of_cpp_tests_are_those_of_the_sources() -> None:
    def folders(root: Path, pattern: str) -> set[str]:
        return {path.parent.relative_to(root).as_posix() for path in root.rglob(pattern)}

    others = {".", "soak"}  # what tests share, and what tests the folder soak
    assert folders(ROOT / "tests" / "cpp", "*.cpp") - others <= folders(ROOT / "src", "*.h")


# Sources that other tests cover, and these. The list may only become shorter.
TESTED_ELSEWHERE = {
    "held/bond_batches": "held/bonds_test.cpp: one force, written in each way",
    "ingredient/fields": "held/fields_test.cpp, model/audit_test.cpp",
    "ingredient/model": "ingredient/ingredient_list_test.cpp: all folds see an added ingredient",
    "net/connection": "net/server_test.cpp, over real sockets",
    "solver/diagnosis": "island/diagnose_test.cpp, by numbers worked out by hand",
    "solver/general/kinsol": "solver/general/solver_test.cpp, which tests each solver of a build",
    "solver/sparse/block_pattern": "solver/sparse/pattern_builder_test.cpp, block_factor_test.cpp: a dense twin",
}


def test_every_cpp_source_has_a_test_of_its_name() -> None:
    """src/solver/judge.cpp: tests/cpp/solver/judge_test.cpp; a part of a class, integrator_gaps.cpp: integrator_test.cpp.
    The functions in src/system pass commands and readings on, which have their own tests."""
    sources, tests = ROOT / "src", ROOT / "tests" / "cpp"
    tested = {path.relative_to(tests).as_posix().removesuffix("_test.cpp") for path in tests.rglob("*_test.cpp")}

    def is_tested(name: str) -> bool:
        words = name.split("_")
        return any("_".join(words[:count]) in tested for count in range(len(words), 0, -1))

    names = [path.relative_to(sources).with_suffix("").as_posix() for path in sources.rglob("*.cpp")]
    without = {name for name in names if not name.startswith("system/") and not is_tested(name)}
    assert sorted(without - set(TESTED_ELSEWHERE)) == [], "write a test, tests/cpp/NAME_test.cpp"
    assert sorted(set(TESTED_ELSEWHERE) - without) == [], "these have a test, or are gone: remove them from the list"
    elsewhere = [name for text in TESTED_ELSEWHERE.values() for name in re.findall(r"\S+_test\.cpp", text)]
    assert [name for name in elsewhere if not list(tests.rglob(name))] == []


@pytest.mark.parametrize(
    ("page", "root", "sources"), [("docs/architecture.md", "src", "*.h"), ("web/README.md", "web/src", "*.ts")]
)
def test_the_table_of_folders_has_every_folder(page: str, root: str, sources: str) -> None:
    base = (ROOT / root).parent
    folders = {path.parent.relative_to(base).as_posix() for path in (ROOT / root).rglob(sources)}
    table = [line for line in (ROOT / page).read_text().splitlines() if line.startswith("| `")]
    named = set(re.findall(r"`(src/[\w/]+)`", "\n".join(line.split("|")[1] for line in table)))
    assert len(folders) > 10 and sorted(folders - named) == []
    assert sorted(name for name in named if not (base / name).is_dir()) == []


def test_the_protocol_page_has_all_messages() -> None:
    told = (ROOT / "protocol" / "README.md").read_text()
    schema = json.loads((ROOT / "protocol" / "schema.json").read_text())
    messages = [message["name"] for side in ("client_messages", "server_messages") for message in schema[side]]
    kinds = [path.stem for path in (ROOT / "protocol" / "entities").glob("*.json")]
    assert len(messages) > 20 and len(kinds) > 20
    assert not [name for name in messages + kinds if f"`{name}`" not in told]


BRITISH = re.compile(
    r"(?i)colour|centre|neighbour|behaviour|favour|licence|grey|artefact|catalogue|\b(kilo|centi|milli)?metres?\b"
    r"|\banaly[s](e|ed|er|ing)\b|(initial|maxim|minim|normal|optim|organ|quant|real|serial)is(e[ds]?|er|ing|ation)\b"
    r"|(cance|labe|leve|mode|signa|trave)ll(ed|ing)\b"
)
TEXTS = {".cpp", ".css", ".h", ".html", ".json", ".md", ".py", ".sh", ".toml", ".ts", ".txt"}
OTHERS_WORDS = {  # words of other libraries, which errors translate, and of CSS; tests of that; licenses; this list
    "python/iota/arguments.py", "python/iota/colors.py", "tests/python/test_errors_in_words.py", "tests/python/test_scene.py",
    "tests/packaging/test_sources.py",
}  # fmt: skip


def test_words_have_their_american_spelling() -> None:
    found = []
    for path in files():
        name = path.relative_to(ROOT).as_posix()
        if path.suffix not in TEXTS or name in OTHERS_WORDS or name.startswith("LICENSES/"):
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            found += [f"{name}:{number}: {word[0]}" for word in BRITISH.finditer(line)]
    assert not found
