"""Updates that read one estimate of an unknown action."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from correct_learners import ALPHA, GAMMA, moved
from made_recordings import ACTIONS, STATES, Learner, Step, recorded

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.diagnosis.step_story import update_of_step
from rl_tui.programs.evidence.verdict import CodeFault, Rule, UpdateTarget
from rl_tui.worlds.mdp.space import FloatArray

INITIAL = ("random", "zeros", "high")
SOME_SEEDS = pytest.mark.exhaustive(
    "other random worlds", but=[f"{seed}-{each}" for seed, each in enumerate(INITIAL)]
)


def reading(action: Callable[[FloatArray, Step], int], *, at_ends: bool = True) -> Learner:
    def learn(table: FloatArray, step: Step) -> None:
        future = 0.0 if step.terminated else table[step.next_state, action(table, step)]
        if at_ends or not (step.terminated or step.truncated):
            moved(table, step, step.reward + GAMMA * future)

    return learn


def best_allowed(seed: int) -> Callable[[FloatArray, Step], int]:
    rng = np.random.default_rng(100 + seed)
    allowed = rng.random((STATES, ACTIONS)) < 0.5
    allowed[np.arange(STATES), rng.integers(ACTIONS, size=STATES)] = True
    return lambda table, step: int(
        np.where(allowed[step.next_state], table[step.next_state], -np.inf).argmax()
    )


def drawn_again(seed: int) -> Callable[[FloatArray, Step], int]:
    rng = np.random.default_rng(seed)
    return lambda table, step: (
        int(rng.integers(ACTIONS)) if rng.random() < 0.3 else int(table[step.next_state].argmax())
    )


@SOME_SEEDS
@pytest.mark.parametrize("initial", INITIAL)
@pytest.mark.parametrize("seed", range(3))
def test_a_maximum_over_allowed_actions_is_q_learning(seed: int, initial: str) -> None:
    verdict = verdict_of(recorded(reading(best_allowed(seed)), seed, initial=initial))
    update = verdict.update
    assert (update.rule, update.target) == (Rule.Q_LEARNING, UpdateTarget.ALLOWED)
    assert (update.alpha, update.gamma, update.fits) == (ALPHA, GAMMA, 1.0)
    assert verdict.findings == ()


@pytest.mark.parametrize("initial", INITIAL)
def test_the_last_reward_lost_under_a_mask_is_found(initial: str) -> None:
    verdict = verdict_of(recorded(reading(best_allowed(1), at_ends=False), 1, initial=initial))
    assert verdict.update.target is UpdateTarget.ALLOWED
    (finding,) = verdict.findings
    assert finding.fault is CodeFault.LOSES_UPDATE
    assert finding.steps_for > 100
    assert finding.correction.endswith("gamma * max(Q[s2, b] for b in allowed)")


@SOME_SEEDS
@pytest.mark.parametrize("initial", INITIAL)
@pytest.mark.parametrize("seed", range(3))
def test_a_next_action_that_is_drawn_again_is_a_note(seed: int, initial: str) -> None:
    log = recorded(reading(drawn_again(seed)), seed, initial=initial)
    verdict = verdict_of(log)
    update = verdict.update
    assert (update.rule, update.target) == (Rule.SARSA, UpdateTarget.DRAWN)
    assert (update.alpha, update.gamma) == (ALPHA, GAMMA)
    assert verdict.findings == ()
    (note,) = verdict.notes
    assert "as if it was drawn separately" in note
    last = int(log.recording.changes.step[-1])
    assert update_of_step(log.recording, update, last).explained


def test_the_least_estimate_is_neither() -> None:
    least = reading(lambda table, step: int(table[step.next_state].argmin()))
    assert verdict_of(recorded(least)).update.rule is Rule.UNKNOWN


def test_a_mask_is_not_told_of_a_few_steps() -> None:
    log = recorded(reading(best_allowed(0)), steps=25)
    assert verdict_of(log).update.target is not UpdateTarget.ALLOWED
