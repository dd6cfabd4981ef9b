"""Waiting and breakpoints."""

from __future__ import annotations

import pytest
from playing import begin, do
from recipes import recipe, replay

from rl_tui.agents.exact.solve import solve
from rl_tui.live.commands import (
    Apply,
    ClearBreakpoints,
    GoTo,
    Pause,
    RunUntil,
    Step,
    StepBack,
    ToggleBreakpoint,
    Train,
)
from rl_tui.live.pace.stop_condition import is_optimal
from rl_tui.live.pace.until import Event, Until
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.recipe import SetParameter


def test_a_run_pauses_at_breakpoints_and_at_what_was_waited_for() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    shown = do(playback, RunUntil(Until(Event.REWARD)))
    assert (shown.counters.last_step.reward, shown.playback.paused_by) == (1.0, "the next reward")
    straight = replay(shown.recipe, (), shown.counters.step - 1)
    assert straight.learner.visits.sum() == shown.counters.step - 1
    assert straight.history.total_return == 0.0
    shown = do(playback, GoTo(0), ToggleBreakpoint(state=9), RunUntil(Until(Event.STEP, 2_000)))
    assert shown.playback.paused_by == "breakpoint: state 9"
    assert shown.counters.state == 9
    shown = do(playback, ClearBreakpoints(), RunUntil(Until(Event.STEP, 2_000)))
    assert (shown.counters.step, shown.playback.paused_by) == (2_000, "step 2,000")
    assert "is in the past" in do(playback, RunUntil(Until(Event.STEP, 10))).playback.paused_by
    shown = do(playback, RunUntil(Until(Event.EPISODE, 300)))
    assert (shown.counters.episodes, shown.counters.episode_step) == (299, 0)
    shown = do(playback, GoTo(0), RunUntil(Until(Event.VALUE, pair=0, threshold=0.1)))
    assert shown.agent.q[0] >= 0.1
    assert replay(shown.recipe, (), shown.counters.step - 1).learner.q[0] < 0.1


def test_the_first_moment_the_policy_is_optimal() -> None:
    playback = begin(recipe("student"))
    shown = do(playback, RunUntil(Until(Event.OPTIMAL)))
    assert shown.playback.paused_by
    best = shown.exact_answer.expected_return
    assert best is not None
    assert shown.results.greedy_return == pytest.approx(best)
    before = do(playback, StepBack())
    assert before.results.greedy_return != pytest.approx(best)
    assert "already" in do(playback, Step(), RunUntil(Until(Event.OPTIMAL))).playback.paused_by
    assert "optimal" in do(begin(recipe("cartpole")), RunUntil(Until(Event.OPTIMAL))).playback.paused_by


def test_at_gamma_1_a_policy_that_never_ends_is_not_optimal() -> None:
    mdp = begin(recipe("student")).group.current.run.world.mdp
    assert mdp is not None
    optimum = solve(mdp, 1.0)
    q = optimum.q.copy()
    assert is_optimal(mdp, q, "random", optimum)
    assert is_optimal(mdp, q, "first", optimum)
    q[1] += 1.0  # checking the phone is as good by Q*, but not if the agent does nothing else
    assert not is_optimal(mdp, q, "random", optimum)
    q[0] += 2.0
    assert is_optimal(mdp, q, "random", optimum)


def test_the_best_arm_is_looked_for_where_it_drifts_to() -> None:
    playback = begin(recipe("bandit-drifting", seed=1))

    def is_best(shown: Snapshot) -> bool:
        return bool(shown.exact_answer.solution.greedy[int(shown.agent.q.argmax())])

    assert not is_best(do(playback, Train(20)))
    shown = do(playback, RunUntil(Until(Event.OPTIMAL)))
    assert is_best(shown)
    assert not any(is_best(do(playback, GoTo(step))) for step in range(20, shown.counters.step))


def test_a_breakpoint_is_met_in_the_past_though_something_is_set_there() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, ToggleBreakpoint(state=4))
    shown = do(playback, RunUntil(Until(Event.STEP, 1000)))
    assert shown.playback.paused_by == "breakpoint: state 4"
    shown = do(playback, Apply(SetParameter("ties", "first")), Train(10), GoTo(0))
    again = do(playback, RunUntil(Until(Event.STEP, 1000)))
    assert again.playback.paused_by == "breakpoint: state 4"
    assert again.agent.hyperparameters.ties == "first"


def test_a_breakpoint_that_was_met_is_not_met_again_without_a_step() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, ToggleBreakpoint(state=4))
    there = do(playback, RunUntil(Until(Event.STEP, 1000)))
    assert there.playback.paused_by == "breakpoint: state 4"
    assert do(playback, Pause()).playback.paused_by == ""
    assert do(playback, Train(3)).playback.paused_by == ""
    assert do(playback, StepBack()).counters.step == there.counters.step + 2
