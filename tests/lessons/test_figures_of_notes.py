"""Claims about learning in the notes of scenarios, computed again with fewer runs.

``70.9 ± 0.7`` is a mean and its standard error. The mean of fewer runs must agree within four standard errors
of both.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from recipes import recipe

from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE
from rl_tui.runs.figures import greedy_figures, summary
from rl_tui.runs.recipe import SetParameter
from rl_tui.runs.run import Run
from rl_tui.runs.training.many_runs import many_runs
from rl_tui.runs.training.seeded_runs import Goal, train
from rl_tui.worlds.files.catalogue import find

pytestmark = pytest.mark.slow

AGENTS: Final = (Path(__file__).parents[2] / "docs/reference/agents.md").read_text(encoding="utf-8")
_FIGURE: Final = re.compile(r"([−\d.,]+)( %)? ± ([\d.]+)")
PERCENT: Final = 100.0


@dataclass(frozen=True)
class Claim:
    scenario: str
    text: str
    figure: str
    episodes: int
    runs: int = 40
    values: dict[str, Any] = field(default_factory=dict)
    scale: float = 1.0


def notes_of(scenario: str) -> str:
    return " ".join(find(scenario).notes.split())


def is_said(scenario: str, text: str) -> None:
    assert text in notes_of(scenario)


def agrees(text: str, counted: Sequence[float | None], scale: float = 1.0) -> None:
    found = _FIGURE.search(text)
    assert found, text
    stated, error = (float(found[group].replace("−", "-").replace(",", "")) for group in (1, 3))
    ours = summary([None if each is None else scale * each for each in counted])
    assert ours["mean"] is not None
    assert abs(ours["mean"] - stated) <= 4 * math.hypot(error, ours["stderr"] or 0.0), (text, ours)


@functools.cache
def document(scenario: str, runs: int, episodes: int, values: tuple[tuple[str, Any], ...]) -> dict[str, Any]:
    return many_runs(recipe(scenario, **dict(values)), runs, Goal(episodes=episodes))


def trained(scenario: str, runs: int, episodes: int, **values: Any) -> dict[str, Any]:
    return document(scenario, runs, episodes, tuple(sorted(values.items())))


AVERAGE: Final = {"alpha": SAMPLE_AVERAGE}
FALLING: Final = {"alpha": 0.5, "alpha_decay": 0.0005, "alpha_min": 0.02}
SARSA: Final = {"algorithm": "sarsa"}
LEARNER: Final = {"algorithm": "q-learning"}
DYNA: Final = {"algorithm": "dyna-q", "planning_steps": 10}
CARLO: Final = {"algorithm": "monte-carlo"}
BECAME, AT_START, LAST = "expected_return", "value_at_start", "return_last_100"
SLIPPERY, LARGE = "frozenlake-slippery", "frozenlake-8x8-slippery"

CLAIMS: Final = (
    Claim(SLIPPERY, "arrives in 70.9 ± 0.7 episodes of 100", BECAME, 10_000, scale=PERCENT),
    Claim(SLIPPERY, "reaches 73.9 ± 0.03", BECAME, 10_000, values=FALLING, scale=PERCENT),
    Claim(SLIPPERY, "arrives in 57.5 ± 1.9 episodes", BECAME, 10_000, values={"alpha": 0.02}, scale=PERCENT),
    Claim(
        SLIPPERY,
        "It arrives in 24.7 ± 1.8 if α begins at 0.1",
        BECAME,
        10_000,
        values={"alpha_decay": 0.001},
        scale=PERCENT,
    ),
    Claim(
        SLIPPERY, "in 40.1 ± 2.0 with `sample-average`, 1/N", BECAME, 10_000, values=AVERAGE, scale=PERCENT
    ),
    Claim(LARGE, "comes in episode 520 ± 62", "first_reward_episode", 10_000, runs=20),
    Claim(LARGE, "in 80.4 ± 1.1 episodes of 100", BECAME, 10_000, runs=20, scale=PERCENT),
    Claim(
        LARGE,
        "This gains nothing here: 80 ± 3 of 100",
        BECAME,
        10_000,
        runs=15,
        values={"epsilon": 1.0, "epsilon_decay": 0.001},
        scale=PERCENT,
    ),
    Claim("cliff", "Q-learning gets −50.7 ± 0.5", LAST, 500),
    Claim("cliff", "SARSA gets −27.5 ± 0.5", LAST, 500, values=SARSA),
    Claim("cliff", "calm: −20.7 ± 0.1", LAST, 500, values={"algorithm": "expected-sarsa", "alpha": 1.0}),
    Claim("cliff", "cost 17.1 ± 0.1 each", LAST, 500, values={**SARSA, "epsilon_decay": 0.01}, scale=-1.0),
    Claim("book", "is worth 0.69 ± 0.01", AT_START, 5_000, runs=30, values=LEARNER),
    Claim("bridge", "it gets −1.3 ± 0.1 an episode", LAST, 5_000),
    Claim("discount", "is worth 0.16 ± 0.04", AT_START, 5_000, runs=30, values=LEARNER),
    Claim("discount", "it is 0.37 ± 0.05", AT_START, 5_000, runs=30, values={**LEARNER, "epsilon": 0.5}),
    Claim("discount", "it is 1.678 ± 0.003", AT_START, 5_000, runs=30, values={**LEARNER, "initial_q": 10.0}),
    Claim("karpathy", "worth 0.181 ± 0.007", AT_START, 100),
    Claim("karpathy", "it is 0.210 ± 0.003", AT_START, 1_000, runs=20),
    Claim("maze-188", "worth 0.185 ± 0.002", AT_START, 2_000),
    Claim("windy", "takes 20.3 ± 0.1 steps", "length_last_100", 500),
    Claim("windy", "takes 16.1 ± 0.1 on average if it arrives", BECAME, 500, scale=-1.0),
    Claim("windy", "17.31 ± 0.02 and", "length_last_100", 500, values={"algorithm": "expected-sarsa"}),
    Claim("windy", "17.20 ± 0.02 steps", "length_last_100", 500, values=LEARNER),
    Claim("windy-king", "takes 11.2 ± 0.1 steps", "length_last_100", 500),
    Claim("windy-king", "7.5 ± 0.1 steps in the runs", BECAME, 500, scale=-1.0),
    Claim("taxi", "then returns −53 ± 2", BECAME, 500, runs=10),
    Claim("taxi", "−1.8 ± 0.7", BECAME, 1_000, runs=10),
    Claim("taxi", "returns 7.5 ± 0.2", BECAME, 500, runs=10, values=DYNA),
    Claim("random-walk", "0.085 ± 0.002", "max_error", 100, runs=60),
    Claim("random-walk", "same α: 0.251 ± 0.005", "max_error", 100, runs=60, values=CARLO),
    Claim("random-walk", "better: 0.125 ± 0.003", "max_error", 100, runs=60, values={**CARLO, "alpha": 0.02}),
    Claim(
        "bandit",
        "its regret is 242 ± 1",
        "regret",
        1_000,
        runs=100,
        values={"epsilon": 0.0, "alpha": 0.1, "initial_q": 5.0},
    ),
    Claim("bandit", "with ε = 0.1 it is 236 ± 4", "regret", 1_000, runs=100),
    Claim("bandit", "With c = 2 the regret is 150 ± 1", "regret", 1_000, runs=100, values={"policy": "ucb"}),
    Claim(
        "bandit", "c = 1 only 60 ± 1", "regret", 1_000, runs=100, values={"policy": "ucb", "confidence": 1.0}
    ),
    Claim("bandit", "greed the mean regret is 502 ± 18", "regret", 1_000, runs=100, values={"epsilon": 0.0}),
    Claim("bandit", "sampling 70 ± 1", "regret", 1_000, runs=100, values={"policy": "thompson"}),
    Claim("bandit-bernoulli", "256 ± 8 for greed", "regret", 1_000, runs=100, values={"epsilon": 0.0}),
    Claim("bandit-bernoulli", "180 ± 1 for UCB", "regret", 1_000, runs=100, values={"policy": "ucb"}),
    Claim("bandit-bernoulli", "68 ± 1 for ε = 0.1", "regret", 1_000, runs=100),
    Claim("bandit-bernoulli", "28.0 ± 0.5", "regret", 1_000, runs=100, values={"policy": "thompson"}),
    Claim(
        "bandit-bernoulli",
        "20.6 ± 0.6 for UCB with c = 0.3",
        "regret",
        1_000,
        runs=100,
        values={"policy": "ucb", "confidence": 0.3},
    ),
    Claim("bandit-drifting", "its regret is 167 ± 3", "regret", 1_000, runs=100, values=AVERAGE),
    Claim("bandit-drifting", "with α = 0.1 it is 141 ± 1", "regret", 1_000, runs=100),
    Claim("bandit-drifting", "it is 3,144 ± 44", "regret", 10_000, values=AVERAGE),
    Claim("bandit-drifting", "and 1,532 ± 6", "regret", 10_000),
    Claim("bandit-drifting", "(1,833 ± 5)", "regret", 10_000, values={"alpha": 0.2}),
    Claim("bandit-drifting", "(1,531 ± 9)", "regret", 10_000, values={"alpha": 0.05}),
    Claim("bandit-drifting", "(2,352 ± 65)", "regret", 10_000, values={"epsilon": 0.0}),
    Claim("bandit-drifting", "(2,842 ± 68)", "regret", 10_000, values={"policy": "thompson"}),
    Claim(
        "bandit-drifting", "(1,053 ± 12)", "regret", 10_000, values={"policy": "softmax", "temperature": 0.2}
    ),
)


MANY_SEEDS: Final = pytest.mark.exhaustive("trains many seeds for one more figure of the same scenario")
FIRST_CLAIMS: Final = {claim.scenario: claim for claim in reversed(CLAIMS)}


@pytest.mark.parametrize(
    "claim",
    [pytest.param(each, marks=() if each is FIRST_CLAIMS[each.scenario] else MANY_SEEDS) for each in CLAIMS],
    ids=lambda claim: f"{claim.scenario}: {claim.text}",
)
def test_a_mean_is_what_it_is_said_to_be(claim: Claim) -> None:
    is_said(claim.scenario, claim.text)
    rows = trained(claim.scenario, claim.runs, claim.episodes, **claim.values)["runs"]
    agrees(claim.text, [row[claim.figure] for row in rows], claim.scale)


def test_the_page_on_settings_says_the_same_of_the_slippery_lake() -> None:
    for figure in ("40.1 ± 2.0", "70.9 ± 0.7", "73.9 ± 0.03"):
        is_said(SLIPPERY, figure)
        assert figure in AGENTS


@pytest.mark.parametrize(
    ("scenario", "runs", "alpha", "text"),
    [
        (SLIPPERY, 20, 0.01, "after 5,000 more, the greedy policy arrives in 73.5 ± 0.1 episodes of 100"),
        pytest.param(
            *(LARGE, 10, 0.02, "After 5,000 more, the greedy policy arrives in 84.8 ± 0.5 episodes of 100"),
            marks=MANY_SEEDS,
        ),
    ],
)
def test_a_small_step_size_after_a_large_one_calms_the_lake(
    scenario: str, runs: int, alpha: float, text: str
) -> None:
    is_said(scenario, text)
    found = []
    for seed in range(runs):
        run = Run(recipe(scenario, seed=seed), evaluate=False)
        train(run, Goal(episodes=5_000))
        run.apply(SetParameter("alpha", alpha))
        train(run, Goal(episodes=10_000))
        found.append(greedy_figures(run, None).expected_return)
    agrees(text, found, PERCENT)


def test_the_sample_average_keeps_what_the_first_targets_were() -> None:
    is_said(
        SLIPPERY,
        "After 10,000 episodes with 1/N, the estimate of the start is 0.04. The exact value is 0.54.",
    )
    found = []
    for seed in range(20):
        run = Run(recipe(SLIPPERY, seed=seed, **AVERAGE), evaluate=False)
        train(run, Goal(episodes=10_000))
        found.append(float(run.learner.q[run.world.space.pairs_of(0).start : 4].max()))
    assert np.mean(found) == pytest.approx(0.04, abs=0.02)


def best_arms(scenario: str, episodes: int, last: int, **values: Any) -> float:
    curve = trained(scenario, 100, episodes, **values)["curve"]
    is_late = np.array(curve["episode"]) > episodes - last
    return float(np.array(curve["optimal_action_rate"])[is_late].mean())


def test_optimism_is_better_in_the_end_only() -> None:
    is_said("bandit", "of the last 200 pulls 87 % go to the best arm, against 80 %")
    optimism = best_arms("bandit", 1_000, 200, epsilon=0.0, alpha=0.1, initial_q=5.0)
    assert optimism == pytest.approx(0.87, abs=0.06)
    assert best_arms("bandit", 1_000, 200) == pytest.approx(0.80, abs=0.1)


@MANY_SEEDS
def test_where_arms_drift_a_constant_step_size_finds_the_best_one_more_often() -> None:
    is_said("bandit-drifting", "Of the last 500 pulls 45 % ± 1 go to the best arm, against 77 % ± 1")
    assert best_arms("bandit-drifting", 10_000, 500, **AVERAGE) == pytest.approx(0.45, abs=0.16)
    assert best_arms("bandit-drifting", 10_000, 500) == pytest.approx(0.77, abs=0.1)


def test_greed_finds_the_best_coin_now_and_then() -> None:
    is_said("bandit-bernoulli", "It finds the best arm in 17 % of 1,000 runs")
    rows = trained("bandit-bernoulli", 100, 1_000, epsilon=0.0)["runs"]
    assert np.mean([row["best_arm_rate"] > 0.5 for row in rows]) == pytest.approx(0.17, abs=0.15)


def episode_lengths(scenario: str, runs: int, episodes: int, **values: Any) -> list[list[int]]:
    found: list[list[int]] = []
    for seed in range(runs):
        lengths: list[int] = []
        run = Run(
            recipe(scenario, seed=seed, **values),
            evaluate=False,
            on_episodes=lambda _, finished, __, lengths=lengths: lengths.extend(finished.tolist()),  # type: ignore[misc]
        )
        train(run, Goal(episodes=episodes))
        found.append(lengths[:episodes])
    return found


@pytest.mark.parametrize(
    ("planning_steps", "episode", "text"),
    [
        (50, 2, "takes 39.0 ± 0.6 steps"),
        pytest.param(50, 3, "third 17.6 ± 0.2", marks=MANY_SEEDS),
        pytest.param(0, 2, "the second takes 684 ± 35", marks=MANY_SEEDS),
        pytest.param(0, 10, "the tenth 134 ± 7", marks=MANY_SEEDS),
        pytest.param(0, 25, "the 25th 26.6 ± 1.3", marks=MANY_SEEDS),
    ],
)
def test_planning_shortens_the_first_episodes(planning_steps: int, episode: int, text: str) -> None:
    is_said("maze", text)
    lengths = episode_lengths("maze", 40, episode, planning_steps=planning_steps)
    agrees(text, [run[-1] for run in lengths])


@pytest.mark.parametrize(
    ("values", "first", "text"),
    [
        (LEARNER, 0, "In the first 100 episodes Q-learning goes left in 75.6 ± 0.6 %"),
        pytest.param({"algorithm": "double-q-learning"}, 0, "in 18.8 ± 0.5 %", marks=MANY_SEEDS),
        pytest.param(LEARNER, 280, "the shares are 12.2 ± 0.7 %", marks=MANY_SEEDS),
        pytest.param({"algorithm": "double-q-learning"}, 280, "and 7.0 ± 0.4 %", marks=MANY_SEEDS),
        pytest.param(AVERAGE, 280, "81.9 ± 1.0 % still go left", marks=MANY_SEEDS),
        pytest.param({"algorithm": "expected-sarsa"}, 0, "goes left in 59.9 ± 0.8 %", marks=MANY_SEEDS),
    ],
)
def test_how_often_the_largest_estimate_leads_left(values: dict[str, Any], first: int, text: str) -> None:
    is_said("max-bias", text)
    last = 300 if first else 100
    lengths = episode_lengths("max-bias", 100, last, **values)
    agrees(text, [np.mean(run[first:last]) - 1.0 for run in lengths], PERCENT)


@MANY_SEEDS
def test_the_egg_is_learned_with_a_clock_and_never_without() -> None:
    is_said("egg", "the start is worth 8.000 to the agent, in every one of 100 runs")
    text = "the Pot is worth −9.93 ± 0.03"
    is_said("egg", f"{text}, and in every one of 100 runs the agent eats the egg raw at once")
    pots = []
    for seed in range(60):
        run = Run(recipe("egg", seed=seed), evaluate=False)
        train(run, Goal(episodes=500))
        first, pot = run.learner.q[:2], run.learner.q[6:8]
        assert float(first.max()) == pytest.approx(8.0, abs=0.0005)
        assert pot.argmax() == 1
        pots.append(float(pot.max()))
    agrees(text, pots)
