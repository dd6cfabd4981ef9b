"""``rl-tui evaluate``."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from called import assert_refused, called
from click.testing import Result

from rl_tui.commands.reports.evaluation import CHANCE_TO_END

KEYS = [
    *("scenario", "gamma", "policy", "epsilon", "value_at_start", "expected_return", "steps", "V"),
    *("ends", "not_given"),
]
ENDLESS = """
title = "For ever"
[mdp]
start = "here"
[[mdp.transition]]
state = "here"
action = "stay"
reward = {reward}
to = "here"
[[mdp.transition]]
state = "here"
action = "go"
reward = 2
to = "end"
"""
run = partial(called, "evaluate")


def document(*args: str) -> dict[str, Any]:
    result = run(*args, "--json")
    assert result.exit_code == 0, result.stderr
    answer: dict[str, Any] = json.loads(result.stdout)
    assert list(answer) == KEYS
    return answer


def one_line(result: Result) -> str:
    assert len(result.stderr.splitlines()) == 1
    return result.stderr


def test_a_random_policy_on_the_lake() -> None:
    answer = document("frozenlake", "--policy", "uniform")
    assert (answer["scenario"], answer["gamma"], answer["policy"]) == ("frozenlake", 0.99, "uniform")
    assert (answer["epsilon"], answer["not_given"]) == (0.0, None)
    assert answer["expected_return"] == pytest.approx(0.013939795959171436, rel=1e-13)
    assert 0.999999 < answer["ends"] < 1.0
    assert list(answer["V"]) == [str(state) for state in range(16)]
    assert answer["V"]["0"] == answer["value_at_start"]
    assert answer["V"]["15"] == 0.0


def test_the_best_policy_with_a_random_action_now_and_then() -> None:
    slippery = document("frozenlake-slippery", "--policy", "optimal", "--epsilon", "0.1")
    assert slippery["expected_return"] == pytest.approx(0.4055262082214294, rel=1e-13)
    assert slippery["epsilon"] == 0.1
    cliff = document("cliff", "--policy", "optimal", "--epsilon", "0.1", "--gamma", "1")
    assert cliff["value_at_start"] == cliff["expected_return"] == pytest.approx(-50.80004766676948, rel=1e-13)


@pytest.mark.parametrize(
    "options",
    [("--episodes", "300"), ("--steps", "2000", "--seed", "3", "--gamma", "0.9"), ("--algorithm", "sarsa")],
)
def test_a_greedy_policy_is_that_of_a_training_with_the_same_options(options: tuple[str, ...]) -> None:
    options = (*options, "--episodes", "300") if "--algorithm" in options else options
    trained = json.loads(called("train", "frozenlake", *options, "--json").stdout)
    answer = document("frozenlake", "--policy", "greedy", *options)
    assert answer["gamma"] == trained["hyperparameters"]["gamma"]
    assert answer["expected_return"] == pytest.approx(trained["expected_return"], rel=1e-12)
    assert answer["value_at_start"] == trained["value_at_start"]
    assert answer["ends"] == trained["greedy_ends"]


def test_a_random_action_now_and_then_does_not_change_what_is_learned() -> None:
    trained = document("student", "--policy", "greedy", "--episodes", "300")
    mixed = document("student", "--policy", "greedy", "--episodes", "300", "--epsilon", "0.3")
    assert mixed["value_at_start"] < trained["value_at_start"]
    best = document("student", "--policy", "optimal", "--epsilon", "0.3")
    assert trained["value_at_start"] == pytest.approx(5.2 / 0.82)
    assert mixed["V"] == pytest.approx(best["V"])


def test_a_file_says_what_is_done_and_how_many_states_it_leaves_out(tmp_path: Path) -> None:
    path = tmp_path / "policy.json"
    path.write_text('{"Class": "study", "Phone": {"quit": 1}}', encoding="utf-8")
    answer = document("student", "--policy", str(path))
    assert (answer["policy"], answer["not_given"]) == (str(path), 1)
    assert answer["V"] == pytest.approx(document("student", "--policy", "optimal")["V"])
    path.write_text("{}", encoding="utf-8")
    nothing = document("student", "--policy", str(path))
    assert nothing["not_given"] == 3
    assert nothing["V"] == pytest.approx(document("student", "--policy", "uniform")["V"])
    report = run("student", "--policy", str(path)).stdout
    assert "The file has no action for any state: this is the random policy." in report
    path.write_text('{"Class": "study"}', encoding="utf-8")
    report = run("student", "--policy", str(path)).stdout
    assert "The file has no action for 2 states: the policy is random there." in report


def test_a_policy_that_never_ends_has_no_figures(tmp_path: Path) -> None:
    world, stays = tmp_path / "world.toml", tmp_path / "stays.json"
    stays.write_text('{"here": "stay"}', encoding="utf-8")
    world.write_text(ENDLESS.format(reward=1), encoding="utf-8")
    answer = document(str(world), "--policy", str(stays), "--gamma", "1")
    assert (answer["value_at_start"], answer["expected_return"], answer["steps"]) == (None, None, None)
    assert answer["V"] == {"here": None, "end": 0.0}
    assert answer["ends"] == 0.0
    discounted = document(str(world), "--policy", str(stays), "--gamma", "0.5")
    assert (discounted["value_at_start"], discounted["expected_return"]) == (2.0, None)
    world.write_text(ENDLESS.format(reward=0), encoding="utf-8")
    unpaid = document(str(world), "--policy", str(stays), "--gamma", "1")
    assert (unpaid["value_at_start"], unpaid["expected_return"], unpaid["steps"]) == (0.0, 0.0, None)
    report = run(str(world), "--policy", str(stays)).stdout
    assert "chance to end        0" in report


def test_the_report_of_a_world_without_a_map() -> None:
    assert run("student", "--policy", "uniform").stdout.splitlines() == [
        "A student's evening: policy uniform, exact",
        "",
        "state         V  π study  π check phone  π scroll  π quit  π sleep",
        "Class   4.04362      0.5            0.5",
        "Phone   2.39933                               0.5     0.5",
        "Pass   10.00000                                                  1",
        "Sleep   0.00000",
        "",
        "value at the start   4.04362  discounted, γ 0.9",
        "expected return      6.25000  undiscounted, within 100 steps",
        "steps of an episode  6.00000  expected, within 100 steps",
    ]


def test_the_report_of_a_map_shows_the_likeliest_actions() -> None:
    report = run("frozenlake-slippery", "--policy", "optimal", "--epsilon", "0.1").stdout
    assert report.startswith(
        "FrozenLake 4×4 slippery: policy optimal, a random action with probability 0.1, exact\n"
    )
    assert "likeliest actions\n←  ↑  ↑   ↑\n←  ●  →←  ●\n↑  ↓  ←   ●\n●  →  ↓   ★\n" in report
    assert f"{CHANCE_TO_END}        0.97389   within 100 steps" in report
    certain = run("frozenlake", "--policy", "optimal").stdout
    assert "likeliest" not in certain
    assert "\n●   →   →  ★\n" in certain
    assert CHANCE_TO_END not in certain
    assert "★" not in run("frozenlake", "--policy", "uniform").stdout


def test_a_policy_must_be_named_and_known() -> None:
    for args, said in (((), "missing"), (("--policy", "unifrom"), '"unifrom"')):
        assert_refused(
            run("student", *args), 2, f"--policy is {said}; expected uniform, optimal, greedy or FILE.json"
        )


def test_a_training_is_for_a_greedy_policy_only() -> None:
    for option in (("--alpha", "0.5"), ("--episodes", "5"), ("--steps", "5"), ("--algorithm", "sarsa")):
        assert_refused(
            run("student", "--policy", "optimal", *option), 2, f"{option[0]} works only with --policy greedy"
        )


def test_an_option_without_effect_is_told() -> None:
    result = run("student", "--policy", "greedy", "--algorithm", "value-iteration", "--alpha", "0.5")
    assert result.exit_code == 0
    assert one_line(result) == "--alpha has no effect: value-iteration does not use it\n"


def test_faults_of_a_file_are_a_line_each(tmp_path: Path) -> None:
    path = tmp_path / "policy.json"
    path.write_text('{"Class": "sleep", "Nowhere": "go"}', encoding="utf-8")
    result = run("student", "--policy", str(path), "--json")
    assert (result.exit_code, result.stdout) == (1, "")
    assert [line.rsplit(": ", 1)[0] for line in result.stderr.splitlines()] == [
        f"rl-tui: {path}: Class",
        f"rl-tui: {path}: Nowhere",
    ]


def test_a_world_without_a_table_has_no_exact_answer() -> None:
    assert_refused(run("blackjack", "--policy", "uniform"), 1, "blackjack has no exact values")
