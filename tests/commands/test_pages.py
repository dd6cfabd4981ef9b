"""The commands of README and docs print what they promise."""

from __future__ import annotations

import json
import re
import shlex
import sqlite3
import subprocess
from collections.abc import Callable, Iterator
from contextlib import closing
from itertools import takewhile
from pathlib import Path
from textwrap import dedent
from typing import Final

import click
import pytest
from click.testing import CliRunner
from lessons.lesson_sessions import record
from programs.course_agents import GYMNASIUM
from pseudo_terminal import RL_TUI, PseudoTerminal, environment_with
from recipes import recipe
from session_samples import after, fresh

from rl_tui.commands.main import program
from rl_tui.common.kiosk import VARIABLE as KIOSK
from rl_tui.lessons.file.view import begun
from rl_tui.lessons.lesson import lesson_folder, read_lesson
from rl_tui.live.sessions.session import encoded

ROOT: Final = Path(__file__).parents[2]
DOCS: Final = ROOT / "docs"
COMMAND: Final = re.compile(r" {4,}(?:\$ )?((?:[A-Z_]+=\S+ )?(?:rl-tui|sqlite3)\b.*?)(?: +[|#] .*)?")
ON_SCREEN: Final = re.compile(r"rl-tui(?: --kiosk| (?:play|learn|edit|watch)\b(?!.*--json).*)?")
NOT_RUN: Final = {
    r"\$": "has variables of a batch system",
    "_RL_TUI_COMPLETE=": "prints lines for a shell: test_completion.py",
    "RL_TUI_CACHE_DIR=": "writes to a folder of the system",
    "--dask": "needs a cluster: test_dask_option.py",
    "rl-tui serve": "serves until it is stopped: tests/browser",
    "rl-tui warm$": "compiles every algorithm, for minutes: test_warm.py",
    "rl-tui figure": "trains for long: test_a_picture_is_what_the_program_draws",
    "my_module": "needs a module of the reader: test_gymnasium_ids.py",
    "grade my_agent.py": "learns 200,000 episodes in Python: test_agent_command.py",
}
FEWER: Final = {"--seeds 20": "--seeds 2", "--runs 100": "--runs 10", "--runs 256": "--runs 16"}
HAS_ONLY_BEGUN: Final = {"rl-tui grade handed-in/ loop", "rl-tui grade handed-in/ loop --json"}
STORE: Final = "rl-tui sweep cliff --vary alpha=0.1,0.5 --runs 2 --episodes 9 --store cliff.sqlite"
BEFORE: Final = {"docs/how-to/charts-and-book-figures.md": STORE, "docs/reference/sweep-store.md": STORE}


def commands_of(page: Path) -> Iterator[tuple[str, str]]:
    lines = page.read_text(encoding="utf-8").replace("\\\n", "").splitlines()
    found = {place: match[1] for place, line in enumerate(lines) if (match := COMMAND.fullmatch(line))}
    for place, command in found.items():
        end = place + 1
        while end < len(lines) and end not in found and re.match("    |$", lines[end]):
            end += 1
        yield command, dedent("\n".join(lines[place + 1 : end])).strip()


COMMANDS: Final = {
    page.relative_to(ROOT).as_posix(): commands
    for page in sorted([*ROOT.glob("*.md"), *DOCS.rglob("*.md")])
    if (commands := list(commands_of(page)))
}


def is_run(command: str) -> bool:
    return not any(re.search(pattern, command) for pattern in NOT_RUN)


def is_drawn_before(command: str, page: str) -> bool:
    """An earlier page has the same command for a picture, which no other command reads."""
    earlier = takewhile(lambda each: each != page, COMMANDS)
    return "--out" in command and any(command == each for other in earlier for each, _ in COMMANDS[other])


def lake(table: str = "q") -> str:
    return re.sub(r"\bq\b", table, (DOCS / "lake.py").read_text(encoding="utf-8"))


def notebook() -> str:
    cell = {"cell_type": "code", "metadata": {}, "execution_count": None, "outputs": [], "source": lake()}
    return json.dumps({"nbformat": 4, "nbformat_minor": 5, "metadata": {}, "cells": [cell]})


