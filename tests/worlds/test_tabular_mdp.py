"""The flat arrays of a finite MDP."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, cumulative_inside, tabular_mdp

ARRAYS = [field.name for field in dataclasses.fields(TabularMDP) if field.type.endswith("Array")]


def corridor(**changes):
    """Three cells: left stays or goes back, right goes on. The third ends the episode."""
    arguments = {
        "state_names": ["a", "b", "end", "island"],
        "action_names": ["left", "right"],
        "transitions": [
            Transition(
                1,
                1,
                [Outcome(0.75, 2, 5.0, False), Outcome(0.0, 0, 9.0, False), Outcome(0.25, 1, -1.0, False)],
            ),
            Transition(0, 1, [Outcome(1.0, 1, -1.0, False, 0.5, 1)]),
            Transition(1, 0, [Outcome(0.5, 0, -1.0, False), Outcome(0.5, 0, -2.0, False)]),
            Transition(3, 0, [Outcome(1.0, 0, 0.0, False)]),
        ],
        "start": {0: 0.25, 1: 0.75, 2: 0.0},
        "time_limit": 7,
    }
    return tabular_mdp(**(arguments | changes))


def test_lays_out_pairs_by_state_and_action_and_outcomes_as_given():
    mdp = corridor()
    assert mdp.first_pair.tolist() == [0, 1, 3, 3, 3]
    assert mdp.pair_action.tolist() == [1, 0, 1]
    assert mdp.pair_state.tolist() == [0, 1, 1]
    assert mdp.first_outcome.tolist() == [0, 1, 3, 5]
    assert mdp.outcome_pair.tolist() == [0, 1, 1, 2, 2]
    assert mdp.next_state.tolist() == [1, 0, 0, 2, 1]
    assert mdp.reward.tolist() == [-1.0, -1.0, -2.0, 5.0, -1.0]
    assert mdp.reward_std.tolist() == [0.5, 0.0, 0.0, 0.0, 0.0]
    assert mdp.outcome_action.tolist() == [1, -1, -1, -1, -1]
    assert mdp.probability.tolist() == [1.0, 0.5, 0.5, 0.75, 0.25]
    assert mdp.cumulative.tolist() == [1.0, 0.5, 1.0, 0.75, 1.0]
    assert mdp.start_state.tolist() == [0, 1]
    assert mdp.start_cumulative.tolist() == [0.25, 1.0]
    assert (mdp.states, mdp.pairs, mdp.time_limit) == (4, 3, 7)
    assert list(mdp.pairs_of(1)) == [1, 2]
    assert list(mdp.outcomes_of(2)) == [3, 4]


def test_an_outcome_into_a_state_without_pairs_terminates():
    assert corridor().terminated.tolist() == [False, False, False, True, False]


def test_states_reached_only_by_a_terminated_outcome_own_no_pairs():
    transitions = [
        Transition(0, 0, [Outcome(1.0, 1, 1.0, True)]),
        Transition(1, 0, [Outcome(1.0, 1, 0.0, False)]),
    ]
    mdp = tabular_mdp(["a", "b"], ["go"], transitions, {0: 1.0})
    assert mdp.first_pair.tolist() == [0, 1, 1]


def test_a_terminated_outcome_may_lead_into_a_live_state():
    mdp = tabular_mdp(["only"], ["pull"], [Transition(0, 0, [Outcome(1.0, 0, 1.0, True)])], {0: 1.0})
    assert mdp.terminated.tolist() == [True]
    assert mdp.pairs == 1


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_cannot_be_written(name):
    with pytest.raises(ValueError, match="read-only"):
        getattr(corridor(), name)[0] = 0


def test_an_array_that_the_caller_keeps_is_copied():
    mdp = corridor()
    kept = mdp.reward.copy()
    again = dataclasses.replace(mdp, reward=kept)
    kept[0] = 99.0
    assert again.reward[0] == -1.0


def outcome(**changes):
    return [Transition(0, 0, [Outcome(1.0, 0, 0.0, True)._replace(**changes)])]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"transitions": outcome(probability=0.9)}, "sum to 0.9"),
        ({"transitions": outcome(probability=math.nan)}, "at least 0"),
        ({"transitions": outcome(probability=-1.0)}, "at least 0"),
        ({"transitions": outcome(next_state=4)}, "next states in 0..3"),
        ({"transitions": outcome(next_state=-1)}, "next states in 0..3"),
        ({"transitions": outcome(reward=math.inf)}, r"reward\[0\]: expected a finite number"),
        ({"transitions": outcome(reward=math.nan)}, r"reward\[0\]"),
        ({"transitions": outcome(reward_std=-1.0)}, r"reward_std\[0\]"),
        ({"transitions": outcome(action=2)}, r"outcome_action\[0\]"),
        ({"transitions": [Transition(4, 0, [])]}, "state in 0..3"),
        ({"transitions": [Transition(0, 2, [])]}, "action in 0..1"),
        ({"transitions": [Transition(0, 0, [])]}, "sum to 0"),
        ({"transitions": outcome() * 2}, "given twice"),
        ({"transitions": []}, "state 0 has no actions"),
        ({"start": {}}, "start: probabilities sum to 0"),
        ({"start": {0: 0.5}}, "start: probabilities sum to 0.5"),
        ({"start": {2: 1.0}}, "state 2 has no actions"),
        ({"start": {7: 1.0}}, "state 7 has no actions"),
        ({"time_limit": -1}, "time_limit is -1"),
        ({"state_names": ["a", "a", "b", "c"]}, "state_names"),
    ],
)
def test_refuses(changes, message):
    with pytest.raises(ValueError, match=message):
        corridor(**({"start": {0: 1.0}} | changes))


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("first_pair", [0, 1, 3, 3]),
        ("first_pair", [0, 3, 1, 3, 3]),
        ("first_pair", [1, 1, 3, 3, 3]),
        ("pair_action", [1, 0, 2]),
        ("pair_action", [1, 1, 0]),
        ("pair_action", [1, 0, 0]),
        ("first_outcome", [0, 1, 1, 5]),
        ("first_outcome", [0, 1, 3, 4]),
        ("next_state", [1, 0, 0, 2, 4]),
        ("next_state", [1, 0, 0, 2, 3]),
        ("terminated", [False] * 5),
        ("probability", [1.0, 0.5, 0.5, 0.75, 0.2]),
        ("probability", [1.0, 0.0, 1.0, 0.75, 0.25]),
        ("cumulative", [1.0, 0.5, 1.0, 0.75, 1.0 - 1e-12]),
        ("cumulative", [1.0, 0.6, 1.0, 0.75, 1.0]),
        ("start_state", [0, 0]),
        ("start_state", [0, 3]),
        ("start_cumulative", [0.25, 0.9]),
        ("start_cumulative", [1.25, 1.0]),
        ("reward", [0, 0, 0, 0, 0]),
    ],
)
def test_refuses_arrays_that_contradict_each_other(name, values):
    with pytest.raises(ValueError, match=r"expected"):
        dataclasses.replace(corridor(), **{name: np.array(values)})


def test_rounding_never_opens_a_gap_at_the_end_of_a_pair():
    tenth = np.full(10, 0.1)
    assert tenth.cumsum()[-1] < 1.0
    cumulative = cumulative_inside(np.concatenate([tenth, [1 / 3] * 3]), np.array([0, 10, 13]))
    assert cumulative[9] == 1.0
    assert cumulative[12] == 1.0
    assert cumulative[10] == 1 / 3


@st.composite
def random_mdps(draw):
    states, actions = draw(st.integers(1, 6)), draw(st.integers(1, 3))
    index = st.integers(0, states - 1)
    transitions = []
    for state in range(states):
        for action in draw(st.sets(st.integers(0, actions - 1), min_size=1 if state == 0 else 0)):
            weights = draw(st.lists(st.integers(0, 9), min_size=1, max_size=5).filter(any))
            outcomes = [
                Outcome(weight / sum(weights), draw(index), draw(st.floats(-5, 5)), draw(st.booleans()))
                for weight in weights
            ]
            transitions.append(Transition(state, action, outcomes))
    names = [str(state) for state in range(states)]
    return transitions, tabular_mdp(names, [str(a) for a in range(actions)], transitions, {0: 1.0})


@settings(deadline=None)
@given(random_mdps())
def test_random_worlds_keep_what_was_said(made):
    transitions, mdp = made
    said = {(each.state, each.action): each.outcomes for each in transitions}
    for pair in range(mdp.pairs):
        outcomes = mdp.outcomes_of(pair)
        kept = [o for o in said[int(mdp.pair_state[pair]), int(mdp.pair_action[pair])] if o.probability > 0]
        assert [int(mdp.next_state[o]) for o in outcomes] == [o.next_state for o in kept]
        assert [float(mdp.probability[o]) for o in outcomes] == [o.probability for o in kept]
        assert mdp.cumulative[outcomes[-1]] == 1.0
        assert all(
            mdp.terminated[o] or not said_o.terminated for o, said_o in zip(outcomes, kept, strict=True)
        )


@settings(deadline=None)
@given(random_mdps())
def test_only_live_states_own_pairs(made):
    transitions, mdp = made
    acting = {each.state for each in transitions}
    live, to_visit = {0}, [0]
    while to_visit:
        for pair in mdp.pairs_of(to_visit.pop()):
            for o in mdp.outcomes_of(pair):
                if not mdp.terminated[o] and int(mdp.next_state[o]) not in live:
                    live.add(int(mdp.next_state[o]))
                    to_visit.append(int(mdp.next_state[o]))
    assert {state for state in range(mdp.states) if mdp.pairs_of(state)} == live
    assert live <= acting
