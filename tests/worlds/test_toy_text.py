"""Facts from Gymnasium's own tables."""

from __future__ import annotations

from typing import ClassVar

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Discrete

from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.gym.section import GymnasiumSection
from rl_tui.worlds.gym.toy_text import NoTableError, world_of
from rl_tui.worlds.sections.schema import WorldRefusedError

LEFT, DOWN, RIGHT, UP = range(4)
START, FLOOR, HOLE, GOAL = CellKind.START, CellKind.FLOOR, CellKind.HOLE, CellKind.GOAL


def built(name):
    return find(name).build(np.random.default_rng(0))


@pytest.mark.parametrize(
    ("name", "states", "live", "limit"),
    [
        ("frozenlake", 16, 11, 100),
        ("frozenlake-slippery", 16, 11, 100),
        ("frozenlake-8x8", 64, 53, 200),
        ("frozenlake-8x8-slippery", 64, 53, 200),
    ],
)
def test_sizes_and_time_limits_of_the_lakes(name, states, live, limit):
    mdp = built(name).mdp
    assert (mdp.states, mdp.pairs, mdp.time_limit) == (states, 4 * live, limit)
    assert mdp.state_names == tuple(str(state) for state in range(states))
    assert mdp.action_names == ("left", "down", "right", "up")
    assert mdp.start_state.tolist() == [0]


def test_holes_and_goal_of_the_small_lake_own_no_pairs():
    mdp = built("frozenlake-slippery").mdp
    assert [state for state in range(16) if not mdp.pairs_of(state)] == [5, 7, 11, 12, 15]
    assert mdp.reward[mdp.next_state == 15].tolist() == [1.0] * int(np.sum(mdp.next_state == 15))
    assert set(mdp.reward[mdp.next_state != 15]) == {0.0}


def test_the_small_lake_is_drawn_as_its_map():
    drawing = built("frozenlake").drawing
    assert drawing == Grid(
        rows=4,
        columns=4,
        kinds=(
            *(START, FLOOR, FLOOR, FLOOR),
            *(FLOOR, HOLE, FLOOR, HOLE),
            *(FLOOR, FLOOR, FLOOR, HOLE),
            *(HOLE, FLOOR, FLOOR, GOAL),
        ),
        cell_of_state=tuple(range(16)),
        directions=((0, -1), (1, 0), (0, 1), (-1, 0)),
    )


def test_slips_go_to_the_sides_and_never_backwards():
    mdp = built("frozenlake-slippery").mdp
    for pair in range(mdp.pairs):
        meant = int(mdp.pair_action[pair])
        happened = [int(mdp.outcome_action[o]) for o in mdp.outcomes_of(pair)]
        assert happened == [(meant - 1) % 4, meant, (meant + 1) % 4]


def test_slips_that_land_alike_stay_apart():
    mdp = built("frozenlake-slippery").mdp
    outcomes = mdp.outcomes_of(mdp.pairs_of(0)[LEFT])
    assert [(int(mdp.outcome_action[o]), int(mdp.next_state[o])) for o in outcomes] == [
        (UP, 0),
        (LEFT, 0),
        (DOWN, 4),
    ]
    assert mdp.probability[outcomes[0] : outcomes[-1] + 1] == pytest.approx([1 / 3] * 3)


def test_on_dry_ice_what_was_meant_happens():
    mdp = built("frozenlake").mdp
    assert mdp.outcome_action.tolist() == mdp.pair_action.tolist()
    assert mdp.next_state[mdp.pairs_of(0)[RIGHT]] == 1


def test_a_map_of_ones_own():
    world = world_of("FrozenLake-v1", {"desc": ["SFG"], "is_slippery": False, "max_episode_steps": 9})
    assert world.space.states == 3
    assert world.space.time_limit == 9
    assert world.drawing.rows == 1


def test_cliff_walking_has_its_shape_and_its_own_order_of_actions():
    world = world_of("CliffWalking-v1", {})
    assert (world.drawing.rows, world.drawing.columns) == (4, 12)
    assert world.space.action_names == ("up", "right", "down", "left")
    assert world.space.time_limit == 0
    into_the_cliff = world.space.outcomes_of(world.space.pairs_of(36)[1])[0]
    assert world.space.reward[into_the_cliff] == -100.0
    assert world.space.next_state[into_the_cliff] == 36
    assert world.space.outcome_action[into_the_cliff] == 1, "it went right, and was carried back"


