"""Gymnasium environments with a transition table (``P``), as finite MDPs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.common.findings import one_line
from rl_tui.common.limits import LARGEST_NUMBER
from rl_tui.worlds.gym.bins import check_sizes
from rl_tui.worlds.gym.blackjack import blackjack_world, is_blackjack
from rl_tui.worlds.gym.registered import (
    UnsoundResultError,
    looked_at,
    number_of,
    reason_of,
    seen,
    time_limit_of,
    truth_of,
)
from rl_tui.worlds.gym.table_layout import Layout, layout_of
from rl_tui.worlds.mdp.tabular_mdp import PROBABILITY_TOLERANCE, Outcome, Transition, tabular_mdp
from rl_tui.worlds.sections.schema import WorldRefusedError
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from gymnasium import Env


# Reading and checking the table


_FORM: Final = "(probability, next state, reward, terminated)"


class NoEntriesError(Exception):
    """No readable entries for a pair. `found` and `expected` describe the error."""

    def __init__(self, found: str, expected: str) -> None:
        super().__init__(found)
        self.found, self.expected = found, expected


class UnsoundTableError(NoEntriesError):
    """An entry out of range. The environment may still be simulated."""


class UnusableRewardError(UnsoundTableError):
    """A reward out of range, which rules out simulation too."""


def read_entries(table: Any, state: int, action: int, states: int) -> list[Outcome]:
    """Return the outcomes in ``table[state][action]``, checked.

    Probabilities must be at least 0 and sum to 1 (±1e-9). Rewards must lie within ±1e12.

    Args:
        table: The environment's table.
        state: State of the pair.
        action: Action of the pair.
        states: Number of states.

    Raises:
        NoEntriesError: Entries are missing or have another form.
        UnsoundTableError: A value is out of range.
    """
    where = f"state {state}, action {action}"
    try:
        listed = list(table[state][action])
    except Exception as error:  # a table may run the environment's code
        raise NoEntriesError(
            f"nothing for {where} ({reason_of(error)})", "outcomes for every state and action"
        ) from error
    if not listed:
        raise NoEntriesError(f"no outcome for {where}", "outcomes for every state and action")
    entries = [_entry(each, where, states) for each in listed]
    total = math.fsum(entry.probability for entry in entries)
    if not abs(total - 1.0) <= PROBABILITY_TOLERANCE:
        raise UnsoundTableError(f"probabilities that sum to {total:.12g} for {where}", "a sum of 1")
    return entries


def _entry(listed: Any, where: str, states: int) -> Outcome:
    try:
        probability, next_state, reward, terminated = listed
    except Exception as error:  # unpacking a foreign object may raise anything
        raise NoEntriesError(f"{seen(listed)} for {where}", _FORM) from error
    chance = number_of(probability)
    if not 0.0 <= chance <= 1.0 + PROBABILITY_TOLERANCE:
        raise UnsoundTableError(
            f"a probability of {seen(probability)} for {where}", "probabilities from 0 to 1"
        )
    place = number_of(next_state)
    if not 0 <= place < states or place != int(place):
        raise UnsoundTableError(
            f"a next state of {seen(next_state)} for {where}", f"a state from 0 to {states - 1}"
        )
    earned = number_of(reward)
    if not abs(earned) <= LARGEST_NUMBER:
        expected = f"rewards within ±{LARGEST_NUMBER:g}"
        raise UnusableRewardError(f"a reward of {seen(reward)} for {where}", expected)
    try:
        ends = truth_of(terminated, "terminated")
    except UnsoundResultError as error:
        raise UnsoundTableError(f"terminated = {seen(terminated)} for {where}", "true or false") from error
    return Outcome(chance, int(place), earned, ends)


# The world


_OR_STEPPED: Final = "or table = false in a scenario file, which only simulates it"


class NoTableError(WorldRefusedError):
    """The environment has no readable transition table, but may be sound."""


def world_of(name: str, kwargs: Mapping[str, Any], *, computed: bool = False) -> World:
    """Return the world of a registered environment with a transition table.

    States are named "0", "1", … unless better names are known. The time limit is the environment's own.

    Args:
        name: Registered id.
        kwargs: Arguments of the environment.
        computed: True to accept tables computed here from the rules (Blackjack).

    Raises:
        WorldRefusedError: It is not registered, cannot be made, has no start, or its table is contradictory.
        NoTableError: It is not a finite MDP with a readable table.
    """
    place = "kwargs" if kwargs else "id"
    with looked_at(name, kwargs) as environment:
        if computed and is_blackjack(environment.unwrapped):
            return blackjack_world(environment.unwrapped, time_limit_of(environment))
        states, actions = _sizes(name, environment)
        check_sizes(name, states, actions, place)
        table = _table(name, environment)
        start = _start(name, environment, states, place)
        limit = time_limit_of(environment)
        layout = layout_of(environment.unwrapped, states, actions, start)
    try:
        mdp = tabular_mdp(
            list(layout.state_names),
            layout.action_names,
            (
                Transition(state, action, _outcomes(table, layout, state, action))
                for state in range(states)
                for action in range(actions)
            ),
            start,
            limit,
        )
    except UnsoundTableError as fault:
        # not NoTableError, because simulating would hide the contradiction
        found = f"{name}, whose table has {fault.found}"
        stepped = "" if isinstance(fault, UnusableRewardError) else f", {_OR_STEPPED}"
        raise WorldRefusedError((place,), found, f"{fault.expected}{stepped}") from fault
    except NoEntriesError as fault:
        raise NoTableError(("id",), f"{name}, whose table has {fault.found}", fault.expected) from fault
    except ValueError as fault:
        found = f"{name}, in whose table {one_line(str(fault), 200)}"
        raise WorldRefusedError((place,), found, f"a sound transition table, {_OR_STEPPED}") from fault
    return World(mdp, layout.grid)


def _sizes(name: str, environment: Env[Any, Any]) -> tuple[int, int]:
    from gymnasium.spaces import Discrete

    sizes = []
    for what, space in (("states", environment.observation_space), ("actions", environment.action_space)):
        if not isinstance(space, Discrete) or space.start != 0:
            found = f"{name}, whose {what} are {type(space).__name__}"
            raise NoTableError(("id",), found, f"discrete {what}, counted from 0")
        sizes.append(int(space.n))
    return sizes[0], sizes[1]


def _table(name: str, environment: Env[Any, Any]) -> Any:
    table = getattr(environment.unwrapped, "P", None)
    if table is None:
        raise NoTableError(("id",), f"{name}, which has no transition table", "one that has")
    return table


def _start(name: str, environment: Env[Any, Any], states: int, place: str) -> dict[int, float]:
    distribution = getattr(environment.unwrapped, "initial_state_distrib", None)
    if distribution is None:
        raise NoTableError(("id",), f"{name}, which does not report its start", "initial_state_distrib")
    start = np.asarray(distribution, dtype=np.float64)
    sound = start.shape == (states,) and bool(np.all(start >= 0.0))
    if not sound or not abs(start.sum() - 1.0) <= PROBABILITY_TOLERANCE:
        found = f"{name}, a world without a start"
        raise WorldRefusedError((place,), found, f"probabilities to start in the {states} states")
    return {state: float(probability) for state, probability in enumerate(start) if probability > 0.0}


def _outcomes(table: Any, layout: Layout, state: int, action: int) -> list[Outcome]:
    """Return the outcomes of one pair, not merged even if they are equal."""
    entries = read_entries(table, state, action, len(layout.state_names))
    return [
        entry._replace(action=layout.happened(state, action, number, len(entries), entry.next_state))
        for number, entry in enumerate(entries)
    ]
