"""Maps of the literature have their known values."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from rl_tui.agents.exact.solve import solve
from rl_tui.worlds.drawing import CellKind
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.grid.section import GridSection
from rl_tui.worlds.gym.toy_text import world_of

LAKES = {
    "4x4": ["SFFF", "FHFH", "FFFH", "HFFG"],
    "8x8": ["SFFFFFFF", "FFFFFFFF", "FFFHFFFF", "FFFFFHFF", "FFFHFFFF", "FHHFFFHF", "FHFFHFHF", "FFFHFFFG"],
}
BOOK = "...P\n.#.N\nS..."


def grid(lines, seed=0, **keys):
    raw = keys if lines is None else {"map": "\n".join(lines) if isinstance(lines, list) else lines} | keys
    assert list(GridSection.connection_findings(raw)) == []
    return GridSection.model_validate(raw).build(np.random.default_rng(seed))


@pytest.mark.parametrize(
    ("name", "size", "limit"),
    [
        ("frozenlake", "4x4", 100),
        ("frozenlake-slippery", "4x4", 100),
        ("frozenlake-8x8", "8x8", 200),
        ("frozenlake-8x8-slippery", "8x8", 200),
    ],
)
def test_the_lakes_are_gymnasiums_to_the_last_bit(name, size, limit):
    theirs = find(name).build(np.random.default_rng(0))
    ours = grid(
        LAKES[size], time_limit=limit, slippery=name.endswith("slippery"), legend={"F": {"kind": "floor"}}
    )
    assert ours.drawing == theirs.drawing
    for field in dataclasses.fields(theirs.mdp):
        mine, other = getattr(ours.mdp, field.name), getattr(theirs.mdp, field.name)
        if isinstance(other, np.ndarray):
            np.testing.assert_array_equal(mine, other, field.name)
        else:
            assert (tuple(mine) if field.name == "state_names" else mine) == other
    assert solve(ours.mdp, 0.99).value_at_start == solve(theirs.mdp, 0.99).value_at_start


def test_cliff_walking_is_gymnasiums():
    theirs = world_of("CliffWalking-v1", {}).mdp
    ours = grid(
        ["." * 12, "." * 12, "." * 12, "S" + "C" * 10 + "G"],
        step_reward=-1.0,
        legend={"C": {"kind": "cliff", "reward": -99.0, "back": True}, "G": {"kind": "goal", "reward": 0.0}},
    )
    names = theirs.action_names
    assert ours.drawing.kinds[37:47] == (CellKind.CLIFF,) * 10
    for pair in range(ours.mdp.pairs):
        state, action = ours.mdp.state_of(pair), ours.mdp.action_names[ours.mdp.pair_action[pair]]
        (here,), (there,) = (
            ours.mdp.outcomes_of(pair),
            theirs.outcomes_of(theirs.pairs_of(state)[names.index(action)]),
        )
        for name in ("next_state", "reward", "terminated"):
            assert getattr(ours.mdp, name)[here] == getattr(theirs, name)[there]
    assert ours.mdp.pairs == theirs.pairs == 4 * 37
    assert solve(ours.mdp, 1.0).value_at_start == -13.0


WINDY = ["." * 10] * 3 + ["S......G.."] + ["." * 10] * 3
WIND = [0, 0, 0, 1, 1, 1, 2, 2, 1, 0]


def test_with_gusts_the_wind_is_one_more_or_one_less_a_third_of_the_time_each():
    """Sutton & Barto, exercise 6.10."""
    mdp = grid(WINDY, wind=WIND, moves="king", gusts=True).mdp
    left, calm, windy = 0, 30, 46
    assert [int(mdp.next_state[o]) for o in mdp.outcomes_of(mdp.pairs_of(calm)[left])] == [30]
    outcomes = mdp.outcomes_of(mdp.pairs_of(windy)[left])
    assert sorted(int(mdp.next_state[o]) for o in outcomes) == [15, 25, 35]
    assert [float(mdp.probability[o]) for o in outcomes] == pytest.approx([1 / 3] * 3)


def test_the_jumps_of_figure_3_2():
    """Sutton & Barto, Example 3.5: the equiprobable policy's values are in the figure."""
    mdp = grid(
        [".A.B.", ".....", "...b.", ".....", "Sa..."],
        rewards="leaving",
        bump_reward=-1.0,
        legend={
            "A": {"kind": "floor", "jump": "a", "reward": 10.0},
            "B": {"kind": "floor", "jump": "b", "reward": 5.0},
            "a": {"kind": "floor"},
            "b": {"kind": "floor"},
        },
    ).mdp
    follows, pays = np.zeros((25, 25)), np.zeros(25)
    np.add.at(follows, (mdp.pair_state[mdp.outcome_pair], mdp.next_state), 0.25 * mdp.probability)
    np.add.at(pays, mdp.pair_state[mdp.outcome_pair], 0.25 * mdp.probability * mdp.reward)
    values = np.linalg.solve(np.eye(25) - 0.9 * follows, pays)
    np.testing.assert_allclose(
        values.reshape(5, 5).round(1),
        [
            [3.3, 8.8, 4.4, 5.3, 1.5],
            [1.5, 3.0, 2.3, 1.9, 0.5],
            [0.1, 0.7, 0.7, 0.4, -0.4],
            [-1.0, -0.4, -0.4, -0.6, -1.2],
            [-1.9, -1.3, -1.2, -1.4, -2.0],
        ],
    )


