"""The wait until the first update, also computed a second way."""

from __future__ import annotations

import gc
import math
import weakref
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from exact_reference import lake, world
from hypothesis import given, settings
from hypothesis import strategies as st
from random_worlds import worlds
from test_planners import shipped

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.exact.first_update import Cause, FirstUpdate, Wait, first_update, first_wait
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer
from rl_tui.agents.hyperparameters import Hyperparameters, Ties
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

ONE_STEP = [algorithm.id for algorithm in BY_ID.values() if algorithm.updates_own_pair]
FIRST = Hyperparameters(ties="first")


def wait(mdp: TabularMDP, **values: Any) -> Wait:
    return first_wait(mdp, "q-learning", Hyperparameters(**values))


def answer(mdp: TabularMDP, **values: Any) -> FirstUpdate:
    return first_update(mdp, "q-learning", Hyperparameters(**values))


def corridor(length: int, time_limit: int, back_first: bool = True) -> TabularMDP:
    """A row of states with a reward beyond its end. A step back from the start hits a wall."""
    names = ["back", "on"] if back_first else ["on", "back"]
    back, on = names.index("back"), names.index("on")
    transitions = []
    for state in range(length):
        last = state == length - 1
        transitions += [
            Transition(state, back, [Outcome(1.0, max(0, state - 1), 0.0, False)]),
            Transition(state, on, [Outcome(1.0, state + 1, float(last), last)]),
        ]
    return tabular_mdp([f"{s}" for s in range(length + 1)], names, transitions, {0: 1.0}, time_limit)


def by_the_chain(mdp: TabularMDP, params: Hyperparameters, steps: int) -> tuple[float, float]:
    told = np.zeros(mdp.states)
    silent = np.zeros((mdp.states, mdp.states))
    for state in range(mdp.states):
        pairs = mdp.pairs_of(state)
        for place, pair in enumerate(pairs):
            chance = 1.0 / len(pairs)
            if params.ties == "first":
                chance = params.epsilon / len(pairs) + (1.0 - params.epsilon if place == 0 else 0.0)
            for outcome in mdp.outcomes_of(pair):
                p = chance * float(mdp.probability[outcome])
                bootstrap = 0.0 if mdp.terminated[outcome] else params.initial_q
                target = float(mdp.reward[outcome]) + params.gamma * bootstrap
                if target != params.initial_q or mdp.reward_std[outcome] > 0.0:
                    told[state] += p
                elif not mdp.terminated[outcome]:
                    silent[state, mdp.next_state[outcome]] += p
    here = np.zeros(mdp.states)
    here[mdp.start_state] = mdp.start_probability
    total = 0.0
    for _ in range(steps):
        total += float(here @ told)
        here = here @ silent
    return total, float(here.sum())


LAKES = [
    ("frozenlake", "random", 0.013939795959171436, 71.737, 50),
    ("frozenlake", "first", 5.41665e-6, 184_616, 127_966),
    ("frozenlake-slippery", "first", 9.3105448e-05, 10_741, 7_445),
    ("frozenlake-8x8", "random", 0.0019013955, 526, 365),
]


@pytest.mark.parametrize(("scenario", "ties", "chance", "mean", "median"), LAKES)
def test_known_waits(scenario: str, ties: Ties, chance: float, mean: float, median: int) -> None:
    mdp = shipped(scenario)
    found = wait(mdp, ties=ties)
    assert found.chance == pytest.approx(chance, rel=1e-5)
    assert found.mean_episodes == pytest.approx(mean, rel=1e-3)
    assert found.median_episodes == median
    told, _ = by_the_chain(mdp, Hyperparameters(ties=ties), mdp.time_limit)
    assert found.chance == pytest.approx(told, rel=1e-12)


def test_where_every_step_pays_the_first_one_tells() -> None:
    assert wait(shipped("cliff")) == Wait(1.0, 1.0, 1)
    assert wait(shipped("bandit")) == Wait(1.0, 1.0, 1)


def test_an_optimistic_start_tells_at_once_where_rewards_are_discounted() -> None:
    assert wait(shipped("frozenlake"), initial_q=1.0, ties="first") == Wait(1.0, 1.0, 1)


def test_an_optimistic_start_tells_at_ends_only_where_they_are_not() -> None:
    mdp = lake("4x4", slippery=False, time_limit=100)
    params = Hyperparameters(initial_q=1.0, gamma=1.0)
    found = first_wait(mdp, "q-learning", params)
    assert found.chance == pytest.approx(by_the_chain(mdp, params, 100)[0], rel=1e-12)
    # the goal pays 1, as expected: holes cause an update, and the goal does not
    alone = world(("a", "on", [(1.0, "goal", 1.0)]), time_limit=5)
    assert wait(alone, initial_q=1.0, gamma=1.0) == Wait(0.0, None, None)
    assert wait(alone, initial_q=2.0, gamma=1.0) == Wait(1.0, 1.0, 1)


