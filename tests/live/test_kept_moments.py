"""The memory of the past is true, and limited in size."""

from __future__ import annotations

import numpy as np
from playing import begin, do
from recipes import recipe, replay

from rl_tui.live.commands import Apply, FollowCell, GoTo, Take, Train
from rl_tui.runs.recipe import SetParameter
from rl_tui.runs.run import Run
from rl_tui.runs.timeline.checkpoints import MOST, MOST_LEFT, USUAL, Checkpoints, Target
from rl_tui.runs.timeline.table_samples import TableSamples


def test_the_history_of_a_cell_is_what_it_was() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    shown = do(playback, Train(5_000), FollowCell(3))
    assert (shown.cell.pair, len(shown.cell.step)) == (3, len(shown.cell.value))
    assert 100 < len(shown.cell.step) <= 257
    for step, value in zip(shown.cell.step.tolist()[::20], shown.cell.value.tolist()[::20], strict=True):
        assert replay(shown.recipe, (), step).learner.q[3] == value
    shown = do(playback, GoTo(777))
    assert (shown.cell.step[0], shown.cell.step[-1], shown.cell.value[-1]) == (0, 777, shown.agent.q[3])
    shown = do(playback, Apply(SetParameter("alpha", 0.9)), Train(5_000))
    assert shown.cell.value[-1] == shown.agent.q[3]
    straight = replay(shown.recipe, shown.timeline.current.journal, int(shown.cell.step[-3]))
    assert straight.learner.q[3] == shown.cell.value[-3]


def test_a_mark_is_taken_after_a_step_by_hand_as_after_any_other() -> None:
    by_hand = do(begin(recipe("frozenlake")), *(Take(1) for _ in range(16)))
    assert by_hand.results.marks.step.tolist() == [0, 16]


def test_steps_by_hand_do_not_stop_the_history_of_cells() -> None:
    playback = begin(recipe("frozenlake"))
    shown = do(playback, *(Take(1) for _ in range(5)), FollowCell(1), Train(50))
    assert shown.cell.step.tolist() == list(range(56))


def test_samples_keep_within_their_bounds() -> None:
    samples = TableSamples(4)
    for step in range(5_000):
        if samples.next_step == step:
            samples.add(np.full(4, float(step)))
    history = samples.history(2, 4_999, np.full(4, -1.0))
    assert len(history.step) <= 257
    assert history.step[:-1].tolist() == history.value[:-1].tolist()
    assert set(np.diff(history.step[:-1]).tolist()) == {32}
    assert TableSamples(10**6).next_step is None


def test_checkpoints_keep_within_their_bounds() -> None:
    run, kept = Run(recipe("frozenlake")), Checkpoints()
    for taken in range(1, 3 * MOST + 1):
        run.advance(steps=3)
        kept.add(run.checkpoint())
        assert len(kept) == min(taken, MOST)  # never half of them at once: memory use is steady
    found = kept.last_before(Target(0, 10**9, step=1000))
    assert 1000 - 3 * 16 < found.step <= 1000
    assert kept.last_before(Target(0, 10**9, step=0)) is None
    one, many = kept.up_to(10**9, 0), kept.up_to(10**9, 0)
    one.thin_out(1)
    many.thin_out(2_000)
    assert 1 <= len(many) < len(one) <= MOST_LEFT
    assert many.nbytes <= USUAL.checkpoints_left // 2_000


def test_passing_by_the_same_moments_again_and_again_keeps_no_more_of_them() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(2_000))
    kept = playback.group.current.kept.checkpoints
    spacing = kept.spacing
    for _ in range(10):
        do(playback, GoTo(0), Train(500))
    assert kept.spacing == spacing


def test_the_error_of_v_is_known_where_actions_are_no_choice() -> None:
    playback = begin(recipe("random-walk"))
    shown = do(playback, Train(1_000))
    exact, errors = shown.exact_answer.solution, shown.value_errors
    assert exact is not None
    assert errors is not None
    assert errors.error[-1] == np.sqrt(np.mean((shown.agent.q - exact.q) ** 2))
    past = do(playback, GoTo(0)).value_errors
    assert past is not None
    assert past.error.tolist() == errors.error[:1].tolist()
    assert do(begin(recipe("frozenlake")), Train(10)).value_errors is None
