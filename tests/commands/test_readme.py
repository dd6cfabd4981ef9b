"""The examples of README and docs match the program."""

from __future__ import annotations

import json
import re
import runpy
from pathlib import Path

import pytest
from called import printed as output_of

from rl_tui.commands.main import RlTui

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = (ROOT / "docs/reference/commands.md").read_text(encoding="utf-8")
GENERATED = runpy.run_path(str(ROOT / "docs" / "generate.py"))["BLOCKS"]
FOLDERS = ("tutorial", "how-to", "reference", "explanation")
PAGES = [path for folder in FOLDERS for path in sorted((ROOT / "docs" / folder).glob("*.md"))]
DOCS = "".join(path.read_text(encoding="utf-8") for path in PAGES)


@pytest.mark.parametrize(
    "command",
    [
        "python3 -m venv .venv && .venv/bin/pip install -e . && .venv/bin/rl-tui",
        'python3 -m venv .venv && .venv/bin/pip install -e ".[test]" && .venv/bin/python -m pytest',
    ],
)
def test_the_two_commands_for_a_fresh_machine_stand_there(command: str) -> None:
    assert README.count(f"\n    {command}\n") == 1


def test_the_tables_of_fields_have_all_fields_of_the_documents() -> None:
    def fields(command: str) -> set[str]:
        section = re.search(rf"^### {re.escape(command)}\n(.*?)^##", COMMANDS, re.MULTILINE | re.DOTALL)
        assert section
        table = re.search(r"^\| field .*?\n\n", section[1], re.MULTILINE | re.DOTALL)
        assert table
        cells = re.findall(r"^\| (`.*?) \|", table[0], re.MULTILINE)
        return {name for cell in cells for name in re.findall(r"`([^`]+)`", cell)}

    def found(*args: str) -> set[str]:
        return set(json.loads(output_of(*args, "--json")))

    metrics = set(re.findall(r"^\| `(\w+)` ", GENERATED["run_measures"](), re.MULTILINE))
    assert found("train", "bandit", "--episodes", "9", "--change", "5:epsilon=0") == fields("train") | metrics
    assert found("train", "student", "--episodes", "9", "--runs", "2") == fields("train --runs")
    assert found("solve", "student", "--flips") == fields("solve")
    assert found("evaluate", "student", "--policy", "uniform") == fields("evaluate")
    assert found("why", "student") == fields("why")
    assert found("check", "random-walk", "--deep") == fields("check --deep")
    assert found("sweep", "student", "--vary", "alpha=.1,.2", "--runs", "2", "--episodes", "9") == fields(
        "sweep"
    )


def test_every_option_they_name_exists() -> None:
    option = re.compile(r"(?<![\w-])--[a-z][a-z-]+")
    commands = [(), *((name,) for name in RlTui.modules), ("agent", "new")]
    helps = "".join(output_of(*names, "--help") for names in commands)
    others = re.compile(r"^ *(#SBATCH|(srun )?dask) .*$", re.MULTILINE)  # lines for other programs
    assert set(option.findall(others.sub("", README + DOCS))) - set(option.findall(helps)) == set()