def test_the_last_step_of_the_time_limit_bootstraps_as_any_other() -> None:
    stay = world(("a", "stay", [(1.0, "a", 0.0)]), time_limit=3)
    assert wait(stay, initial_q=1.0, gamma=1.0) == Wait(0.0, None, None)


@pytest.mark.parametrize("chance", [1e-12, 1e-6, 0.013939795959, 0.2, 0.4, 0.5, 0.6, 0.9999])
def test_the_median_is_the_least_number_of_episodes_that_is_enough(chance: float) -> None:
    mdp = world(("a", "try", [(chance, "won", 1.0), (1.0 - chance, "lost", 0.0)]), time_limit=1)
    found = wait(mdp)
    assert found.chance == pytest.approx(chance, rel=1e-12)
    median = found.median_episodes
    assert median is not None

    def within(episodes: int) -> float:
        return -math.expm1(episodes * math.log1p(-found.chance))

    assert within(median) >= 0.5 - 1e-15
    assert within(median - 1) < 0.5


@settings(max_examples=50, deadline=None)
@given(
    worlds(),
    st.sampled_from([0.0, 0.0, 1.0, -0.5, 2.0]),
    st.sampled_from([1.0, 0.9, 0.5]),
    st.sampled_from([0.0, 0.1, 1.0]),
    st.sampled_from(["first", "random"]),
)
def test_random_worlds_against_the_chain_of_the_episode(
    mdp: TabularMDP, q: float, gamma: float, epsilon: float, ties: Ties
) -> None:
    params = Hyperparameters(initial_q=q, gamma=gamma, epsilon=epsilon, ties=ties)
    told, goes_on = by_the_chain(mdp, params, mdp.time_limit or 20_000)
    found = first_wait(mdp, "q-learning", params)
    assert found.chance == pytest.approx(told, rel=1e-9, abs=1e-300)
    if not mdp.time_limit and goes_on > 1e-6:
        assert found.mean_episodes is None
    elif found.chance:
        assert found.mean_episodes == pytest.approx(1.0 / told)


def moved_in(mdp: TabularMDP, algorithm: str, params: Hyperparameters, seed: int) -> bool:
    learner = Learner(mdp, algorithm, params, streams(seed))
    learner.advance(300, episodes=1)
    return bool(np.abs(learner.q - params.initial_q).max() > 1e-9)


@pytest.mark.parametrize("algorithm", ONE_STEP)
def test_random_worlds_against_the_learner(algorithm: str) -> None:
    @settings(max_examples=5, deadline=None)
    @given(
        worlds(),
        st.sampled_from([0.0, 1.0, -0.5]),
        st.sampled_from([1.0, 0.9]),
        st.sampled_from(["first", "random"]),
        st.sampled_from([0.1, "sample-average"]),
    )
    def holds(mdp: TabularMDP, q: float, gamma: float, ties: Ties, alpha: Any) -> None:
        params = Hyperparameters(initial_q=q, gamma=gamma, ties=ties, epsilon=0.3, alpha=alpha)
        found, seeds = first_wait(mdp, algorithm, params), 60
        moved = sum(moved_in(mdp, algorithm, params, seed) for seed in range(seeds))
        deviation = math.sqrt(seeds * found.chance * (1.0 - found.chance))
        assert abs(moved - seeds * found.chance) <= 4.5 * deviation + 1e-9

    holds()


@pytest.mark.exhaustive("trains 2,000 seeds")
def test_learners_of_2000_seeds_wait_as_long_as_is_said() -> None:
    mdp, params = shipped("frozenlake"), Hyperparameters()
    found = first_wait(mdp, "q-learning", params)
    waits = []
    for seed in range(2_000):
        learner = Learner(mdp, "q-learning", params, streams(seed))
        while not learner.q.any():
            learner.advance(2_000)
            learner.drain_episodes()
        waits.append(learner.first_reward_episode)
    assert found.mean_episodes is not None
    assert found.median_episodes is not None
    error = float(np.std(waits)) / math.sqrt(len(waits))
    assert float(np.mean(waits)) == pytest.approx(found.mean_episodes, abs=4.0 * error)
    share = float(np.mean(np.array(waits) <= found.median_episodes))
    assert share == pytest.approx(0.5, abs=4.0 * 0.5 / math.sqrt(len(waits)))


def test_an_episode_that_may_never_end_leaves_no_mean() -> None:
    # an update has chance 1/4, then 1/4 of another 1/4, and so on: a third in total. Half stay in a corner
    # for ever
    mdp = world(
        ("a", "go", [(0.25, "won", 1.0), (0.25, "lost", 0.0), (0.5, "corner", 0.0)]),
        ("corner", "go", [(1.0, "corner", 0.0)]),
    )
    assert wait(mdp) == Wait(0.25, None, None)
    # an update has chance 0.4, and within two episodes 0.4 + 0.3 · 0.4 = 0.52
    other = replace(
        mdp, probability=np.array([0.4, 0.3, 0.3, 1.0]), cumulative=np.array([0.4, 0.7, 1.0, 1.0])
    )
    found = wait(other)
    assert (found.chance, found.mean_episodes) == (pytest.approx(0.4), None)
    assert found.median_episodes == 2


