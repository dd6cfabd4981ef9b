"""Runs with a planner."""

from __future__ import annotations

from pathlib import Path

import pytest
from playing import begin, do
from recipes import bandit, one_run, recipe, replay
from snapshots import snapshot_of

from rl_tui.live.commands import AddLane, Apply, ChooseBranch, Pause, Train
from rl_tui.live.sessions.session import encoded, read_session
from rl_tui.live.snapshot import Phase
from rl_tui.runs.recipe import Recipe, SetParameter, SwitchAlgorithm
from rl_tui.runs.run import Run
from rl_tui.runs.training.many_runs import many_runs
from rl_tui.runs.training.seeded_runs import Goal

PLAN = SwitchAlgorithm("value-iteration")
LEARN = SwitchAlgorithm("q-learning")


def seen_state(run: Run) -> int:
    return snapshot_of(run).counters.state


def test_a_planner_that_is_done_stays_so_whatever_is_refused() -> None:
    playback = begin(recipe("student", algorithm="value-iteration"))
    assert do(playback, Train(10_000)).playback.phase is Phase.DONE
    assert do(playback, ChooseBranch(2)).playback.phase is Phase.DONE
    assert do(playback, Pause()).playback.phase is Phase.DONE


def test_a_planner_pulls_no_arm() -> None:
    figures = one_run(recipe("bandit", algorithm="value-iteration"), Goal(episodes=100))
    assert (figures["regret"], figures["winnings"], figures["best_arm_rate"]) == (0.0, 0.0, None)


@pytest.mark.parametrize("scenario", ["bandit", "bandit-drifting"])
def test_what_was_pulled_stays_the_same_while_a_planner_is_at_work(scenario: str) -> None:
    run = Run(recipe(scenario), evaluate=False)
    run.advance(100)
    before = run.bandit
    run.apply(PLAN)
    run.advance()
    assert run.learner.converged
    assert run.bandit == before
    assert before.pulls == 100


def test_sweeps_are_not_taken_from_the_budget() -> None:
    run = Run(bandit(budget=50, algorithm="value-iteration"), evaluate=False, episode_limit=50)
    run.advance()
    run.apply(LEARN)
    run.advance()
    assert (run.bandit.pulls, run.history.curve().episode[-1], run.spent) == (50, 50, True)


def test_a_planner_says_how_many_sweeps_were_its_own() -> None:
    alone = Run(recipe("student", algorithm="value-iteration"), evaluate=False)
    alone.advance()
    later = Run(recipe("student"), evaluate=False)
    later.advance(episodes=40)
    later.learner.q[:] = 0.0
    later.apply(PLAN)
    later.advance()
    assert later.message == alone.message
    assert "converged after" in alone.message


def test_many_runs_of_a_planner_have_no_curve() -> None:
    for goal in (Goal(episodes=100), Goal(steps=40)):
        document = many_runs(recipe("student", algorithm="value-iteration"), 2, goal)
        assert set(map(len, document["curve"].values())) == {0}
        assert all(row["episodes"] > 0 for row in document["runs"])


def test_whoever_takes_over_is_seen_where_it_begins() -> None:
    run = Run(recipe("frozenlake"), evaluate=False)
    while run.learner.episode_step == 0 or run.learner.state == 0:
        run.advance(1)
    run.apply(PLAN)
    assert seen_state(run) == run.learner.state == 0
    run.advance(episodes=1)
    last = run.learner.last_step
    assert seen_state(run) == last.state != 0
    run.apply(LEARN)
    assert seen_state(run) == run.learner.state == 0


def test_a_checkpoint_knows_what_was_planned() -> None:
    made_from: Recipe = bandit(budget=30, algorithm="value-iteration")
    run = Run(made_from, evaluate=False)
    run.advance()
    run.apply(SetParameter("epsilon", 0.5))
    run.apply(LEARN)
    run.advance(10)
    other = Run(made_from, evaluate=False)
    other.restore(run.checkpoint())
    assert other.bandit == run.bandit == replay(made_from, run.journal, run.step).bandit
    assert other.learner.planned == run.learner.planned == (2, 2)


def test_a_planner_beside_a_run_is_done_before_what_was_changed_there_and_a_session_says_so(
    tmp_path: Path,
) -> None:
    playback = begin(recipe("student"))
    do(
        playback,
        Train(5_000),
        Apply(SetParameter("gamma", 0.8)),
        AddLane((SwitchAlgorithm("policy-iteration"),)),
    )
    lane = playback.record.lanes[1].branches[0]
    assert lane.end < 5_000
    assert lane.journal == ()
    path = tmp_path / "session.json"
    path.write_bytes(encoded(playback.record))
    assert read_session(path).record().lanes[1].branches == (lane,)
