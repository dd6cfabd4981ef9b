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
    """No readable entries for a pair."""


class UnsoundTableError(NoEntriesError):
    """An entry out of range. The environment may still be simulated."""


class UnusableRewardError(UnsoundTableError):
    """A reward out of range, which rules out simulation too."""


def read_entries(table: Any, state: int, action: int, states: int) -> list[Outcome]:
    """Return the outcomes in ``table[state][action]``, checked.

    Probabilities must be at least 0 and sum to 1 (±1e-9). Rewards must lie within ±1e12.

    Raises:
        NoEntriesError: Entries are missing or have another form.
        UnsoundTableError: A value is out of range.
    """
    where = f"state {state}, action {action}"
    try:
        listed = list(table[state][action])
    except Exception as error:  # a table may run the environment's code
        raise NoEntriesError(f"{where} has no outcome ({reason_of(error)})") from error
    if not listed:
        raise NoEntriesError(f"{where} has no outcome")
    entries = [_entry(each, where, states) for each in listed]
    total = math.fsum(entry.probability for entry in entries)
    if not abs(total - 1.0) <= PROBABILITY_TOLERANCE:
        raise UnsoundTableError(f"the probabilities of {where} sum to {total:.12g}, not to 1")
    return entries


def _entry(listed: Any, where: str, states: int) -> Outcome:
    try:
        probability, next_state, reward, terminated = listed
    except Exception as error:  # unpacking a foreign object may raise anything
        raise NoEntriesError(f"an outcome of {where} is {seen(listed)}, not {_FORM}") from error
    chance = number_of(probability)
    if not 0.0 <= chance <= 1.0 + PROBABILITY_TOLERANCE:
        raise UnsoundTableError(f"a probability of {where} is {seen(probability)}, not from 0 to 1")
    place = number_of(next_state)
    if not 0 <= place < states or place != int(place):
        raise UnsoundTableError(f"a next state of {where} is {seen(next_state)}, not from 0 to {states - 1}")
    earned = number_of(reward)
    if not abs(earned) <= LARGEST_NUMBER:
        found = f"a reward of {where} is {seen(reward)}, not within ±{LARGEST_NUMBER:g}"
        raise UnusableRewardError(found)
    try:
        ends = truth_of(terminated, "terminated")
    except UnsoundResultError as error:
        found = f"terminated of {where} is {seen(terminated)}, not true or false"
        raise UnsoundTableError(found) from error
    return Outcome(chance, int(place), earned, ends)


# The world


_OR_STEPPED: Final = "; simulate it by a scenario file with table = false"


class NoTableError(WorldRefusedError):
    """The environment has no readable transition table, but may be sound."""


def world_of(name: str, kwargs: Mapping[str, Any], *, computed: bool = False) -> World:
    """Return the world of a registered environment with a transition table.

    States are named "0", "1", … unless better names are known. `computed` accepts tables computed here from
    the rules (Blackjack).

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
        fix = "; choose another environment" if isinstance(fault, UnusableRewardError) else _OR_STEPPED
        raise WorldRefusedError((place,), f"the table of {name} has an error: {fault}{fix}") from fault
    except NoEntriesError as fault:
        raise NoTableError(("id",), f"the table of {name} has an error: {fault}{_OR_STEPPED}") from fault
    except ValueError as fault:
        found = f"the table of {name} has an error: {one_line(str(fault), 200)}{_OR_STEPPED}"
        raise WorldRefusedError((place,), found) from fault
    return World(mdp, layout.grid)


def _sizes(name: str, environment: Env[Any, Any]) -> tuple[int, int]:
    from gymnasium.spaces import Discrete

    sizes = []
    for what, space in (("states", environment.observation_space), ("actions", environment.action_space)):
        if not isinstance(space, Discrete) or space.start != 0:
            found = f"the {what} of {name} are {type(space).__name__}, not discrete and counted from 0"
            raise NoTableError(("id",), f"{found}{_OR_STEPPED}")
        sizes.append(int(space.n))
    return sizes[0], sizes[1]


def _table(name: str, environment: Env[Any, Any]) -> Any:
    table = getattr(environment.unwrapped, "P", None)
    if table is None:
        raise NoTableError(("id",), f"{name} has no transition table{_OR_STEPPED}")
    return table


def _start(name: str, environment: Env[Any, Any], states: int, place: str) -> dict[int, float]:
    distribution = getattr(environment.unwrapped, "initial_state_distrib", None)
    if distribution is None:
        raise NoTableError(("id",), f"{name} has no initial_state_distrib{_OR_STEPPED}")
    start = np.asarray(distribution, dtype=np.float64)
    sound = start.shape == (states,) and bool(np.all(start >= 0.0))
    if not sound or not abs(start.sum() - 1.0) <= PROBABILITY_TOLERANCE:
        found = f"the start of {name} is not {states:,} probabilities that sum to 1{_OR_STEPPED}"
        raise WorldRefusedError((place,), found)
    return {state: float(probability) for state, probability in enumerate(start) if probability > 0.0}


def _outcomes(table: Any, layout: Layout, state: int, action: int) -> list[Outcome]:
    # Equal outcomes are not merged
    entries = read_entries(table, state, action, len(layout.state_names))
    return [
        entry._replace(action=layout.happened(state, action, number, len(entries), entry.next_state))
        for number, entry in enumerate(entries)
    ]
