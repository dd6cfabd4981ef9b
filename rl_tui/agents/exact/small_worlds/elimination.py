"""Solve v = b + γ P v by eliminating states, then refine the values.

Grassmann, Taksar and Heyman (1985), *Regenerative analysis and steady state distributions for Markov chains*.
The probability to leave a state is summed, never computed as a difference. So nothing cancels, no pivoting is
needed, and all factors are precise even near 0. The residual of equation 4.4 then corrects the last digit.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.agents.exact.small_worlds.chain import Chain
from rl_tui.agents.exact.small_worlds.double_double import plus, quick_two_sum, times, two_sum
from rl_tui.agents.kernels.compiled import for_kernels
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

MOST_STEPS: Final = 1e10
"""Largest expected number of discounted steps of a well-conditioned chain."""
MOST_WORK: Final = 200_000
"""Largest number of products in an elimination. Interpreted, they take some tenths of a second."""

SOLVABLE, ENDLESS, UNSUITABLE = range(3)


class Factors(NamedTuple):
    """The factors of a chain whose N states are eliminated in order.

    State n is left with the weight ``leaving``[n] when it is eliminated. Entries ``first``[2n] ..
    ``first``[2n+1] of `entry` are the weights of its ways to later states, named by `state`. Those up to
    ``first``[2n+2] are the shares of n in later states. The expected number of discounted steps is `steps`,
    [N]. Elimination holds weights in `matrix`, [N N], which is 0 otherwise.
    """

    matrix: FloatArray
    leaving: FloatArray
    steps: FloatArray
    first: IntArray
    state: npt.NDArray[np.int32]
    entry: FloatArray


def new_factors(states: int) -> Factors:
    """Return empty factors."""
    return Factors(
        matrix=np.zeros(states * states),
        leaving=np.zeros(states),
        steps=np.zeros(states),
        first=np.zeros(2 * states + 1, dtype=np.int64),
        # pages that are never written take no memory
        state=np.empty(states * states, dtype=np.int32),
        entry=np.empty(states * states),
    )


@for_kernels
def eliminate(chain: Chain, gamma: float, unknown: BoolArray, factors: Factors) -> int:
    """Eliminate the `unknown` states, [N+1], of the chain into `factors`.

    Returns:
        ``SOLVABLE``, ``ENDLESS`` if some states are never left (γ = 1), or ``UNSUITABLE`` for too many steps
        or too much work.
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
                        # a way back to the same state does not leave it
                        if factors.state[part] != other:
                            matrix[other * states + factors.state[part]] += share * factors.entry[part]
                    work += upper - first[2 * taken]
    first[2 * states] = used
    return SOLVABLE if _is_well_conditioned(unknown, factors) else UNSUITABLE


@for_kernels
def _fill(chain: Chain, gamma: float, unknown: BoolArray, factors: Factors) -> None:
    # Weights between unknown states go to `matrix`, all others to `leaving`
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
    # Computes `steps`. Few of them mean that rounding does no harm
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


# Refinement


# normally two or three are enough, about ten for a badly conditioned chain
_MOST_ROUNDS: Final = 20
# relative to the largest value; below it a double has no digits
_NEGLIGIBLE: Final = 2.0**-64


class Unknowns(NamedTuple):
    """Values of N live states as `value` + `rest`, and their residual, [N] each.

    Unmarked values are 0: `unknown` marks values to find, `undefined` missing ones, [N+1] each, with the end
    last. Scratch memory is `pays`, [N+1].
    """

    value: FloatArray
    rest: FloatArray
    residual: FloatArray
    unknown: BoolArray
    undefined: BoolArray
    pays: BoolArray


def new_unknowns(states: int) -> Unknowns:
    """Return empty values."""
    return Unknowns(
        value=np.zeros(states),
        rest=np.zeros(states),
        residual=np.zeros(states),
        unknown=np.zeros(states + 1, dtype=np.bool_),
        undefined=np.zeros(states + 1, dtype=np.bool_),
        pays=np.zeros(states + 1, dtype=np.bool_),
    )


@for_kernels
def refine(chain: Chain, gamma: float, factors: Factors, found: Unknowns) -> bool:
    """Compute the values of the unknown states to full double precision.

    Returns False if the corrections do not converge, for example after overflow.
    """
    states = len(chain.earned)
    for state in range(states):
        found.value[state], found.rest[state] = 0.0, 0.0
        found.residual[state] = chain.earned[state] if found.unknown[state] else 0.0
    before = 0.0
    for _ in range(_MOST_ROUNDS):
        correction, largest = _correct(factors, found)
        # the next correction would shrink by the same factor
        after = correction * min(correction / before, 1.0) if before > 0.0 else correction
        if after <= _NEGLIGIBLE * largest:
            return True
        before = correction
        _find_residual(chain, gamma, found)
    return False


@for_kernels
def _correct(factors: Factors, found: Unknowns) -> tuple[float, float]:
    # Largest correction (NaN if any is), and largest value
    states = len(found.value)
    first, residual = factors.first, found.residual
    for taken in range(states):
        for part in range(first[2 * taken + 1], first[2 * taken + 2]):
            residual[factors.state[part]] += factors.entry[part] * residual[taken]
    correction, largest = 0.0, 0.0
    for taken in range(states - 1, -1, -1):
        if found.unknown[taken]:
            more = residual[taken]
            for part in range(first[2 * taken], first[2 * taken + 1]):
                more += factors.entry[part] * residual[factors.state[part]]
            more /= factors.leaving[taken]
            residual[taken] = more
            value, rest = two_sum(found.value[taken], more)
            value, rest = quick_two_sum(value, rest + found.rest[taken])
            found.value[taken], found.rest[taken] = value, rest
            if not abs(more) <= correction:
                correction = abs(more)
            if abs(value) > largest:
                largest = abs(value)
    return correction, largest


@for_kernels
def _find_residual(chain: Chain, gamma: float, found: Unknowns) -> None:
    # E[R + γ v(S′)] − v(s) of the unknown states, 0 for others
    states = len(chain.earned)
    for state in range(states):
        found.residual[state] = 0.0
        if found.unknown[state]:
            value, rest = found.value[state], found.rest[state]
            gain, gain_rest = 0.0, 0.0
            for way in range(chain.first[state], chain.first[state + 1]):
                target = chain.target[way]
                later, later_rest = 0.0, 0.0
                if target < states:
                    later, later_rest = found.value[target], found.rest[target]
                # differences keep the digits that γ v(s′) − v(s) would lose for γ near 1
                step, step_rest = plus(later, later_rest, -value, -rest)
                more, more_rest = times(step, step_rest, chain.weight[way], chain.weight_rest[way])
                gain, gain_rest = plus(gain, gain_rest, more, more_rest)
            gain, gain_rest = times(gain, gain_rest, gamma, 0.0)
            lost, lost_rest = times(value, rest, chain.stop[state], chain.stop_rest[state])
            left, left_rest = plus(gain, gain_rest, -lost, -lost_rest)
            found.residual[state] = plus(chain.earned[state], chain.earned_rest[state], left, left_rest)[0]
