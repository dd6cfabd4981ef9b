"""The finite Markov decision process as flat arrays (Sutton & Barto, 2nd ed., section 3.1)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.worlds.mdp.reachable import reachable
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray, IntArray, NumberNames

PROBABILITY_TOLERANCE: Final = 1e-9
"""Largest deviation from 1 of a sum of probabilities."""


# What the arrays must satisfy for all that is built on them


def check_consistency(mdp: TabularMDP) -> None:
    """Raise ValueError for an unsound MDP, with the array and the first bad index."""
    _check_shapes(mdp)
    _check_pairs(mdp)
    _check_outcomes(mdp)
    _check_distributions(mdp)
    _check_start_states(mdp)
    if mdp.time_limit < 0:
        raise ValueError(f"time_limit is {mdp.time_limit}; expected 0 or more")


def _require(holds: npt.NDArray[np.bool_], array: str, expected: str) -> None:
    if not holds.all():
        raise ValueError(f"{array}[{int(np.argmin(holds))}]: expected {expected}")


def _check_shapes(mdp: TabularMDP) -> None:
    pairs, outcomes, starts = len(mdp.pair_action), len(mdp.next_state), len(mdp.start_state)
    integers: Mapping[str, int] = {
        "first_pair": mdp.states + 1,
        "pair_action": pairs,
        "first_outcome": pairs + 1,
        "next_state": outcomes,
        "outcome_action": outcomes,
        "start_state": starts,
    }
    numbers: Mapping[str, int] = {
        "reward": outcomes,
        "reward_std": outcomes,
        "probability": outcomes,
        "cumulative": outcomes,
        "start_cumulative": starts,
    }
    for name, length in integers.items():
        _check_array(name, getattr(mdp, name), length, np.int64)
    for name, length in numbers.items():
        _check_array(name, getattr(mdp, name), length, np.float64)
        _require(np.isfinite(getattr(mdp, name)), name, "a finite number")
    _check_array("terminated", mdp.terminated, outcomes, np.bool_)
    for kind, names in {"state": mdp.state_names, "action": mdp.action_names}.items():
        # rising numbers are distinct, so no texts need to be made
        if not isinstance(names, NumberNames) and len(set(names)) != len(names):
            raise ValueError(f"{kind}_names: a name is listed twice; expected distinct names")


def _check_array(name: str, array: npt.NDArray[Any], length: int, kind: type[np.generic]) -> None:
    if array.dtype != kind or array.shape != (length,):
        raise ValueError(
            f"{name} is {array.dtype} of shape {array.shape}; expected {np.dtype(kind)} of shape ({length},)"
        )


def _check_pairs(mdp: TabularMDP) -> None:
    first = mdp.first_pair
    if first[0] != 0 or first[-1] != mdp.pairs:
        raise ValueError(f"first_pair: expected 0 as the first and {mdp.pairs} as the last")
    _require(np.diff(first) >= 0, "first_pair", "offsets that do not decrease")
    action = mdp.pair_action
    _require((action >= 0) & (action < len(mdp.action_names)), "pair_action", "the index of an action")
    rises, same_state = np.diff(action) > 0, np.diff(mdp.pair_state) == 0
    _require(rises | ~same_state, "pair_action", "the actions of a state in increasing order")


def _check_outcomes(mdp: TabularMDP) -> None:
    first, count = mdp.first_outcome, len(mdp.next_state)
    if first[0] != 0 or first[-1] != count:
        raise ValueError(f"first_outcome: expected 0 as the first and {count} as the last")
    _require(np.diff(first) > 0, "first_outcome", "at least one outcome in every pair")
    _require((mdp.next_state >= 0) & (mdp.next_state < mdp.states), "next_state", "the index of a state")
    action = mdp.outcome_action
    _require((action >= -1) & (action < len(mdp.action_names)), "outcome_action", "an action, or -1")
    _require(mdp.reward_std >= 0.0, "reward_std", "0 or more")
    goes_on = (np.diff(mdp.first_pair) > 0)[mdp.next_state]
    _require(mdp.terminated | goes_on, "terminated", "true, because the next state has no actions")


def _check_distributions(mdp: TabularMDP) -> None:
    _require(mdp.probability > 0.0, "probability", "more than 0")
    first = mdp.first_outcome
    if mdp.pairs:
        total = np.add.reduceat(mdp.probability, first[:-1])
        total -= 1.0
        _require(
            np.abs(total, out=total) <= PROBABILITY_TOLERANCE, "first_outcome", "probabilities that sum to 1"
        )
    _require(
        mdp.cumulative[first[1:] - 1] == 1.0,
        "first_outcome",
        "cumulative probabilities that end at exactly 1",
    )
    step = mdp.cumulative.copy()
    step[1:] -= mdp.cumulative[:-1]
    step[first[1:-1]] = mdp.cumulative[first[1:-1]]
    rises = step >= 0.0
    step -= mdp.probability
    _require(
        rises & (np.abs(step, out=step) <= 2 * PROBABILITY_TOLERANCE),
        "cumulative",
        "the running sum of the probabilities inside the pair",
    )


def _check_start_states(mdp: TabularMDP) -> None:
    state, cumulative = mdp.start_state, mdp.start_cumulative
    if not len(state):
        raise ValueError("start_state: expected at least one state")
    _require((state >= 0) & (state < mdp.states), "start_state", "the index of a state")
    if len(set(state.tolist())) != len(state):  # np.unique would import numpy.ma
        raise ValueError("start_state: a state is listed twice; expected distinct states")
    _require(np.diff(mdp.first_pair)[state] > 0, "start_state", "a state with actions")
    if cumulative[-1] != 1.0:
        raise ValueError("start_cumulative: expected 1 as the last")
    _require(np.diff(cumulative, prepend=0.0) >= 0.0, "start_cumulative", "sums that do not decrease")


UNKNOWN_ACTION = -1


class Outcome(NamedTuple):
    """One possible outcome of a pair.

    Args:
        reward: Mean reward.
        terminated: True if the episode ends here.
        reward_std: Standard deviation of Gaussian noise.
        action: Action that really happened; −1: unknown.
    """

    probability: float
    next_state: int
    reward: float
    terminated: bool
    reward_std: float = 0.0
    action: int = UNKNOWN_ACTION


@dataclass(frozen=True, slots=True, eq=False)
class TabularMDP(FiniteSpace):
    """S states, A named actions, P available state–action pairs and O outcomes, as immutable arrays.

    State s owns the pairs first_pair[s] .. first_pair[s+1], in the order of their actions. Pair p owns the
    outcomes first_outcome[p] .. first_outcome[p+1], at least one. A state without pairs is terminal or cannot
    be reached, and every outcome into it is terminated. See also :func:`tabular_mdp`.

        ========================  =========  ==========================================================
        first_pair                [S+1]      pair_action     [P]    which of the A actions this pair is
        first_outcome             [P+1]      probability     [O]    for solvers
        next_state                [O]        cumulative      [O]    inside the pair; the last is exactly 1
        reward, reward_std        [O]        terminated      [O]    no bootstrapping past it
        outcome_action            [O]        the action that really happened; −1: not known
        start_state               [K]        start_cumulative [K]   cumulative start distribution
        ========================  =========  ==========================================================

    With a `drift_std` above 0 the world is not stationary. After every step the rewards of each pair move
    together by a draw from N(0, drift_std²). The initial value is `reward`.

    Raises:
        ValueError: The arrays contradict each other or are out of range.
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
        # a separately unpickled array would be writable
        return TabularMDP, tuple(getattr(self, each.name) for each in fields(self))

    @property
    def outcome_pair(self) -> IntArray:
        """Pair of each outcome, [O]."""
        return np.repeat(np.arange(self.pairs), np.diff(self.first_outcome))

    @property
    def expected_reward(self) -> FloatArray:
        """Expected reward of each pair, [P]."""
        expected: FloatArray = np.add.reduceat(self.probability * self.reward, self.first_outcome[:-1])
        return expected

    @property
    def start_probability(self) -> FloatArray:
        """Probability of each of `start_state`, [K]."""
        return np.diff(self.start_cumulative, prepend=0.0)

    def average_at_start(self, values: npt.NDArray[np.floating]) -> float:
        """Return the mean of state values, [S] or more, at the start."""
        # Added in sequence, as a kernel does; numpy's dot product uses another order
        return float(np.cumsum(self.start_probability * values[self.start_state])[-1])

    def outcomes_of(self, pair: int) -> range:
        """Return the outcomes of `pair`."""
        return range(int(self.first_outcome[pair]), int(self.first_outcome[pair + 1]))


