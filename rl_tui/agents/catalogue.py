"""The algorithms, a row each. Free of numba, so that lists and help are quick."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Algorithm:
    """One algorithm as people see it and where its code is.

    ``module`` holds its memory and update rule; ``parameters`` names its hyper-parameters in the order of the
    controls panel; ``source`` is the box in Sutton & Barto (2nd ed.) that it follows.
    """

    id: str
    name: str
    summary: str
    equation: str
    source: str
    module: str
    parameters: tuple[str, ...]


ALGORITHMS: Final[tuple[Algorithm, ...]] = (
    Algorithm(
        id="q-learning",
        name="Q-learning",
        summary="off-policy TD control: learns the greedy policy's values while it explores",
        equation="Q(S,A) ← Q(S,A) + α [R + γ max Q(S′,·) − Q(S,A)]",
        source="equation 6.8, box on page 131",
        module="rl_tui.agents.algorithms.q_learning",
        parameters=("alpha", "gamma", "epsilon", "epsilon_min", "epsilon_decay", "initial_q", "ties"),
    ),
)

BY_ID: Final = {algorithm.id: algorithm for algorithm in ALGORITHMS}
