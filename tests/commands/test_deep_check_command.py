"""``rl-tui check --deep``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from rl_tui.commands.main import program

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


@pytest.mark.exhaustive("trains under many seeds")
def test_the_evening_has_its_known_figures() -> None:
    found = document("student")
    assert (found["best_return"], found["shortest_way"]) == (7.5, 2)
    assert [flip["gamma"] for flip in found["flips"]] == [0.25]
    assert found["first_update"] == {"chance": 1.0, "mean_episodes": 1.0, "median_episodes": 1}
    assert (found["never_reached"], found["endless"], found["exit"]) == ([], [], 0)


@pytest.mark.exhaustive("compiles all that learn")
def test_a_trap_is_named_by_its_state_and_warned_of(tmp_path: Path) -> None:
    path = tmp_path / "trap.toml"
    path.write_text(TRAP, encoding="utf-8")
    found = document(str(path))
    assert found["endless_states"] == ["8"]
    assert found["shortest_way"] == 3
    assert any("8" in warning for warning in found["warnings"])
    assert "q-learning" in found["endless"]


@pytest.mark.exhaustive("compiles all that learn")
def test_a_trap_that_a_time_limit_ends_is_named_without_a_warning(tmp_path: Path) -> None:
    path = tmp_path / "trap.toml"
    path.write_text(TRAP.replace("[grid]\n", "[grid]\ntime_limit = 20\n", 1), encoding="utf-8")
    found = document(str(path))
    assert (found["endless_states"], found["warnings"]) == (["8"], [])
    said = CliRunner().invoke(program, ["check", "--deep", str(path)]).stdout
    assert "1 state: 8; the time limit of 20 steps ends episodes there" in said


LEDGE = """title = "ledge"
[defaults]
algorithm = "sarsa"
[grid]
{limit}
step_reward = -1
map = '''
S....
.#.a.
...G.
'''
[grid.legend]
a = {{ kind = "floor", only = ["up"], reward = {pays} }}
"""


@pytest.mark.exhaustive("compiles all that learn")
@pytest.mark.parametrize(("limit", "pays"), [("", 2), ("", -1), ("time_limit = 60", 2)])
def test_where_a_greedy_policy_may_never_end_a_time_limit_is_asked_for(
    limit: str, pays: int, tmp_path: Path
) -> None:
    path = tmp_path / "ledge.toml"
    path.write_text(LEDGE.format(limit=limit, pays=pays), encoding="utf-8")
    found = document(str(path))
    asked = [each for each in found["warnings"] if "time_limit" in each]
    is_trap = pays > 0
    assert bool(asked) is (is_trap and not limit)
    assert ("sarsa" in found["endless"]) is is_trap
    plain = CliRunner().invoke(program, ["check", str(path)])
    assert ("time_limit" in plain.stderr) is bool(asked)


@pytest.mark.exhaustive("compiles all that learn")
@pytest.mark.parametrize(
    ("episodes", "cells", "warned"),
    [
        (100, "S.G", ""),
        (100, "SHG", "the agent can never learn"),
        (3, "S....G", "but training has only 3 episodes"),
    ],
)
def test_where_nothing_will_be_learned_that_is_said(
    episodes: int, cells: str, warned: str, tmp_path: Path
) -> None:
    path = tmp_path / "quiet.toml"
    text = f"[defaults]\nepisodes = {episodes}\n[grid]\ntime_limit = 10\nmap = '{cells}'\n"
    path.write_text(text, encoding="utf-8")
    found = document(str(path))["warnings"]
    assert len(found) == bool(warned)
    assert all(warned in each for each in found)


def test_of_a_large_world_what_is_not_worked_out_is_said(tmp_path: Path) -> None:
    rows = ["." * 240 for _ in range(240)]
    rows[0], rows[-1] = "S" + rows[0][1:], rows[-1][1:] + "G"
    path = tmp_path / "large.toml"
    path.write_text("[grid]\nmap = '''\n" + "\n".join(rows) + "\n'''\n", encoding="utf-8")
    found = document(str(path))
    assert (found["random_return"], found["best_return"], found["shortest_way"]) == (None, None, None)
    assert (found["first_update"], found["flips"], found["endless"]) == (None, None, None)
    assert (found["never_reached"], found["endless_states"], found["exit"]) == ([], [], 0)
    assert len(found["warnings"]) == 6


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
    assert "no exact results without a transition table" in result.stdout


@pytest.mark.parametrize("arguments", [["--json", "a.toml"], ["--deep", "student", "maze"]])
def test_one_scenario_and_deep_go_together(arguments: list[str]) -> None:
    assert CliRunner().invoke(program, ["check", *arguments]).exit_code == 2


def test_a_lesson_is_no_scenario() -> None:
    lesson = Path(__file__).parents[2] / "lessons/loop.toml"
    result = CliRunner().invoke(program, ["check", "--deep", str(lesson)])
    assert (result.exit_code, result.stdout) == (2, "")
    assert "loop.toml is a lesson: leave out --deep" in result.stderr
