"""The finite Markov decision process in flat arrays (Sutton & Barto, 2nd ed., section 3.1)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from rl_tui.worlds.consistency import check_consistency
from rl_tui.worlds.space import BoolArray, FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.tolerance import PROBABILITY_TOLERANCE

__all__ = [
    "UNKNOWN_ACTION",
    "BoolArray",
    "FloatArray",
    "IntArray",
    "Outcome",
    "TabularMDP",
    "Transition",
    "cumulative_inside",
    "tabular_mdp",
]

UNKNOWN_ACTION = -1


class Outcome(NamedTuple):
    """One thing that may happen when a pair (state, action) is taken.

    ``reward`` is its mean and ``reward_std`` the standard deviation of Gaussian noise on it. ``terminated``
    says that the episode ends here. ``action`` is the action that really happened where the world slips, −1
    if not known.
    """

    probability: float
    next_state: int
    reward: float
    terminated: bool
    reward_std: float = 0.0
    action: int = UNKNOWN_ACTION


@dataclass(frozen=True, slots=True, eq=False)
class TabularMDP(FiniteSpace):
    """S states, A named actions, P legal state–action pairs, O outcomes, as arrays that never change.

    State s owns the pairs first_pair[s] .. first_pair[s+1], in the order of their actions; pair p owns the
    outcomes first_outcome[p] .. first_outcome[p+1], at least one. A state that owns no pair is terminal or
    cannot be reached, and every outcome into it is terminated. :func:`tabular_mdp` makes one from a list of
    transitions.

    ========================  =========  ==========================================================
    first_pair                [S+1]      pair_action     [P]    which of the A actions this pair is
    first_outcome             [P+1]      probability     [O]    for solvers
    next_state                [O]        cumulative      [O]    inside the pair; the last is exactly 1
    reward, reward_std        [O]        terminated      [O]    no bootstrapping past it
    outcome_action            [O]        the action that really happened; −1: not known
    start_state               [K]        start_cumulative [K]   cumulative start distribution
    ========================  =========  ==========================================================

    ``time_limit`` is the number of steps after which an episode is truncated (0: none). With a ``drift_std``
    above 0 the world is not stationary: after every step the rewards of each pair move together by a draw
    from N(0, drift_std²); ``reward`` is where they start. Raises ValueError where the arrays contradict each
    other or leave their ranges.
    """

    first_outcome: IntArray
    next_state: IntArray
    reward: FloatArray
    reward_std: FloatArray
    terminated: BoolArray
    outcome_action: IntArray
    probability: FloatArray
    cumulative: FloatArray
    start_state: IntArray
    start_cumulative: FloatArray
    drift_std: float = 0.0

    def __post_init__(self) -> None:
        FiniteSpace.__post_init__(self)
        check_consistency(self)

    def __reduce__(self) -> tuple[type[TabularMDP], tuple[object, ...]]:
        # an array unpickled by itself would come back writable
        return TabularMDP, tuple(getattr(self, each.name) for each in fields(self))

    @property
    def outcome_pair(self) -> IntArray:
        """The pair of each outcome, [O]."""
        return np.repeat(np.arange(self.pairs), np.diff(self.first_outcome))

    @property
    def start_probability(self) -> FloatArray:
        """The probability of each of ``start_state``, [K]."""
        return np.diff(self.start_cumulative, prepend=0.0)

    def outcomes_of(self, pair: int) -> range:
        """Return the outcomes that ``pair`` owns."""
        return range(int(self.first_outcome[pair]), int(self.first_outcome[pair + 1]))


class Transition(NamedTuple):
    """The outcomes of one pair, as :func:`tabular_mdp` takes them."""

    state: int
    action: int
    outcomes: Sequence[Outcome]


def tabular_mdp(
    state_names: Sequence[str],
    action_names: Sequence[str],
    transitions: Iterable[Transition],
    start: Mapping[int, float],
    time_limit: int = 0,
) -> TabularMDP:
    """Make the MDP of these transitions, keeping the pairs of live states only.

    Live are the states that can be reached from ``start`` (state → probability) through outcomes that do not
    terminate. Every outcome into a state without pairs is marked as terminated. Outcomes that land alike stay
    apart.

    Raises ValueError where a probability, reward, state or action is out of its range, probabilities do not
    sum to 1 (±1e-9), a pair is given twice, or nothing can be done at the start.
    """
    by_state = _pairs_by_state(len(state_names), len(action_names), transitions)
    possible_start = _possible_start(start, by_state)
    live = _live_states(by_state, possible_start)
    pairs: list[list[Outcome]] = []
    first_pair, pair_action = [0], []
    for state, actions in enumerate(by_state):
        if state in live:
            for action, outcomes in sorted(actions.items()):
                pairs.append(outcomes)
                pair_action.append(action)
        first_pair.append(len(pairs))
    outcomes = [outcome for pair in pairs for outcome in pair]
    probability = np.array([outcome.probability for outcome in outcomes], dtype=np.float64)
    first_outcome = np.cumsum([0, *(len(pair) for pair in pairs)], dtype=np.int64)
    start_probability = np.array(list(possible_start.values()), dtype=np.float64)
    return TabularMDP(
        state_names=tuple(state_names),
        action_names=tuple(action_names),
        first_pair=np.array(first_pair, dtype=np.int64),
        pair_action=np.array(pair_action, dtype=np.int64),
        first_outcome=first_outcome,
        next_state=np.array([outcome.next_state for outcome in outcomes], dtype=np.int64),
        reward=np.array([outcome.reward for outcome in outcomes], dtype=np.float64),
        reward_std=np.array([outcome.reward_std for outcome in outcomes], dtype=np.float64),
        terminated=np.array(
            [each.terminated or each.next_state not in live for each in outcomes], dtype=np.bool_
        ),
        outcome_action=np.array([outcome.action for outcome in outcomes], dtype=np.int64),
        probability=probability,
        cumulative=cumulative_inside(probability, first_outcome),
        start_state=np.array(list(possible_start), dtype=np.int64),
        start_cumulative=cumulative_inside(start_probability, np.array([0, len(start_probability)])),
        time_limit=time_limit,
    )


def cumulative_inside(probability: FloatArray, first_outcome: IntArray) -> FloatArray:
    """Return the running sums of ``probability`` inside each pair, as drawing from it needs them.

    They start afresh in every pair, never exceed 1, and the last of a pair is exactly 1, whatever rounding
    did.
    """
    result = probability.copy()
    first, length = first_outcome[:-1], np.diff(first_outcome)
    for place in range(1, int(length.max(initial=0))):
        here = first[length > place] + place
        result[here] += result[here - 1]
    np.minimum(result, 1.0, out=result)
    result[first_outcome[1:] - 1] = 1.0
    return result


def _pairs_by_state(
    states: int, actions: int, transitions: Iterable[Transition]
) -> list[dict[int, list[Outcome]]]:
    """Return state → action → its possible outcomes, each checked."""
    by_state: list[dict[int, list[Outcome]]] = [{} for _ in range(states)]
    for state, action, outcomes in transitions:
        where = f"state {state}, action {action}"
        if not 0 <= state < states or not 0 <= action < actions:
            raise ValueError(
                f"{where}: expected a state in 0..{states - 1} and an action in 0..{actions - 1}"
            )
        if action in by_state[state]:
            raise ValueError(f"{where}: given twice")
        if any(not 0 <= outcome.next_state < states for outcome in outcomes):
            raise ValueError(f"{where}: expected next states in 0..{states - 1}")
        _check_distribution(where, [outcome.probability for outcome in outcomes])
        by_state[state][action] = [outcome for outcome in outcomes if outcome.probability > 0.0]
    return by_state


def _check_distribution(where: str, probabilities: Sequence[float]) -> None:
    # "not p >= 0" also catches NaN, which would otherwise be dropped as if it were 0
    if any(not probability >= 0.0 for probability in probabilities):
        raise ValueError(f"{where}: expected probabilities of at least 0")
    if not abs(math.fsum(probabilities) - 1.0) <= PROBABILITY_TOLERANCE:
        raise ValueError(f"{where}: probabilities sum to {math.fsum(probabilities)}, not to 1")


def _possible_start(start: Mapping[int, float], by_state: Sequence[Mapping[int, object]]) -> dict[int, float]:
    _check_distribution("start", list(start.values()))
    possible = {state: probability for state, probability in start.items() if probability > 0.0}
    for state in possible:
        if not 0 <= state < len(by_state) or not by_state[state]:
            raise ValueError(f"start: nothing can be done in state {state}")
    return possible


def _live_states(by_state: Sequence[Mapping[int, Sequence[Outcome]]], start: Iterable[int]) -> set[int]:
    """Return the states with pairs that can be reached from ``start`` without ending an episode."""
    live = set(start)
    to_visit = list(live)
    while to_visit:
        for outcomes in by_state[to_visit.pop()].values():
            for outcome in outcomes:
                reached = outcome.next_state
                if not outcome.terminated and reached not in live and by_state[reached]:
                    live.add(reached)
                    to_visit.append(reached)
    return live
