"""How often a policy comes to each state within some steps, worked out forwards from the start."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.exact.backward_induction import model_of
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Up to so many states the matrix is dense
MOST_DENSE: Final = 400

Step = Callable[[FloatArray], FloatArray]
"""From where the agent stands, [S] probabilities, to where it does a step later if the episode goes on."""


class _Entries(NamedTuple):
    """The entries of the matrix of a step: how likely it leads from ``source`` to ``target``, [n] each."""

    source: IntArray
    target: IntArray
    chance: FloatArray


def expected_visits(mdp: TabularMDP, policy: FloatArray, steps: int) -> FloatArray:
    """Return in how many of the first ``steps`` steps, on average, each state is where the agent stands, [S].

    One pass serves every sum over an episode: the average of a figure of each state, weighted so, is its
    expected sum. ``policy``, [P], is followed from the start distribution.
    """
    now = np.zeros(mdp.states)
    np.add.at(now, mdp.start_state, mdp.start_probability)
    entries = _entries(mdp, policy)
    if mdp.states > MOST_DENSE:
        return _one_by_one(_sparse(entries, mdp.states), now, steps)
    matrix = _dense(entries, mdp.states)
    if mdp.states * steps.bit_length() < steps:
        return _by_doubling(matrix, now, steps)
    return _one_by_one(matrix.dot, now, steps)


def _one_by_one(step: Step, now: FloatArray, steps: int) -> FloatArray:
    visits = np.zeros_like(now)
    for done in range(steps):
        later = step(now)
        if np.array_equal(later, now):  # what has come to rest, to the last bit, rests for ever
            return visits + (steps - done) * now
        visits += now
        now = later
    return visits


def _by_doubling(matrix: FloatArray, now: FloatArray, steps: int) -> FloatArray:
    """Return (1 + M + M² + …) x of so many terms, in twos: (1 + M) x, and from there on by steps of M²."""
    visits = np.zeros_like(now)
    while steps:
        if steps % 2:
            visits += now
            now = matrix @ now
        now = now + matrix @ now
        matrix = matrix @ matrix
        steps //= 2
    return visits


def _entries(mdp: TabularMDP, policy: FloatArray) -> _Entries:
    chance = policy[mdp.outcome_pair] * model_of(mdp, mdp.reward).weight
    goes_on = np.flatnonzero(chance)
    source = mdp.pair_state[mdp.outcome_pair[goes_on]]
    return _Entries(source, mdp.next_state[goes_on], chance[goes_on])


def _dense(entries: _Entries, size: int) -> FloatArray:
    places = entries.target * size + entries.source
    matrix = np.bincount(places, weights=entries.chance, minlength=size * size)
    return matrix.astype(np.float64).reshape(size, size)


def _sparse(entries: _Entries, size: int) -> Step:
    # scipy takes a quarter of a second to import and most worlds never need it
    from scipy.sparse import csr_matrix

    step: Step = csr_matrix((entries.chance, (entries.target, entries.source)), shape=(size, size)).dot
    return step
