"""Numbers out of bounds stop a run."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_change_over import fitting
from two_forms import EVERY_LOOP, advance, all_bits, examples, learner_in, worlds_for

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.machine_code import Loop
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# At the ends of their ranges and beyond: a learner does not check them
extreme_hyperparameters = st.builds(
    Hyperparameters,
    alpha=st.sampled_from([5e-324, 0.5, 1.0, 2.0, -1.0, 1e300, "sample-average"]),
    step_size_schedule=st.sampled_from(["constant", "linear", "exponential"]),
    alpha_min=st.sampled_from([0.0, 1.0, 1e300]),
    alpha_decay=st.sampled_from([0.0, 1.0, 1e308]),
    gamma=st.sampled_from([0.0, 1.0, 1.5, -3.0, 1e200]),
    epsilon=st.sampled_from([0.0, 0.3, 1.0]),
    epsilon_schedule=st.sampled_from(["constant", "linear", "exponential"]),
    epsilon_min=st.sampled_from([0.0, 1.0]),
    epsilon_decay=st.sampled_from([0.0, 1.0, 1e308]),
    temperature=st.sampled_from([5e-324, 1e-300, 1e6]),
    confidence=st.sampled_from([0.0, 1e6, 1e308]),
    baseline=st.sampled_from(["mean", "none"]),
    lambda_=st.sampled_from([0.0, 1.0, 10.0, -1.0]),
    traces=st.sampled_from(["replacing", "accumulating"]),
    n=st.sampled_from([1, 4]),
    planning_steps=st.sampled_from([0, 8, 30]),
    threshold=st.sampled_from([0.0, 1e6]),
    accuracy=st.sampled_from([0.0, 1e6]),
    initial_q=st.sampled_from([0.0, 1e12, -1e12, 1e300]),
    ties=st.sampled_from(["random", "first"]),
)


def stretched(mdp: TabularMDP, scale: float, std: float) -> TabularMDP:
    return replace(mdp, reward=mdp.reward * scale, reward_std=mdp.reward_std * std)


@pytest.mark.compiled
@EVERY_LOOP
@examples(6)
@given(
    st.data(),
    extreme_hyperparameters,
    st.integers(0, 1000),
    st.sampled_from([1.0, 1e6, 5e11, 1e150]),
    st.sampled_from([1.0, 1e6, 1e150]),
)
def test_a_runaway_stops_both_forms_at_the_same_step_with_the_same_bits(
    algorithm: str,
    policy: str,
    stepped: bool,
    data: st.DataObject,
    hyperparameters: Hyperparameters,
    seed: int,
    scale: float,
    std: float,
) -> None:
    loop = Loop(algorithm, policy, stepped)
    mdp = stretched(data.draw(worlds_for(loop)), scale, std)
    fit = replace(fitting(loop, hyperparameters), temperature=hyperparameters.temperature)
    as_machine_code, as_python = (learner_in(mdp, loop, fit, seed) for _ in range(2))
    stops = [advance(as_machine_code, 60, is_interpreted=False), advance(as_python, 60, is_interpreted=True)]
    assert stops[0] == stops[1]
    assert all_bits(as_machine_code) == all_bits(as_python)
