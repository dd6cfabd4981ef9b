"""Learners, interpreted and as machine code."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Final

import numpy as np
import pytest
from arms import bandit_of
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from random_worlds import worlds
from test_environment_loop import Table, untabled

from rl_tui.agents import learner
from rl_tui.agents.batches import batch, seeding
from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.agents.compiling.loops import all_loops
from rl_tui.agents.exact import backward_induction
from rl_tui.agents.exact.small_worlds import many_policies
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels import environment_loop, machine_code, watch
from rl_tui.agents.kernels.machine_code import Loop
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.runs import history
from rl_tui.runs.training import seeded_runs as learning_curve
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP

EVERYDAY: Final = {
    Loop("q-learning", "epsilon-greedy", stepped=False),
    Loop("q-learning", "epsilon-greedy", stepped=True),
    Loop("value-iteration", "", stepped=False),
}
_EXHAUSTIVE: Final = pytest.mark.exhaustive("compiles the loop of every algorithm and policy")
EVERY_LOOP: Final = pytest.mark.parametrize(
    ("algorithm", "policy", "stepped"),
    [pytest.param(*loop[:3], marks=() if loop in EVERYDAY else _EXHAUSTIVE) for loop in all_loops()],
)
"""Every loop of the catalogue.

A normal run takes only some, since all take a quarter of an hour to compile.
"""


def examples(count: int) -> Callable[[Any], Any]:
    return settings(max_examples=count, deadline=None, suppress_health_check=[HealthCheck.too_slow])


@contextmanager
def interpreted() -> Iterator[None]:
    with in_place_of_machine_code(machine_code.interpreted) as patch:
        patch.setattr(Learner, "is_compiled", False)
        yield


@contextmanager
def in_place_of_machine_code(stand_in: Callable[..., Callable[..., Any]]) -> Iterator[pytest.MonkeyPatch]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Learner, "is_compiled", True)
        patch.setattr(learner, "COMPILED_LOOPS", set())
        patch.setattr(learner, "use_machine_code", stand_in)
        for module in (learner, watch, history, learning_curve, seeding, batch, many_policies):
            patch.setattr(module, "fastest", stand_in)
        for module in (environment_loop, backward_induction):
            patch.setattr(module, "machine_code", stand_in)
        yield patch


def advance(ours: Learner, steps: int, *, is_interpreted: bool) -> int:
    if not is_interpreted:
        return ours.advance(steps)
    with interpreted():
        return ours.advance(steps)


@st.composite
def bandits(draw: st.DrawFn) -> TabularMDP:
    coins, noise = draw(st.booleans()), draw(st.sampled_from([0.0, 1.0]))
    payments = st.sampled_from([0.2, 0.9] if coins else [-1.0, 0.0, 2.5])
    return bandit_of(
        [
            [Outcome(each, 0, 1.0, True), Outcome(1.0 - each, 0, 0.0, True)]
            if coins
            else [Outcome(1.0, 0, each, True, noise)]
            for each in draw(st.lists(payments, min_size=1, max_size=5))
        ]
    )


def worlds_for(loop: Loop) -> st.SearchStrategy[TabularMDP]:
    if loop.policy and POLICY_BY_ID[loop.policy].bandits_only:
        return bandits()
    return worlds(noise=not loop.stepped)


def learner_in(mdp: TabularMDP, loop: Loop, hyperparameters: Hyperparameters, seed: int) -> Learner:
    if not loop.stepped:
        return Learner(mdp, loop.algorithm, hyperparameters, streams(seed))
    ours = Learner(untabled(mdp), loop.algorithm, hyperparameters, streams(seed), Table(mdp, seed))
    ours.rewindable = True  # so that it exposes its whole state
    return ours


def all_bits(ours: Learner) -> list[Any]:
    """Return every bit of a learner, and forget the episodes. All NaNs count as equal."""
    state = ours.checkpoint()
    parts = (state.memory, state.rule, state.drift, state.position, state.record, ours.drain_episodes())
    return [
        (state.algorithm, state.hyperparameters, state.planned, state.stop, state.streams),
        [[_bits(array) for array in arrays] for arrays in parts],
    ]


def _bits(array: Any) -> bytes:
    """Use one NaN for all: processors and compilers choose the kind of NaN."""
    whole = np.where(np.isnan(array), np.nan, array) if array.dtype.kind == "f" else array
    return bytes(whole.tobytes())
