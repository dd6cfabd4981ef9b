"""Values to the last digit: what the factors give, corrected by what is left of the equation (4.4)."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.exact.small_worlds.chain import Chain
from rl_tui.agents.exact.small_worlds.double_double import plus, quick_two_sum, times, two_sum
from rl_tui.agents.exact.small_worlds.elimination import Factors
from rl_tui.agents.kernels.compiled import for_kernels
from rl_tui.worlds.mdp.space import BoolArray, FloatArray

# Two or three are enough as a rule, some ten where a chain is hardly well-conditioned
_MOST_ROUNDS: Final = 20
# Of the largest value: below it a double has no digits
_NEGLIGIBLE: Final = 2.0**-64


class Unknowns(NamedTuple):
    """The values of N live states, ``value`` + ``rest``, and what is left of their equations, [N] each.

    ``unknown`` says whose value is to be found, ``undefined`` who has none, [N+1] each, with the end as the
    last; all others are worth 0. ``pays``, [N+1], is memory.
    """

    value: FloatArray
    rest: FloatArray
    residual: FloatArray
    unknown: BoolArray
    undefined: BoolArray
    pays: BoolArray


def new_unknowns(states: int) -> Unknowns:
    """Return the memory for any chain of so many states."""
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
    """Find the values of the unknown states, and correct them until nothing is left that a double shows.

    Returns False where that does not come to an end, as where numbers overflow.
    """
    states = len(chain.earned)
    for state in range(states):
        found.value[state], found.rest[state] = 0.0, 0.0
        found.residual[state] = chain.earned[state] if found.unknown[state] else 0.0
    before = 0.0
    for _ in range(_MOST_ROUNDS):
        correction, largest = _correct(factors, found)
        # The next would be smaller by the same factor once more
        after = correction * min(correction / before, 1.0) if before > 0.0 else correction
        if after <= _NEGLIGIBLE * largest:
            return True
        before = correction
        _find_residual(chain, gamma, found)
    return False


@for_kernels
def _correct(factors: Factors, found: Unknowns) -> tuple[float, float]:
    """Add to the values what solves the equations for ``residual``, which is lost.

    Returns the largest of what was added and the largest value, both without their sign; the first is NaN
    where anything is.
    """
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
    """Leave E[R + γ v(S′)] − v(s) in ``residual`` of the unknown states, 0 in the others."""
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
                # Differences of values keep the digits that γ v(s′) − v(s) would lose where γ is near 1
                step, step_rest = plus(later, later_rest, -value, -rest)
                more, more_rest = times(step, step_rest, chain.weight[way], chain.weight_rest[way])
                gain, gain_rest = plus(gain, gain_rest, more, more_rest)
            gain, gain_rest = times(gain, gain_rest, gamma, 0.0)
            lost, lost_rest = times(value, rest, chain.stop[state], chain.stop_rest[state])
            left, left_rest = plus(gain, gain_rest, -lost, -lost_rest)
            found.residual[state] = plus(chain.earned[state], chain.earned_rest[state], left, left_rest)[0]
