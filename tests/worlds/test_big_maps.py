"""Maps of a hundred thousand cells and more."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rl_tui.worlds.grid.section import GridSection
from rl_tui.worlds.mdp.reachable import reachable
from rl_tui.worlds.mdp.space import NumberNames
from rl_tui.worlds.mdp.tabular_mdp import TransitionArrays, mdp_of_arrays

LEFT, DOWN, RIGHT, UP = range(4)


def big(lines, **keys):
    raw = {"map": "\n".join(lines)} | keys
    assert list(GridSection.connection_findings(raw)) == []
    return GridSection.model_validate(raw).build(np.random.default_rng(0))


@pytest.fixture(scope="module")
def icy():
    middle = ["." * 400] * 398
    return big(["S" + "." * 399, *middle, "." * 399 + "G"], slippery=True).mdp


def test_a_big_slippery_map_has_all_its_outcomes(icy):
    assert (icy.states, icy.pairs, len(icy.next_state)) == (160_000, 4 * 159_999, 12 * 159_999)
    inside = 200 * 400 + 7
    outcomes = icy.outcomes_of(icy.pairs_of(inside)[LEFT])
    assert [int(icy.next_state[o]) - inside for o in outcomes] == [-400, -1, 400]
    assert [int(icy.outcome_action[o]) for o in outcomes] == [UP, LEFT, DOWN]
    edge = icy.outcomes_of(icy.pairs_of(399)[UP])
    assert [int(icy.next_state[o]) for o in edge] == [399, 399, 398]
    assert int(icy.terminated.sum()) == 6, "three outcomes from each of the two neighbours of the goal"
    assert float(icy.reward.sum()) == 6.0


def test_a_big_maze_keeps_only_what_can_be_reached():
    island = ["S" + "." * 149 + "#" + "." * 149] * 2 + ["." * 150 + "#" + "." * 149] * 398
    mdp = big(island).mdp
    assert mdp.states == 400 * 299
    assert mdp.pairs == 4 * 400 * 150
    assert not mdp.pairs_of(150), "the first cell beyond the wall"


def test_a_long_corridor_is_followed_to_its_end():
    """Every other row is a wall with one gap, at alternating ends, which gives the longest path."""
    rows = []
    for row in range(301):
        if row % 2 == 0:
            rows.append("." * 300)
        else:
            rows.append("." + "#" * 299 if row % 4 == 3 else "#" * 299 + ".")
    rows[0] = "S" + "." * 299
    mdp = big(rows).mdp
    assert mdp.pairs == 4 * mdp.states == 4 * (151 * 300 + 150)


def test_states_are_called_by_numbers_without_a_text_for_each(icy):
    names = icy.state_names
    assert isinstance(names, NumberNames)
    assert (names[0], names[-1], len(names)) == ("0", "159999", 160_000)


def test_names_of_numbers_are_a_sequence_like_any_other():
    names = NumberNames(np.array([0, 3, 12]))
    assert list(names) == ["0", "3", "12"]
    assert list(names[1:]) == ["3", "12"]
    assert names.index("12") == 2
    assert "4" not in names
    assert names == pickle.loads(pickle.dumps(names))
    assert hash(names) == hash(NumberNames(np.array([0, 3, 12])))
    assert names != NumberNames(np.array([0, 3, 11]))
    assert names != ("0", "3", "12")
    with pytest.raises(ValueError, match="increasing"):
        NumberNames(np.array([0, 3, 3]))


@settings(deadline=None)
@given(
    st.integers(1, 12).flatmap(lambda n: st.lists(st.lists(st.integers(0, n - 1)), min_size=n, max_size=n)),
    st.data(),
)
def test_both_searches_find_the_same_states(edges, data):
    start = np.array(data.draw(st.lists(st.integers(0, len(edges) - 1), min_size=1)))
    first = np.cumsum([0, *map(len, edges)])
    ends = np.array([end for each in edges for end in each], dtype=np.int64)
    plain = reachable(first, ends, start)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rl_tui.worlds.mdp.reachable.MOST_PLAIN", -1)
        large = reachable(first, ends, start)
    assert plain.tolist() == large.tolist()
    reached = set(start.tolist())
    while more := {end for state in reached for end in edges[state]} - reached:
        reached |= more
    assert np.flatnonzero(plain).tolist() == sorted(reached)


def two_states(**changes):
    arrays = TransitionArrays(
        pair_state=np.array([0, 0, 1]),
        pair_action=np.array([0, 1, 0]),
        outcome_count=np.array([1, 2, 1]),
        probability=np.array([1.0, 0.5, 0.5, 1.0]),
        next_state=np.array([0, 0, 2, 1]),
        reward=np.arange(4.0),
        reward_std=np.zeros(4),
        terminated=np.zeros(4, dtype=np.bool_),
        outcome_action=np.array([0, 1, 1, 0]),
    )._replace(**changes)
    return mdp_of_arrays(("a", "b", "end"), ("x", "y"), arrays, np.array([0]), np.array([1.0]), 9)


def test_arrays_become_a_table_of_what_can_be_reached():
    mdp = two_states()
    assert mdp.first_pair.tolist() == [0, 2, 2, 2], "b is not reached"
    assert mdp.first_outcome.tolist() == [0, 1, 3]
    assert mdp.terminated.tolist() == [False, False, True]
    assert mdp.reward.tolist() == [0.0, 1.0, 2.0]
    assert mdp.cumulative.tolist() == [1.0, 0.5, 1.0]
    assert mdp.time_limit == 9


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"pair_action": np.array([1, 0, 0])}, "pair_action"),
        ({"probability": np.array([1.0, 0.5, 0.4, 1.0])}, "sum to 1"),
        ({"pair_state": np.array([1, 1, 2])}, "state 0 has no actions"),
        ({"reward": np.array([0.0, np.nan, 0.0, 0.0])}, "reward"),
    ],
)
def test_arrays_that_contradict_each_other_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        two_states(**changes)
