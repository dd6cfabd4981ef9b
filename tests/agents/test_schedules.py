"""Step size and exploration from episode to episode."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rl_tui.agents.hyperparameters import SCHEDULES, Hyperparameters
from rl_tui.agents.kernels.compiled import compiled
from rl_tui.agents.kernels.machine_code import machine_code
from rl_tui.agents.kernels.parameters import Schedule, scheduled, schedules_of
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

probabilities = st.floats(0.0, 1.0)
decays = st.one_of(st.just(0.0), st.floats(1e-9, 10.0))
episodes = st.one_of(st.integers(0, 50), st.integers(0, 10**12))


@compiled
def now(schedule: Schedule, episode: int) -> float:
    return scheduled(schedule, episode)


def arms() -> TabularMDP:
    return tabular_mdp(
        ["here"],
        ["0", "1"],
        [Transition(0, arm, [Outcome(1.0, 0, float(arm), True, 1.0)]) for arm in range(2)],
        {0: 1.0},
    )


@settings(deadline=None)
@given(st.sampled_from(SCHEDULES), st.floats(1e-9, 1.0), probabilities, decays, episodes)
def test_compiled_schedules_are_exactly_as_said(
    schedule: str, start: float, least: float, decay: float, episode: int
) -> None:
    exploring = Hyperparameters(
        epsilon=start, epsilon_schedule=schedule, epsilon_min=least, epsilon_decay=decay
    )
    learning = Hyperparameters(alpha=start, step_size_schedule=schedule, alpha_min=least, alpha_decay=decay)
    for form in (now, machine_code(now)):
        assert form(schedules_of(exploring).epsilon, episode) == exploring.epsilon_at(episode)
        assert form(schedules_of(learning).alpha, episode) == learning.alpha_at(episode)


def test_the_schedules_at_known_episodes() -> None:
    def epsilons(schedule: str, least: float = 0.1) -> list[float]:
        hyperparameters = Hyperparameters(
            epsilon=0.5, epsilon_schedule=schedule, epsilon_min=least, epsilon_decay=0.125
        )
        return [hyperparameters.epsilon_at(episode) for episode in (0, 1, 2, 100)]

    assert epsilons("constant") == [0.5] * 4
    assert epsilons("linear") == [0.5, 0.375, 0.25, 0.1]
    assert epsilons("linear", least=1.0) == [0.5, 0.625, 0.75, 1.0]
    assert epsilons("exponential") == pytest.approx(
        [0.1 + 0.4 * math.exp(-0.125 * episode) for episode in (0, 1, 2, 100)]
    )


def test_a_decay_without_a_word_about_its_form_is_exponential() -> None:
    hyperparameters = Hyperparameters(epsilon=1.0, epsilon_min=0.1, epsilon_decay=0.5)
    assert hyperparameters.epsilon_at(3) == pytest.approx(0.1 + 0.9 * math.exp(-1.5))
    assert Hyperparameters(alpha=0.4, alpha_decay=0.5).alpha_at(2) == pytest.approx(0.4 * math.exp(-1.0))
    assert Hyperparameters(epsilon=0.3).epsilon_at(10**9) == 0.3


@pytest.mark.parametrize("fields", [{"alpha": "sample-average"}, {"step_size_schedule": "sample-average"}])
def test_the_sample_average_can_be_asked_for_in_two_ways(fields: dict[str, str]) -> None:
    hyperparameters = Hyperparameters(**fields)  # type: ignore[arg-type]
    assert hyperparameters.sample_average
    assert hyperparameters.alpha_at(5) is None
    assert hyperparameters.without_average() == Hyperparameters()
    assert hyperparameters.as_dict() == {**Hyperparameters().as_dict(), **fields}
    ours = Learner(arms(), "q-learning", hyperparameters, streams(0))
    for _ in range(30):
        ours.advance(1)
        last = ours.last_step
        assert last.step_size == 1.0 / ours.visits[last.pair]


@pytest.mark.parametrize("schedule", SCHEDULES)
def test_a_learner_follows_both_schedules_episode_by_episode(schedule: str) -> None:
    hyperparameters = Hyperparameters(
        alpha=0.8,
        step_size_schedule=schedule,
        alpha_min=0.05,
        alpha_decay=0.1,
        epsilon=0.9,
        epsilon_schedule=schedule,
        epsilon_min=0.2,
        epsilon_decay=0.07,
    )
    ours = Learner(arms(), "q-learning", hyperparameters, streams(0))
    for episode in range(20):
        ours.advance(1)
        last = ours.last_step
        assert (last.step_size, last.epsilon) == (
            hyperparameters.alpha_at(episode),
            hyperparameters.epsilon_at(episode),
        )
