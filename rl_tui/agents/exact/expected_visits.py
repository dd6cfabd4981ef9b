"""How often a policy takes each pair in an episode of limited length, worked out forwards from the start."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from rl_tui.agents.exact.backward_induction import model_of
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Up to so many states the matrix is dense
MOST_DENSE: Final = 400


def expected_visits(mdp: TabularMDP, policy: FloatArray, steps: int) -> FloatArray:
    """Return in how many of the first ``steps`` steps, on average, each state is where the agent stands, [S].

    One pass serves every sum over an episode: an average of a figure of each state, weighted so, is its
    expected sum. ``policy``, [P], is followed from the start distribution.
    """
    step = _step_of(mdp, policy)
    now = np.zeros(mdp.states)
    np.add.at(now, mdp.start_state, mdp.start_probability)
    visits = np.zeros(mdp.states)
    for done in range(steps):
        later = step(now)
        if np.array_equal(later, now):  # what has come to rest, to the last bit, rests for ever
            return visits + (steps - done) * now
        visits += now
        now = later
    return visits


def _step_of(mdp: TabularMDP, policy: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return the function from where the agent stands, [S] probabilities, to where it does a step later."""
    weight = policy[mdp.outcome_pair] * model_of(mdp, mdp.reward).weight
    goes_on = np.flatnonzero(weight)
    source = mdp.pair_state[mdp.outcome_pair[goes_on]]
    target, size = mdp.next_state[goes_on], mdp.states
    if size <= MOST_DENSE:
        places = target * size + source
        matrix = np.bincount(places, weights=weight[goes_on], minlength=size * size).reshape(size, size)
        return lambda now: matrix @ now
    # scipy takes a quarter of a second to import and most worlds never need it
    from scipy.sparse import csr_matrix

    sparse = csr_matrix((weight[goes_on], (target, source)), shape=(size, size))
    step: Callable[[FloatArray], FloatArray] = sparse.dot
    return step
