"""Expected targets, compared with values computed by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from recipes import recipe
from snapshots import changed, snapshot_of

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.last_step import NOTHING, LastStep
from rl_tui.live.last_step.backup import Backup, Leaf, expected_target
from rl_tui.live.last_step.step_report import story_of
from rl_tui.live.snapshot import PlaybackView, Snapshot
from rl_tui.live.snapshot_builder import SnapshotBuilder
from rl_tui.runs.recipe import begin
from rl_tui.runs.run import Run

STUDY, CHECK_PHONE, SCROLL, QUIT, SLEEP = range(5)
Q = np.array([6.37, 5.0, 1.0, 2.0, 10.0])


def backup_of(snapshot: Snapshot) -> Backup | None:
    story = story_of(snapshot)
    return None if story is None else story.backup


def sources(snapshot: Snapshot) -> dict[int, float]:
    story = story_of(snapshot)
    return {} if story is None else story.sources


def study(algorithm: str, *, fails: bool = False, epsilon: float = 0.2, **changes: Any) -> Snapshot:
    """A student's study step: Q(Class, study) rises from 6.3 to 6.37, γ is .9."""
    started = recipe("student", algorithm=algorithm, epsilon=epsilon)
    shown = SnapshotBuilder().before(started, begin(started).world, PlaybackView(), is_hidden=False)
    usual: dict[str, Any] = {
        "step": 1,
        "episode": 1,
        "state": 0,
        "pair": STUDY,
        "explored": False,
        "epsilon": epsilon,
        "outcome": 1 if fails else 0,
        "reward": -2.0,
        "next_state": 0 if fails else 2,
        "terminated": False,
        "truncated": False,
        "updated_pair": STUDY,
        "others": 0,
        "table": 0,
        "before": 6.3,
        "step_size": 0.1,
        "gamma": 0.9,
        "gathered": -2.0,
        "discount": 0.9,
        "bootstrap": 10.0,
        "after": 6.37,
    }
    told = usual | changes
    bootstrap_state = NOTHING if told["terminated"] else told["next_state"]
    return changed(shown, q=Q, last_step=LastStep(**told, bootstrap_state=bootstrap_state))


def test_the_greatest_of_the_next_state_is_what_q_learning_expects() -> None:
    # .8 (−2 + .9·10) + .2 (−2 + .9·6.3): if the student stays, the estimate before the update counts
    backup = backup_of(study("q-learning"))
    assert backup.expected == pytest.approx(0.8 * 7.0 + 0.2 * 3.67)
    assert backup.sampled == pytest.approx(7.0)
    assert [leaf.value for leaf in backup.leaves] == [10.0, 6.3]
    assert [leaf.happened for leaf in backup.leaves] == [True, False]
    assert backup.is_current
    assert not backup.is_certain


@pytest.mark.parametrize("algorithm", ["sarsa", "expected-sarsa"])
def test_on_policy_methods_expect_the_mean_over_their_policy(algorithm: str) -> None:
    # π = .9, .1 in Class: V = .9·6.3 + .1·5 = 6.17
    shown = study(algorithm, fails=True, bootstrap=5.0 if algorithm == "sarsa" else 6.17)
    backup = backup_of(shown)
    assert backup.expected == pytest.approx(0.8 * 7.0 + 0.2 * (-2.0 + 0.9 * 6.17))
    assert backup.sampled == pytest.approx(-2.0 + 0.9 * (5.0 if algorithm == "sarsa" else 6.17))
    found = sources(shown)
    assert found == (
        {CHECK_PHONE: 1.0} if algorithm == "sarsa" else pytest.approx({STUDY: 0.9, CHECK_PHONE: 0.1})
    )


def test_each_of_two_tables_judges_the_best_of_the_other() -> None:
    own, other = Q.copy(), Q + np.array([0.3, 0.5, 0.0, 0.0, 1.0])
    shown = changed(study("double-q-learning", table=1, bootstrap=11.0), tables=(own, other))
    backup = backup_of(shown)
    # study is best in Class by table 1, before the update 6.3. Table 2 values it at 6.67
    assert backup.expected == pytest.approx(0.8 * (-2.0 + 0.9 * 11.0) + 0.2 * (-2.0 + 0.9 * 6.67))
    assert sources(shown) == {SLEEP: 1.0}
    without = backup_of(changed(shown, tables=()))
    assert without.expected is None


def test_nothing_follows_an_end() -> None:
    ended = study("q-learning", state=2, pair=SLEEP, updated_pair=SLEEP, outcome=5, next_state=3,
                  reward=10.0, gathered=10.0, terminated=True, bootstrap=0.0)  # fmt: skip
    backup = backup_of(ended)
    assert backup.leaves == (Leaf(1.0, 4, 10.0, 0.0, 3, True, 0.0, True),)
    assert (backup.sampled, backup.expected) == (10.0, 10.0)
    assert backup.is_certain
    assert sources(ended) == {}


