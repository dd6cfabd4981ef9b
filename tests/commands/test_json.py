"""The JSON documents for other programs."""

from __future__ import annotations

import csv
import json
import math
import subprocess
import sys
from pathlib import Path

import pytest
from called import called, document

from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.runs.training import benchmark
from rl_tui.worlds.files.catalogue import scenarios

TRAIN = [
    *("scenario", "algorithm", "seed", "hyperparameters", "episodes", "steps", "seconds"),
    *("steps_per_second", "states", "actions", "world", "q", "visits", "policy", "value_at_start"),
    *("optimal_value_at_start", "expected_return", "max_error", "return_mean", "return_last_100"),
    *("length_last_100", "greedy_ends", "first_reward_episode"),
]
HEAD = ["scenario", "algorithm", "seed", "hyperparameters"]
RUN = [
    *("seed", "steps", "episodes", "value_at_start", "expected_return", "max_error", "return_mean"),
    *("return_last_100", "length_last_100", "first_reward_episode", "world"),
]
BANDIT = ["winnings", "regret", "best_arm_rate"]
SUMMARY = ["mean", "stderr", "min", "max", "count"]
CURVE = ["episode", "return_mean", "return_stderr", "length_mean", "length_stderr"]
BANDIT_CURVE = ["optimal_action_rate", "optimal_action_stderr"]
SOLVE = [
    *("scenario", "gamma", "states", "actions", "v", "q", "policy", "left_out", "value_at_start"),
    *("expected_return", "best_expected_return", "iterations"),
]
LIST = ["id", "title", "kind", "states", "actions", "pairs", "time_limit", "defaults"]
BENCH = ["scenario", "kernel_steps_per_second", "gymnasium_steps_per_second", "ratio"]


def test_train() -> None:
    figures = document("train", "frozenlake")
    assert list(figures) == TRAIN
    assert (figures["scenario"], figures["algorithm"], figures["seed"]) == ("frozenlake", "q-learning", 0)
    assert list(figures["hyperparameters"]) == list(PARAMETERS)
    assert (
        figures["hyperparameters"]
        | {
            "alpha": 0.1,
            "gamma": 0.99,
            "epsilon": 0.1,
            "epsilon_min": 0.0,
            "epsilon_decay": 0.0,
            "initial_q": 0.0,
            "ties": "random",
        }
        == figures["hyperparameters"]
    )
    assert figures["episodes"] == 10_000
    assert figures["states"] == [str(state) for state in range(16)]
    assert figures["actions"] == ["left", "down", "right", "up"]
    assert figures["q"][5] == [None] * 4  # a hole
    assert figures["policy"][5] == []
    assert figures["policy"][14] == ["right"]
    assert sum(count for row in figures["visits"] for count in row if count is not None) == figures["steps"]
    assert figures["expected_return"] == 1.0
    assert figures["greedy_ends"] == 1.0
    assert figures["optimal_value_at_start"] == pytest.approx(0.99**5, abs=1e-9)
    assert figures["value_at_start"] == pytest.approx(0.99**5, abs=1e-9)


def test_train_takes_the_options() -> None:
    options = (
        "--alpha sample-average --gamma 0.5 --epsilon 1 --epsilon-min 0.2 --epsilon-decay 0.01"
        " --initial-q -3 --ties first --seed 7 --steps 1234"
    )
    figures = document("train", "student", *options.split())
    assert (
        figures["hyperparameters"]
        | {
            "alpha": "sample-average",
            "gamma": 0.5,
            "epsilon": 1.0,
            "epsilon_min": 0.2,
            "epsilon_decay": 0.01,
            "initial_q": -3.0,
            "ties": "first",
        }
        == figures["hyperparameters"]
    )
    assert (figures["seed"], figures["steps"]) == (7, 1234)


def test_without_a_reward_nothing_is_hidden() -> None:
    figures = document("train", "frozenlake", "--ties", "first", "--episodes", "200")
    assert figures["first_reward_episode"] is None
    assert figures["expected_return"] == 0.0
    assert figures["greedy_ends"] == 0.0
    assert figures["policy"][0] == ["left", "down", "right", "up"]


def test_without_a_finished_episode_means_are_null() -> None:
    figures = document("train", "frozenlake", "--steps", "1")
    assert figures["episodes"] == 0
    assert figures["return_last_100"] is None
    assert figures["length_last_100"] is None


@pytest.mark.parametrize("scenario", ["frozenlake", "bandit"])
def test_train_runs(scenario: str) -> None:
    figures = document("train", scenario, "--runs", "3", "--episodes", "300", "--seed", "5")
    names = [*RUN, *(BANDIT if scenario == "bandit" else [])]
    assert [key for key in figures if key in {*HEAD, "runs", "summary", "curve"}] == [
        *HEAD,
        "runs",
        "summary",
        "curve",
    ]
    assert [list(row) for row in figures["runs"]] == [names] * 3
    assert [row["seed"] for row in figures["runs"]] == [5, 6, 7]
    assert set(figures["summary"]) == set(names) - {"seed", "world"}
    assert all(list(each) == SUMMARY for each in figures["summary"].values())
    assert figures["summary"]["steps"]["mean"] == pytest.approx(
        sum(row["steps"] for row in figures["runs"]) / 3
    )
    assert list(figures["curve"]) == [*CURVE, *(BANDIT_CURVE if scenario == "bandit" else [])]
    assert figures["curve"]["episode"] == list(range(2, 301, 2))
    assert all(len(column) == 150 for column in figures["curve"].values())


