"""The world of a program, derived from its environment."""

from __future__ import annotations

import numpy as np
import pytest

from rl_tui.common.errors import UserError
from rl_tui.programs.watched.program_log import ProgramEnvironment
from rl_tui.programs.watched.program_world import world_of_program

LAKE = ProgramEnvironment(0, "FrozenLake-v1", {"is_slippery": False, "map_name": "4x4"}, (16,), 4, 100)
BLACKJACK = ProgramEnvironment(0, "Blackjack-v1", {"sab": True, "natural": False}, (32, 11, 2), 2, 0)
TWO_STATES = [[[[1.0, 1, 1.0, True]], [[1.0, 0, 0.0, False]]], [[[1.0, 1, 0.0, True]]] * 2]


def test_an_environment_with_a_table_is_known_by_its_id_and_what_it_was_made_with() -> None:
    found = world_of_program(LAKE)
    mdp = found.world.mdp
    assert (mdp.states, mdp.time_limit) == (16, 100)
    assert len(mdp.next_state) == mdp.pairs  # it does not slip
    table = np.arange(64.0)
    assert found.q_of(table)[found.pair(4, 2, 3)] == 4 * 4 + 2


def test_pairs_and_cells_lead_back_to_one_another() -> None:
    found = world_of_program(LAKE)
    assert list(found.pair_of_cell[found.cell_of_pair]) == list(range(found.world.space.pairs))
    assert found.pair_of_cell[5 * 4] == -1  # a hole


def test_an_absent_entry_of_a_table_counts_as_0() -> None:
    found = world_of_program(LAKE)
    assert not found.q_of(np.full(64, np.nan)).any()


def test_the_time_limit_is_the_programs_own() -> None:
    short = ProgramEnvironment(0, "FrozenLake-v1", {}, (16,), 4, 7)
    endless = ProgramEnvironment(0, "FrozenLake-v1", {}, (16,), 4, -1)
    assert world_of_program(short).world.space.time_limit == 7
    assert world_of_program(endless).world.space.time_limit == 0


def test_in_blackjack_a_natural_is_a_state_of_its_own_that_shares_its_cell() -> None:
    found = world_of_program(BLACKJACK)
    names = found.world.space.state_names
    dealt_21 = int(np.ravel_multi_index((21, 7, 1), (32, 11, 2)))
    natural, drawn = found.state(dealt_21, 0), found.state(dealt_21, 2)
    assert (names[natural], names[drawn]) == ("21, 7, natural", "21, 7, yes")
    cells = found.cell_of_pair
    assert cells[found.pair(dealt_21, 1, 0)] == cells[found.pair(dealt_21, 1, 2)] == dealt_21 * 2 + 1


@pytest.mark.parametrize(("reward", "end"), [(1.0, "won"), (0.0, "drew"), (-1.0, "lost")])
def test_a_game_of_blackjack_ends_in_a_state_that_says_how(reward: float, end: str) -> None:
    found = world_of_program(BLACKJACK)
    bust = int(np.ravel_multi_index((26, 7, 0), (32, 11, 2)))
    assert found.world.space.state_names[found.landing(bust, reward, terminated=True)] == end


def test_the_environment_of_one_of_our_scenarios_is_that_scenario() -> None:
    found = world_of_program(ProgramEnvironment(0, "rl_tui/cliff-v0", {}, (48,), 4, 0))
    assert found.scenario.id == "cliff"
    assert found.world.mdp is not None


def test_a_table_that_only_the_program_has_makes_a_world_with_exact_answers() -> None:
    theirs = ProgramEnvironment(
        0, "Theirs-v0", None, (2,), 2, 9, transitions=TWO_STATES, start=[1.0, 0.0], first_state=(3,)
    )
    mdp = world_of_program(theirs).world.mdp
    assert list(mdp.state_names) == ["3", "4"]
    assert list(mdp.reward) == [1.0, 0.0]


@pytest.mark.parametrize(
    "environment",
    [
        ProgramEnvironment(0, "Nowhere-v0", {}, (3, 2), 2, 5, first_state=(1, 0)),
        ProgramEnvironment(0, "FrozenLake-v1", {"map_name": "none of ours"}, (3, 2), 2, 5),
        ProgramEnvironment(0, "FrozenLake-v1", {}, (3, 2), 2, 5),
        ProgramEnvironment(0, "rl_tui/nothing-v0", {}, (3, 2), 2, 5),
        ProgramEnvironment(0, "os:system", {}, (3, 2), 2, 5),
        ProgramEnvironment(0, "Theirs-v0", None, (3, 2), 2, 5, transitions=[[["junk"]]], start=[1.0]),
    ],
    ids=["unknown", "wrong arguments", "other sizes", "no scenario", "a module", "a faulty table"],
)
def test_what_is_not_known_here_has_states_and_actions_alone(environment: ProgramEnvironment) -> None:
    found = world_of_program(environment)
    space = found.world.space
    assert (space.states, space.pairs, space.time_limit) == (6, 12, 5)
    assert found.world.mdp is None
    assert list(found.pair_of_cell) == list(range(12))


def test_what_is_too_large_to_be_shown_is_refused() -> None:
    with pytest.raises(UserError, match="can be watched"):
        world_of_program(ProgramEnvironment(0, "Huge-v0", {}, (100_000, 100_000), 2, 0))
