"""A change between interpreted and compiled code keeps the bits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_environment_loop import lake
from test_every_algorithm import any_hyperparameters
from two_forms import EVERY_LOOP, advance, all_bits, examples, learner_in, worlds_for

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.machine_code import Loop

CUTS = st.lists(st.integers(0, 60), min_size=2, max_size=6)


def fitting(loop: Loop, hyperparameters: Hyperparameters) -> Hyperparameters:
    if not loop.policy:
        return hyperparameters
    needs_step_size = POLICY_BY_ID[loop.policy].needs_step_size
    fit = hyperparameters.without_average() if needs_step_size else hyperparameters
    return replace(fit, policy=loop.policy, temperature=0.3)


@pytest.mark.exhaustive("compiles many loops", but=["q-learning-epsilon-greedy-False"])
@pytest.mark.compiled
@EVERY_LOOP
@examples(5)
@given(st.data(), any_hyperparameters, st.integers(0, 1000), CUTS, st.booleans())
def test_changes_at_any_step_leave_no_trace(
    algorithm: str,
    policy: str,
    stepped: bool,
    data: st.DataObject,
    hyperparameters: Hyperparameters,
    seed: int,
    cuts: list[int],
    begins_interpreted: bool,
) -> None:
    loop = Loop(algorithm, policy, stepped)
    mdp, fit = data.draw(worlds_for(loop)), fitting(loop, hyperparameters)
    as_machine_code, as_python, changing = (learner_in(mdp, loop, fit, seed) for _ in range(3))
    stops = [
        advance(as_machine_code, sum(cuts), is_interpreted=False),
        advance(as_python, sum(cuts), is_interpreted=True),
    ]
    for place, steps in enumerate(cuts):
        stop = advance(changing, steps, is_interpreted=(place % 2 == 0) == begins_interpreted)
    assert stops == [stop, stop]
    assert all_bits(as_machine_code) == all_bits(as_python) == all_bits(changing)


@pytest.mark.exhaustive("compiles many loops")
@pytest.mark.compiled
@pytest.mark.parametrize("seed", range(4))
def test_nor_do_they_where_algorithms_change_too(seed: int) -> None:
    generator = np.random.default_rng(seed)
    loops = [Loop(algorithm, "epsilon-greedy", stepped=False) for algorithm in BY_ID]
    whole, changing = (learner_in(lake(), loops[0], Hyperparameters(epsilon=0.5), seed) for _ in range(2))
    for algorithm in generator.permutation([*BY_ID]).tolist():
        is_interpreted, steps = bool(generator.random() < 0.5), int(generator.integers(1, 80))
        for ours in (whole, changing):
            ours.switch(algorithm)
        stops = [
            advance(whole, steps, is_interpreted=False),
            advance(changing, steps, is_interpreted=is_interpreted),
        ]
        assert stops[0] == stops[1]
    assert all_bits(whole) == all_bits(changing)


@pytest.mark.interpreted
def test_once_a_loop_is_compiled_all_learners_go_on_in_machine_code(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rl_tui.agents.learner.COMPILED_LOOPS", set())
    loop = Loop("q-learning", "epsilon-greedy", stepped=False)
    ours, another = (learner_in(lake(), loop, Hyperparameters(), 0) for _ in range(2))
    planner = learner_in(lake(), Loop("value-iteration", "", stepped=False), Hyperparameters(), 0)
    for each in (ours, another):
        each.advance(50)
    assert not ours.is_compiled
    ours.compile()
    assert (ours.is_compiled, another.is_compiled, planner.is_compiled) == (True, True, False)
    assert all_bits(ours) == all_bits(another)
    ours.advance(50)
    advance(another, 50, is_interpreted=True)
    assert all_bits(ours) == all_bits(another)