def test_cliff_walking_is_drawn_with_its_cliff():
    kinds = world_of("CliffWalking-v1", {}).drawing.kinds
    assert kinds[:36] == (FLOOR,) * 36
    assert kinds[36:] == (START, *(CellKind.CLIFF,) * 10, GOAL)


def test_a_table_without_a_map_lies_in_the_squarest_grid_that_holds_it():
    gymnasium.register("Tabled-v0", Tabled, disable_env_checker=True)
    try:
        world = world_of("Tabled-v0", {})
    finally:
        del gymnasium.registry["Tabled-v0"]
    assert (world.drawing.rows, world.drawing.columns) == (3, 3)
    assert world.drawing.directions == (None,) * 2
    assert world.space.state_names == tuple("0123456")
    assert world.space.action_names == ("0", "1")


def test_taxi_is_twenty_towns():
    world = built("taxi")
    assert (world.space.states, world.space.pairs, world.space.time_limit) == (500, 6 * 400, 200)
    assert world.space.action_names == ("south", "north", "east", "west", "pick up", "drop off")
    assert len(world.space.start_state) == 300
    assert world.space.start_probability == pytest.approx(np.full(300, 1 / 300))
    drawing = world.drawing
    assert (drawing.rows, drawing.columns) == (29, 23)
    assert len(set(drawing.cell_of_state)) == 500
    assert drawing.kinds.count(CellKind.WALL) == 29 * 23 - 500
    assert all(drawing.kinds[cell] is not CellKind.WALL for cell in drawing.cell_of_state)


def test_a_wall_of_the_town_is_where_driving_east_and_back_leads_nowhere():
    world = built("taxi")
    mdp, drawing = world.space, world.drawing
    east, west = mdp.action_names.index("east"), mdp.action_names.index("west")

    def stays(state: int, action: int) -> bool:
        pair = mdp.pair_of(state, action)
        return pair is not None and int(mdp.next_state[mdp.outcomes_of(pair)[0]]) == state

    state_of = {cell: state for state, cell in enumerate(drawing.cell_of_state)}
    acting = {cell for cell, state in state_of.items() if mdp.pairs_of(state)}
    beside = {cell for cell in acting if cell + 1 in acting and (cell + 1) % drawing.columns}
    assert {cell for cell in beside if stays(state_of[cell], east)} == set(drawing.walls) & beside
    assert {cell for cell in beside if stays(state_of[cell + 1], west)} == set(drawing.walls) & beside
    assert len(drawing.walls) == 20 * 6


def test_the_names_of_taxi_are_what_gymnasium_decodes():
    world = built("taxi")
    taxi = gymnasium.make("Taxi-v4").unwrapped
    for state, name in enumerate(world.space.state_names):
        row, column, passenger, destination = taxi.decode(state)
        assert name == f"{row},{column} {('R', 'G', 'Y', 'B', 'in')[passenger]}→{'RGYB'[destination]}"


def test_driving_is_a_step_on_the_map_and_picking_up_leads_to_another_town():
    world = built("taxi")
    mdp, drawing = world.space, world.drawing
    for pair in range(mdp.pairs):
        here = divmod(drawing.cell_of_state[int(mdp.pair_state[pair])], drawing.columns)
        to = int(mdp.next_state[mdp.outcomes_of(pair)[0]])
        there = divmod(drawing.cell_of_state[to], drawing.columns)
        moved = (there[0] - here[0], there[1] - here[1])
        direction = drawing.directions[int(mdp.pair_action[pair])]
        if direction is not None:
            assert moved in (direction, (0, 0))
        elif moved != (0, 0):
            assert moved[0] % 6 == 0
            assert moved[1] == 0


