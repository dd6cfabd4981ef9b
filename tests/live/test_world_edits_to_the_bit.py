"""After any edits, the state of a run equals its journal."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from edited_worlds import GRAPH_STROKES, MAP_STROKES, small_graph, small_map
from hypothesis import given, settings
from hypothesis import strategies as st
from playing import bits, stand

from rl_tui.agents.catalogue import BY_ID
from rl_tui.common.errors import UserError
from rl_tui.live.record import Record
from rl_tui.live.sessions.session import encoded, read_session
from rl_tui.runs.recipe import Change, Recipe, RedoEdit, SetParameter, SwitchAlgorithm, TakeAction, UndoEdit
from rl_tui.runs.run import Run, RunState
from rl_tui.runs.timeline.branches import Branch, RunRecord
from rl_tui.worlds.mdp.digest import table_digest
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

pytestmark = pytest.mark.unit


def differing(run: Run, other: Run) -> list[str]:
    one, two = _known(run), _known(other)
    return [name for name in one if one[name] != two[name]]


def _known(run: Run) -> dict[str, Any]:
    learner, mdp = run.learner, run.world.mdp
    assert mdp is not None
    return {
        "all that is shown": stand(run),
        "world": table_digest(mdp),
        "changes of the world": (run.world_changes, learner.world_since),
        "history": bits(run.history.checkpoint()),
        "memory": bits(learner.checkpoint().memory),
        "policy's memory": bits(learner.checkpoint().rule),
        "planned": learner.planned,
    }


def assert_valid(mdp: TabularMDP) -> None:
    sums = [
        mdp.probability[first:last].sum()
        for first, last in zip(mdp.first_outcome[:-1], mdp.first_outcome[1:], strict=True)
    ]
    assert sums == pytest.approx([1.0] * mdp.pairs)
    assert len(mdp.start_state)
    assert all(len(mdp.pairs_of(state)) for state in mdp.start_state.tolist())


def through_a_file(run: Run) -> tuple[Recipe, Any]:
    branch = Branch("branch 1", run.journal, end=run.step, here=run.step)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "session.json"
        path.write_bytes(encoded(Record((RunRecord(run.recipe, (branch,)),))))
        lane = read_session(path).record().lanes[0]
    return lane.recipe, lane.branches[0].journal


CHANGES: st.SearchStrategy[Change] = st.one_of(
    st.just(UndoEdit()),
    st.just(RedoEdit()),
    st.builds(TakeAction, st.sampled_from(["left", "down", "right", "up", "study", "quit", "cheat"])),
    st.builds(SetParameter, st.just("alpha"), st.sampled_from([0.1, 0.9])),
)


def deeds(strokes: st.SearchStrategy[Any]) -> st.SearchStrategy[list[Any]]:
    """Steps (a number), changes, "keep" to make a checkpoint and "back" to restore it."""
    deed = st.one_of(st.integers(1, 60), strokes, strokes, CHANGES, st.sampled_from(["keep", "back"]))
    return st.lists(deed, min_size=3, max_size=14)


def done(run: Run, what: list[Any]) -> None:
    kept: list[RunState] = []
    run.advance(steps=0)  # the mark of the beginning must exist first
    for deed in what:
        if isinstance(deed, int):
            run.advance(deed)
        elif deed == "keep":
            kept.append(run.checkpoint())
        elif deed == "back":
            run.restore(kept.pop() if kept else run.checkpoint())
        else:
            before = _known(run)
            try:
                run.apply(deed)
            except UserError:
                assert _known(run) == before
        assert run.world.mdp is not None
        assert_valid(run.world.mdp)


def straight(recipe: Recipe, journal: Any, step: int) -> Run:
    run = Run(recipe)
    run.follow(journal, step)
    return run


@pytest.mark.parametrize("algorithm", BY_ID)
@settings(max_examples=15, deadline=None)
@given(what=deeds(MAP_STROKES))
def test_on_a_map_it_ends_in_the_bits_of_the_straight_replay(algorithm: str, what: list[Any]) -> None:
    run = Run(small_map(algorithm=algorithm))
    done(run, what)
    assert not differing(run, straight(run.recipe, run.journal, run.step))
    assert not differing(run, straight(*through_a_file(run), run.step))


@settings(max_examples=30, deadline=None)
@given(
    algorithm=st.sampled_from(["q-learning", "n-step-sarsa", "value-iteration"]), what=deeds(GRAPH_STROKES)
)
def test_on_a_graph_it_ends_in_the_bits_of_the_straight_replay(algorithm: str, what: list[Any]) -> None:
    run = Run(small_graph(algorithm=algorithm))
    done(run, what)
    assert not differing(run, straight(*through_a_file(run), run.step))


@settings(max_examples=15, deadline=None)
@given(first=st.sampled_from(list(BY_ID)), then=st.sampled_from(list(BY_ID)), what=deeds(MAP_STROKES))
def test_so_it_does_where_the_algorithm_is_changed_between(first: str, then: str, what: list[Any]) -> None:
    run = Run(small_map(algorithm=first))
    half = len(what) // 2
    done(run, [*what[:half], SwitchAlgorithm(then), *what[half:]])
    assert not differing(run, straight(run.recipe, run.journal, run.step))
