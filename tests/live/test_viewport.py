from __future__ import annotations

import numpy as np
import pytest
from open_grids import open_grid, open_grid_recipe
from playing import busy
from recipes import recipe
from snapshots import snapshot_of

from rl_tui.live.commands import LookAt, Step
from rl_tui.live.playback import Playback
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.live.viewport import (
    NO_STATE,
    Cells,
    RowRange,
    Viewport,
    first_state_of_cells,
    followed_state,
    pairs_of_states,
)
from rl_tui.runs.large_worlds import MOST_COPIED, is_large
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.run import Run
from rl_tui.worlds.drawing import CellKind, Grid

SIDE = 200
STEPS = 5_000
NEAR = Viewport(Cells(9, 7), RowRange(40))


@pytest.fixture(scope="module")
def run() -> Run:
    run = Run(open_grid_recipe(SIDE), evaluate=False)
    run.advance(STEPS)
    return run


def state_at(row: int, column: int) -> int:
    return row * SIDE + column


def shown(run: Run, sight: Viewport) -> Snapshot:
    return snapshot_of(run, viewport=sight)


def test_a_small_world_is_copied_whole_whatever_is_in_sight() -> None:
    run = Run(recipe("frozenlake"), evaluate=False)
    snapshot = snapshot_of(run, viewport=Viewport(Cells(1, 1)))
    assert not is_large(run.world)
    assert snapshot.agent.part is None
    assert snapshot.agent.holds(0)
    assert snapshot.agent.q.tolist() == run.learner.q.tolist()


def test_a_large_world_is_copied_whole_until_somebody_says_what_is_shown(run: Run) -> None:
    assert is_large(run.world)
    assert run.world.space.pairs > MOST_COPIED
    snapshot = snapshot_of(run)
    assert snapshot.agent.part is None
    assert np.array_equal(snapshot.agent.q, run.learner.q)


def test_only_what_is_in_sight_is_copied(run: Run) -> None:
    snapshot = shown(run, NEAR)
    window = snapshot.agent.part
    held = np.flatnonzero(window.held)
    assert set(held.tolist()) == set(window.pairs.tolist())
    # cells and rows around the agent, and the states of the last step
    most = 4 * (19 * 15 + 4) + 2 * 40 + 4
    assert 0 < len(held) <= most
    assert np.array_equal(snapshot.agent.q[held], run.learner.q[held])
    assert np.array_equal(snapshot.agent.visits[held], run.learner.visits[held])
    elsewhere = ~window.held
    assert not snapshot.agent.q[elsewhere].any()
    assert not snapshot.agent.visits[elsewhere].any()


def test_all_that_a_view_which_follows_may_show_is_there(run: Run) -> None:
    snapshot = shown(run, NEAR)
    row, column = divmod(snapshot.counters.state, SIDE)
    for top in range(max(0, row - 8), min(row, SIDE - 9) + 1):
        for left in range(max(0, column - 6), min(column, SIDE - 7) + 1):
            for state in (state_at(top, left), state_at(top + 8, left + 6)):
                assert all(map(snapshot.agent.holds, run.world.space.pairs_of(state)))
    here = run.world.space.pairs_of(snapshot.counters.state).start
    assert all(snapshot.agent.holds(pair) for pair in range(here - 40, here + 44))


def test_parts_that_were_scrolled_to_are_there_as_well(run: Run) -> None:
    sight = Viewport(Cells(2, 3, top=0, left=150), RowRange(8, first=120_000), pair=99_999)
    snapshot = shown(run, sight)
    space = run.world.space
    for state in (state_at(0, 150), state_at(1, 152)):
        assert all(map(snapshot.agent.holds, space.pairs_of(state)))
    assert not any(map(snapshot.agent.holds, space.pairs_of(state_at(2, 150))))
    assert not any(map(snapshot.agent.holds, space.pairs_of(state_at(1, 153))))
    assert all(snapshot.agent.holds(pair) for pair in range(120_000, 120_008))
    assert not snapshot.agent.holds(119_999)
    assert not snapshot.agent.holds(120_008)
    assert snapshot.agent.holds(99_999)


