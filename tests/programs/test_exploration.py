"""ε as used."""

from __future__ import annotations

from dataclasses import replace

import pytest
from correct_learners import only_if, q_learning, with_alpha
from made_recordings import recorded

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.diagnosis.exploration import exploration_of
from rl_tui.programs.diagnosis.update_rule import update_of
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import ExplorationFound, UpdateFound, UpdateTarget
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.screen.panels.program.words import exploration_texts
from rl_tui.screen.theme.glyphs import UNICODE


def acting(epsilon: float, seed: int = 0, steps: int = 3000) -> ProgramLog:
    """Return a program that explores with the probability ``epsilon``, and says .05."""
    log = recorded(q_learning, seed, steps=steps, greedy=1.0 - epsilon)
    log.numbers["agent.epsilon"] = 0.05
    return log


@pytest.mark.exhaustive("watches twenty programs for each", but=["0.3-4"])
@pytest.mark.parametrize(
    ("epsilon", "seeds"), [*((each, 20) for each in (0.0, 0.05, 0.3, 0.95, 1.0)), (0.3, 4)]
)
def test_the_interval_holds_the_epsilon_in_use(epsilon: float, seeds: int) -> None:
    hits = 0
    for seed in range(seeds):
        verdict = verdict_of(acting(epsilon, seed))
        found = verdict.exploration
        assert found is not None
        assert 0.0 <= found.low <= found.epsilon <= found.high <= 1.0
        assert (found.name, found.written) == ("agent.epsilon", 0.05)
        assert verdict.findings == ()
        assert found.departs == (not found.low <= 0.05 <= found.high)
        hits += found.low <= epsilon <= found.high
    assert hits >= 0.85 * seeds


@pytest.mark.exhaustive("watches twenty programs for each", but=["0.1-4"])
@pytest.mark.parametrize(("epsilon", "seeds"), [*((each, 20) for each in (0.05, 0.1, 0.3)), (0.1, 4)])
def test_greedy_episodes_of_a_converged_table_count(epsilon: float, seeds: int) -> None:
    hits = 0
    for seed in range(seeds):
        learner = with_alpha(lambda _: 0.5)
        log = recorded(learner, seed, steps=8000, greedy=1.0 - epsilon, is_slippery=False)
        evidence = Evidence(log.recording)
        found = exploration_of(evidence, update_of(evidence))
        assert found is not None
        hits += found.low <= epsilon <= found.high
    assert hits >= 0.85 * seeds


def test_evaluations_do_not_count() -> None:
    log = recorded(only_if(lambda step: step.episode % 2 == 0), steps=3000, greedy=0.7)
    evidence = Evidence(log.recording)
    found = exploration_of(evidence, update_of(evidence))
    whole = exploration_of(evidence, replace(update_of(evidence), alpha=None, alpha_schedule=None))
    assert found is not None
    assert found.low <= 0.3 <= found.high
    assert whole is None  # an evaluation looks like a converged episode


def test_few_choices_and_allowed_actions_give_no_estimate() -> None:
    evidence = Evidence(acting(0.3, steps=80).recording)
    assert exploration_of(evidence, UpdateFound()) is None
    evidence = Evidence(acting(0.3).recording)
    assert exploration_of(evidence, UpdateFound()) is not None
    assert exploration_of(evidence, UpdateFound(target=UpdateTarget.ALLOWED)) is None


def test_equal_values_have_no_best_action() -> None:
    log = recorded(lambda table, step: None, initial="zeros")
    assert exploration_of(Evidence(log.recording), UpdateFound()) is None


def test_the_line_needs_an_epsilon_in_the_code() -> None:
    found = ExplorationFound(0.94, 0.91, 0.97, 2000, "epsilon", 0.05)
    whole, _, short = exploration_texts(found, UNICODE)
    assert whole == "ε used .94 (.91 to .97) in the last 2,000 choices · epsilon in your code is .05"
    assert short == "ε used .94 · epsilon .05"
    assert exploration_texts(replace(found, name="", written=None), UNICODE) == ()
    assert exploration_texts(None, UNICODE) == ()
