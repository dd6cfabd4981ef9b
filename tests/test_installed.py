"""The wheel in empty environments."""

from __future__ import annotations

import json
import os
import shutil
import struct
import subprocess
import sys
import venv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from test_packaging import LESSONS, SCENARIOS, VERSION, dist, wheel_in  # noqa: F401

pytestmark = pytest.mark.exhaustive("installs all it needs")

UNREACHABLE = ("Could not find a version", "No solution found", "error sending request", "Failed to fetch")


def surroundings(folder: Path) -> dict[str, str]:
    kept = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    return kept | {
        "RL_TUI_CACHE_DIR": str(folder / "cache"),
        "NUMBA_DISABLE_JIT": "1",  # compiling takes longer than everything here
        "UV_TOOL_DIR": str(folder / "uv"),
        "UV_TOOL_BIN_DIR": str(folder / "bin"),
        "PIPX_HOME": str(folder / "pipx"),
        "PIPX_BIN_DIR": str(folder / "bin"),
        "PIPX_MAN_DIR": str(folder / "man"),
    }


def done(folder: Path, *command: object) -> str:
    ended = subprocess.run(
        [str(each) for each in command],
        cwd=folder,
        env=surroundings(folder.parent),
        capture_output=True,
        text=True,
        check=False,
    )
    if ended.returncode and any(words in ended.stderr for words in UNREACHABLE):
        pytest.skip("the package index cannot be reached")
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def tool(name: str) -> str:
    found = shutil.which(name, path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    if found is None:
        pytest.skip(f'needs {name}: pip install "rl-tui[test]"')
    return found


def by_pip(wheel: str, folder: Path) -> Path:
    home = folder.parent / "venv"
    venv.EnvBuilder(with_pip=False).create(home)  # its own pip would take longer than the test
    python = home / "bin" / "python"
    done(folder, sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-compile", wheel)
    return home / "bin" / "rl-tui"


def by_uv(wheel: str, folder: Path) -> Path:
    done(folder, tool("uv"), "tool", "install", "--python", sys.executable, wheel)
    return folder.parent / "bin" / "rl-tui"


def by_pipx(wheel: str, folder: Path) -> Path:
    done(folder, tool("pipx"), "install", "--python", sys.executable, wheel)
    return folder.parent / "bin" / "rl-tui"


@pytest.fixture
def elsewhere(tmp_path: Path) -> Path:
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    return folder


@pytest.mark.parametrize("install", [by_pip, by_uv, by_pipx])
def test_the_wheel_works_in_an_empty_environment_from_another_folder(
    install: Callable[[str, Path], Path],
    dist: Path,  # noqa: F811
    elsewhere: Path,
) -> None:
    program = install(str(wheel_in(dist)), elsewhere)

    def says(*args: str) -> str:
        return done(elsewhere, program, *args)

    def found(*args: str) -> Any:
        return json.loads(says(*args, "--json"))

    assert says("--version") == f"rl-tui, version {VERSION}\n"
    assert {line.split()[0] for line in says("list").splitlines()[1:]} >= {
        name.removesuffix(".toml") for name in SCENARIOS
    }
    assert {f"{row['id']}.toml" for row in found("learn", "--list")} == LESSONS
    assert says("screenshot", "--lesson", "loop", "--size", "80x24", "--out", "-").startswith("<svg")
    assert found("train", "frozenlake")["expected_return"] == 1.0
    (finding,) = found("watch", "--example", "--steps", "1500")["findings"]
    assert finding["fault"] == "updates-after-moving"
    from_python = """
import gymnasium, rl_tui
print(gymnasium.make("rl_tui/cliff-v0").unwrapped, len(rl_tui.scenarios()))
print(rl_tui.train("student", steps=5).steps)
"""
    python = program.resolve().parent / "python"
    assert done(elsewhere, python, "-c", from_python).splitlines() == [
        f"<ScenarioEnv<rl_tui/cliff-v0>> {len(SCENARIOS)}",
        "5",
    ]
    assert list(elsewhere.iterdir()) == []


WITH_A_CLUSTER = """
import subprocess, sys
from distributed import LocalCluster
if __name__ == "__main__":
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        sweep = [sys.argv[1], "sweep", "student", "--vary", "alpha=.1,.2", "--runs", "2", "--episodes", "9"]
        subprocess.run([*sweep, "--json", "--dask", cluster.scheduler_address], check=True)
"""


def test_each_extra_works_from_the_wheel(
    dist: Path,  # noqa: F811
    elsewhere: Path,
) -> None:
    program = by_uv(f"{wheel_in(dist)}[plot,serve,dask]", elsewhere)
    script = elsewhere / "cluster.py"
    script.write_text(WITH_A_CLUSTER, encoding="utf-8")
    results = elsewhere / "sweep.json"
    results.write_text(
        done(elsewhere, program.resolve().parent / "python", script, program), encoding="utf-8"
    )
    assert len(json.loads(results.read_text(encoding="utf-8"))["cells"]) == 2
    done(elsewhere, program, "plot", results, "--out", "sweep.png")
    assert struct.unpack(">I", (elsewhere / "sweep.png").read_bytes()[16:20])[0] > 1_000
    serving = subprocess.Popen(
        [program, "serve", "--port", "0", "--no-kiosk", "--yes"],
        cwd=elsewhere,
        env=surroundings(elsewhere.parent),
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        assert serving.stdout is not None
        assert "http://" in serving.stdout.readline()
    finally:
        serving.terminate()
        serving.communicate()