def test_equal_estimates_share_what_was_looked_up() -> None:
    shown = study("q-learning", fails=True, bootstrap=5.0, before=5.0)
    assert sources(shown) == {STUDY: 0.5, CHECK_PHONE: 0.5}


def test_what_spans_many_steps_has_no_expected_target() -> None:
    for algorithm in ("n-step-sarsa", "monte-carlo"):
        backup = backup_of(study(algorithm, gathered=3.0, discount=0.81))
        assert (backup.sampled, backup.expected) == (None, None)


def test_without_a_number_nothing_is_expected() -> None:
    known = Leaf(0.5, -1, 1.0, 0.0, 1, False, 2.0, True)
    assert expected_target((known, replace(known, value=4.0)), 0.9) == pytest.approx(1.0 + 0.9 * 3.0)
    assert expected_target((known, replace(known, value=None)), 0.9) is None
    assert expected_target((replace(known, probability=None),), 0.9) is None


def test_before_the_first_step_there_is_none() -> None:
    shown = changed(study("q-learning"), last_step=None)
    assert backup_of(shown) is None
    assert sources(shown) == {}


def test_updates_beside_the_one_told_of_make_the_estimates_newer_than_it() -> None:
    backup = backup_of(study("dyna-q", others=10))
    assert not backup.is_current


ONE_STEP = ["q-learning", "sarsa", "expected-sarsa", "double-q-learning"]


@pytest.mark.parametrize("algorithm", ONE_STEP)
def test_without_chance_sample_and_expectation_agree(algorithm: str) -> None:
    run = Run(recipe("frozenlake", algorithm=algorithm, epsilon=0.5), evaluate=False)
    run.advance(3_000)
    for _ in range(60):
        run.advance(1)
        shown = snapshot_of(run)
        backup = backup_of(shown)
        assert backup.is_certain
        if algorithm != "sarsa":
            assert backup.expected == pytest.approx(backup.sampled, abs=1e-12)
        looked_up = sources(shown)
        assert shown.counters.last_step is not None
        if looked_up and not shown.counters.last_step.table:
            seen = {
                **dict(enumerate(shown.agent.q)),
                shown.counters.last_step.updated_pair: shown.counters.last_step.before,
            }
            mean = sum(weight * seen[pair] for pair, weight in looked_up.items())
            assert mean == pytest.approx(shown.counters.last_step.bootstrap, abs=1e-12)


@pytest.mark.parametrize("algorithm", ONE_STEP)
def test_the_samples_of_a_slippery_step_have_the_expected_target_for_their_mean(algorithm: str) -> None:
    run = Run(recipe("frozenlake-slippery", algorithm=algorithm), evaluate=False)
    run.advance(20_000)
    run.advance(1)
    shown = snapshot_of(run)
    backup = backup_of(shown)
    assert backup.expected is not None
    targets = [leaf.reward + backup.gamma * (leaf.value or 0.0) for leaf in backup.leaves]
    assert backup.expected == pytest.approx(sum(targets) / 3, abs=1e-12)
    if algorithm != "sarsa":
        happened = [target for target, leaf in zip(targets, backup.leaves, strict=True) if leaf.happened]
        assert happened == pytest.approx([backup.sampled], abs=1e-12)


@pytest.mark.parametrize("algorithm", [each.id for each in BY_ID.values() if each.planner])
def test_a_planner_backs_up_the_expectation_itself(algorithm: str) -> None:
    run = Run(recipe("frozenlake-slippery", algorithm=algorithm), evaluate=False)
    run.advance(60)
    for _ in range(40):
        run.advance(1)
        shown = snapshot_of(run)
        backup = backup_of(shown)
        assert backup.sampled == backup.expected == shown.counters.last_step.target
        assert expected_target(backup.leaves, backup.gamma) == pytest.approx(
            shown.counters.last_step.target, abs=1e-12
        )


def test_of_a_world_without_a_table_only_the_sample_is_known() -> None:
    run = Run(recipe("blackjack"), evaluate=False)
    run.advance(50)
    backup = backup_of(snapshot_of(run))
    assert len(backup.leaves) == 1
    assert backup.leaves[0].probability is None
    assert backup.expected is None
    assert backup.sampled is not None


def test_every_panel_of_a_frame_is_told_the_same_story() -> None:
    run = Run(recipe("frozenlake"), evaluate=False)
    run.advance(steps=3)
    first = snapshot_of(run)
    assert story_of(first) is story_of(first)
    run.advance(steps=1)
    assert story_of(snapshot_of(run)) is not story_of(first)
