"""What README and docs show is what the program does."""

from __future__ import annotations

import json
import re
from pathlib import Path
from textwrap import dedent

import pytest
from click.testing import CliRunner

from rl_tui.commands.main import RlTui, program

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
DOCS = "".join(path.read_text(encoding="utf-8") for path in sorted((ROOT / "docs").rglob("*.md")))


def output_of(*args: str) -> str:
    result = CliRunner().invoke(program, args)
    assert (result.exit_code, result.stderr) == (0, "")
    return result.stdout


def shown_after(command: str) -> str:
    """Return the indented lines that the docs show below ``command``, where they show any."""
    blocks = re.findall(rf"    \$ {re.escape(command)}\n((?:    .*\n|\n)*?)(?=\n*[^ \n])", DOCS)
    (shown,) = filter(None, (dedent(block).strip() for block in blocks))
    return shown


@pytest.mark.parametrize(
    "command",
    [
        "python3 -m venv .venv && .venv/bin/pip install -e . && .venv/bin/rl-tui",
        'python3 -m venv .venv && .venv/bin/pip install -e ".[test]" && .venv/bin/python -m pytest',
    ],
)
def test_the_two_commands_for_a_fresh_machine_stand_there(command: str) -> None:
    assert README.count(f"\n    {command}\n") == 1


def test_solve_prints_what_is_shown() -> None:
    assert output_of("solve", "student").strip() == shown_after("rl-tui solve student")


def test_train_prints_what_is_shown() -> None:
    def without_speed(text: str) -> str:
        return re.sub(r"in [\d.]+ s, [\d.,]+ (million )?steps/s", "", text)

    real = output_of("train", "frozenlake").strip()
    assert without_speed(real) == without_speed(shown_after("rl-tui train frozenlake"))


def test_train_beyond_a_budget_prints_what_is_shown() -> None:
    result = CliRunner().invoke(program, ["train", "bandit", "--episodes", "2000"])
    lines = {*result.stdout.splitlines(), *result.stderr.splitlines()}
    shown = shown_after("rl-tui train bandit --episodes 2000").splitlines()
    assert len(shown) == 9
    assert set(shown) - {"…"} <= lines


def test_the_documents_hold_what_is_shown() -> None:
    figures = json.loads(output_of("train", "frozenlake", "--json"))
    shown = shown_after("rl-tui train frozenlake --json")
    assert f'"visits": [[{figures["visits"][0][0]}, …' in shown
    assert f'"q": [[{figures["q"][0][0]:.2f}, …' in shown
    for name in ("episodes", "steps", "expected_return", "return_last_100", "first_reward_episode"):
        assert f'"{name}": {figures[name]}' in shown
    many = json.loads(output_of("train", "bandit", "--runs", "100", "--json"))
    shown = shown_after("rl-tui train bandit --runs 100 --json")
    first, mean = many["runs"][0], many["summary"]["return_last_100"]
    assert f'"return_last_100": {first["return_last_100"]:.3f}, …, "regret": {first["regret"]:.1f}' in shown
    assert f'{{"mean": {mean["mean"]:.2f}, "stderr": {mean["stderr"]:.2f}, ' in shown
    assert '"episode": [5, 10, …' in shown
    assert many["curve"]["episode"][:2] == [5, 10]


def test_the_scenario_in_it_has_no_fault(tmp_path: Path) -> None:
    toml = re.search(r'(    title = "Two roads"\n(?:    .*\n|\n)*)', DOCS)
    assert toml
    file = tmp_path / "two-roads.toml"
    file.write_text(dedent(toml[1]), encoding="utf-8")
    assert output_of("check", str(file)) == f"{file}: ok\n"


def test_every_option_they_name_exists() -> None:
    option = re.compile(r"(?<![\w-])--[a-z][a-z-]+")
    commands = [(), *((name,) for name in RlTui.modules), ("agent", "new")]
    helps = "".join(output_of(*names, "--help") for names in commands)
    others = re.compile(r"^ *(#SBATCH|(srun )?dask) .*$", re.MULTILINE)  # lines for other programs
    assert set(option.findall(others.sub("", README + DOCS))) - set(option.findall(helps)) == set()
