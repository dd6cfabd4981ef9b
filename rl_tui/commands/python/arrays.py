"""Arrays over available pairs, [P], and over states and actions, [S, A]."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from rl_tui.agents.exact.policy_figures import SUM_TOLERANCE, Choice
from rl_tui.common.errors import UserError
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray


def by_state(space: FiniteSpace, of_pairs: npt.NDArray[Any], otherwise: float = np.nan) -> npt.NDArray[Any]:
    """Return values of pairs, [P], as [S, A], with `otherwise` for unavailable actions."""
    table = np.full((space.states, len(space.action_names)), otherwise, dtype=of_pairs.dtype)
    table[space.pair_state, space.pair_action] = of_pairs
    return table


def numbers(values: Iterable[float | None]) -> FloatArray:
    """Return a float array, with NaN for None."""
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


def choices_in(space: FiniteSpace, policy: npt.ArrayLike) -> Mapping[int, Choice]:
    """Read a policy: one action per state, whole numbers [S], or probabilities [S, A].

    Terminal states are ignored. Returns the probability of each pair, by state.

    Raises:
        UserError: The shape is wrong, an action is not available, or probabilities are negative or do not sum
            to 1 (±1e-9).
    """
    try:
        array = np.asarray(policy)
    except ValueError as fault:  # the rows have different lengths
        raise UserError("the policy is not an array: its rows have different lengths") from fault
    states, actions = space.states, len(space.action_names)
    if array.shape == (states,) and array.dtype.kind in "iu":
        array = array[:, None] == np.arange(actions)[None, :]
    if array.shape != (states, actions) or array.dtype.kind not in "biuf":
        raise UserError(
            f"the policy is an array {list(array.shape)} of {array.dtype}; expected one action "
            f"for each state, [{states}] whole numbers, or probabilities, [{states}, {actions}]"
        )
    chances = np.nan_to_num(array.astype(np.float64), nan=0.0)
    live = (state for state in range(states) if space.pairs_of(state))
    return {state: _choice(space, state, chances[state]) for state in live}


def _choice(space: FiniteSpace, state: int, chances: FloatArray) -> Choice:
    pairs = space.pairs_of(state)
    legal = space.pair_action[pairs.start : pairs.stop]
    here = chances[legal]
    if (chances < 0.0).any() or not abs(here.sum() - 1.0) <= SUM_TOLERANCE or np.delete(chances, legal).any():
        names = ", ".join(space.action_names[action] for action in legal[:10])
        raise UserError(
            f"the policy in state {state} ({space.state_names[state]}): expected an available "
            f"action ({names}), or probabilities of these that sum to 1"
        )
    return dict(zip(pairs, here.tolist(), strict=True))
