"""Unknown names are refused with a list."""

from __future__ import annotations

import pytest
from test_every_algorithm import eight_states, learner

from rl_tui.agents.compatibility import incompatibility
from rl_tui.agents.hyperparameters import Hyperparameters


def test_an_unknown_parameter_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(ValueError, match="there is no parameter alhpa; expected one of alpha, "):
        Hyperparameters().changed("alhpa", 0.5)


def test_an_unknown_algorithm_is_refused_with_those_that_there_are() -> None:
    ours = learner(eight_states(0), "q-learning", Hyperparameters())
    with pytest.raises(ValueError, match="there is no algorithm q-lerning; expected one of q-learning, "):
        ours.switch("q-lerning")


def test_why_something_cannot_work_is_a_sentence_or_nothing() -> None:
    bandit_rule = Hyperparameters(policy="thompson")
    assert incompatibility(eight_states(0), "q-learning", Hyperparameters()) == ""
    assert "is for bandits" in incompatibility(eight_states(0), "q-learning", bandit_rule)


def test_a_checkpoint_of_monte_carlo_has_no_room_that_is_empty() -> None:
    state = learner(eight_states(0), "monte-carlo", Hyperparameters()).checkpoint()
    assert sum(array.nbytes for array in state.memory) < 10_000