def test_what_the_last_step_met_is_there(run: Run) -> None:
    last = run.learner.last_step
    snapshot = shown(run, Viewport())
    assert snapshot.agent.holds(last.updated_pair)
    assert all(map(snapshot.agent.holds, run.world.space.pairs_of(last.next_state)))
    assert snapshot.agent.part.held.sum() <= 3 * 4


def test_a_sight_beyond_the_edges_is_cut_off() -> None:
    run = Run(open_grid_recipe(SIDE), evaluate=False)
    snapshot = shown(
        run,
        Viewport(Cells(500, 500, top=150, left=150), RowRange(1_000_000, first=run.world.space.pairs - 4)),
    )
    assert snapshot.agent.part.held.all()


def test_a_snapshot_never_changes_and_cannot_be_changed() -> None:
    run = Run(open_grid_recipe(SIDE), evaluate=False)
    run.advance(1_000)
    first = shown(run, NEAR)
    q, visits = (
        first.agent.q[first.agent.part.pairs].tolist(),
        first.agent.visits[first.agent.part.pairs].tolist(),
    )
    run.advance(20_000)
    second = shown(run, NEAR)
    assert first.agent.q[first.agent.part.pairs].tolist() == q
    assert first.agent.visits[first.agent.part.pairs].tolist() == visits
    assert second.agent.visits.sum() != first.agent.visits.sum()
    for array in (first.agent.q, first.agent.visits, first.agent.part.held):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_to_look_at_a_part_changes_nothing_but_the_pictures(run: Run) -> None:
    playback = Playback(
        open_grid_recipe(SIDE), speed=10.0, automatic=True, clock=lambda: 0.0, on_exact=lambda: None
    )
    while busy(playback):
        playback.work()
    assert playback.snapshot().agent.part is None
    playback.handle(LookAt(NEAR))
    assert playback.changed
    first = playback.snapshot()
    assert first.agent.part is not None
    assert first.playback.phase is Phase.PAUSED
    for _ in range(3):
        playback.handle(Step())
    plain = Run(open_grid_recipe(SIDE), evaluate=False)
    plain.advance(3)
    after = playback.snapshot()
    assert (after.counters.step, after.counters.state) == (3, plain.learner.state)
    assert np.array_equal(after.agent.q[after.agent.part.pairs], plain.learner.q[after.agent.part.pairs])


def test_what_was_shown_of_a_larger_world_is_left_out(run: Run) -> None:
    pairs = run.world.space.pairs
    far = Viewport(Cells(9, 7, 10 * SIDE, 10 * SIDE), RowRange(40, 10 * pairs), pairs)
    window = shown(run, far).agent.part
    assert set(window.pairs.tolist()) == set(near_pairs(run))


def near_pairs(run: Run) -> list[int]:
    window = shown(run, NEAR).agent.part
    pairs: list[int] = window.pairs.tolist()
    return pairs


def test_the_first_of_several_states_in_a_cell_is_found() -> None:
    grid = Grid(2, 2, (CellKind.FLOOR,) * 4, (3, 0, 3, 0, 2), ())
    assert first_state_of_cells(grid).tolist() == [[1, NO_STATE], [4, 0]]


def test_pairs_of_several_states() -> None:
    space = open_grid(3).space
    assert pairs_of_states(space, np.array([2, 8, 0])).tolist() == [8, 9, 10, 11, 0, 1, 2, 3]
    assert pairs_of_states(space, np.array([], dtype=np.int64)).tolist() == []


def test_a_table_follows_the_agent_to_the_end_of_its_episode() -> None:
    made_from: Recipe = open_grid_recipe(3)
    run = Run(made_from, evaluate=False)
    run.advance(episodes=1)
    last, goal = run.learner.last_step, 8
    assert last.next_state == goal
    assert followed_state(run.world.space, goal, last) == last.state
    assert followed_state(run.world.space, 4, last) == 4
    assert followed_state(run.world.space, 4, None) == 4
