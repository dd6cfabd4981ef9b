"""``rl-tui train --agent``."""

from __future__ import annotations

import csv
import io
import json
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from called import assert_refused, called
from programs.course_agents import FUNCTION, GYMNASIUM, OF_STYLE, RL_GLUE, UDACITY, agent_in

pytestmark = pytest.mark.process
train = partial(called, "train")


def document(*args: object) -> dict[str, Any]:
    result = train(*args, "--json")
    assert result.exit_code == 0, result.stderr
    answer: dict[str, Any] = json.loads(result.stdout)
    return answer


def test_the_document_has_the_keys_of_ours_and_who_learned(tmp_path: Path) -> None:
    path = agent_in(tmp_path, GYMNASIUM)
    mine = document("frozenlake", "--agent", path, "--episodes", 500)
    ours = document("frozenlake", "--episodes", 500)
    assert set(ours) <= set(mine)
    assert mine["agent"] == {"file": str(path), "name": "LakeAgent", "style": "gymnasium"}
    assert (mine["algorithm"], mine["episodes"]) == ("q-learning", 500)
    assert set(mine["hyperparameters"]) == set(ours["hyperparameters"])
    proven = {name: value for name, value in mine["hyperparameters"].items() if value is not None}
    assert proven == pytest.approx({"alpha": 0.1, "gamma": 0.95})
    assert np.shape(mine["q"]) == np.shape(mine["visits"]) == (16, 4)
    assert mine["steps"] == sum(count for row in mine["visits"] for count in row if count is not None)
    assert mine["expected_return"] == 1.0
    assert mine["optimal_value_at_start"] == ours["optimal_value_at_start"]
    assert 0.0 < mine["max_error"] <= 1.0


def test_figures_of_a_table_are_those_that_it_has(tmp_path: Path) -> None:
    text = "def update(q, s, a, r, s_next):\n    q[:] = [[0, 0, 1, 0]]\n"
    mine = document("frozenlake", "--agent", agent_in(tmp_path, text), "--episodes", 3)
    nothing, right = [None] * 4, [0.0, 0.0, 1.0, 0.0]
    assert mine["q"] == [nothing if state in (5, 7, 11, 12, 15) else right for state in range(16)]
    assert mine["policy"][0] == ["right"]
    assert mine["expected_return"] == 0.0
    assert mine["algorithm"] is None
    assert set(mine["hyperparameters"].values()) == {None}


def test_rows_of_episodes_tell_what_the_document_sums_up(tmp_path: Path) -> None:
    path, rows = agent_in(tmp_path, RL_GLUE), tmp_path / "rows.csv"
    mine = document("frozenlake", "--agent", path, "--episodes", 120, "--csv", rows)
    read = list(csv.DictReader(io.StringIO(rows.read_text())))
    returns = [float(row["return"]) for row in read]
    assert len(read) == 120
    assert sum(int(row["length"]) for row in read) == mine["steps"]
    assert mine["return_mean"] == pytest.approx(np.mean(returns))
    assert mine["return_last_100"] == pytest.approx(np.mean(returns[-100:]))
    paid = [place for place, value in enumerate(returns, 1) if value]
    assert mine["first_reward_episode"] == (paid[0] if paid else None)


def test_many_runs_are_those_of_the_seeds(tmp_path: Path) -> None:
    path = agent_in(tmp_path, FUNCTION)
    many = document("frozenlake", "--agent", path, "--episodes", 100, "--runs", 3, "--seed", 4)
    assert [row["seed"] for row in many["runs"]] == [4, 5, 6]
    alone = document("frozenlake", "--agent", path, "--episodes", 100, "--seed", 5)
    assert {name: alone[name] for name in many["runs"][1] if name != "seed"} == {
        name: value for name, value in many["runs"][1].items() if name != "seed"
    }
    assert many["summary"]["return_mean"]["count"] == 3
    assert many["curve"]["episode"][-1] == 100
    assert many["agent"]["style"] == "function"


def test_so_many_steps(tmp_path: Path) -> None:
    path = agent_in(tmp_path, UDACITY)
    assert document("frozenlake", "--agent", path, "--steps", 777)["steps"] == 777


def test_the_report(tmp_path: Path) -> None:
    path = agent_in(tmp_path, UDACITY)
    result = train("frozenlake", "--agent", f"{path}:Agent", "--episodes", 400, "--algorithm", "sarsa")
    assert result.exit_code == 0
    assert result.stderr.strip() == "--algorithm has no effect: your own agent decides that"
    note = train("frozenlake", "--agent", path, "--episodes", 2, "--gamma", 0.5).stderr
    assert note.strip() == "--gamma has no effect: Agent has no such parameter"
    lines = result.stdout.splitlines()
    assert lines[0] == f"FrozenLake 4×4: Agent of {path}, seed 0"
    assert lines[1] == "its update is q-learning with α 0.2, γ 0.9"
    assert "discounted: greedy policy" in result.stdout


@pytest.mark.parametrize(
    ("text", "more", "said"),
    [
        (UDACITY.replace("goal = reward if", "goal = 1 / 0 if"), (), "mine.py, line 18: ZeroDivisionError"),
        ("def f(:\n", (), "line 1"),
        ("x = 1\n", (), "found no agent. An agent needs the methods of one of these styles"),
        (OF_STYLE["udacity"], ("--alpha", "sample-average"), "expected a number for an agent"),
    ],
)
def test_what_goes_wrong_is_one_line(text: str, more: tuple[str, ...], said: str, tmp_path: Path) -> None:
    path = agent_in(tmp_path, text)
    assert_refused(train("frozenlake", "--agent", path, "--episodes", 20, *more), 1, said)


def test_no_changes_on_the_way(tmp_path: Path) -> None:
    path = agent_in(tmp_path, UDACITY)
    result = train("frozenlake", "--agent", path, "--change", "10:alpha=0.5")
    assert result.exit_code == 2
    assert "give --change or --agent, not both" in result.stderr