def test_the_goals_of_taxi_are_where_its_rides_end():
    world = built("taxi")
    ends = {int(state) for state in world.space.next_state[world.space.terminated]}
    assert sorted(world.space.state_names[state] for state in ends) == [
        "0,0 R→R",
        "0,4 G→G",
        "4,0 Y→Y",
        "4,3 B→B",
    ]
    goals = {cell for cell, kind in enumerate(world.drawing.kinds) if kind is GOAL}
    assert goals == {world.drawing.cell_of_state[state] for state in ends}


@pytest.mark.parametrize(
    ("name", "kwargs", "found"),
    [
        ("FrozenLake-v9", {}, 'no environment is registered as "FrozenLake-v9"'),
        ("CartPole-v1", {}, "the states of CartPole-v1 are Box"),
        ("Blackjack-v1", {}, "the states of Blackjack-v1 are Tuple"),
        (
            "FrozenLake-v1",
            {"map_name": "5x5"},
            "FrozenLake-v1 cannot be created with these arguments (KeyError: '5x5')",
        ),
        (
            "FrozenLake-v1",
            {"desc": ["FF", "FG"]},
            "the start of FrozenLake-v1 is not 4 probabilities that sum to 1",
        ),
    ],
)
def test_refuses(name, kwargs, found):
    with pytest.raises(WorldRefusedError) as refusal:
        world_of(name, kwargs)
    assert refusal.value.finding.found.startswith(found)


def test_impossible_chances_are_refused_and_not_stepped():
    section = GymnasiumSection(id="FrozenLake-v1", kwargs={"success_rate": 1.5})
    (finding,) = section.environment_findings()
    assert finding.location == ("kwargs",)
    assert finding.found.startswith(
        "the table of FrozenLake-v1 has an error: a probability of state 0, action 0 is -0.25"
    )


class Counting(gymnasium.Env):
    closed = 0

    def __init__(self, **attributes):
        self.observation_space = self.action_space = Discrete(2)
        for name, value in attributes.items():
            setattr(self, name, value)

    def close(self):
        type(self).closed += 1


START_AT_0 = {"initial_state_distrib": [1.0, 0.0]}
SOUND = (1.0, 0, 0.0, False)


@pytest.fixture
def counting():
    gymnasium.register("Counting-v0", Counting, disable_env_checker=True)
    yield Counting
    del gymnasium.registry["Counting-v0"]


def table_with(*entries):
    """``entries`` are the outcomes of action 0 in state 1."""
    return {s: {a: list(entries) if (s, a) == (1, 0) else [SOUND] for a in (0, 1)} for s in (0, 1)}


@pytest.mark.parametrize(
    ("attributes", "found"),
    [
        ({}, "has no transition table"),
        ({"P": table_with(SOUND)}, "has no initial_state_distrib"),
        (
            {"P": {0: {0: [SOUND], 1: [SOUND]}}, **START_AT_0},
            "state 1, action 0 has no outcome (KeyError: 1)",
        ),
        (
            {"P": {s: {0: [SOUND]} for s in (0, 1)}, **START_AT_0},
            "state 0, action 1 has no outcome (KeyError: 1)",
        ),
        ({"P": [[[SOUND]] * 2], **START_AT_0}, "state 1, action 0 has no outcome (IndexError"),
        ({"P": 7, **START_AT_0}, "state 0, action 0 has no outcome (TypeError"),
        ({"P": table_with(), **START_AT_0}, "state 1, action 0 has no outcome"),
        (
            {"P": table_with((1.0, 0, 0.0)), **START_AT_0},
            "state 1, action 0 is (1.0, 0, 0.0), not (probability",
        ),
        ({"P": table_with(None), **START_AT_0}, "state 1, action 0 is None, not (probability"),
    ],
)
def test_what_has_no_whole_table_is_left_to_be_stepped(counting, attributes, found):
    before = counting.closed
    with pytest.raises(NoTableError) as refusal:
        world_of("Counting-v0", attributes)
    assert "Counting-v0 has " in refusal.value.finding.found
    assert found in refusal.value.finding.found
    assert counting.closed == before + 1