def cs188(gamma, living, digits):
    exits = {
        "P": {"kind": "goal", "reward": 1.0, "exit": True},
        "N": {"kind": "hole", "reward": -1.0, "exit": True},
    }
    mdp = grid(BOOK, rewards="leaving", noise=0.2, step_reward=living, legend=exits).mdp
    return solve(mdp, gamma).v.round(digits).tolist()


def test_the_book_grid_of_cs188():
    """The values that ``python gridworld.py -a value -i 100 -g BookGrid`` draws (two decimals)."""
    assert cs188(gamma=0.9, living=0.0, digits=2) == [
        *(0.64, 0.74, 0.85, 1.0),
        *(0.57, 0.57, -1.0),
        *(0.49, 0.43, 0.48, 0.28),
    ]


def test_an_exit_pays_its_cell_alone_and_ends():
    mdp = grid(
        "SX", step_reward=-1.0, noise=0.2, legend={"X": {"kind": "goal", "exit": True, "reward": 5.0}}
    ).mdp
    assert mdp.action_names == ("left", "down", "right", "up", "exit")
    (pair,) = mdp.pairs_of(1)
    (outcome,) = mdp.outcomes_of(pair)
    assert (mdp.pair_action[pair], mdp.reward[outcome], mdp.terminated[outcome]) == (4, 5.0, True)
    assert set(mdp.reward[mdp.next_state == 1][:-1]) == {-1.0}, "entering it pays nothing"


def test_a_blocked_step_enters_its_own_cell_again():
    mdp = grid("SG", legend={"S": {"kind": "start", "reward": 0.5}}).mdp
    assert mdp.reward.tolist() == [0.5, 0.5, 1.0, 0.5]


def test_several_starts_are_equally_likely_and_an_island_owns_nothing():
    mdp = grid("S#.\nSG#\n###").mdp
    assert mdp.start_state.tolist() == [0, 2]
    assert mdp.start_probability.tolist() == [0.5, 0.5]
    assert mdp.state_names[1] == "2"
    assert not mdp.pairs_of(1)


def test_the_drawing_knows_what_is_no_direction():
    drawing = grid("S.X", moves="king+stay", legend={"X": {"kind": "goal", "exit": True}}).drawing
    assert drawing.directions[:5] == ((0, -1), (1, 0), (0, 1), (-1, 0), (1, -1))
    assert drawing.directions[8:] == (None, None)
    assert drawing.kinds == (CellKind.START, CellKind.FLOOR, CellKind.GOAL)


def test_a_random_map_is_another_one_for_another_seed():
    wanted = {"rows": 6, "columns": 9, "holes": 0.4}
    maps = [grid(None, seed, random=wanted).drawing for seed in range(20)]
    assert maps[3] == grid(None, 3, random=wanted).drawing
    assert len({drawing.kinds for drawing in maps}) > 15
    for drawing in maps:
        assert (drawing.rows, drawing.columns) == (6, 9)
        assert (drawing.kinds[0], drawing.kinds[-1]) == (CellKind.START, CellKind.GOAL)


def test_the_goal_of_a_random_map_can_be_reached():
    for seed in range(30):
        mdp = grid(None, seed, random={"rows": 5, "columns": 5, "holes": 0.5}).mdp
        assert 24 in mdp.next_state
    oblique = [
        grid(None, seed, random={"rows": 9, "columns": 9, "holes": 0.55}, moves="king").mdp
        for seed in range(9)
    ]
    assert all(80 in mdp.next_state for mdp in oblique)
