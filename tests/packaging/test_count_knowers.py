# SPDX-License-Identifier: Apache-2.0
"""The counter of who knows whom counts code, in all its spellings, and nothing else."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def count(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    script = ROOT / "tools" / "count_knowers.py"
    return subprocess.run([sys.executable, script, *arguments], capture_output=True, text=True)


def knowers_of(thing: str, tree: Path, **files: str) -> set[str]:
    (tree / "src").mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        path = tree / name.replace("__", "/").replace("_ts", ".ts").replace("_h", ".h").replace("_py", ".py")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    done = count("--tree", tree, "--list", thing)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.split())


def test_identifiers_paths_and_quoted_names_are_knowledge(tmp_path: Path) -> None:
    found = knowers_of(
        "nails",
        tmp_path,
        src__a_h="struct SetNail {};",
        src__b_h="void hold(int nails_);",
        src__c_h='#include "ingredient/nail.h"\n',
        src__d_h='const char* name = "nail";',
        src__e_h="int snail;",
    )
    assert found == {"src/a.h", "src/b.h", "src/c.h", "src/d.h"}


def test_comments_and_sentences_are_not(tmp_path: Path) -> None:
    found = knowers_of(
        "capsule",
        tmp_path,
        src__a_h='// a capsule\n/* a\n   capsule */\nthrow Error("a capsule has no corners");',
        python__iota__b_py='"""A capsule."""\n# capsule\nprint("a capsule is round")',
        web__src__c_ts="// capsule\nconst text = `a capsule`;",
        web__node_modules__d_ts="makeCapsule()",
    )
    assert found == set()


def test_every_language_spells_in_its_own_way(tmp_path: Path) -> None:
    found = knowers_of(
        "half-space",
        tmp_path,
        src__a_h="struct HalfSpace {};",
        python__iota__b_py="half_space = None",
        web__src__c_ts="export function halfSpace() {}",
    )
    assert found == {"src/a.h", "python/iota/b.py", "web/src/c.ts"}


def test_messages_are_those_of_the_schema(tmp_path: Path) -> None:
    (tmp_path / "protocol").mkdir()
    schema = '{"client_messages": [{"name": "wave_hand"}], "server_messages": []}'
    (tmp_path / "protocol" / "schema.json").write_text(schema)
    found = knowers_of(
        "wave_hand",
        tmp_path,
        src__net__a_h="void on(const protocol::WaveHand&);",
        web__src__b_ts='send({ type: "wave_hand" });',
    )
    assert found == {"src/net/a.h", "web/src/b.ts", "protocol/schema.json"}


def test_two_checkouts_are_printed_side_by_side(tmp_path: Path) -> None:
    knowers_of("grips", tmp_path, src__a_h="struct Grip {};")
    done = count("--against", tmp_path)
    assert done.returncode == 0, done.stderr
    row = next(line for line in done.stdout.splitlines() if line.startswith("ingredient    grips"))
    before, after = map(int, row.split()[2:4])
    assert before == 1 and after > 1


def test_an_unknown_thing_is_refused_with_the_list(tmp_path: Path) -> None:
    done = count("--list", "teapot")
    assert done.returncode == 1
    assert "teapot" in done.stderr and "torus" in done.stderr
