"""The transition table ``P`` that an environment of Gymnasium may carry, read and checked entry by entry."""

from __future__ import annotations

import math
from typing import Any, Final

from rl_tui.common.limits import LARGEST_NUMBER
from rl_tui.worlds.gym.env_result import UnsoundResultError, number_of, seen, truth_of
from rl_tui.worlds.gym.registered import reason_of
from rl_tui.worlds.mdp.tabular_mdp import Outcome
from rl_tui.worlds.mdp.tolerance import PROBABILITY_TOLERANCE

_FORM: Final = "(probability, next state, reward, terminated)"


class NoEntriesError(Exception):
    """The table has no readable entry for a pair; ``found`` and ``expected`` say where and what."""

    def __init__(self, found: str, expected: str) -> None:
        super().__init__(found)
        self.found, self.expected = found, expected


class UnsoundTableError(NoEntriesError):
    """An entry of the table is out of range, though the environment may still be stepped."""


class UnusableRewardError(UnsoundTableError):
    """A reward that is unusable in steps too."""


def read_entries(table: Any, state: int, action: int, states: int) -> list[Outcome]:
    """Return the outcomes that ``table[state][action]`` lists, of a world with so many ``states``.

    Probabilities are at least 0 and sum to 1 (±1e-9), rewards lie within ±1e12. Raises NoEntriesError where
    there are none, or they have another form, UnsoundTableError where one of them is out of its range.
    """
    where = f"state {state}, action {action}"
    try:
        listed = list(table[state][action])
    except Exception as error:  # a table is an environment's own code too
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
