"""The rewards of the current episode and their discounted sum."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_worlds import worlds
from test_environment_loop import HYPERPARAMETERS, Table, lake, untabled
from test_every_algorithm import learner

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp


def endless(time_limit: int = 0) -> TabularMDP:
    return tabular_mdp(
        ["here"], ["stay"], [Transition(0, 0, [Outcome(1.0, 0, 1.0, False, 1.0)])], {0: 1.0}, time_limit
    )


def followed(ours: Learner) -> Iterator[tuple[list[float], float, int]]:
    rewards: list[float] = []
    total, discount = 0.0, 1.0
    while True:
        if ours.episode_step == 0:
            rewards, total, discount = [], 0.0, 1.0
        gamma = ours.hyperparameters.gamma
        ours.advance(1)
        ours.drain_episodes()
        rewards.append(ours.last_step.reward)
        total += discount * rewards[-1]
        discount *= gamma
        yield rewards[-256:], total, len(rewards)


def shown(ours: Learner) -> tuple[list[float], float, int]:
    return ours.counters.rewards.tolist(), ours.counters.discounted_return, ours.last_step.episode_step


def test_before_the_first_step_there_are_none() -> None:
    ours = learner(endless(), "q-learning", Hyperparameters())
    assert (ours.counters.rewards.tolist(), ours.counters.discounted_return) == ([], 0.0)


@given(worlds(), st.sampled_from([0.0, 0.9, 1.0]), st.lists(st.integers(1, 40), min_size=1, max_size=8))
@settings(max_examples=60, deadline=None)
def test_they_are_those_of_a_plain_list_however_the_work_is_cut(
    mdp: TabularMDP, gamma: float, chunks: list[int]
) -> None:
    hyperparameters = Hyperparameters(gamma=gamma, epsilon=0.5)
    single, cut = (learner(mdp, "q-learning", hyperparameters) for _ in range(2))
    steps = followed(single)
    for chunk in chunks:
        expected = [next(steps) for _ in range(chunk)][-1]
        cut.advance(chunk)
        cut.drain_episodes()
        assert shown(cut) == shown(single) == expected


@pytest.mark.parametrize("time_limit", [0, 600, 512, 256])
def test_of_a_long_episode_the_last_256_are_kept_and_all_are_summed(time_limit: int) -> None:
    mdp = endless(time_limit)
    single, cut = (learner(mdp, "q-learning", Hyperparameters(gamma=0.999)) for _ in range(2))
    steps = followed(single)
    for chunk in (200, 55, 1, 1, 255, 256, 257, 700, 1):
        expected = [next(steps) for _ in range(chunk)][-1]
        cut.advance(chunk)
        cut.drain_episodes()
        assert shown(cut) == shown(single) == expected
    whole = learner(mdp, "q-learning", Hyperparameters(gamma=0.999))
    whole.advance(cut.step)
    assert shown(whole) == shown(cut)


def test_a_stepped_environment_gives_them_alike() -> None:
    mdp = lake()
    ours = Learner(untabled(mdp), "q-learning", HYPERPARAMETERS, streams(7), Table(mdp, 7))
    steps = followed(learner(mdp, "q-learning", HYPERPARAMETERS, 7))
    for _ in range(200):
        ours.advance(1)
        assert shown(ours) == next(steps)


def test_every_reward_counts_with_the_discount_of_its_time() -> None:
    ours = learner(endless(), "q-learning", Hyperparameters(gamma=0.5))
    ours.advance(2)
    ours.configure(Hyperparameters(gamma=0.1))
    ours.advance(2)
    first, second, third, fourth = ours.counters.rewards.tolist()
    assert ours.counters.discounted_return == first + 0.5 * second + 0.25 * third + 0.25 * 0.1 * fourth


def test_they_come_back_from_a_checkpoint() -> None:
    ours = learner(endless(50), "q-learning", Hyperparameters())
    ours.advance(120)
    ours.drain_episodes()
    kept, expected = ours.checkpoint(), shown(ours)
    ours.advance(33)
    after = shown(ours)
    ours.restore(kept)
    assert shown(ours) == expected
    ours.advance(33)
    assert shown(ours) == after


def test_a_planner_earns_none_and_leaves_none_behind() -> None:
    ours = learner(endless(50), "q-learning", Hyperparameters(accuracy=0.0, gamma=0.9))
    ours.advance(7)
    ours.switch("value-iteration")
    assert (ours.counters.rewards.tolist(), ours.counters.discounted_return) == ([], 0.0)
    ours.advance(3)
    assert (ours.counters.rewards.tolist(), ours.counters.discounted_return) == ([], 0.0)
    ours.switch("q-learning")
    assert (ours.counters.rewards.tolist(), ours.counters.discounted_return) == ([], 0.0)
    ours.advance(1)
    assert ours.counters.rewards.tolist() == [ours.counters.discounted_return]
    assert np.isfinite(ours.counters.discounted_return)


def test_a_step_knows_its_number_in_its_episode_and_a_backup_in_its_sweep() -> None:
    ours = learner(lake(), "value-iteration", Hyperparameters())
    numbers = []
    for _ in range(2 * int(np.count_nonzero(np.diff(ours.space.first_pair)))):
        ours.advance(1)
        numbers.append(ours.last_step.episode_step)
    assert numbers == [*range(1, len(numbers) // 2 + 1)] * 2
