from __future__ import annotations

import importlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.policies.chances import action_chances
from rl_tui.agents.policies.family import expectation
from rl_tui.worlds.mdp.space import FiniteSpace

NO_VISITS = np.zeros(4, np.int64)
Q = np.array([1.0, 3.0, 3.0, 0.0])


def chances(
    hyperparameters: Hyperparameters, epsilon: float = 0.0, visits: Any = NO_VISITS
) -> list[float] | None:
    found = action_chances(hyperparameters, epsilon, Q, visits)
    return None if found is None else found.tolist()


def test_epsilon_is_shared_by_all_and_the_rest_by_the_best() -> None:
    assert chances(Hyperparameters(), 0.2) == pytest.approx([0.05, 0.45, 0.45, 0.05])
    assert chances(Hyperparameters(ties="first"), 0.2) == pytest.approx([0.05, 0.85, 0.05, 0.05])


def test_softmax_weighs_by_powers() -> None:
    weights = np.exp([1.0, 3.0, 3.0, 0.0])
    assert chances(Hyperparameters(policy="softmax", temperature=1.0)) == pytest.approx(
        (weights / weights.sum()).tolist()
    )


def test_ucb_takes_what_was_never_tried_first() -> None:
    hyperparameters = Hyperparameters(policy="ucb")
    assert chances(hyperparameters, visits=np.array([5, 5, 0, 0])) == [0.0, 0.0, 0.5, 0.5]
    # t = 23: 1 + 2 √(ln 23 / 1) = 4.54 is more than 3 + 2 √(ln 23 / 10) = 4.12
    assert chances(hyperparameters, visits=np.array([1, 10, 10, 1])) == [1.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize("policy", ["gradient", "thompson"])
def test_rules_with_a_memory_of_their_own_are_not_known(policy: str) -> None:
    assert chances(Hyperparameters(policy=policy)) is None


@given(
    q=st.lists(st.floats(-5, 5), min_size=1, max_size=5),
    counts=st.lists(st.integers(0, 9), min_size=5, max_size=5),
    policy=st.sampled_from(["epsilon-greedy", "softmax", "ucb"]),
    ties=st.sampled_from(["random", "first"]),
)
def test_the_mean_they_make_is_the_one_that_the_rule_itself_expects(
    q: list[float], counts: list[int], policy: str, ties: Any
) -> None:
    hyperparameters = Hyperparameters(policy=policy, ties=ties, epsilon=0.3, temperature=0.7)
    estimates, visits = np.array(q), np.array(counts[: len(q)], dtype=np.int64)
    space = FiniteSpace(("s",), tuple(map(str, q)), np.array([0, len(q)]), np.arange(len(q)), 0)
    rule = importlib.import_module(POLICY_BY_ID[policy].module).new_rule(space, hyperparameters)
    weights = action_chances(hyperparameters, 0.3, estimates, visits)
    assert weights is not None
    assert weights.sum() == pytest.approx(1.0)
    assert weights @ estimates == pytest.approx(expectation(rule, estimates, visits, 0, len(q)))
