"""The shell completes commands, options, names and files."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import BashComplete

from rl_tui.commands.main import program

ROOT = Path(__file__).parents[2]
VARIABLE = "_RL_TUI_COMPLETE"


@pytest.mark.parametrize(
    ("before", "begun", "expected"),
    [
        ([], "tra", ["train"]),
        (["train"], "--episo", ["--episodes"]),
        (["train"], "cart", ["cartpole"]),
        (["train", "--algorithm"], "dyna", ["dyna-q"]),
        (["play"], "frozenlake-8x8-", ["frozenlake-8x8-slippery"]),
        (["learn"], "cliff", ["cliff-walk"]),
    ],
)
def test_names_are_completed(before: list[str], begun: str, expected: list[str]) -> None:
    found = BashComplete(program, {}, "rl-tui", VARIABLE).get_completions(before, begun)
    assert [(each.type, each.value) for each in found] == [("plain", value) for value in expected]


@pytest.mark.parametrize("command", ["watch", "check", "play", "grade", "plot", "replay"])
def test_files_are_left_to_the_shell(command: str) -> None:
    [found] = BashComplete(program, {}, "rl-tui", VARIABLE).get_completions([command], "./my_")
    assert found.type == "file"


@pytest.mark.process
@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
def test_the_line_of_the_docs_works_in_bash(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "how-to" / "terminals-and-ssh.md").read_text(encoding="utf-8")
    [line] = [each.strip() for each in text.splitlines() if "bash_source" in each]
    command = tmp_path / "rl-tui"
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m rl_tui "$@"\n', encoding="utf-8")
    command.chmod(0o755)
    typed = "COMP_WORDS=(rl-tui solve egg) COMP_CWORD=2; _rl_tui_completion rl-tui; echo ${COMPREPLY[@]}"
    places = {"PATH": f"{tmp_path}:{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}
    ended = subprocess.run(
        ["bash", "-c", f"{line}\n{typed}"],
        env=os.environ | places,
        capture_output=True,
        text=True,
        check=True,
    )
    assert (ended.stdout, ended.stderr) == ("egg\n", "")
