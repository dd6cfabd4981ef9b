"""Solving v = b + γ P v by taking one state after the other out of the chain.

Grassmann, Taksar and Heyman (1985), *Regenerative analysis and steady state distributions for Markov chains*:
how likely a state is left is summed from what leaves it and never found as a difference. So nothing cancels,
no pivot has to be looked for, and every factor has nearly all its digits, however near to 0 it is.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.agents.exact.small_worlds.chain import Chain
from rl_tui.agents.kernels.compiled import for_kernels
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

MOST_STEPS: Final = 1e10
"""The expected number of steps, each discounted, up to which a chain is well-conditioned."""
MOST_WORK: Final = 200_000
"""How many products the elimination of a chain may add up: interpreted, they take some tenths of a second."""

SOLVABLE, ENDLESS, UNSUITABLE = range(3)


class Factors(NamedTuple):
    """A chain without its N states, taken out one by one, from the first.

    When state n is taken out, it is left with the weight ``leaving``[n], [N]. The parts ``first``[2n] ..
    ``first``[2n+1] of ``entry`` are the weights of its ways to states that are still there, those up to
    ``first``[2n+2] the shares of n in what the values of such states are made of; ``state`` says which.
    ``steps``, [N], is the expected number of steps, each discounted, from each state. ``matrix``, [N N], has
    the weights while states are taken out, and is 0 before and after.
    """

    matrix: FloatArray
    leaving: FloatArray
    steps: FloatArray
    first: IntArray
    state: npt.NDArray[np.int32]
    entry: FloatArray


def new_factors(states: int) -> Factors:
    """Return the memory for any chain of so many states."""
    return Factors(
        matrix=np.zeros(states * states),
        leaving=np.zeros(states),
        steps=np.zeros(states),
        first=np.zeros(2 * states + 1, dtype=np.int64),
        # Pages that are never written to take no memory
        state=np.empty(states * states, dtype=np.int32),
        entry=np.empty(states * states),
    )


@for_kernels
def eliminate(chain: Chain, gamma: float, unknown: BoolArray, factors: Factors) -> int:
    """Take the ``unknown`` states, [N+1], out of the chain; the values of all others are known.

    ``gamma`` is that of the chain. Returns ``SOLVABLE``; ``ENDLESS``, with no factors, where some states are
    never left (at γ = 1); or ``UNSUITABLE`` where it takes too many steps or too much work.
    """
    states = len(chain.earned)
    matrix, leaving, first = factors.matrix, factors.leaving, factors.first
    _fill(chain, gamma, unknown, factors)
    used, work = 0, 0
    for taken in range(states):
        first[2 * taken] = used
        out = leaving[taken]
        total = out
        for other in range(taken + 1, states):
            weight = matrix[taken * states + other]
            if weight > 0.0:
                matrix[taken * states + other] = 0.0
                factors.state[used], factors.entry[used] = other, weight
                used += 1
                total += weight
        leaving[taken] = total
        upper = used
        first[2 * taken + 1] = upper
        if unknown[taken]:
            if not total > 0.0 or work > MOST_WORK:
                matrix[:] = 0.0
                return UNSUITABLE if total > 0.0 else ENDLESS
            for other in range(taken + 1, states):
                weight = matrix[other * states + taken]
                if weight > 0.0:
                    matrix[other * states + taken] = 0.0
                    share = weight / total
                    factors.state[used], factors.entry[used] = other, share
                    used += 1
                    leaving[other] += share * out
                    for part in range(first[2 * taken], upper):
                        # What comes back to the same state does not leave it
                        if factors.state[part] != other:
                            matrix[other * states + factors.state[part]] += share * factors.entry[part]
                    work += upper - first[2 * taken]
    first[2 * states] = used
    return SOLVABLE if _is_well_conditioned(unknown, factors) else UNSUITABLE


@for_kernels
def _fill(chain: Chain, gamma: float, unknown: BoolArray, factors: Factors) -> None:
    """Set ``matrix`` to the weights of ways between unknown states, ``leaving`` to those of all others."""
    states = len(chain.earned)
    for state in range(states):
        if unknown[state]:
            out = chain.stop[state]
            for way in range(chain.first[state], chain.first[state + 1]):
                target, weight = chain.target[way], gamma * chain.weight[way]
                if target < states and unknown[target]:
                    factors.matrix[state * states + target] += weight
                else:
                    out += weight
            factors.leaving[state] = out


@for_kernels
def _is_well_conditioned(unknown: BoolArray, factors: Factors) -> bool:
    """Find the ``steps`` of the unknown states, and return whether they are few enough."""
    states = len(factors.steps)
    steps, first = factors.steps, factors.first
    for state in range(states):
        steps[state] = 1.0 if unknown[state] else 0.0
    for taken in range(states):
        for part in range(first[2 * taken + 1], first[2 * taken + 2]):
            steps[factors.state[part]] += factors.entry[part] * steps[taken]
    for taken in range(states - 1, -1, -1):
        if unknown[taken]:
            total = steps[taken]
            for part in range(first[2 * taken], first[2 * taken + 1]):
                total += factors.entry[part] * steps[factors.state[part]]
            steps[taken] = total / factors.leaving[taken]
            if not steps[taken] <= MOST_STEPS:
                return False
    return True
