"""The program runs where everything that only POSIX has is hidden: see hidden_posix/sitecustomize.py."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any, Final

import pytest

HERE: Final = Path(__file__).parent / "hidden_posix"
REFUSED: Final = "rl-tui: your own programs run on Linux and macOS only; on Windows, use WSL\n"

pytestmark = [
    pytest.mark.process,
    pytest.mark.exhaustive("a new process imports all and plays for some seconds"),
]


def hidden(folder: Path, *command: str, **more: str) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join((str(HERE), str(HERE.parents[1])))
    environment = os.environ | {"PYTHONPATH": path, **more}
    return subprocess.run(
        [sys.executable, *command], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    folder = tmp_path_factory.mktemp("hidden")
    (folder / "own.py").write_text("import gymnasium\n", encoding="utf-8")
    done = hidden(folder, str(HERE / "played.py"))
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    assert found["platform"] == "win32"
    return found


def test_training_and_exact_values_are_the_same(shown: dict[str, Any]) -> None:
    for name in ("trained", "solved"):
        status, out, _ = shown[name]
        assert (status, bool(json.loads(out))) == (0, True)


def test_a_sweep_continues_in_its_store(shown: dict[str, Any]) -> None:
    for number, (status, out, _) in zip((3, 4), shown["swept"], strict=True):
        assert (status, [cell["runs"] for cell in json.loads(out)["cells"]]) == (0, [number, number])


def test_a_session_played_by_keys_is_saved_and_continued(shown: dict[str, Any]) -> None:
    first, later = (json.loads(shown[name][1]) for name in ("replayed", "continued"))
    assert later["steps"] == first["steps"] + 1


def test_many_seeds_are_trained_in_the_background(shown: dict[str, Any]) -> None:
    assert shown["many seeds"]


def test_what_needs_posix_is_refused_in_one_sentence(shown: dict[str, Any]) -> None:
    for name in ("watched", "graded"):
        assert shown[name] == [1, "", REFUSED]


def test_printed_commands_are_quoted_for_windows(shown: dict[str, Any]) -> None:
    assert shown["new"][1] == 'rl-tui edit "a & b.toml"\nrl-tui check --deep "a & b.toml"\n'


@pytest.mark.parametrize("encoding", ["cp1252", "utf-8"])
def test_the_program_starts_as_a_module_with_any_encoding_of_its_output(
    tmp_path: Path, encoding: str
) -> None:
    done = hidden(tmp_path, "-m", "rl_tui", "train", "student", "--episodes", "5", PYTHONIOENCODING=encoding)
    assert done.returncode == 0, done.stderr
    assert "value at the start" in done.stdout
