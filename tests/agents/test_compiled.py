from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from rl_tui.agents.compiled import compiled, inlined_by_type, member_of

SCRIPT = """
from rl_tui.agents.compiled import CACHED, compiled

@compiled
def double(x):
    return 2.0 * x

print(double(21.0), CACHED, sum(double.stats.cache_hits.values()))
"""


def run_with_cache(folder: Path, script: Path, **also: str) -> str:
    if not script.exists():  # a younger script would not be the one that was compiled
        script.write_text(SCRIPT)
    environment = os.environ | {"RL_TUI_CACHE_DIR": str(folder), **also}
    finished = subprocess.run(
        [sys.executable, "-W", "error", str(script)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.stderr == ""
    return finished.stdout.strip()


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a cache and the script that filled it."""
    folder = tmp_path_factory.mktemp("filled")
    assert run_with_cache(folder / "cache", folder / "kernel.py") == "42.0 True 0"
    return folder


def test_the_second_process_reads_what_the_first_compiled(filled: Path) -> None:
    assert run_with_cache(filled / "cache", filled / "kernel.py") == "42.0 True 1"


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
@pytest.mark.parametrize("damage", [b"", b"not what was written"])
def test_a_damaged_cache_is_rebuilt(filled: Path, ending: str, damage: bytes) -> None:
    cache, script = filled / "cache", filled / "kernel.py"
    damaged = list(cache.rglob(f"*.{ending}"))
    assert damaged
    for file in damaged:
        file.write_bytes(damage)
    assert run_with_cache(cache, script) == "42.0 True 0"
    assert run_with_cache(cache, script) == "42.0 True 1"


def test_it_does_without_a_cache_where_none_can_be_written(tmp_path: Path) -> None:
    occupied = tmp_path / "a file"
    occupied.write_text("")
    assert run_with_cache(occupied, tmp_path / "kernel.py") == "42.0 False 0"
    assert occupied.read_text() == ""


def test_a_kiosk_reads_the_cache_and_writes_nothing(filled: Path, tmp_path: Path) -> None:
    cache, script = filled / "cache", filled / "kernel.py"
    before = {path: path.stat().st_mtime_ns for path in cache.rglob("*")}
    assert run_with_cache(cache, script, RL_TUI_KIOSK="1") == "42.0 True 1"
    assert run_with_cache(cache, tmp_path / "other.py", RL_TUI_KIOSK="1") == "42.0 True 0"
    assert {path: path.stat().st_mtime_ns for path in cache.rglob("*")} == before
    assert run_with_cache(tmp_path / "no cache", script, RL_TUI_KIOSK="1") == "42.0 False 0"
    assert not (tmp_path / "no cache").exists()


class One:
    class Alike(NamedTuple):
        number: float
        word: bool


class Other:
    class Alike(NamedTuple):
        number: float
        word: bool


@inlined_by_type
def answer_of(asked: Any) -> int:
    return 0


@compiled
def ask(asked: Any) -> int:
    return answer_of(asked)


def test_types_that_look_alike_do_not_run_each_others_code() -> None:
    member_of(answer_of, One.Alike)(lambda _: 1)
    member_of(answer_of, Other.Alike)(lambda _: 2)
    one, other = One.Alike(0.5, True), Other.Alike(0.5, True)
    assert [ask(one), ask(other), ask(one)] == [1, 2, 1]