@pytest.mark.parametrize(
    ("entries", "what", "value", "wanted"),
    [
        ([(np.nan, 0, 0.0, False)], "a probability", "is nan", "not from 0 to 1"),
        ([(np.inf, 0, 0.0, False)], "a probability", "is inf", "not from 0 to 1"),
        ([(-0.5, 0, 0.0, False), (1.5, 1, 0.0, False)], "a probability", "is -0.5", "not from 0 to 1"),
        ([("1", 0, 0.0, False)], "a probability", "is '1'", "not from 0 to 1"),
        ([(0.5, 0, 0.0, False)], "the probabilities", "sum to 0.5", "not to 1"),
        ([(0.7, 0, 0.0, False), (0.7, 1, 0.0, False)], "the probabilities", "sum to 1.4", "not to 1"),
        ([(1.0, 2, 0.0, False)], "a next state", "is 2", "not from 0 to 1"),
        ([(1.0, -1, 0.0, False)], "a next state", "is -1", "not from 0 to 1"),
        ([(1.0, 0.5, 0.0, False)], "a next state", "is 0.5", "not from 0 to 1"),
        ([(1.0, np.nan, 0.0, False)], "a next state", "is nan", "not from 0 to 1"),
        ([(1.0, None, 0.0, False)], "a next state", "is None", "not from 0 to 1"),
        ([(1.0, 10**400, 0.0, False)], "a next state", "is 1000", "not from 0 to 1"),
        ([(1.0, 0, np.nan, False)], "a reward", "is nan", "not within ±1e+12"),
        ([(1.0, 0, -np.inf, False)], "a reward", "is -inf", "not within ±1e+12"),
        ([(1.0, 0, 2e12, False)], "a reward", "is 2000000000000.0", "not within ±1e+12"),
        ([(1.0, 0, "a\x1blot", False)], "a reward", "is 'a\\x1blot'", "not within ±1e+12"),
        ([(1.0, 0, 0.0, "no")], "terminated", "is 'no'", "not true or false"),
    ],
)
def test_a_table_that_cannot_be_is_refused_in_one_line(counting, entries, what, value, wanted):
    with pytest.raises(WorldRefusedError) as refusal:
        world_of("Counting-v0", {"P": table_with(*entries), **START_AT_0})
    finding = refusal.value.finding
    assert not isinstance(refusal.value, NoTableError)
    start = f"the table of Counting-v0 has an error: {what} of state 1, action 0 {value}"
    assert finding.found.startswith(start)
    fix = (
        "choose another environment"
        if "reward" in what
        else "simulate it by a scenario file with table = false"
    )
    assert finding.found.endswith(f", {wanted}; {fix}")
    assert not finding.expected
    assert "\n" not in finding.found


def test_numbers_of_numpy_are_numbers(counting):
    entry = (np.float32(1.0), np.float64(1.0), np.array([2]), np.bool_(False))
    world = world_of("Counting-v0", {"P": table_with(entry), "initial_state_distrib": [0.0, 1.0]})
    assert world.space.reward.max() == 2.0


@pytest.mark.parametrize(
    "start", [[np.nan, 1.0], [-1.0, 2.0], [0.5, 0.0], [1.0], [[1.0, 0.0]], [np.inf, 0.0]]
)
def test_a_start_that_cannot_be_is_refused(counting, start):
    with pytest.raises(WorldRefusedError, match="the start of Counting-v0 is not 2 probab"):
        world_of("Counting-v0", {"P": table_with(SOUND), "initial_state_distrib": start})


def test_what_cannot_be_made_without_arguments_is_said_of_the_id():
    def broken():
        raise ImportError("no jax here")

    gymnasium.register("Broken-v0", broken)
    try:
        with pytest.raises(WorldRefusedError) as refusal:
            world_of("Broken-v0", {})
    finally:
        del gymnasium.registry["Broken-v0"]
    assert refusal.value.finding.location == ("id",)
    assert refusal.value.finding.found == (
        "Broken-v0 cannot be created here (ImportError: no jax here); choose another environment"
    )


class Tabled(Counting):
    P: ClassVar = {s: {a: [(1.0, (s + 1) % 7, 0.0, s == 6)] for a in (0, 1)} for s in range(7)}
    initial_state_distrib = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    def __init__(self):
        super().__init__()
        self.observation_space = Discrete(7)