class Transition(NamedTuple):
    """The outcomes of one pair, for :func:`tabular_mdp`."""

    state: int
    action: int
    outcomes: Sequence[Outcome]


class TransitionArrays(NamedTuple):
    """All outcomes of P pairs, for :func:`mdp_of_arrays`.

    Pairs are sorted by state, then by action. Pair p owns ``outcome_count[p]`` of the O outcomes. The other
    arrays are as in :class:`TabularMDP`.
    """

    pair_state: IntArray
    pair_action: IntArray
    outcome_count: IntArray
    probability: FloatArray
    next_state: IntArray
    reward: FloatArray
    reward_std: FloatArray
    terminated: BoolArray
    outcome_action: IntArray


def tabular_mdp(
    state_names: Sequence[str],
    action_names: Sequence[str],
    transitions: Iterable[Transition],
    start: Mapping[int, float],
    time_limit: int = 0,
) -> TabularMDP:
    """Make an MDP from transitions in any order, keeping only pairs of live states.

    Live states can be reached from the start through outcomes that do not terminate. Every outcome into a
    state without pairs is marked as terminated. Equal outcomes are not merged.

    Raises:
        ValueError: A value is out of range, probabilities do not sum to 1 (±1e-9), a pair is given twice, or
            a start state has no actions.
    """
    by_state = _pairs_by_state(len(state_names), len(action_names), transitions)
    _check_distribution("start", list(start.values()))
    pairs = [
        Transition(state, action, outcomes)
        for state, actions in enumerate(by_state)
        for action, outcomes in sorted(actions.items())
    ]
    outcomes = [outcome for pair in pairs for outcome in pair.outcomes]
    possible = {state: probability for state, probability in start.items() if probability > 0.0}
    return mdp_of_arrays(
        tuple(state_names),
        tuple(action_names),
        TransitionArrays(
            pair_state=np.array([pair.state for pair in pairs], dtype=np.int64),
            pair_action=np.array([pair.action for pair in pairs], dtype=np.int64),
            outcome_count=np.array([len(pair.outcomes) for pair in pairs], dtype=np.int64),
            probability=np.array([outcome.probability for outcome in outcomes], dtype=np.float64),
            next_state=np.array([outcome.next_state for outcome in outcomes], dtype=np.int64),
            reward=np.array([outcome.reward for outcome in outcomes], dtype=np.float64),
            reward_std=np.array([outcome.reward_std for outcome in outcomes], dtype=np.float64),
            terminated=np.array([outcome.terminated for outcome in outcomes], dtype=np.bool_),
            outcome_action=np.array([outcome.action for outcome in outcomes], dtype=np.int64),
        ),
        np.array(list(possible), dtype=np.int64),
        np.array(list(possible.values()), dtype=np.float64),
        time_limit,
    )


