"""Correct programs get no findings, for every update."""

from __future__ import annotations

import pytest
from correct_learners import CORRECT_LEARNERS
from made_recordings import ACTIONS, STATES, recorded

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.watched.program_log import ProgramEnvironment

WORLDS = {
    "dense": {"initial": "random", "rewards": (-1.0, 0.0, 0.0, 1.0, 2.0)},
    "costs": {"initial": "zeros", "rewards": (-1.0,), "greedy": 0.8},
    "sparse": {"initial": "high", "rewards": (0.0,) * 9 + (1.0,), "greedy": 0.7, "dtype": "float32"},
}


@pytest.mark.exhaustive(
    "other worlds", but=[f"{name}-{[*WORLDS][i % 3]}" for i, name in enumerate(CORRECT_LEARNERS)]
)
@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("name", CORRECT_LEARNERS)
def test_nothing_is_said_of_a_correct_learner(name: str, world: str) -> None:
    log = recorded(CORRECT_LEARNERS[name](), 1, steps=1200, **WORLDS[world])  # type: ignore[arg-type]
    log.environments.append(ProgramEnvironment(0, "Taxi-v3", None, (STATES,), ACTIONS, 12))
    log.numbers |= {"alpha": 0.1, "gamma": 0.9, "epsilon": 0.2}
    assert verdict_of(log).findings == ()
