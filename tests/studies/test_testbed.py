"""The figures of chapter 2 of Sutton & Barto (2nd ed.), at fixed seeds and with fewer runs than the book's.

A value agrees within three standard errors for this number of runs. "Better" holds by three standard errors
too, for pairs of runs with the same seed.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from recipes import recipe

from rl_tui.runs.training.many_runs import many_runs
from rl_tui.runs.training.seeded_runs import Goal
from rl_tui.worlds.mdp.space import FloatArray

pytestmark = pytest.mark.slow

PULLS = 1_000
GREEDY = {"epsilon": 0.0}
TENTH = {"epsilon": 0.1}
UCB = {"policy": "ucb", "confidence": 2.0}
THOMPSON = {"policy": "thompson"}


def of_runs(runs: int, scenario: str = "bandit", pulls: int = PULLS, **values: Any) -> dict[str, Any]:
    return _document(runs, scenario, pulls, tuple(sorted(values.items())))


@cache
def _document(runs: int, scenario: str, pulls: int, values: tuple[tuple[str, Any], ...]) -> dict[str, Any]:
    return many_runs(recipe(scenario, **dict(values)), runs, Goal(episodes=pulls))


def column(document: dict[str, Any], name: str) -> FloatArray:
    return np.array([row[name] for row in document["runs"]])


def margin(better: FloatArray, worse: FloatArray) -> float:
    """The mean of the paired differences, in standard errors above 0."""
    difference = better - worse
    return float(difference.mean() / (difference.std(ddof=1) / np.sqrt(len(difference))))


def optimal(document: dict[str, Any], first: int, last: int) -> float:
    """The share of the best arm among the pulls ``first`` .. ``last``, from 1, of all runs."""
    curve = document["curve"]
    inside = [
        rate
        for episode, rate in zip(curve["episode"], curve["optimal_action_rate"], strict=True)
        if first < episode <= last
    ]
    return float(np.mean(inside))


@pytest.mark.exhaustive("trains 600 bandits")
def test_figure_2_3_optimism_is_behind_at_first_and_ahead_in_the_end() -> None:
    optimistic = of_runs(300, epsilon=0.0, alpha=0.1, initial_q=5.0)
    realistic = of_runs(300, epsilon=0.1, alpha=0.1)
    assert optimal(optimistic, 20, 100) < optimal(realistic, 20, 100) - 0.1
    assert optimal(optimistic, 800, PULLS) > optimal(realistic, 800, PULLS) + 0.04
    assert margin(column(optimistic, "return_last_100"), column(realistic, "return_last_100")) > 3


@pytest.mark.exhaustive("trains 2,000 bandits of its own")
def test_figure_2_4_ucb_does_better_than_epsilon_greedy() -> None:
    ucb, greedy = of_runs(400, **UCB), of_runs(400, **TENTH)
    assert margin(column(ucb, "return_last_100"), column(greedy, "return_last_100")) > 3
    assert margin(column(ucb, "winnings"), column(greedy, "winnings")) > 3
    paid = [np.array(each["curve"]["return_mean"]) for each in (ucb, greedy)]
    assert (paid[0][40:] > paid[1][40:]).all()


@pytest.mark.exhaustive("trains 2,000 bandits of its own")
def test_figure_2_4_ucb_spikes_at_the_eleventh_pull() -> None:
    # With all arms tried once and all bounds equal, the eleventh pull is greedy. Then that arm's bound is
    # lower
    paid = of_runs(400, pulls=60, **UCB)["curve"]["return_mean"]
    assert np.mean(paid[:10]) == pytest.approx(0.0, abs=0.07)
    assert max(paid[:30]) == paid[10]
    assert paid[10] > np.mean(paid[11:16]) + 0.15


@pytest.mark.exhaustive("trains 2,000 bandits of its own")
def test_figure_2_5_the_baseline_makes_the_gradient_bandit(tmp_path: Path) -> None:
    file = tmp_path / "shifted.toml"
    file.write_text(
        "[defaults]\ngamma = 0.0\n"
        "[bandit]\narms = 10\nmean = { normal = [4.0, 1.0] }\nstd = 1.0\nbudget = 1000\n"
    )
    rates, won = {}, {}
    for baseline in ("mean", "none"):
        for alpha in (0.1, 0.4):
            document = of_runs(200, str(file), policy="gradient", alpha=alpha, baseline=baseline)
            rates[baseline, alpha] = optimal(document, 900, PULLS)
            won[baseline, alpha] = column(document, "winnings")
    for alpha in (0.1, 0.4):
        assert margin(won["mean", alpha], won["none", alpha]) > 3
        assert rates["mean", alpha] > rates["none", alpha] + 0.15
    assert rates["mean", 0.1] > max(rate for values, rate in rates.items() if values != ("mean", 0.1))


@pytest.mark.exhaustive("trains 2,000 bandits of its own")
def test_thompson_sampling_regrets_less_than_epsilon_greedy() -> None:
    gaussian = [column(of_runs(400, **values), "regret") for values in (TENTH, THOMPSON)]
    assert margin(gaussian[0], gaussian[1]) > 3
    assert gaussian[1].mean() < gaussian[0].mean() / 2
    coins = [column(of_runs(200, "bandit-bernoulli", **values), "regret") for values in (TENTH, THOMPSON)]
    assert margin(coins[0], coins[1]) > 3


def test_exercise_2_5_a_constant_step_size_follows_means_that_drift() -> None:
    constant = of_runs(40, "bandit-drifting", 10_000)
    average = of_runs(40, "bandit-drifting", 10_000, alpha="sample-average")
    assert margin(column(constant, "winnings"), column(average, "winnings")) > 3
    assert margin(column(average, "regret"), column(constant, "regret")) > 3
    assert optimal(constant, 9_000, 10_000) > optimal(average, 9_000, 10_000) + 0.15
