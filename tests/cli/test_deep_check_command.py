"""``rl-tui check --deep``: figures known from elsewhere, faults, and what cannot be known."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from rl_tui.cli.main import program

pytestmark = pytest.mark.unit

TRAP = """[grid]
map = '''
S..G
.##.
a##.
'''
[grid.legend]
a = { kind = "floor", only = ["down"] }
"""


def document(*arguments: str) -> dict[str, Any]:
    result = CliRunner().invoke(program, ["check", "--deep", "--json", *arguments])
    found: dict[str, Any] = json.loads(result.stdout)
    return found | {"exit": result.exit_code}


def test_the_evening_has_its_known_figures() -> None:
    found = document("student")
    assert (found["best_return"], found["shortest_way"]) == (7.5, 2)
    assert [flip["gamma"] for flip in found["flips"]] == [0.25]
    assert found["first_update"] == {"chance": 1.0, "mean_episodes": 1.0, "median_episodes": 1}
    assert (found["never_reached"], found["endless"], found["exit"]) == ([], [], 0)


def test_a_trap_is_named_by_its_state_and_warned_of(tmp_path: Path) -> None:
    path = tmp_path / "trap.toml"
    path.write_text(TRAP, encoding="utf-8")
    found = document(str(path))
    assert found["endless_states"] == ["8"]
    assert found["shortest_way"] == 3
    assert any("8" in warning for warning in found["warnings"])
    assert "q-learning" in found["endless"]


def test_faults_stand_alone(tmp_path: Path) -> None:
    path = tmp_path / "faulty.toml"
    path.write_text("[grid]\nmap = '...'\n", encoding="utf-8")
    found = document(str(path))
    assert found["exit"] == 1
    assert len(found["faults"]) == 1
    assert found["best_return"] is None


def test_what_has_no_table_is_null_with_the_reason() -> None:
    found = document("blackjack")
    assert all(found[name] is None for name in ("random_return", "best_return", "flips", "never_reached"))
    assert len(found["warnings"]) == 1
    result = CliRunner().invoke(program, ["check", "--deep", "blackjack"])
    assert result.exit_code == 0
    assert "there is no table" in result.stdout


@pytest.mark.parametrize("arguments", [["--json", "a.toml"], ["--deep", "student", "maze"]])
def test_one_scenario_and_deep_go_together(arguments: list[str]) -> None:
    assert CliRunner().invoke(program, ["check", *arguments]).exit_code == 2
