"""What the arrays of a finite MDP must satisfy for everything built on them to be right."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rl_tui.worlds.mdp.number_names import NumberNames
from rl_tui.worlds.mdp.tolerance import PROBABILITY_TOLERANCE

if TYPE_CHECKING:
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def check_consistency(mdp: TabularMDP) -> None:
    """Raise ValueError, naming the array and the first bad index, unless ``mdp`` is a sound finite MDP."""
    _check_shapes(mdp)
    _check_pairs(mdp)
    _check_outcomes(mdp)
    _check_distributions(mdp)
    _check_start(mdp)
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
        # numbers that rise are all different, without making a text of each
        if not isinstance(names, NumberNames) and len(set(names)) != len(names):
            raise ValueError(f"{kind}_names: expected no name twice")


def _check_array(name: str, array: npt.NDArray[Any], length: int, kind: type[np.generic]) -> None:
    if array.dtype != kind or array.shape != (length,):
        raise ValueError(
            f"{name} is {array.dtype} of shape {array.shape}; expected {np.dtype(kind)} of shape ({length},)"
        )


def _check_pairs(mdp: TabularMDP) -> None:
    first = mdp.first_pair
    if first[0] != 0 or first[-1] != mdp.pairs:
        raise ValueError(f"first_pair: expected to go from 0 to {mdp.pairs}")
    _require(np.diff(first) >= 0, "first_pair", "offsets that never fall")
    action = mdp.pair_action
    _require((action >= 0) & (action < len(mdp.action_names)), "pair_action", "an action that has a name")
    rises, same_state = np.diff(action) > 0, np.diff(mdp.pair_state) == 0
    _require(rises | ~same_state, "pair_action", "the actions of a state in order, none twice")


def _check_outcomes(mdp: TabularMDP) -> None:
    first, count = mdp.first_outcome, len(mdp.next_state)
    if first[0] != 0 or first[-1] != count:
        raise ValueError(f"first_outcome: expected to go from 0 to {count}")
    _require(np.diff(first) > 0, "first_outcome", "at least one outcome in every pair")
    _require((mdp.next_state >= 0) & (mdp.next_state < mdp.states), "next_state", "a state that has a name")
    action = mdp.outcome_action
    _require((action >= -1) & (action < len(mdp.action_names)), "outcome_action", "an action, or -1")
    _require(mdp.reward_std >= 0.0, "reward_std", "0 or more")
    goes_on = (np.diff(mdp.first_pair) > 0)[mdp.next_state]
    _require(mdp.terminated | goes_on, "terminated", "true, as nothing can be done in the next state")


def _check_distributions(mdp: TabularMDP) -> None:
    _require(mdp.probability > 0.0, "probability", "more than 0")
    first = mdp.first_outcome
    if mdp.pairs:
        total = np.add.reduceat(mdp.probability, first[:-1])
        total -= 1.0
        _require(
            np.abs(total, out=total) <= PROBABILITY_TOLERANCE, "first_outcome", "probabilities that sum to 1"
        )
    _require(mdp.cumulative[first[1:] - 1] == 1.0, "first_outcome", "a last cumulative of exactly 1")
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


def _check_start(mdp: TabularMDP) -> None:
    state, cumulative = mdp.start_state, mdp.start_cumulative
    if not len(state):
        raise ValueError("start_state: expected at least one state")
    _require((state >= 0) & (state < mdp.states), "start_state", "a state that has a name")
    if len(set(state.tolist())) != len(state):  # np.unique would import numpy.ma
        raise ValueError("start_state: expected no state twice")
    _require(np.diff(mdp.first_pair)[state] > 0, "start_state", "a state in which something can be done")
    if cumulative[-1] != 1.0:
        raise ValueError("start_cumulative: expected to end at exactly 1")
    _require(np.diff(cumulative, prepend=0.0) >= 0.0, "start_cumulative", "a rising sum of probabilities")