def test_without_a_time_limit_a_walk_that_surely_arrives_has_chance_1() -> None:
    assert wait(corridor(6, time_limit=0)) == Wait(1.0, 1.0, 1)


def test_a_chance_below_all_numbers_is_refused() -> None:
    with pytest.raises(NoExactAnswer, match="too small for a number"):
        first_wait(corridor(400, 400), "q-learning", replace(FIRST, epsilon=1e-3))


def test_ties_are_the_cause_where_random_ones_alone_make_it_short() -> None:
    found = answer(shipped("frozenlake"), ties="first")
    assert (found.cause, found.distance) == (Cause.TIES, 6)
    best, *others = found.remedies
    assert (best.setting, best.value, best.wait) == ("initial_q", 1.0, Wait(1.0, 1.0, 1))
    assert {(each.setting, each.value): each.wait.median_episodes for each in others} == {
        ("ties", "random"): 50,
        ("epsilon", 1.0): 50,
    }


def test_no_setting_is_blamed_where_the_way_is_long() -> None:
    found = answer(shipped("frozenlake-8x8"))
    assert (found.cause, found.distance) == (None, 14)
    assert [remedy.setting for remedy in found.remedies] == ["initial_q"]


def test_epsilon_is_the_cause_where_less_of_it_alone_makes_it_short() -> None:
    found = answer(corridor(20, time_limit=20, back_first=False), ties="first", epsilon=1.0)
    assert found.cause is Cause.EPSILON
    assert ("epsilon", 0.1) in {(remedy.setting, remedy.value) for remedy in found.remedies}


def test_a_reward_further_than_an_episode_is_long() -> None:
    found = answer(corridor(20, time_limit=19), initial_q=0.0)
    assert (found.wait, found.cause, found.distance) == (Wait(0.0, None, None), Cause.TIME_LIMIT, 20)
    assert answer(corridor(20, time_limit=20)).cause is not Cause.TIME_LIMIT


def test_a_world_that_pays_nothing() -> None:
    found = answer(world(("a", "on", [(1.0, "end", 0.0)]), time_limit=5))
    assert (found.wait.chance, found.cause, found.distance) == (0.0, Cause.NO_REWARD, None)


def test_a_step_size_that_moves_nothing() -> None:
    found = answer(shipped("frozenlake"), initial_q=1.0, alpha=1e-18)
    assert (found.wait.chance, found.cause) == (0.0, Cause.ALPHA)
    assert [(remedy.setting, remedy.value) for remedy in found.remedies] == [("alpha", 0.1)]


def test_a_step_size_that_has_fallen_to_0() -> None:
    params = Hyperparameters(alpha=0.5, step_size_schedule="linear", alpha_decay=0.1)
    mdp = shipped("cliff")
    with pytest.raises(NoExactAnswer, match="α falls towards 0"):
        first_update(mdp, "q-learning", params)
    falling = Hyperparameters(alpha=0.5, alpha_decay=0.05)
    with pytest.raises(NoExactAnswer, match="α falls towards 0"):
        first_update(mdp, "q-learning", falling)
    found = first_update(mdp, "q-learning", params, episode=5)
    assert (found.wait.chance, found.cause) == (0.0, Cause.ALPHA)
    assert [(remedy.setting, remedy.value) for remedy in found.remedies] == [
        ("step_size_schedule", "constant")
    ]


@pytest.mark.parametrize(
    ("scenario", "algorithm", "values", "reason"),
    [
        ("bandit-drifting", "q-learning", {}, "drift"),
        ("frozenlake", "value-iteration", {}, "plans with the model"),
        ("frozenlake", "dyna-q", {}, "one pair per step"),
        ("frozenlake", "monte-carlo", {}, "one pair per step"),
        ("frozenlake", "sarsa-lambda", {}, "one pair per step"),
        ("frozenlake", "q-learning", {"policy": "softmax"}, "softmax"),
        ("frozenlake", "q-learning", {"epsilon_decay": 0.01}, "ε changes"),
    ],
)
def test_what_is_not_known_is_refused_with_the_reason(
    scenario: str, algorithm: str, values: dict[str, Any], reason: str
) -> None:
    with pytest.raises(NoExactAnswer, match=reason):
        first_update(shipped(scenario), algorithm, Hyperparameters(**values))


def test_no_world_but_the_last_one_is_kept_alive() -> None:
    old, other = corridor(3, 10), corridor(4, 10)
    wait(old)
    kept = weakref.ref(old.reward)  # a world itself takes no weak references
    wait(other)
    del old
    gc.collect()
    assert kept() is None
