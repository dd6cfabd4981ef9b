"""The wheel and the sdist, installed into an empty environment and used from another folder."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest

import rl_tui

ROOT = Path(__file__).parents[1]
SCENARIOS = {path.name for path in (ROOT / "scenarios").glob("*.toml")}
LESSONS = {path.name for path in (ROOT / "lessons").glob("*.toml")}
VERSION = rl_tui.__version__


def build(source: Path, target: Path, *what: str) -> None:
    """Build from ``source`` with the installed tools, without downloads."""
    subprocess.run(
        [sys.executable, "-m", "build", "--no-isolation", *what, "--outdir", str(target), str(source)],
        check=True,
        capture_output=True,
    )


@pytest.fixture(scope="module")
def dist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the wheel and the sdist, both built from the tree."""
    folder = tmp_path_factory.mktemp("dist")
    build(ROOT, folder, "--wheel", "--sdist")
    return folder


def wheel_in(folder: Path) -> Path:
    return folder / f"rl_tui-{VERSION}-py3-none-any.whl"


def names_in(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        return set(archive.namelist())


def test_the_wheel_holds_package_styles_scenarios_and_lessons_and_nothing_else(dist: Path) -> None:
    names = names_in(wheel_in(dist))
    assert {f"rl_tui/scenarios/{name}" for name in SCENARIOS} <= names
    assert LESSONS
    assert {f"rl_tui/lessons/{name}" for name in LESSONS} <= names
    assert {"rl_tui/py.typed", "rl_tui/commands/main.py", "rl_tui/screen/glossary/glossary.toml"} <= names
    styles = {path.relative_to(ROOT).as_posix() for path in (ROOT / "rl_tui").glob("**/*.tcss")}
    assert styles
    assert styles <= names
    script_texts = {path.relative_to(ROOT).as_posix() for path in (ROOT / "rl_tui").glob("**/*.py.txt")}
    assert "rl_tui/agents/algorithms/q_learning.py.txt" in script_texts
    assert script_texts <= names
    assert {name.split("/")[0] for name in names} == {"rl_tui", f"rl_tui-{VERSION}.dist-info"}
    assert not any("__pycache__" in name for name in names)


@pytest.mark.exhaustive("builds the wheel once more")
def test_the_sdist_is_enough_to_build_the_same_wheel(dist: Path, tmp_path: Path) -> None:
    with tarfile.open(dist / f"rl_tui-{VERSION}.tar.gz") as archive:
        # before Python 3.11.4 there are no filters
        archive.extractall(tmp_path, **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    source = tmp_path / f"rl_tui-{VERSION}"
    assert {path.name for path in (source / "scenarios").glob("*.toml")} == SCENARIOS
    assert {path.name for path in (source / "lessons").glob("*.toml")} == LESSONS
    for name in ("README.md", "LICENSE", "CHANGELOG.md", "CONTRIBUTING.md", "pyproject.toml", "tests"):
        assert (source / name).exists()
    build(source, tmp_path / "again", "--wheel")
    assert names_in(wheel_in(tmp_path / "again")) == names_in(wheel_in(dist))


@pytest.mark.exhaustive("installs all it needs")
def test_the_wheel_works_in_an_empty_environment_from_another_folder(dist: Path, tmp_path: Path) -> None:
    home = tmp_path / "venv"
    venv.EnvBuilder(with_pip=False).create(home)  # its own pip would take longer than the test
    binaries = home / "bin"
    pip = [sys.executable, "-m", "pip", "--python", binaries / "python"]
    installing = subprocess.run(
        [*pip, "install", "--quiet", "--no-compile", wheel_in(dist)],
        capture_output=True,
        text=True,
        check=False,
    )
    if installing.returncode and "Could not find a version" in installing.stderr:
        pytest.skip("the package index cannot be reached")
    assert installing.returncode == 0, installing.stderr

    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    environment["RL_TUI_CACHE_DIR"] = str(tmp_path / "cache")
    environment["NUMBA_DISABLE_JIT"] = "1"  # compiling takes longer than everything here

    def rl_tui_says(*args: str) -> str:
        done = subprocess.run(
            [binaries / "rl-tui", *args],
            cwd=elsewhere,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout

    assert {line.split()[0] for line in rl_tui_says("list").splitlines()[1:]} >= {
        name.removesuffix(".toml") for name in SCENARIOS
    }
    assert {f"{row['id']}.toml" for row in json.loads(rl_tui_says("learn", "--list", "--json"))} == LESSONS
    assert rl_tui_says("screenshot", "--lesson", "loop", "--size", "80x24", "--out", "-").startswith("<svg")
    assert json.loads(rl_tui_says("train", "frozenlake", "--json"))["expected_return"] == 1.0
    from_python = """
import gymnasium, rl_tui
print(gymnasium.make("rl_tui/cliff-v0").unwrapped, len(rl_tui.scenarios()))
print(rl_tui.train("student", steps=5).steps)
"""
    python_says = subprocess.run(
        [binaries / "python", "-c", from_python],
        cwd=elsewhere,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert python_says.stdout.splitlines() == [f"<ScenarioEnv<rl_tui/cliff-v0>> {len(SCENARIOS)}", "5"]
    assert list(elsewhere.iterdir()) == []