def mdp_of_arrays(
    state_names: Sequence[str],
    action_names: tuple[str, ...],
    arrays: TransitionArrays,
    start_state: IntArray,
    start_probability: FloatArray,
    time_limit: int = 0,
    *,
    is_live: bool = False,
) -> TabularMDP:
    """Make an MDP from arrays, like :func:`tabular_mdp`, but with few NumPy passes.

    The MDP keeps the arrays where possible, so do not write to them afterwards. Starts are [K]. All pairs
    belong to live states if `is_live`.

    Raises:
        ValueError: A start state has no actions, or the arrays contradict each other.
    """
    states = len(state_names)
    owned = np.bincount(arrays.pair_state, minlength=states)
    _check_start(start_state, owned)
    if not is_live:
        live = _live_states(arrays, owned, start_state)
        alive = live[arrays.pair_state]
        if not alive.all():
            arrays = _only(arrays, alive)
            owned = np.where(live, owned, 0)
        np.logical_or(arrays.terminated, ~live[arrays.next_state], out=arrays.terminated)
    first_outcome = _offsets(arrays.outcome_count)
    for array in arrays:
        array.flags.writeable = False
    return TabularMDP(
        state_names=state_names,
        action_names=action_names,
        first_pair=_offsets(owned),
        pair_action=arrays.pair_action,
        first_outcome=first_outcome,
        next_state=arrays.next_state,
        reward=arrays.reward,
        reward_std=arrays.reward_std,
        terminated=arrays.terminated,
        outcome_action=arrays.outcome_action,
        probability=arrays.probability,
        cumulative=cumulative_inside(arrays.probability, first_outcome),
        start_state=start_state,
        start_cumulative=cumulative_inside(start_probability, np.array([0, len(start_probability)])),
        time_limit=time_limit,
    )