def corridor(more: str = "") -> str:
    guide = (DOCS / "how-to/write-a-lesson.md").read_text(encoding="utf-8")
    return "\n".join([*re.findall(r"```toml\n(.*?)```", guide, re.DOTALL), more])


def two_roads() -> str:
    page = (DOCS / "reference/scenario-files.md").read_text(encoding="utf-8")
    [shown] = re.findall(r'    title = "Two roads"\n(?:    .*\n|\n)*', page)
    return dedent(shown)


def handed_in() -> str:
    return encoded(record(begun(read_lesson(lesson_folder() / "loop.toml")))).decode()


FILES: Final[dict[str, Callable[[], str]]] = {
    "my_lake.py": lake,
    "docs/lake.py": lake,
    "my_script.py": lambda: lake("q_values"),
    "my_notebook.ipynb": notebook,
    "submissions/anna.py": lambda: GYMNASIUM,
    "corridor.toml": corridor,
    "my-lesson.toml": lambda: corridor("[variants]\nid = [1, 2, 3, 4, 5, 6, 7]"),
    "two-roads.toml": two_roads,
    "my-policy.json": lambda: '{"0": "right", "1": {"left": 0.5, "down": 0.5}}',
    "cliff-demo.json": lambda: encoded(after(fresh(recipe("cliff")), 10)).decode(),
    "handed-in/lesson-loop.json": handed_in,
    "config/rl-tui/scenarios/my-maze.toml": lambda: (ROOT / "scenarios/maze.toml").read_text("utf-8"),
}
"""What the reader of a page has written, drawn, saved or collected before."""


def show(command: str) -> str:
    with PseudoTerminal([*RL_TUI, *shlex.split(command)[1:]]) as terminal:
        terminal.wait_until(lambda: bool(terminal.screen.strip()))
        terminal.press("qq")
        assert terminal.wait_for_end() == 0, terminal.screen
        return terminal.screen


def run(line: str) -> str:
    printed = ""
    for command in line.split(" && "):
        fewer = re.sub("|".join(FEWER), lambda said: FEWER[said[0]], command)
        call, _, target = fewer.partition(" > ")
        words = shlex.split(call)
        if words[0] == "sqlite3":
            with closing(sqlite3.connect(words[1])) as store:
                return "\n".join(map(str, store.execute(words[2])))
        done = subprocess.run(
            [*RL_TUI, *words[1:]], env=environment_with({}), capture_output=True, text=True, check=False
        )
        assert done.returncode == (command in HAS_ONLY_BEGUN), f"{command}\n{done.stdout}{done.stderr}"
        printed = done.stdout
        if target:
            Path(target).write_text(printed, encoding="utf-8")
    return printed


def without_speed(text: str) -> str:
    return re.sub(r"in [\d.]+ s, [\d.,]+ (million )?steps/s", "", text).strip()


@pytest.mark.process
@pytest.mark.slow
@pytest.mark.exhaustive("runs commands for seconds", but=["docs/reference/scenario-files.md"])
@pytest.mark.parametrize(
    "page", [pytest.param(page, marks=pytest.mark.xdist_group(page)) for page in COMMANDS]
)
def test_a_page_can_be_followed(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_text(text(), encoding="utf-8")
    if page in BEFORE:
        run(BEFORE[page])
    for command, shown in COMMANDS[page]:
        if is_run(command) and not is_drawn_before(command, page):
            printed = show(command) if ON_SCREEN.fullmatch(command) else run(command)
            assert not shown or without_speed(printed) == without_speed(shown)


@pytest.mark.parametrize(
    "line", sorted({line for commands in COMMANDS.values() for line, _ in commands if not is_run(line)})
)
def test_a_command_that_does_not_run_here_is_one_that_the_program_takes(
    line: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(click.Command, "invoke", lambda self, context: None)
    monkeypatch.setenv(KIOSK, "")
    words = shlex.split(re.sub(r"\$\w+", "1", re.sub(r"\$\(.*\)", "tcp://node0:8786", line)))
    result = CliRunner().invoke(program, words[words.index("rl-tui") + 1 :])
    assert (result.exit_code, result.output) == (0, "")