def test_a_bandit_tells_how_its_pulls_were_spent() -> None:
    figures = document("train", "bandit", "--seed", "3")
    assert list(figures) == [*TRAIN, *BANDIT]
    pulls, means = figures["visits"][0], document("solve", "bandit", "--seed", "3")["q"][0]
    best = max(means)
    assert figures["best_arm_rate"] == pulls[means.index(best)] / 1000
    assert figures["regret"] == pytest.approx(
        sum(count * (best - mean) for count, mean in zip(pulls, means, strict=True))
    )
    # with the sample average, the return of each arm is its estimate times its pulls
    brought = math.fsum(count * q for count, q in zip(pulls, figures["q"][0], strict=True))
    assert figures["winnings"] == pytest.approx(brought)


def test_csv_has_a_row_an_episode(tmp_path: Path) -> None:
    file = tmp_path / "episodes.csv"
    figures = document("train", "student", "--episodes", "50", "--runs", "2", "--csv", str(file))
    with file.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert list(rows[0]) == ["run", "episode", "return", "length"]
    assert [(row["run"], row["episode"]) for row in rows] == [
        (str(run), str(episode)) for run in (1, 2) for episode in range(1, 51)
    ]
    assert sum(int(row["length"]) for row in rows) == sum(row["steps"] for row in figures["runs"])
    assert math.fsum(float(row["return"]) for row in rows[:50]) / 50 == pytest.approx(
        figures["runs"][0]["return_last_100"]
    )


@pytest.mark.parametrize("runs", [(), ("--runs", "2")])
def test_csv_can_go_to_stdout(runs: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    command = ["train", "student", "--episodes", "5", *runs, "--csv"]
    to_file = called(*command, "rows.csv")
    result = called(*command, "-")
    assert result.exit_code == 0
    assert result.stdout == Path("rows.csv").read_text(encoding="utf-8")
    assert result.stderr.splitlines()[:2] == to_file.stdout.splitlines()[:2]
    assert [file.name for file in tmp_path.iterdir()] == ["rows.csv"]


@pytest.mark.parametrize(
    ("args", "value"), [(("frozenlake-slippery", "--gamma", "0.99"), 0.54203), (("student",), 5.2 / 0.82)]
)
def test_solve(args: tuple[str, ...], value: float) -> None:
    answer = document("solve", *args)
    assert list(answer) == SOLVE
    assert answer["value_at_start"] == pytest.approx(value, abs=1e-5)
    assert answer["v"][0] == pytest.approx(value, abs=1e-5)
    assert len(answer["q"]) == len(answer["states"]) == len(answer["policy"])
    assert answer["best_expected_return"] >= answer["expected_return"] - 1e-12


def test_solve_at_gamma_1_has_no_policy_that_never_ends() -> None:
    answer = document("solve", "student", "--gamma", "1")
    assert answer["policy"] == [["study"], ["quit"], ["sleep"], []]
    assert answer["left_out"] == [["check phone"], [], [], []]
    assert answer["q"][0][:2] == pytest.approx([7.5, 7.5])
    assert answer["expected_return"] == answer["best_expected_return"] == pytest.approx(7.5)


def test_solve_draws_the_arms_from_the_seed() -> None:
    first, again, other = (document("solve", "bandit", "--seed", seed)["q"] for seed in ("1", "1", "2"))
    assert first == again != other


def test_list() -> None:
    rows = document("list")
    assert all(list(row) == LIST for row in rows)
    shipped = {row["id"]: row for row in rows}
    assert list(shipped) == [scenario.id for scenario in scenarios()]
    sizes = {name: tuple(row[key] for key in LIST[3:7]) for name, row in shipped.items()}
    assert sizes["student"] == (4, 5, 5, 100)
    assert sizes["frozenlake"] == (16, 4, 44, 100)
    assert sizes["frozenlake-8x8"][3] == 200
    assert shipped["bandit"]["defaults"]["alpha"] == "sample-average"
    assert shipped["frozenlake"]["defaults"]["episodes"] == 10_000


def test_bench(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(benchmark, "KERNEL_STEPS", 10_000)
    monkeypatch.setattr(benchmark, "PLAIN_STEPS", 100)
    figures = document("bench", "--rounds", "1")
    assert list(figures)[:4] == BENCH
    assert figures["scenario"] == "frozenlake-slippery"
    assert figures["ratio"] == pytest.approx(
        figures["kernel_steps_per_second"] / figures["gymnasium_steps_per_second"]
    )


@pytest.mark.usefixtures("real_start")
@pytest.mark.process
def test_nothing_but_the_document_is_on_stdout() -> None:
    command = [sys.executable, "-m", "rl_tui", "train", "frozenlake", "--runs", "2", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    assert done.stdout.count("\n") == 1
    assert json.loads(done.stdout)["scenario"] == "frozenlake"
