"""Machine code depends only on types, never on the world."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import Any, Final

import numba
import numpy as np
import pytest
from arms import gaussian
from shipped import SCENARIOS, SHIPPED
from two_forms import EVERY_LOOP, in_place_of_machine_code

from rl_tui.agents.batches.batch import RunBatch
from rl_tui.agents.batches.seeding import streams_of
from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.agents.compatibility import incompatibility
from rl_tui.agents.compiling.jit import dispatcher_of
from rl_tui.agents.compiling.loops import compile_here, learner_of
from rl_tui.agents.exact.backward_induction import best_values, policy_values
from rl_tui.agents.exact.policy_figures import batch_figures, expected_returns
from rl_tui.agents.exact.small_worlds import many_policies
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.compiled import CALLED_FROM_PYTHON
from rl_tui.agents.kernels.loop import advance
from rl_tui.agents.kernels.machine_code import SHARED, Loop
from rl_tui.agents.kernels.watch import Watching
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.runs.history import History
from rl_tui.runs.training.seeded_runs import RunCurve
from rl_tui.worlds.world import World

pytestmark = pytest.mark.compiled
STEPS: Final = 12
Types = tuple[Any, ...]

# Integers in place of floats, as a file or a program may give them, and every value that changes in a run
ODD: Final = [
    Hyperparameters(),
    Hyperparameters(
        alpha=1, alpha_min=0, alpha_decay=1, gamma=1, epsilon=1, epsilon_min=0, epsilon_decay=1,
        temperature=1, confidence=2, lambda_=1, threshold=0, accuracy=0, initial_q=1,
    ),
    Hyperparameters(alpha="sample-average", ties="first", traces="accumulating", baseline="none"),
    Hyperparameters(step_size_schedule="linear", alpha_decay=0.1, epsilon_schedule="constant", n=1),
]  # fmt: skip
WATCHED: Final = Watching(reward=True, policy=True, cell=0, threshold=1, states=frozenset({0}))


@cache
def world(scenario: str) -> World:
    return SCENARIOS[SHIPPED.index(scenario)].build(streams(0).world)


def types_of(arguments: tuple[Any, ...]) -> Types:
    return tuple(numba.typeof(each) for each in arguments)


class Recorder:
    def __init__(self) -> None:
        self.seen = set[tuple[str, Types]]()

    def __call__(self, function: Callable[..., Any], *example: Any) -> Callable[..., Any]:
        def noted(*arguments: Any) -> Any:
            self.seen.add((function.__name__, types_of(arguments)))
            return function(*arguments)

        if example:
            self.seen.add((function.__name__, types_of(example)))
        return noted


@pytest.fixture
def recorder() -> Iterator[Recorder]:
    recorder = Recorder()
    with in_place_of_machine_code(recorder):
        yield recorder


def run(ours: Learner, watching: Watching | None = None) -> None:
    ours.watch(watching)
    for _ in range(2):
        ours.advance(STEPS // 2)
        ours.drain_episodes()


@EVERY_LOOP
def test_no_world_and_no_setting_asks_for_other_machine_code(
    algorithm: str, policy: str, stepped: bool, recorder: Recorder
) -> None:
    loop = Loop(algorithm, policy, stepped)
    learner_of(loop).compile()
    asked = set(recorder.seen)
    (name,) = {name for name, _ in asked}
    for scenario in SHIPPED:
        made = world(scenario)
        if (made.mdp is None) != stepped:
            continue
        for settings in ODD:
            fit = replace(settings, policy=policy) if policy else settings
            if policy and POLICY_BY_ID[policy].needs_step_size:
                fit = fit.without_average()
            if incompatibility(made.space, algorithm, fit):
                continue
            environment = made.new_environment() if made.new_environment else None
            ours = Learner(made.space, algorithm, fit, streams(0), environment)
            run(ours, WATCHED)
            assert {each for each in recorder.seen if each[0] == name} == asked, scenario


@pytest.mark.parametrize("algorithm", ["q-learning", "value-iteration", "policy-iteration"])
def test_nor_do_drift_a_time_limit_and_a_learner_that_came_back(algorithm: str, recorder: Recorder) -> None:
    learner_of(Loop(algorithm, "" if "iteration" in algorithm else "epsilon-greedy", stepped=False)).compile()
    asked = set(recorder.seen)
    drifting = replace(gaussian([0, 1, 2]), drift_std=1, time_limit=np.int64(1))  # type: ignore[arg-type]
    ours = Learner(drifting, "q-learning", Hyperparameters(), streams(0))
    ours.advance(STEPS)
    ours.drain_episodes()
    ours.switch(algorithm)
    run(ours)
    ours.restore(ours.checkpoint())
    run(ours, Watching(pairs=frozenset({0})))
    ours.configure(replace(ODD[1], n=np.int64(2), planning_steps=True))  # type: ignore[arg-type]
    run(ours)
    names = {name for name, _ in asked}
    others = {each for each in recorder.seen - asked if each[0] in names}
    if algorithm != "q-learning":
        assert not others
    else:
        assert recorder.seen >= asked
        assert not others


def test_what_all_share_is_called_with_the_types_of_its_examples(
    recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(many_policies, "COMPILED_LOOPS", {SHARED})
    mdp = world("frozenlake").mdp
    policy = np.full(mdp.pairs, 0.25)
    policy_values(mdp, policy, 3)
    policy_values(mdp, policy, 3, mdp.reward + 1)
    best_values(mdp, 1, 3)
    expected_returns(mdp, policy[np.newaxis])
    batch_figures(replace(mdp, time_limit=np.int64(3)), policy[np.newaxis], "first", 1, None)  # type: ignore[arg-type]
    ours = Learner(mdp, "q-learning", Hyperparameters(), streams(0))
    ours.watch(WATCHED)
    ours.advance(5)
    ours.watch(None)
    ours.advance(500)
    streams_of([1, 2])
    RunBatch("q-learning", Hyperparameters(), [1, 2], mdp).recent_means()
    history, curve = History(), RunCurve(3)
    for _ in range(2):
        returns, lengths, optimal = ours.drain_episodes()
        history.add(returns, lengths)
        curve(returns, lengths, optimal)
    examples = {function.__name__: {types_of(example())} for function, example in CALLED_FROM_PYTHON.items()}
    seen = {name: {types for each, types in recorder.seen if each == name} for name in examples}
    assert seen == examples


def test_no_other_machine_code_is_compiled() -> None:
    compile_here(Loop("q-learning", "epsilon-greedy", stepped=False))
    before = list(dispatcher_of(advance).signatures)
    mdp = world("frozenlake").mdp
    assert mdp is not None
    for settings in ODD:
        run(Learner(mdp, "q-learning", settings, streams(0)), WATCHED)
    assert dispatcher_of(advance).signatures == before