def cumulative_inside(probability: FloatArray, first_outcome: IntArray) -> FloatArray:
    """Return read-only running sums of probabilities inside each pair, [O].

    They restart in every pair, never exceed 1, and end at exactly 1 despite rounding.
    """
    result = probability.copy()
    length = np.diff(first_outcome)
    longest = int(length.max(initial=0))
    if len(result) == longest * len(length):
        # with equal counts the pairs form rows, without index lookups
        rows = result.reshape(len(length), longest)
        for place in range(1, longest):
            rows[:, place] += rows[:, place - 1]
    else:
        for place in range(1, longest):
            here = first_outcome[:-1][length > place] + place
            result[here] += result[here - 1]
    np.minimum(result, 1.0, out=result)
    result[first_outcome[1:] - 1] = 1.0
    result.flags.writeable = False
    return result


def _offsets(count: IntArray) -> IntArray:
    offsets = np.zeros(len(count) + 1, dtype=np.int64)
    np.cumsum(count, out=offsets[1:])
    offsets.flags.writeable = False
    return offsets


def _check_start(start_state: IntArray, owned: IntArray) -> None:
    known = (start_state >= 0) & (start_state < len(owned))
    idle = ~known
    idle[known] = owned[start_state[known]] == 0
    if idle.any():
        raise ValueError(f"start: state {start_state[np.argmax(idle)]} has no actions")


def _live_states(arrays: TransitionArrays, owned: IntArray, start_state: IntArray) -> BoolArray:
    goes_on = ~arrays.terminated
    goes_on &= (owned > 0)[arrays.next_state]
    # the first outcome of each state, and the number of continuing outcomes before it
    first = _offsets(arrays.outcome_count)[_offsets(owned)]
    first_edge = np.where(first > 0, np.cumsum(goes_on)[first - 1], 0)
    return reachable(first_edge, arrays.next_state[goes_on], start_state)


def _only(arrays: TransitionArrays, kept: BoolArray) -> TransitionArrays:
    outcomes = np.repeat(kept, arrays.outcome_count)
    pairs = ("pair_state", "pair_action", "outcome_count")
    return TransitionArrays(
        **{name: array[kept if name in pairs else outcomes] for name, array in arrays._asdict().items()}
    )


def _pairs_by_state(
    states: int, actions: int, transitions: Iterable[Transition]
) -> list[dict[int, list[Outcome]]]:
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
    # "not p >= 0" also catches NaN
    if any(not probability >= 0.0 for probability in probabilities):
        raise ValueError(f"{where}: expected probabilities of at least 0")
    if not abs(math.fsum(probabilities) - 1.0) <= PROBABILITY_TOLERANCE:
        raise ValueError(f"{where}: probabilities sum to {math.fsum(probabilities)}, not to 1")


def smallest_mdp() -> TabularMDP:
    """Return a world with one state and two actions that end the episode."""
    transitions = [Transition(0, action, [Outcome(1.0, 0, 0.0, terminated=True)]) for action in (0, 1)]
    return tabular_mdp(["here"], ["one", "other"], transitions, {0: 1.0})
