"""How policies become arrays of probabilities."""

from __future__ import annotations

import numpy as np
import pytest
from exact_reference import student

from rl_tui.agents.exact.policy_figures import (
    Choice,
    greedy_policy,
    policy_of_choices,
    softened,
    uniform_policy,
)

STUDENT = student()
"""Class: study, check phone. Phone: scroll, quit. Pass: sleep. Sleep is the end."""


def test_learned_ties_are_exact_equality() -> None:
    q = np.array([1.0, 1.0, 0.0, 1e-15, 5.0])
    assert greedy_policy(STUDENT, q, "random").tolist() == [0.5, 0.5, 0.0, 1.0, 1.0]
    assert greedy_policy(STUDENT, q, "first").tolist() == [1.0, 0.0, 0.0, 1.0, 1.0]


def test_a_uniform_policy_shares_evenly_among_legal_actions() -> None:
    assert uniform_policy(STUDENT).tolist() == [0.5, 0.5, 0.5, 0.5, 1.0]


def test_a_random_action_may_be_the_one_that_the_policy_takes() -> None:
    policy = np.array([1.0, 0.0, 0.25, 0.75, 1.0])
    assert softened(STUDENT, policy, 0.2).tolist() == pytest.approx([0.9, 0.1, 0.3, 0.7, 1.0])
    assert softened(STUDENT, policy, 0.0).tolist() == policy.tolist()
    assert softened(STUDENT, policy, 1.0).tolist() == uniform_policy(STUDENT).tolist()


def test_choices_are_a_pair_or_chances_and_what_is_not_chosen_is_uniform() -> None:
    assert policy_of_choices(STUDENT, {0: 1, 1: {2: 0.25, 3: 0.75}}).tolist() == [0.0, 1.0, 0.25, 0.75, 1.0]
    assert policy_of_choices(STUDENT, {1: 3}).tolist() == [0.5, 0.5, 0.0, 1.0, 1.0]
    assert policy_of_choices(STUDENT, {}).tolist() == uniform_policy(STUDENT).tolist()


def test_chances_that_almost_sum_to_one_are_scaled() -> None:
    policy = policy_of_choices(STUDENT, {0: {0: 0.3, 1: 0.7 + 5e-10}})
    assert policy[:2].sum() == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize(
    "choice", [2, {0: 0.5, 3: 0.5}, {0: 0.5, 1: 0.4}, {0: 1.5, 1: -0.5}, {0: float("nan"), 1: 1.0}, {}]
)
def test_what_is_no_choice_of_its_state_is_refused(choice: Choice) -> None:
    with pytest.raises(ValueError, match="state 0"):
        policy_of_choices(STUDENT, {0: choice})
