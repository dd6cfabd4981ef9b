"""Stored runs equal runs trained now: a change of their bits raises a number in the key.

The expected whole numbers are equal on every machine, and almost any change of bits changes them.
"""

from __future__ import annotations

from typing import Final

import pytest
from plans import cell_of

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.studies.sweeps.cell import KERNELS
from rl_tui.studies.sweeps.runs import run_rows

pytestmark = pytest.mark.interpreted  # it has the same bits, and nothing to wait for

SEEDS: Final = (0, 1)


def steps_of(algorithm: str) -> tuple[int, ...]:
    cell = cell_of(
        "frozenlake", f"algorithm={algorithm}", episodes=30, overrides={"initial_q": 1.0, "alpha": 0.5}
    )
    return tuple(int(row.figures["steps"] or 0) for row in run_rows(cell, SEEDS))


def winnings_of(policy: str) -> tuple[int, ...]:
    cell = cell_of("bandit-bernoulli", f"policy={policy}", episodes=200)
    return tuple(round(200 * float(row.figures["area"] or 0)) for row in run_rows(cell, SEEDS))


@pytest.mark.parametrize("algorithm", BY_ID)
def test_the_steps_of_an_algorithm(algorithm: str) -> None:
    steps = steps_of(algorithm)
    assert algorithm in STEPS[KERNELS], f"a new algorithm: add {algorithm!r}: {steps} to STEPS"
    assert STEPS[KERNELS][algorithm] == steps, "raise KERNELS in studies/sweeps/cell.py"


@pytest.mark.parametrize("policy", POLICY_BY_ID)
def test_the_winnings_of_a_policy(policy: str) -> None:
    winnings = winnings_of(policy)
    assert policy in WINNINGS[KERNELS], f"a new action rule: add {policy!r}: {winnings} to WINNINGS"
    assert WINNINGS[KERNELS][policy] == winnings, "raise KERNELS in studies/sweeps/cell.py"


STEPS: Final = {
    1: {
        "q-learning": (294, 302),
        "sarsa": (311, 498),
        "expected-sarsa": (325, 341),
        "double-q-learning": (339, 346),
        "n-step-sarsa": (386, 889),
        "sarsa-lambda": (812, 561),
        "q-lambda": (967, 785),
        "dyna-q": (202, 212),
        "prioritized-sweeping": (189, 200),
        "monte-carlo": (315, 504),
        "value-iteration": (66, 66),
        "policy-iteration": (330, 330),
    }
}
"""For each number of the kernels."""
WINNINGS: Final = {
    1: {
        "epsilon-greedy": (140, 151),
        "softmax": (147, 148),
        "ucb": (137, 108),
        "gradient": (122, 110),
        "thompson": (167, 135),
    }
}
