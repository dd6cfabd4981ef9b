"""The worlds that are chains."""

from __future__ import annotations

import pytest

from rl_tui.worlds.sections.chain import Move, chain_order


def walk(action: str = "walk", states: int = 5) -> list[Move]:
    row = [states - 2, *range(states - 2), states - 1]
    return [
        Move(row[place], action, {row[place - 1]: 0.5, row[place + 1]: 0.5}) for place in range(1, states - 1)
    ]


def choices(states: int = 5) -> list[Move]:
    return [
        Move(state, action, {state - 1: 0.9 - 0.8 * goes_right, state + 1: 0.1 + 0.8 * goes_right})
        for state in range(1, states - 1)
        for action, goes_right in (("left", 0), ("right", 1))
    ]


def test_a_single_action_makes_a_chain_that_begins_with_the_smaller_end() -> None:
    assert chain_order(5, walk(), {}) == (3, 0, 1, 2, 4)


def test_the_end_further_left_in_the_file_is_on_the_left() -> None:
    assert chain_order(5, walk(), {4: (0, 0), 3: (7, 0)}) == (4, 2, 1, 0, 3)


def test_right_leads_to_the_right() -> None:
    assert chain_order(5, choices(), {0: (9, 0), 4: (0, 0)}) == (0, 1, 2, 3, 4)


def test_a_chain_needs_no_terminal_states_and_may_stay_where_it_is() -> None:
    moves = [Move(s, "right", {min(s + 1, 3): 0.6, s: 0.4}) for s in range(4)]
    moves += [Move(s, "left", {max(s - 1, 0): 1.0}) for s in range(4)]
    assert chain_order(4, moves, {}) == (0, 1, 2, 3)


@pytest.mark.parametrize(
    "moves",
    [
        [*walk(), Move(0, "rest", {0: 1.0})],  # a row of boxes has no space for names
        [*walk(), Move(0, "walk", {2: 1.0})],
        [*walk(), Move(3, "walk", {4: 1.0})],
        [Move(0, "walk", {3: 1.0}), Move(1, "walk", {2: 1.0}), Move(2, "walk", {4: 1.0})],
    ],
    ids=["other names", "a jump", "a ring", "two parts"],
)
def test_other_worlds_are_no_chains(moves: list[Move]) -> None:
    assert chain_order(5, moves, {}) == ()


def test_two_states_are_no_chain() -> None:
    assert chain_order(2, [Move(0, "walk", {1: 1.0})], {}) == ()
